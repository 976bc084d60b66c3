//! Models that are refused, and what is said about them.

use shapebot_codegen::derive::{Parameters, derive};
use shapebot_codegen::{Build, BuildError};
use shapebot_tests::models::checked;

const SEGWAY_ABSOLUTE: &str = include_str!("../data/segway_absolute.robot");
const FREE_CHAIN: &str = include_str!("../data/free_chain.robot");

/// What a build script says about a model that it refuses.
fn refusal(name: &str, text: &str) -> String {
    match Build::new().text(name, text).modules() {
        Err(error @ BuildError::Model { .. }) => error.to_string(),
        Err(other) => panic!("refused for another reason: {other}"),
        Ok(_) => panic!("`{name}` is not refused"),
    }
}

#[test]
fn a_segway_in_the_absolute_wheel_angle_is_refused_naming_wheel_minus_body() {
    let said = refusal("segway_absolute", SEGWAY_ABSOLUTE);
    assert!(said.contains("theta - phi"), "the coordinate that would do is not named:\n{said}");
    assert!(said.contains("segway_absolute.robot:"), "no place is named:\n{said}");
}

#[test]
fn the_same_segway_in_wheel_minus_body_is_accepted() {
    let text = SEGWAY_ABSOLUTE.replace("r_w*theta,", "r_w*(theta + phi),");
    let text = text.replace("on d/dt(theta - phi)", "on d/dt(theta)");
    assert_ne!(text, SEGWAY_ABSOLUTE);
    let modules = Build::new().text("segway", text).modules();
    assert!(modules.unwrap_or_else(|error| panic!("{error}"))[0].shape_accelerated);
}

#[test]
fn a_chain_of_free_links_gets_its_dynamics_but_no_shape_map() {
    let derived = derive(&checked("free_chain", FREE_CHAIN), Parameters::Symbolic);
    let derived = derived.unwrap_or_else(|errors| panic!("{errors:?}"));
    assert!(!derived.certificate.is_shape_accelerated());
    let module = &Build::new().text("free_chain", FREE_CHAIN).modules().expect("a module")[0];
    assert!(!module.shape_accelerated);
    assert!(module.text.contains("::shapebot_dynamics::LagrangianSystem<T, 3>"));
    assert!(!module.text.contains("ShapeAccelerated<"), "Γ is emitted without proof");
}

#[test]
fn all_refused_models_of_a_build_are_reported_at_once() {
    let twice = Build::new().text("first", SEGWAY_ABSOLUTE).text("second", SEGWAY_ABSOLUTE);
    let said = twice.modules().expect_err("refused").to_string();
    assert!(said.contains("first.robot") && said.contains("second.robot"), "{said}");
}
