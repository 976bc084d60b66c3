//! Commands, their output and their exit codes.

mod common;

use common::{root, shapebot};
use std::path::Path;

const CARTPOLE: &str = "
/// Cart-pole.
robot Cart {
    params { m_c: kg = 1 in 0.1..10; m_p: kg = 0.1 in 0.01..1; l: m = 0.5 in 0.1..2; g: m/s^2 = 9.81; }
    position x: m;
    shape phi: rad in -30deg..30deg;
    let tip = [x + l*sin(phi), 0, l*cos(phi)];
    kinetic 1/2*m_c*|d/dt([x, 0, 0])|^2 + 1/2*m_p*|d/dt(tip)|^2;
    potential m_p*g*l*cos(phi);
    actuator force on d/dt(x);
    require shape_accelerated;
}
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cart.robot"), CARTPOLE).unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let list = shapebot(folder, &["robots"], "").ok().stdout;
    let name = |line: &str| line.split_whitespace().next().map(str::to_owned);
    list.lines().skip(1).filter_map(name).collect()
}

#[test]
fn every_model_file_is_a_bundled_robot() {
    let here = folder();
    let models = std::fs::read_dir(root().join("robots/models")).unwrap();
    let mut stems: Vec<String> = models
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "robot"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    stems.sort();
    let mut listed = names(here.path());
    listed.sort();
    assert_eq!(listed, stems);
}

#[test]
fn without_a_command_the_paper_s_experiments_are_planned_and_simulated() {
    let here = folder();
    let run = shapebot(here.path(), &["-o", "out"], "").ok();
    let column = |robot: &str, i: usize| -> String {
        let line = run.stdout.lines().find(|line| line.split_whitespace().next() == Some(robot));
        let cells: Vec<&str> = line.unwrap().split("  ").filter(|cell| !cell.is_empty()).collect();
        cells[i].trim().to_owned()
    };
    for (robot, states, rmse) in [
        ("cartpole_planar", "4", 0.0211),
        ("ballbot_planar", "4", 0.0492),
        ("ballbot3d", "8", 0.0492),
        ("ballbot3d_arms", "16", 0.0488),
    ] {
        assert_eq!(column(robot, 1), states);
        let found: f64 = column(robot, 3).parse().unwrap();
        assert!((found - rmse).abs() <= 1.001e-4, "{robot}: {found}");
        for extension in ["csv", "svg"] {
            assert!(here.path().join(format!("out/{robot}.{extension}")).exists());
        }
    }
    assert!(!run.stdout.contains('\u{1b}') && run.stderr.is_empty(), "{}", run.stderr);
    let ends = run.stdout.lines().last().unwrap();
    assert!(run.stdout.contains("Closed loops") && ends.contains("report.html"), "{ends}");
    assert!(here.path().join("out/report.html").exists());
    // The planning table alone.
    let table = shapebot(here.path(), &["table", "-o", "table"], "").ok().stdout;
    assert!(table.contains("Table II") && !table.contains("Closed loops"));
}

#[test]
fn a_sound_model_is_checked_and_its_equations_printed() {
    let here = folder();
    let certificate = shapebot(here.path(), &["check", "cart.robot"], "").ok();
    assert!(certificate.stdout.contains("Cart"), "{}", certificate.stdout);
    for format in ["text", "latex", "json"] {
        let run = shapebot(here.path(), &["derive", "cart.robot", "--format", format], "").ok();
        assert!(run.stdout.contains("phi"), "{}", run.stdout);
    }
    let json = shapebot(here.path(), &["derive", "cart.robot", "--format", "json"], "").ok().stdout;
    serde_json::from_str::<serde_json::Value>(&json).unwrap();
}

#[test]
fn a_wrong_model_is_refused_with_its_place() {
    let here = folder();
    let wrong = CARTPOLE.replace("m_p*g*l*cos(phi);", "m_p*g*cos(phi);");
    std::fs::write(here.path().join("wrong.robot"), wrong).unwrap();
    for command in ["check", "derive", "eval"] {
        let run = shapebot(here.path(), &[command, "wrong.robot"], "").fails(1, "wrong.robot:9:");
        assert!(run.stdout.is_empty() && !run.stderr.contains('\u{1b}'));
    }
    std::fs::write(here.path().join("bytes.robot"), [0xff, 0xfe, 0x00]).unwrap();
    shapebot(here.path(), &["check", "bytes.robot"], "").fails(1, "UTF-8");
}

#[test]
fn emitted_code_is_written_and_named() {
    let here = folder();
    let run = shapebot(here.path(), &["emit", "cart.robot", "--bake", "-o", "code"], "").ok();
    assert!(run.stdout.contains("cart::Cart"), "{}", run.stdout);
    let code = std::fs::read_to_string(here.path().join("code/cart.rs")).unwrap();
    assert!(code.contains("pub mod cart") && code.contains("CartBaked"));
}

#[test]
fn a_file_is_planned_with_as_its_compiled_twin() {
    let here = folder();
    let plan = |robot: &str, json: &str| {
        let args = ["plan", robot, "--line", "2", "--duration", "5", "--json", json];
        shapebot(here.path(), &args, "").ok();
        let text = std::fs::read_to_string(here.path().join(json)).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()
    };
    std::fs::copy(
        root().join("robots/models/cartpole_planar.robot"),
        here.path().join("twin.robot"),
    )
    .unwrap();
    let (compiled, interpreted) = (plan("cartpole_planar", "a.json"), plan("twin.robot", "b.json"));
    let number = |plan: &serde_json::Value, key: &str| plan[key].as_f64().unwrap();
    for key in ["output_rmse", "output_end_error", "cost"] {
        let (a, b) = (number(&compiled, key), number(&interpreted, key));
        assert!((a - b).abs() <= 1e-9 * a, "{key}: {a} {b}");
    }
    assert_eq!(interpreted["robot"], "twin");
    assert_eq!(interpreted["samples"].as_array().unwrap().len(), 501);
}

#[test]
fn plans_are_written_in_every_form() {
    let here = folder();
    let bezier = "0,0 0,0 0,0 0,0 0,0 1,0 1,1 1,1 1,1 1,1 1,1";
    let files = ["--csv", "p/plan.csv", "--json", "p/plan.json", "--svg", "p/plan.svg"];
    let args = ["plan", "ballbot3d", "--bezier", bezier, "--duration", "8", "--samples", "41"];
    let run = shapebot(here.path(), &[&args[..], &files].concat(), "").ok();
    assert!(run.stdout.contains("RMSE") && run.stdout.contains("K phi_x"), "{}", run.stdout);
    let read = |name: &str| std::fs::read_to_string(here.path().join("p").join(name)).unwrap();
    let csv = read("plan.csv");
    assert_eq!(csv.lines().count(), 42);
    let columns = |line: &str| line.split(',').count();
    assert!(csv.lines().all(|line| columns(line) == columns(csv.lines().next().unwrap())));
    assert!(read("plan.svg").ends_with("</svg>\n"));
    assert!(read("plan.json").contains("\"K0\": [["));
}

#[test]
fn a_plan_that_does_not_work_out_is_refused_and_a_senseless_task_is_misuse() {
    let here = folder();
    let plan = |robot: &str, rest: &[&str]| {
        shapebot(here.path(), &[&["plan", robot][..], rest].concat(), "")
    };
    plan("ballbot3d", &["--line", "20,0", "--duration", "2"]).fails(1, "phi_y");
    plan("ballbot3d", &["--line", "2", "--duration", "5"]).fails(2, "output has 2");
    plan("ballbot3d", &["--line", "2,0", "--duration", "-5"]).fails(2, "duration");
    plan("ballbot3d", &["--line", "2,0", "--duration", "5", "--degree", "8"]).fails(2, "degree");
    plan("ballbot3d", &["--duration", "5"]).fails(2, "--line");
    plan("ballbot3d", &["--line", "2,inf", "--duration", "5"]).fails(2, "finite");
    let weights = ["--line", "2,0", "--duration", "5", "--weights", "phy=1"];
    plan("ballbot3d", &weights).fails(2, "did you mean `phi`?");
}

#[test]
fn a_model_outside_the_class_has_dynamics_but_no_plan() {
    let here = folder();
    let free = CARTPOLE
        .replace("    actuator force on d/dt(x);\n", "")
        .replace("    require shape_accelerated;\n", "");
    std::fs::write(here.path().join("free.robot"), free).unwrap();
    let run = shapebot(here.path(), &["eval", "free.robot"], "{\"q\":[0,0],\"qd\":[0,0]}\n").ok();
    assert!(run.stdout.contains("\"qdd_fd\":[") && !run.stdout.contains("Gamma"));
    shapebot(here.path(), &["eval", "free.robot", "--fields", "Gamma"], "")
        .fails(2, "not shape-acc");
    let plan = ["plan", "free.robot", "--line", "1", "--duration", "5"];
    shapebot(here.path(), &plan, "").fails(1, "shapebot check free.robot");
    shapebot(here.path(), &["check", "free.robot"], "").ok();
}

#[test]
fn parameters_are_known_by_name_and_range() {
    let here = folder();
    let eval = |robot: &str, parameter: &str| {
        let args = ["eval", robot, "--fields", "potential", "--param", parameter];
        shapebot(here.path(), &args, "{\"q\":[0.1,0.2]}\n")
    };
    let number = |robot: &str, parameter: &str| -> f64 {
        let line = eval(robot, parameter).ok().stdout;
        serde_json::from_str::<serde_json::Value>(&line).unwrap()["potential"].as_f64().unwrap()
    };
    assert!(
        (number("cart.robot", "m_p=0.2") / number("cart.robot", "m_p=0.1") - 2.0).abs() < 1e-14
    );
    assert!(number("ballbot_planar", "m_b=50").is_finite());
    eval("cart.robot", "m_q=1").fails(2, "did you mean");
    eval("cart.robot", "m_p=7").fails(2, "range 0.01 to 1");
    eval("ballbot_planar", "m_b=nan").fails(2, "finite");
}

#[test]
fn codes_are_listed_and_explained() {
    let here = folder();
    let list = shapebot(here.path(), &["explain"], "").ok().stdout;
    let code = list.split_whitespace().next().unwrap();
    assert!(list.lines().count() > 10);
    assert!(shapebot(here.path(), &["explain", code], "").ok().stdout.contains(code));
    shapebot(here.path(), &["explain", "E9999"], "").fails(2, "E9999");
}

#[test]
fn misuse_is_answered_with_help() {
    let here = folder();
    shapebot(here.path(), &["check", "balbot3d"], "").fails(2, "did you mean `ballbot3d`?");
    shapebot(here.path(), &["check", "absent.robot"], "").fails(2, "absent.robot");
    shapebot(here.path(), &["check", "."], "").fails(2, ".");
    shapebot(here.path(), &["fly"], "").fails(2, "fly");
    for command in ["robots", "check", "derive", "emit", "plan", "eval", "explain"] {
        let help = shapebot(here.path(), &[command, "--help"], "").ok().stdout;
        assert!(command == "robots" || help.contains("Examples:"), "{help}");
    }
    assert!(shapebot(here.path(), &["--help"], "").ok().stdout.contains("Examples:"));
}
