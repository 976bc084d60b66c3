//! The printed equations of the bundled models: what the paper prints, symbol by symbol.

use super::sheet::wanted;
use super::*;
use crate::derive;
use shapebot_symbolic::{Graph, Id, Symbol};

const ALL: [&str; 7] = [
    "ballbot_planar",
    "ballbot3d",
    "ballbot3d_arms",
    "cartpole_planar",
    "cartpole3d",
    "marble_maze",
    "segway_planar",
];

fn model(name: &str) -> Model {
    let path = format!("{}/../../robots/models/{name}.robot", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    shapebot_model_dsl::parse(name, &text).model.unwrap()
}

fn printed(name: &str, print: fn(Subject<'_>) -> String) -> String {
    let model = model(name);
    let (equations, certificate) = derive::prove(&model).unwrap();
    print(Subject::from((&model, &equations, &certificate)))
}

/// A parameter or coordinate by its path.
fn symbol(graph: &mut Graph, model: &Model, path: &str) -> Id {
    let index = |found: Option<usize>| found.map(|i| u32::try_from(i).unwrap());
    let parameter =
        index(model.parameters.iter().position(|p| p.path == path)).map(Symbol::Parameter);
    let coordinate =
        index(model.coordinates.iter().position(|c| c.path == path)).map(Symbol::Coordinate);
    graph.symbol(parameter.or(coordinate).unwrap())
}

fn sum(graph: &mut Graph, terms: &[&[Id]]) -> Id {
    terms.iter().fold(graph.zero(), |sum, factors| {
        let product = factors.iter().fold(graph.one(), |p, &f| graph.mul(p, f));
        graph.add(sum, product)
    })
}

#[test]
fn equation_21_of_the_paper_is_what_was_derived() {
    let model = model("ballbot3d");
    let equations = derive::equations(&model).unwrap();
    let mut g = equations.graph.clone();
    let derived = wanted(&mut g, &equations).static_map;
    let [iw, mb, mw, lb, rw, gr] =
        ["I_w", "m_b", "m_w", "l_b", "r_w", "g"].map(|name| symbol(&mut g, &model, name));
    let [x, y] = ["phi.x", "phi.y"].map(|name| symbol(&mut g, &model, name));
    let (cx, sx, cy, sy) = (g.cos(x), g.sin(x), g.cos(y), g.sin(y));
    let eta1 = sum(&mut g, &[&[iw], &[mb, rw, rw], &[mw, rw, rw]]);
    let eta2 = sum(&mut g, &[&[mb, lb, rw]]);
    let eta3 = sum(&mut g, &[&[mb, gr, lb]]);
    let both = sum(&mut g, &[&[eta1], &[eta2, cx, cy]]);
    let single = sum(&mut g, &[&[eta1], &[eta2, cx]]);
    let first = sum(&mut g, &[&[eta3, cx, sy]]);
    let first = g.div(first, both);
    let inner = sum(&mut g, &[&[eta1, cy], &[eta2, cx]]);
    let second = sum(&mut g, &[&[eta3, sx, inner]]);
    let below = g.mul(both, single);
    let second = g.div(second, below);
    let second = g.neg(second);
    assert_eq!(derived, [first, second]);
}

#[test]
fn equation_21_is_printed_in_lowest_terms() {
    let text = printed("ballbot3d", text::print);
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(joined.contains(
        "theta.x'' = m_b*g*l_b*cos(phi.x)*sin(phi.y)/(I_w + (m_b + m_w)*r_w^2 + m_b*l_b*r_w*cos(phi.x)*cos(phi.y))"
    ));
    assert!(joined.contains(
        "/((I_w + (m_b + m_w)*r_w^2 + m_b*l_b*r_w*cos(phi.x))*(I_w + (m_b + m_w)*r_w^2 + m_b*l_b*r_w*cos(phi.x)*cos(phi.y)))"
    ));
}

#[test]
fn equation_22_is_one_factor_times_a_quarter_turn() {
    let latex = printed("ballbot3d", latex::print);
    assert!(latex.contains(
        "K^0_{q_s} = \\frac{m_b g \\ell_b}{I_w + (m_b + m_w) r_w^2 + m_b \\ell_b r_w}\
         \\begin{bmatrix}0 & 1 \\\\ -1 & 0\\end{bmatrix}"
    ));
    assert!(
        latex.contains(
            "K^0_{q_x} = \\frac{I_w + (m_b + m_w) r_w^2 + m_b \\ell_b r_w}{m_b g \\ell_b}"
        )
    );
}

#[test]
fn equation_26_is_one_factor_times_a_short_matrix() {
    let latex = printed("ballbot3d_arms", latex::print);
    assert!(latex.contains(
        "K^0_{q_s} = \\frac{g}{I_w + (2 m_a + m_b + m_w) r_w^2 + 2 m_a r_w (d_z - \\ell_a) + m_b \\ell_b r_w}\
         \\begin{bmatrix}0 & -m_a \\ell_a & 0 & -m_a \\ell_a & 0 & 2 m_a (d_z - \\ell_a) + m_b \\ell_b \\\\"
    ));
}

#[test]
fn cart_pole_accelerates_as_the_tangent_of_its_lean() {
    let text = printed("cartpole_planar", text::print);
    assert!(text.contains("  x'' = g*sin(phi)/cos(phi)\n"));
    assert!(text.contains("  K0_qs = g\n"));
    assert!(text.contains("  M[x, phi] = m_p*l*cos(phi)\n"));
    assert!(text.contains("  Cq'[x] = -m_p*l*sin(phi)*phi'^2\n"));
}

#[test]
fn maze_prints_rational_factors() {
    let text = printed("marble_maze", text::print);
    assert!(text.contains("  K0_qs = 5/7*g * [0, 1; -1, 0]\n"));
    assert!(text.contains("  K0_qx = 7/(5*g) * [0, -1; 1, 0]\n"));
}

#[test]
fn latex_is_balanced() {
    for name in ALL {
        let latex = printed(name, latex::print);
        let body: String = latex.lines().filter(|line| !line.starts_with('%')).collect();
        let count = |what: &str| body.matches(what).count();
        assert_eq!(count("{"), count("}"), "{name}");
        assert_eq!(count("("), count(")"), "{name}");
        assert_eq!(count("\\begin"), count("\\end"), "{name}");
        assert!(!body.contains('?'), "{name}");
    }
}

#[test]
fn text_keeps_to_its_width() {
    for name in ALL {
        let text = printed(name, text::print);
        // One product of an arm's bias is as long as that.
        let longest = text.lines().map(str::len).max().unwrap();
        assert!(longest <= 120, "{name}: {longest}");
    }
}

#[test]
fn json_is_balanced_and_says_what_was_proved() {
    for name in ALL {
        let json = printed(name, json::print);
        let outside: String = json.split('"').step_by(2).collect();
        let count = |what: char| outside.matches(what).count();
        assert_eq!(count('{'), count('}'), "{name}");
        assert_eq!(count('['), count(']'), "{name}");
        assert!(json.contains("\"shape_accelerated\": true"));
    }
}

#[test]
fn printing_is_deterministic() {
    assert_eq!(printed("ballbot3d_arms", text::print), printed("ballbot3d_arms", text::print));
}
