//! What a task says about its simulation, at the robot's sizes and in its units.

use crate::{Error, SizedRobot};
use nalgebra::{SVector, Vector3};
use shapebot_dynamics::Description;
use shapebot_planning::Refusal;
use shapebot_sim::{Floor, Friction, Push, Scenario};
use shapebot_tasks::simulation::{self, Simulation};
use shapebot_tasks::{Quantities, Said};

/// The scenario of a simulation.
pub(crate) fn scenario<const N: usize, const NX: usize, const NS: usize>(
    model: &SizedRobot<N, NX, NS>,
    simulation: &Simulation,
) -> Result<Scenario<NX, NS>, Error> {
    let robot = model.description();
    let mut scenario = Scenario {
        drive: friction(&simulation.drive, robot)?,
        contact: friction(&simulation.contact, robot)?,
        floor: Floor { slope: slope(simulation)?, ..Floor::default() },
        weights: weights(simulation, robot)?,
        actuation_delay: simulation.delay[1],
        strength: simulation.strength.unwrap_or(1.0),
        seed: simulation.seed,
        ..Scenario::default()
    };
    for push in &simulation.pushes {
        scenario.pushes.push(Push {
            point: point(&push.point, robot)?,
            force: Vector3::from_fn(|i, _| push.force.value.values[i]),
            start: push.start,
            duration: push.duration,
        });
    }
    let sensors = &mut scenario.sensors;
    sensors.delay = simulation.delay[0];
    let noise = &simulation.noise;
    let placed = |refusal: Refusal| refusal.at(&noise.place);
    sensors.lean_noise = number(noise.value.lean.as_ref(), "rad").map_err(placed)?;
    sensors.lean_rate_noise = number(noise.value.rate.as_ref(), "rad/s").map_err(placed)?;
    if noise.value.counts > 0.0 {
        let turn = if position_unit(robot) == "rad" { std::f64::consts::TAU } else { 1.0 };
        sensors.position_step = turn / noise.value.counts;
    }
    if let Some(bias) = &simulation.bias {
        sensors.lean_bias = lean(bias, robot)?;
    }
    if let Some(start) = &simulation.start_lean {
        scenario.start_shape = lean(start, robot)?;
    }
    if let Some(start) = &simulation.start_position {
        let output: SVector<f64, NX> = entries(start, robot.output_unit)?;
        let inverse = model.output_jacobian_position().try_inverse();
        let equation = "inverse of the output's Jacobian";
        let inverse = inverse.ok_or(shapebot_sim::Error::NoSolution { equation })?;
        scenario.start_position = inverse * output;
    }
    Ok(scenario)
}

fn position_unit(robot: &Description) -> &'static str {
    robot.coordinates.first().map_or("m", |coordinate| coordinate.unit)
}

/// A number in a unit; zero if there is none.
fn number(given: Option<&Quantities>, unit: &str) -> Result<f64, Refusal> {
    let Some(Quantities { values, dimension }) = given else {
        return Ok(0.0);
    };
    if dimension.unit() != unit {
        return Err(Refusal::task(format!("expected {unit}, found {}", dimension.unit())));
    }
    Ok(values.first().copied().unwrap_or_default())
}

fn friction(said: &Said<simulation::Friction>, robot: &Description) -> Result<Friction, Refusal> {
    let (viscous, coulomb) = match position_unit(robot) {
        "rad" => ("N*m*s", "N*m"),
        _ => ("N*s/m", "N"),
    };
    let placed = |refusal: Refusal| refusal.at(&said.place);
    Ok(Friction {
        viscous: number(said.value.viscous.as_ref(), viscous).map_err(placed)?,
        coulomb: number(said.value.coulomb.as_ref(), coulomb).map_err(placed)?,
    })
}

/// One number per entry, or one for all.
fn entries<const L: usize>(
    said: &Said<Quantities>,
    unit: &str,
) -> Result<SVector<f64, L>, Refusal> {
    let Quantities { values, dimension } = &said.value;
    if dimension.unit() != unit {
        let message = format!("expected {unit}, found {}", dimension.unit());
        return Err(Refusal::task(message).at(&said.place));
    }
    match values.as_slice() {
        many if many.len() == L => Ok(SVector::from_fn(|i, _| many[i])),
        many => {
            let message = format!("expected {L} numbers, found {}", many.len());
            Err(Refusal::task(message).at(&said.place))
        }
    }
}

/// Angles of what an inertial unit measures: the unactuated shape, or all of it. One number is that of
/// the first.
fn lean<const NS: usize>(
    said: &Said<Quantities>,
    robot: &Description,
) -> Result<SVector<f64, NS>, Refusal> {
    let leaning = leaning(robot);
    let values = &said.value.values;
    let unit = said.value.dimension.unit();
    let wrong = |message: String| Err(Refusal::task(message).at(&said.place));
    if unit != "rad" {
        return wrong(format!("expected rad or deg, found {unit}"));
    }
    if values.len() > leaning.len() {
        return wrong(format!(
            "expected at most {} numbers, found {}",
            leaning.len(),
            values.len()
        ));
    }
    let mut shape = SVector::zeros();
    for (index, value) in leaning.into_iter().zip(values) {
        shape[index] = *value;
    }
    Ok(shape)
}

/// Indices in q_s of the unactuated shape, or of all of it.
pub(crate) fn leaning(robot: &Description) -> Vec<usize> {
    let leaning: Vec<usize> = robot.unactuated_shape().collect();
    if leaning.is_empty() { (0..robot.shape_coordinates().len()).collect() } else { leaning }
}

fn slope(simulation: &Simulation) -> Result<[f64; 2], Refusal> {
    let Some(said) = &simulation.slope else {
        return Ok([0.0; 2]);
    };
    let wrong = |message: &str| Err(Refusal::task(message).at(&said.place));
    match (said.value.dimension.unit(), said.value.values.as_slice()) {
        ("rad", &[x]) => Ok([x, 0.0]),
        ("rad", &[x, y]) => Ok([x, y]),
        ("rad", _) => wrong("expected one angle or two"),
        _ => wrong("expected an angle such as \"2 deg\""),
    }
}

fn point(said: &Said<String>, robot: &Description) -> Result<usize, Refusal> {
    let index = robot.points.iter().position(|name| *name == said.value);
    let unknown = || Refusal::unknown("point", &said.value, robot.points.iter().copied());
    index.ok_or_else(|| unknown().at(&said.place))
}

fn weights(simulation: &Simulation, robot: &Description) -> Result<Vec<(usize, f64)>, Refusal> {
    let given = simulation.point_weights.iter();
    let weight = |(name, weight): &(Said<String>, Quantities)| {
        Ok((point(name, robot)?, number(Some(weight), "N")?))
    };
    given.map(weight).collect()
}
