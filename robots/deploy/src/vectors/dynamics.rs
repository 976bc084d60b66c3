//! Equations of motion at random states.

use super::random::Random;
use super::text::{array, list};
use crate::Error;
use crate::derived::Derived;
use shapebot_codegen::derive::Quantity;
use shapebot_dynamics::Coordinate;
use shapebot_interpreter::{State, Tapes};

/// States.
const STATES: usize = 16;

/// Share of a coordinate's declared range that is used: at its ends a mass matrix may be ill-conditioned.
const SHARE: f64 = 0.6;

const KIND: &str = "/// A state, and what is known there; matrices row by row.
#[derive(Debug)]
pub struct Dynamics {
    pub q: &'static [f64],
    pub qd: &'static [f64],
    pub qdd: &'static [f64],
    pub force: &'static [f64],
    pub mass_matrix: &'static [f64],
    pub coriolis_vector: &'static [f64],
    pub gravity: &'static [f64],
    pub gamma: &'static [f64],
    pub forward_dynamics: &'static [f64],
}

";

/// The items of the vectors' module.
pub(crate) fn record(derived: &Derived) -> Result<String, Error> {
    let mut random = Random::new();
    let mut entries = Vec::new();
    for _ in 0..STATES {
        entries.push(entry(&derived.tapes, &mut random)?);
    }
    let docs = "The symbolic derivation, interpreted at the model's own parameters.";
    Ok(KIND.to_owned() + &list(docs, "DYNAMICS", "Dynamics", &entries))
}

fn entry(tapes: &Tapes<f64>, random: &mut Random) -> Result<String, Error> {
    let coordinates = tapes.description().coordinates;
    let q: Vec<f64> = coordinates.iter().map(|c| within(c, random)).collect();
    let mut draw = |most: f64| -> Vec<f64> {
        coordinates.iter().map(|_| random.between(-most, most)).collect()
    };
    let (qd, qdd, force) = (draw(1.0), draw(2.0), draw(10.0));
    let state = State { q: &q, qd: &qd, qdd: &qdd, force: &force };
    let mut text = String::from("Dynamics {");
    for (name, numbers) in [("q", &q), ("qd", &qd), ("qdd", &qdd), ("force", &force)] {
        text += &format!("{name}: &{},\n", array(numbers));
    }
    for (name, quantity) in [
        ("mass_matrix", Quantity::MassMatrix),
        ("coriolis_vector", Quantity::CoriolisVector),
        ("gravity", Quantity::Gravity),
        ("gamma", Quantity::Gamma),
        ("forward_dynamics", Quantity::ForwardDynamics),
    ] {
        let mut results = vec![0.0; tapes.result_count(quantity)?];
        tapes.evaluate(quantity, &state, &mut results)?;
        text += &format!("{name}: &{},\n", array(&results));
    }
    Ok(text + "},")
}

/// A value in the middle of a coordinate's range.
fn within(coordinate: &Coordinate, random: &mut Random) -> f64 {
    let (lower, upper) = (coordinate.lower.max(-1.0), coordinate.upper.min(1.0));
    let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower) * SHARE);
    random.between(middle - half, middle + half)
}
