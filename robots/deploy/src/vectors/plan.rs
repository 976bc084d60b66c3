//! A plan that is known in closed form.

use super::text::{array, list};
use crate::Error;
use crate::derived::Derived;
use shapebot_planner::value::{RobotId, Sizes, encode_values, encoded_values_len};

/// Nodes of the plan.
const NODES: usize = 9;

/// Times at which it is evaluated: on nodes and between them.
const POINTS: i32 = 41;

/// Seconds from the first node to the last.
const DURATION: f64 = 4.0;

/// Derivatives with respect to time of 10 s³ − 15 s⁴ + 6 s⁵: from rest at 0 to rest at 1.
fn rest_to_rest(time: f64) -> [f64; 3] {
    let s = time / DURATION;
    let (h, hh) = (DURATION, DURATION * DURATION);
    [
        s * s * s * (10.0 + s * (6.0 * s - 15.0)),
        30.0 * s * s * (1.0 + s * (s - 2.0)) / h,
        60.0 * s * (1.0 + s * (2.0 * s - 3.0)) / hh,
    ]
}

/// The same of 16 s² (1 − s)²: there and back.
fn there_and_back(time: f64) -> [f64; 3] {
    let s = time / DURATION;
    let (h, hh) = (DURATION, DURATION * DURATION);
    [
        16.0 * s * s * (1.0 + s * (s - 2.0)),
        32.0 * s * (1.0 + s * (2.0 * s - 3.0)) / h,
        32.0 * (1.0 + s * (6.0 * s - 6.0)) / hh,
    ]
}

/// All numbers of the plan at a time, in the order of [`Sizes::values`].
fn values(sizes: &Sizes, time: f64) -> Vec<f64> {
    let mut values = Vec::new();
    let (position, shape) = (rest_to_rest(time), there_and_back(time));
    for derivative in position {
        values.extend((0..sizes.positions).map(|i| (1.0 + i as f64) * derivative));
    }
    for derivative in shape {
        values.extend((0..sizes.shapes).map(|i| 0.05 / (1.0 + i as f64) * derivative));
    }
    // Straight lines: cubic pieces through differences of nodes are these exactly.
    values.extend((0..sizes.forces).map(|i| (i as f64 - 1.0) * (time - 1.0)));
    values
}

const KIND: &str =
    "/// A plan at a time: q_x with two derivatives, q_s with two derivatives, forces.
#[derive(Debug)]
pub struct Point {
    pub time: f64,
    pub values: &'static [f64],
}

/// The plan's file.
pub const PLAN: &[u8] = include_bytes!(\"plan.bin\");

";

/// The plan's file, and the items of the vectors' module.
pub(crate) fn record(derived: &Derived) -> Result<(Vec<u8>, String), Error> {
    let description = derived.tapes.description();
    let (all, positions) = (description.coordinates.len(), description.position_count);
    let sizes = Sizes { positions, shapes: all - positions, forces: all };
    let time = |node: usize| DURATION * node as f64 / (NODES - 1) as f64;
    let mut bytes = vec![0; encoded_values_len::<f64>(&sizes, NODES)];
    let value = |node: usize, index: usize| values(&sizes, time(node))[index];
    let id = RobotId::of(description);
    let used = encode_values::<f64>(&id, &sizes, NODES, time, value, &mut bytes)?;
    bytes.truncate(used);
    let point = |index: i32| {
        let time = DURATION * f64::from(index) / f64::from(POINTS - 1);
        format!("Point {{ time: {time:?}, values: &{} }},", array(&values(&sizes, time)))
    };
    let entries: Vec<String> = (0..POINTS).map(point).collect();
    let docs = "The polynomials that the plan's nodes were taken from.";
    Ok((bytes, KIND.to_owned() + &list(docs, "POINTS", "Point", &entries)))
}
