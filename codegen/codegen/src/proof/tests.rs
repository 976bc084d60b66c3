//! What the proof says about the bundled models, and about the same models spoiled.

use super::*;
use crate::derive;
use shapebot_model_dsl::codes;

/// Text of a bundled model.
fn bundled(name: &str) -> String {
    let path = format!("{}/../../robots/models/{name}.robot", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

fn model(text: &str) -> Model {
    let parsed = shapebot_model_dsl::parse("test.robot", text);
    parsed.model.unwrap_or_else(|| panic!("{:#?}", parsed.diagnostics))
}

/// The model with one piece of text replaced.
fn spoiled(name: &str, changes: &[(&str, &str)]) -> Model {
    let text = changes.iter().fold(bundled(name), |text, (from, to)| {
        assert!(text.contains(from), "{name} contains `{from}`");
        text.replace(from, to)
    });
    model(&text)
}

fn certified(model: &Model) -> Certificate {
    prove(model, &derive::equations(model).unwrap()).unwrap_or_else(|errors| panic!("{errors:#?}"))
}

fn refused(model: &Model) -> Vec<Diagnostic> {
    prove(model, &derive::equations(model).unwrap()).unwrap_err()
}

const ALL: [&str; 7] = [
    "ballbot_planar",
    "ballbot3d",
    "ballbot3d_arms",
    "cartpole_planar",
    "cartpole3d",
    "marble_maze",
    "segway_planar",
];

#[test]
fn every_bundled_model_is_shape_accelerated() {
    for name in ALL {
        let model = model(&bundled(name));
        let certificate = certified(&model);
        assert!(certificate.is_shape_accelerated(), "{name}");
        assert_eq!(certificate.conditions.len(), 6);
        assert_eq!(certificate.strict.holds, name != "marble_maze");
    }
}

#[test]
fn ballbot_falls_with_the_known_poles() {
    let certificate = certified(&model(&bundled("ballbot_planar")));
    let linear = certificate.linearisation.unwrap();
    let fastest = linear.poles.iter().map(|r| r.re).fold(0.0, f64::max);
    let locked = linear.locked_poles.iter().map(|r| r.re).fold(0.0, f64::max);
    assert!((fastest - 6.25).abs() < 0.01 && (locked - 2.748).abs() < 0.01);
    assert!((linear.output_time_constants[0][0] - 0.120).abs() < 5e-4);
    let pole = certified(&model(&bundled("cartpole_planar"))).linearisation.unwrap();
    // τ² = l/g, as seen from the cart.
    assert!((pole.output_time_constants[0][0] - 0.5 / 9.81).abs() < 1e-12);
}

#[test]
fn numeric_gain_is_equation_26() {
    let map = certified(&model(&bundled("ballbot3d_arms"))).shape_map.unwrap();
    let chi1 = 9.81 * 0.55;
    let chi2 = 70.3 * 9.81 * 0.87 + 2.0 * 9.81 * (1.3 - 0.55);
    let (r, reach) = (0.1058_f64, 1.3 - 0.55);
    let chi3 = 0.0174 + (2.0 + 70.3 + 2.44) * r * r + 70.3 * 0.87 * r + 2.0 * reach * r;
    let (a, b) = (chi1 / chi3, chi2 / chi3);
    let expected = [[0.0, -a, 0.0, -a, 0.0, b], [a, 0.0, a, 0.0, -b, 0.0]];
    for (row, want) in map.gain.iter().zip(expected) {
        for (value, want) in row.iter().zip(want) {
            assert!((value - want).abs() < 1e-12 * b);
        }
    }
    assert!(!map.invertible);
    assert!(matches!(map.over_coordinates, RangeClaim::Proved { .. }));
    assert!(matches!(map.over_parameters, RangeClaim::Proved { .. }));
}

#[test]
fn constraint_of_the_ballbot_is_not_even_partially_integrable() {
    let certificate = certified(&model(&bundled("ballbot3d")));
    assert!(certificate.integrability.is_nonholonomic());
}

#[test]
fn mass_matrix_that_sees_the_position_is_refused_by_its_term() {
    let text =
        ("kinetic 1/2*(m_w", "kinetic 1/2*I_w*(1 + theta^2)*d/dt(phi)^2;\n    kinetic 1/2*(m_w");
    let model = spoiled("ballbot_planar", &[text]);
    let errors = refused(&model);
    assert_eq!(errors[0].code, codes::P0602);
    assert!(model.text(errors[0].span).contains("1 + theta^2"));
    assert!(errors[0].primary_label.contains("M[phi, phi]"));
}

#[test]
fn spring_on_the_position_that_couples_is_refused_by_its_term() {
    let spring =
        ("gravity g along", "potential 1/2*m_b*g/l_b*(r_w*(theta + phi))^2;\n    gravity g along");
    let model = spoiled("ballbot_planar", &[spring]);
    let errors = refused(&model);
    assert_eq!(errors[0].code, codes::P0602);
    assert!(errors[0].primary_label.contains("potential term makes G[phi]"));
}

#[test]
fn inertia_of_the_position_that_changes_with_shape_is_refused_by_its_rate() {
    let text =
        ("kinetic 1/2*(m_w", "kinetic 1/2*I_w*(1 + phi^2)*d/dt(theta)^2;\n    kinetic 1/2*(m_w");
    let errors = refused(&spoiled("ballbot_planar", &[text]));
    assert_eq!(errors[0].code, codes::P0603);
}

#[test]
fn pendulum_at_a_right_angle_has_no_shape_map() {
    let errors = refused(&spoiled(
        "cartpole_planar",
        &[("track + pole*[0, 0, l] }", "track + pole*[l, 0, 0] }")],
    ));
    assert_eq!(errors[0].code, codes::P0604);
    // Nor is it an equilibrium: both are said at once.
    assert!(errors.iter().any(|e| e.code == codes::P0605));
}

#[test]
fn eccentric_body_is_told_where_it_balances() {
    let errors = refused(&spoiled(
        "cartpole_planar",
        &[("track + pole*[0, 0, l] }", "track + pole*[l/10, 0, l] }")],
    ));
    assert_eq!(errors[0].code, codes::P0605);
    assert!(errors[0].help.as_ref().unwrap().contains("phi = -5.71 deg"));
}

#[test]
fn robot_without_gravity_cannot_accelerate_by_its_shape() {
    let errors = refused(&spoiled("ballbot3d", &[("gravity g along -world.z;", "")]));
    assert_eq!(errors[0].code, codes::P0606);
}

#[test]
fn segway_in_the_absolute_wheel_angle_is_told_wheel_minus_body() {
    let model = spoiled(
        "segway_planar",
        &[
            ("r_w*(theta + phi)", "r_w*theta"),
            ("tau_wheels on d/dt(theta)", "tau_wheels on d/dt(theta - phi)"),
        ],
    );
    let errors = refused(&model);
    assert_eq!(errors.len(), 1);
    assert_eq!(errors[0].code, codes::P0607);
    assert!(errors[0].help.as_ref().unwrap().contains("`theta - phi`"));
    assert!(errors[0].help.as_ref().unwrap().contains("let theta = theta_rel + phi;"));
}

#[test]
fn range_with_a_singularity_inside_is_refused() {
    let errors = refused(&spoiled("cartpole_planar", &[("-60deg..60deg", "-100deg..100deg")]));
    assert_eq!(errors[0].code, codes::P0613);
    // Up to the right angle itself is singular as well, at the very edge.
    let errors = refused(&spoiled("cartpole_planar", &[("-60deg..60deg", "-90deg..90deg")]));
    assert_eq!(errors[0].code, codes::P0613);
}

#[test]
fn arms_that_differ_are_no_mirror_images() {
    let errors = refused(&spoiled(
        "ballbot3d_arms",
        &[("right = Arm(alpha_r, -1);", "right = Arm(alpha_r, -2);")],
    ));
    assert_eq!(errors[0].code, codes::P0608);
    assert!(!errors[0].labels.is_empty());
}

#[test]
fn mass_without_a_coordinate_is_refused_in_any_class() {
    let model = spoiled(
        "cartpole_planar",
        &[("rigid bob { mass: m_p", "rigid bob { mass: 0*m_p"), ("require shape_accelerated;", "")],
    );
    assert_eq!(refused(&model)[0].code, codes::P0611);
}

#[test]
fn idle_arm_joint_is_warned_about() {
    // Gravity does nothing to an arm whose mass sits in the shoulder.
    let model = spoiled(
        "ballbot3d_arms",
        &[("shoulder + arm*[0, 0, -l_a],", "shoulder,"), ("require mirror(left, right);", "")],
    );
    let warnings = certified(&model).warnings;
    assert_eq!(warnings.iter().filter(|w| w.code == codes::P0612).count(), 2);
}

#[test]
fn undriven_model_without_demands_gets_its_reasons() {
    let model = spoiled(
        "cartpole3d",
        &[("actuator f_y on d/dt(y) limit f_max;", ""), ("require shape_accelerated;", "")],
    );
    let certificate = certified(&model);
    let Class::NotShapeAccelerated { reasons } = &certificate.class else {
        panic!("three unactuated equations")
    };
    assert_eq!(reasons[0].code, codes::P0601);
    assert!(certificate.to_text().contains("not shape-accelerated"));
}

#[test]
fn free_particle_is_completely_integrable() {
    let text = "robot Free { params { m: kg = 1; } position x: m; shape y: m; \
                kinetic 1/2*m*d/dt(x)^2; kinetic 1/2*m*d/dt(y)^2; actuator f on d/dt(x); }";
    let certificate = certified(&model(text));
    assert_eq!(certificate.integrability.involutive, Some(true));
    assert!(!certificate.is_shape_accelerated());
}
