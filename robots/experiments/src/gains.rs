//! Gains: as designed, with what the task overrides.

use crate::{Error, SizedRobot};
use nalgebra::{SMatrix, SVector};
use shapebot_control::{Compensate, Gains};
use shapebot_dynamics::control::ControlDesign;
use shapebot_planning::{Detail, Phase, PlannedMotion, Refusal};
use shapebot_tasks::simulation::{self, Simulation};

/// Gains for following a plan as the task says.
pub(crate) fn gains<const N: usize, const NX: usize, const NS: usize>(
    model: &SizedRobot<N, NX, NS>,
    design: &ControlDesign,
    planned: &PlannedMotion,
    simulation: &Simulation,
) -> Result<Gains<f64, NX, NS>, Error> {
    let mut gains = Gains::from_design(&model, design)?;
    gains.compensate = match simulation.compensate {
        simulation::Compensate::Plan => Compensate::Plan,
        simulation::Compensate::Body => Compensate::Body,
    };
    gains.plan_gain = plan_gain(planned);
    gains.observer = simulation.observer.unwrap_or(gains.observer);
    gains.offset = simulation.offset.unwrap_or(gains.offset);
    for (name, values) in &simulation.gains {
        set(&mut gains, &name.value, values).map_err(|refusal| refusal.at(&name.place))?;
    }
    Ok(gains)
}

/// K⁰_qx of the plan's weights; the mean over its phases, which all are right inverses of K⁰_qs.
fn plan_gain<const NX: usize, const NS: usize>(planned: &PlannedMotion) -> SMatrix<f64, NS, NX> {
    let of = |phase: &Phase| {
        let rows = match &phase.detail {
            Detail::Gain(detail) => &detail.initial_gain,
            Detail::Refined(_) => &phase.gain,
        };
        SMatrix::<f64, NS, NX>::from_fn(|i, j| {
            rows.get(i).and_then(|row| row.get(j)).copied().unwrap_or_default()
        })
    };
    let count = planned.phases.len().max(1) as f64;
    planned.phases.iter().map(of).sum::<SMatrix<f64, NS, NX>>() / count
}

fn set<const NX: usize, const NS: usize>(
    gains: &mut Gains<f64, NX, NS>,
    name: &str,
    values: &[f64],
) -> Result<(), Refusal> {
    let axes = || -> Result<SVector<f64, NX>, Refusal> {
        match values {
            [single] => Ok(SVector::repeat(*single)),
            many if many.len() == NX => Ok(SVector::from_fn(|i, _| many[i])),
            many => {
                Err(Refusal::task(format!("expected one number or {NX}, found {}", many.len())))
            }
        }
    };
    let single = || match values {
        [single] => Ok(*single),
        many => Err(Refusal::task(format!("expected one number, found {}", many.len()))),
    };
    match name {
        "lean" => gains.lean = axes()?,
        "lean_rate" => gains.lean_rate = axes()?,
        "lean_integral" => gains.lean_integral = axes()?,
        "position" => gains.position = axes()?,
        "velocity" => gains.velocity = axes()?,
        "servo_rate" => gains.servo_rate = single()?,
        "servo_damping" => gains.servo_damping = single()?,
        "servo_integral" => gains.servo_integral = single()?,
        "observer_rate" => gains.observer_rate = single()?,
        "offset_rate" => gains.offset_rate = single()?,
        "force_slew" => gains.force_slew = single()?,
        other => return Err(Refusal::unknown("gain", other, shapebot_tasks::GAINS)),
    }
    Ok(())
}
