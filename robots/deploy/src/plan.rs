//! The plan that a robot's program has from the start.

use crate::derived::Derived;
use crate::{Error, Files, Request, Target};
use shapebot_planner::value::{PlanBytes, RobotId, Stored, encode_values, encoded_values_len};

/// Where the plan is in the folder.
pub(crate) const PATH: &str = "src/plan.bin";

/// Adds the plan in the target's scalar, if there is one.
pub(crate) fn add(
    derived: &Derived,
    request: &Request<'_>,
    files: &mut Files,
) -> Result<(), Error> {
    let Some(bytes) = request.plan else { return Ok(()) };
    let plan = PlanBytes::open(bytes).map_err(Error::GivenPlan)?;
    let id = RobotId::of(derived.tapes.description());
    id.check(plan.robot()).map_err(Error::GivenPlan)?;
    let content = match request.target {
        Target::Linux => in_scalar::<f64>(&plan, &id)?,
        Target::CortexM => in_scalar::<f32>(&plan, &id)?,
    };
    files.add(PATH, content);
    Ok(())
}

fn in_scalar<T: Stored>(plan: &PlanBytes<'_>, id: &RobotId<'_>) -> Result<Vec<u8>, Error> {
    let (sizes, nodes) = (plan.sizes(), plan.nodes());
    let mut file = vec![0; encoded_values_len::<T>(&sizes, nodes)];
    let value = |node: usize, index: usize| plan.value(node, index);
    encode_values::<T>(id, &sizes, nodes, |node| plan.time(node), value, &mut file)
        .map_err(Error::GivenPlan)?;
    Ok(file)
}
