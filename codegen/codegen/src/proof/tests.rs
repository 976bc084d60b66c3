//! What the proof says about the bundled models, and about the same models spoiled.

use super::*;
use crate::derive;
use std::time::Instant;

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
    let errors = prove(model, &derive::equations(model).unwrap()).unwrap_err();
    eprintln!("{}", shapebot_model_dsl::render(&errors, &model.source_name, &model.source, false));
    errors
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
        let equations = derive::equations(&model).unwrap();
        let start = Instant::now();
        let certificate = prove(&model, &equations).unwrap_or_else(|e| panic!("{name}: {e:#?}"));
        eprintln!("{name}: {:?}\n{}", start.elapsed(), certificate.to_text());
        assert!(certificate.is_shape_accelerated(), "{name}");
        assert_eq!(certificate.conditions.len(), 6);
        assert_eq!(certificate.strict.holds, name != "marble_maze");
    }
}
