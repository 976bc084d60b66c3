//! What plants of compiled and interpreted robots have in common.

use super::bundled::{bundled, identifier};
use shapebot_experiments::{AnySystem, Settings};
use shapebot_planning::Refusal;

/// Settings with some of them put in the place of others.
pub(super) fn merged(base: &Settings, set: &Settings) -> Vec<(String, f64)> {
    let replaced = |name: &str| set.iter().any(|(other, _)| identifier(other) == identifier(name));
    let kept = base.iter().filter(|(name, _)| !replaced(name));
    kept.chain(set).cloned().collect()
}

/// A bundled model as the plant of another one.
pub(super) fn other(model: &str, set: &Settings) -> Result<AnySystem, Refusal> {
    let names = || bundled().map(|robot| robot.name());
    let found = bundled().find(|robot| robot.name() == model);
    let robot = found.ok_or_else(|| Refusal::unknown("bundled robot", model, names()))?;
    Ok(robot.system(set)?)
}
