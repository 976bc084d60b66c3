//! Models, robots and reference files are the same set, found and not listed by hand.

use shapebot_tests::environment::{robot_names, say};
use shapebot_tests::models::{derivation, model};
use shapebot_tests::reference::{load, names};

macro_rules! names_of {
    ($({ $name:literal, $($rest:tt)* })*) => { &[$($name),*] };
}

/// Robots that are compiled, and those among them with Γ.
const SYSTEMS: &[&str] = shapebot_generated::for_each_system!(names_of);
const ROBOTS: &[&str] = shapebot_generated::for_each_robot!(names_of);

#[test]
fn every_model_file_is_compiled() {
    let listed: Vec<&str> = shapebot_models::MODELS.iter().map(|(name, _)| *name).collect();
    assert_eq!(robot_names(), listed, "files and models");
    assert_eq!(SYSTEMS, listed, "compiled systems and models");
    ROBOTS.iter().for_each(|name| say(&format!("robot: {name}")));
}

#[test]
fn every_model_that_requires_to_be_a_robot_is_one() {
    use shapebot_model_dsl::model::Requirement;
    for name in SYSTEMS {
        let requirements = model(name).requirements;
        let mut required = requirements.iter().map(|r| &r.requirement);
        if required.any(|r| matches!(r, Requirement::ShapeAccelerated)) {
            assert!(ROBOTS.contains(name), "`{name}` is not among the robots");
        }
    }
}

#[test]
fn robots_are_the_models_that_are_proved_to_be() {
    for name in SYSTEMS {
        let proved = derivation(name).certificate.is_shape_accelerated();
        assert_eq!(ROBOTS.contains(name), proved, "{name}");
    }
}

#[test]
fn every_reference_file_is_of_a_robot() {
    let files = names("dynamics");
    assert!(files.len() >= 5, "{files:?}");
    for file in files {
        assert!(ROBOTS.contains(&file.as_str()), "no robot for the reference file {file}");
        let data = load("dynamics", &file).expect("a reference file");
        assert_eq!(data.get("system").text(), file);
    }
}
