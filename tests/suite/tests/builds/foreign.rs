//! Somebody else's crate, outside of this workspace, that follows the README.

use shapebot_tests::copies::{build_folder, cargo, copy_crate};
use shapebot_tests::environment::read;

const FILES: [&str; 4] = ["Cargo.toml", "build.rs", "src/main.rs", "models/my_robot.robot"];

/// Γ, M₁₁, M₁₂, M₂₂, (C q̇)₁, G₂ and K⁰ at the state that the crate prints.
fn expected() -> [f64; 7] {
    let (cart, mass, l, g) = (1.5, 0.2, 0.4, 9.81);
    let (sin, cos) = 0.2_f64.sin_cos();
    let gamma = (g * sin - l * 1.5) / cos;
    let bias = -mass * l * sin * 0.7 * 0.7;
    [gamma, cart + mass, mass * l * cos, mass * l * l, bias, -mass * g * l * sin, g]
}

#[test]
fn five_lines_of_build_script_make_a_robot() {
    let (folder, target) = (build_folder("foreign/crate"), build_folder("foreign/target"));
    copy_crate("foreign", &FILES, &folder);
    let printed = cargo(&folder, &target, &["run", "--quiet", "--offline"], "");
    let numbers: Vec<f64> = printed.lines().map(|line| line.parse().expect("a number")).collect();
    assert_eq!(numbers.len(), 16, "{printed}");
    for (index, expected) in expected().into_iter().enumerate() {
        let (double, single) = (numbers[index], numbers[7 + index]);
        assert!(
            (double / expected - 1.0).abs() < 1e-14,
            "number {index}: {double}, not {expected}"
        );
        assert!((single / expected - 1.0).abs() < 1e-6, "number {index}: {single}, not {expected}");
    }
    assert!((numbers[14] - 2.7).abs() < 1e-15, "a heavier cart: {}", numbers[14]);
    // More than the (m_c + m_p) g φ that would hold the lean, towards it.
    assert!(numbers[15] > 1.7 * 9.81 * 0.05 && numbers[15] < 10.0, "a force: {}", numbers[15]);
}

#[test]
fn the_build_script_is_that_of_the_readme() {
    let lines = |text: &str| -> Vec<String> {
        let code = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with("//"));
        code.map(str::to_owned).collect()
    };
    let readme = read("README.md");
    let script = lines(&read("tests/foreign/build.rs"));
    assert!(script.len() <= 5, "{script:?}");
    let shown: Vec<Vec<String>> = readme.split("```").map(lines).collect();
    let shown =
        |code: &[String]| shown.iter().any(|block| block.windows(code.len()).any(|w| w == code));
    assert!(shown(&script), "the README shows another build script");
    let main = read("tests/foreign/src/main.rs");
    let include =
        lines(&main).into_iter().find(|line| line.contains("include_model!")).expect("an include");
    assert!(shown(std::slice::from_ref(&include)), "the README includes the model in another way");
}
