//! The bundled models are clean and say what they should.
#![allow(missing_docs)]

use shapebot_model_dsl::model::{Model, Role};
use shapebot_model_dsl::{parse, render};
use std::collections::BTreeMap;
use std::path::Path;

/// The models of this checkout; none in a packaged crate.
fn models() -> BTreeMap<String, Model> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../robots/models");
    let Ok(files) = std::fs::read_dir(folder) else { return BTreeMap::new() };
    let mut list = BTreeMap::new();
    for path in
        files.map(|f| f.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "robot"))
    {
        let text = std::fs::read_to_string(&path).unwrap();
        let parsed = parse(&path.to_string_lossy(), &text);
        let messages = render(&parsed.diagnostics, &path.to_string_lossy(), &text, false);
        assert!(parsed.diagnostics.is_empty(), "{messages}");
        list.insert(
            path.file_stem().unwrap().to_string_lossy().into_owned(),
            parsed.model.unwrap(),
        );
    }
    list
}

#[test]
fn coordinates_are_those_of_the_reference_data() {
    let expected: &[(&str, &[&str])] = &[
        ("cartpole_planar", &["x", "phi"]),
        ("cartpole3d", &["x", "y", "phi_x", "phi_y"]),
        ("ballbot_planar", &["theta", "phi"]),
        ("ballbot3d", &["theta_x", "theta_y", "phi_x", "phi_y"]),
        (
            "ballbot3d_arms",
            &[
                "theta_x",
                "theta_y",
                "alpha_l_x",
                "alpha_l_y",
                "alpha_r_x",
                "alpha_r_y",
                "phi_x",
                "phi_y",
            ],
        ),
        ("segway_planar", &["theta", "phi"]),
        ("marble_maze", &["x", "y", "beta_x", "beta_y"]),
    ];
    let models = models();
    for (name, names) in expected.iter().filter(|_| !models.is_empty()) {
        let found: Vec<&str> = models[*name].coordinates.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(&found, names, "{name}");
    }
}

#[test]
fn every_model_is_complete() {
    for (name, model) in models() {
        assert!(!model.docs.is_empty(), "{name}");
        assert!(model.parameters.iter().all(|p| !p.docs.is_empty() && p.range.is_some()), "{name}");
        assert!(model.coordinates.iter().all(|c| c.range.is_some()), "{name}");
        assert_eq!(
            model.output.as_ref().map(|o| o.entries.len()),
            Some(model.position_count()),
            "{name}"
        );
        assert!(
            !model.actuators.is_empty() && model.actuators.iter().all(|a| a.limit.is_some()),
            "{name}"
        );
        assert!(!model.geometry.is_empty() && !model.points.is_empty(), "{name}");
        assert!(!model.requirements.is_empty() && !model.dissipation.is_empty(), "{name}");
        assert_well_formed(&model);
    }
}

/// What other crates may rely on.
fn assert_well_formed(model: &Model) {
    let positions = model.position_count();
    assert!(model.coordinates[..positions].iter().all(|c| c.role == Role::Position));
    for (i, set) in model.sets.iter().enumerate() {
        for id in &set.coordinates {
            assert_eq!(model.coordinates[id.0 as usize].set, i);
        }
    }
    for (i, frame) in model.frames.iter().enumerate() {
        assert_eq!(frame.parent.is_none(), i == 0);
        assert!(frame.parent.is_none_or(|p| (p.0 as usize) < i));
    }
    for body in &model.bodies {
        assert!(body.com.terms.windows(2).all(|w| w[0].frame < w[1].frame));
    }
}

#[test]
fn arms_exchange_their_coordinates() {
    use shapebot_model_dsl::model::Requirement;
    let models = models();
    let Some(model) = models.get("ballbot3d_arms") else { return };
    let mirror = model.requirements.iter().find_map(|r| match &r.requirement {
        Requirement::Mirror { instances, exchanged } => {
            Some((instances.clone(), exchanged.clone()))
        }
        _ => None,
    });
    let (instances, exchanged) = mirror.unwrap();
    assert_eq!(instances, ("left".to_owned(), "right".to_owned()));
    let name = |id: shapebot_model_dsl::model::CoordinateId| {
        model.coordinates[id.0 as usize].name.as_str()
    };
    let pairs: Vec<(&str, &str)> = exchanged.iter().map(|(a, b)| (name(*a), name(*b))).collect();
    assert_eq!(pairs, [("alpha_l_x", "alpha_r_x"), ("alpha_l_y", "alpha_r_y")]);
    let bodies: Vec<&str> = model.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(bodies, ["trunk", "left.weight", "right.weight"]);
}
