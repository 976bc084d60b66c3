//! The description of a model as the runtime traits want it: with names that live for ever.

use crate::constant::Constants;
use shapebot_codegen::derive::{Derivation, points};
use shapebot_dynamics::{
    Actuator, Coordinate, CoulombFriction, Description, Geometry, Parameter, Role, ShapeSet, Solid,
};
use shapebot_model_dsl::model::{self, FrameId, Model};

/// A description of static lifetime. Its memory is not given back: a tool loads a handful of models.
pub(crate) fn leak(derivation: &Derivation) -> &'static Description {
    let model = &derivation.model;
    let constants = Constants::of(model);
    let description = Description {
        name: name(model),
        summary: text(summary(model)),
        coordinates: list(coordinates(derivation)),
        position_count: model.position_count(),
        shape_sets: list(shape_sets(derivation)),
        actuators: list(model.actuators.iter().map(|a| actuator(a, &constants))),
        parameters: list(model.parameters.iter().map(parameter)),
        outputs: list(outputs(model)),
        output_unit: output_unit(model),
        frames: list(model.frames.iter().map(|f| text(&f.name))),
        points: list(points(model).iter().map(|(name, _)| text(name))),
        geometry: list(geometry(model, &constants)),
        friction: list(model.friction.iter().map(|f| CoulombFriction {
            level: constants.value(f.level),
            weights: list(constants.slopes(f.displacement)),
        })),
    };
    Box::leak(Box::new(description))
}

fn text(string: &str) -> &'static str {
    Box::leak(string.to_owned().into_boxed_str())
}

fn list<T>(items: impl IntoIterator<Item = T>) -> &'static [T] {
    Box::leak(items.into_iter().collect::<Vec<T>>().into_boxed_slice())
}

/// The model file's stem; the robot's own name for a text without a file.
fn name(model: &Model) -> &'static str {
    let path = std::path::Path::new(&model.source_name);
    let is_file = path.extension().is_some_and(|extension| extension == "robot");
    let stem = path.file_stem().and_then(|stem| stem.to_str()).filter(|_| is_file);
    text(stem.unwrap_or(&model.name))
}

/// The first paragraph's first line.
fn summary(model: &Model) -> &str {
    model.docs.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or("")
}

fn coordinates(derivation: &Derivation) -> impl Iterator<Item = Coordinate> {
    let unactuated = derivation.equations.unactuated();
    derivation.model.coordinates.iter().enumerate().map(move |(i, coordinate)| {
        let (lower, upper) = bounds(coordinate.range);
        Coordinate {
            name: text(&coordinate.name),
            unit: text(&coordinate.unit.text),
            role: match coordinate.role {
                model::Role::Position => Role::Position,
                model::Role::Shape => Role::Shape,
            },
            actuated: !unactuated.contains(&i),
            lower,
            upper,
        }
    })
}

fn bounds(range: Option<model::Range>) -> (f64, f64) {
    range.map_or((f64::NEG_INFINITY, f64::INFINITY), |range| (range.lower, range.upper))
}

fn shape_sets(derivation: &Derivation) -> impl Iterator<Item = ShapeSet> {
    let unactuated = derivation.equations.unactuated();
    let position_count = derivation.model.position_count();
    let shapes = derivation.model.sets.iter().filter(|set| set.role == model::Role::Shape);
    shapes.map(move |set| {
        let members = || set.coordinates.iter().map(|id| id.0 as usize);
        ShapeSet {
            name: text(&set.name),
            first: members().next().unwrap_or(0).saturating_sub(position_count),
            len: set.coordinates.len(),
            actuated: members().all(|i| !unactuated.contains(&i)),
        }
    })
}

fn actuator(actuator: &model::Actuator, constants: &Constants<'_>) -> Actuator {
    Actuator {
        name: text(&actuator.name),
        unit: text(&actuator.unit.text),
        limit: actuator.limit.map_or(f64::INFINITY, |limit| constants.value(limit)),
    }
}

fn parameter(parameter: &model::Parameter) -> Parameter {
    let (lower, upper) = bounds(parameter.range);
    Parameter {
        name: text(&parameter.name),
        unit: text(&parameter.unit.text),
        value: parameter.value_f64,
        lower,
        upper,
        docs: text(&parameter.docs),
    }
}

fn outputs(model: &Model) -> Vec<&'static str> {
    match &model.output {
        Some(output) => output.names.iter().map(|name| text(name)).collect(),
        None => position_coordinates(model).map(|c| text(&c.name)).collect(),
    }
}

fn output_unit(model: &Model) -> &'static str {
    match &model.output {
        Some(output) => text(&output.unit.text),
        None => position_coordinates(model).next().map_or("", |c| text(&c.unit.text)),
    }
}

fn position_coordinates(model: &Model) -> impl Iterator<Item = &model::Coordinate> {
    model.coordinates.iter().filter(|c| c.role == model::Role::Position)
}

fn geometry(model: &Model, constants: &Constants<'_>) -> impl Iterator<Item = Geometry> {
    let first = model.points.len() + model.bodies.len();
    model.geometry.iter().enumerate().map(move |(i, geometry)| {
        let FrameId(frame) = geometry.frame;
        Geometry {
            name: text(&geometry.name),
            solid: solid(&geometry.solid, constants),
            frame: frame as usize,
            center: first + i,
        }
    })
}

fn solid(solid: &model::Solid, constants: &Constants<'_>) -> Solid {
    let v = |id| constants.value(id);
    match *solid {
        model::Solid::Sphere(radius) => Solid::Sphere(v(radius)),
        model::Solid::Box(edges) => Solid::Box(edges.map(v)),
        model::Solid::Capsule(radius, length) => Solid::Capsule(v(radius), v(length)),
        model::Solid::Cylinder(radius, length) => Solid::Cylinder(v(radius), v(length)),
    }
}
