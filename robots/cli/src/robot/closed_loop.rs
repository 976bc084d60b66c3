//! What closed loops of compiled and interpreted robots have in common.

use super::bundled::{bundled, identifier};
use super::{RunsOf, Then};
use crate::failure::{Failure, Outcome};
use shapebot_dynamics::{LagrangianSystem, Robot};
use shapebot_experiments::{Settings, Subject, System, Trials};
use shapebot_planning::Refusal;

/// Settings with some of them put in the place of others.
pub(super) fn merged(base: &Settings, set: &Settings) -> Vec<(String, f64)> {
    let replaced = |name: &str| set.iter().any(|(other, _)| identifier(other) == identifier(name));
    let kept = base.iter().filter(|(name, _)| !replaced(name));
    kept.chain(set).cloned().collect()
}

/// A bundled model as the plant of another one.
pub(super) fn other<const N: usize>(
    model: &str,
    set: &Settings,
) -> Result<Box<System<N>>, Refusal> {
    let names = || bundled().map(|robot| robot.name());
    let found = bundled().find(|robot| robot.name() == model);
    let robot = found.ok_or_else(|| Refusal::unknown("bundled robot", model, names()))?;
    Ok(robot.system(set)?)
}

/// Why there is no controller.
pub(super) fn no_design(name: &str) -> Failure {
    Failure::refused(format!(
        "no gains were found that make the linearised loop of `{name}` stable"
    ))
}

pub(super) fn with_runs<R, const N: usize, const NX: usize, const NS: usize>(
    subject: Subject<'_, R, N>,
    of: &RunsOf<'_>,
    then: &mut Then<'_>,
) -> Outcome
where
    R: Robot<f64, N, NX, NS> + Sync,
{
    let RunsOf { name, task, planned, id, runs } = *of;
    then(&Trials::new(subject, (name, task), planned, id, runs)?)
}

/// Poles at the origin without control, 1/s.
pub(super) fn poles<const N: usize>(
    robot: &dyn LagrangianSystem<f64, N>,
) -> Outcome<Vec<[f64; 2]>> {
    let linear = shapebot_sim::lqr::linearise(robot).map_err(Failure::refused)?;
    let poles = linear.state.complex_eigenvalues();
    Ok(poles.iter().map(|pole| [pole.re, pole.im]).collect())
}
