//! Simulated nodes over a body, in virtual time.

use crate::{Body, Error, Stance};
use shapebot_bus::{VirtualBus, candump};
use shapebot_drive_build::DriveDescription;
use shapebot_dynamics::Robot;
use shapebot_nodes::{DriveUnit, Mechanism as _, Network, Node, PowerState, YawAxis, described};
use shapebot_sim::Plant;
use std::io::Write;

/// Simulated nodes of a drive over a body.
pub type World<'a, R, const N: usize, const NX: usize, const NS: usize> =
    Network<DriveUnit<Body<'a, R, N, NX, NS>>>;

/// The nodes of a description on buses in virtual time; `seed` is for faults that are left to chance.
///
/// # Errors
///
/// A description for a robot with another number of coordinates.
pub fn network<'a, R, const N: usize, const NX: usize, const NS: usize>(
    description: &DriveDescription,
    robot: &'a R,
    plant: &'a Plant<'a, N, NX, NS>,
    seed: u64,
) -> Result<World<'a, R, N, NX, NS>, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let buses = description.buses.iter().zip(seed..);
    let buses = buses.map(|(bus, seed)| VirtualBus::new(bus.bit_rate, seed)).collect();
    let nodes = described(&description.simulated);
    let nodes = nodes.iter().map(|(bus, settings)| (*bus, Node::new(settings))).collect();
    Ok(Network::new(buses, nodes, drive_unit(description, robot, plant)?))
}

/// The motors of a description on a body.
pub(crate) fn drive_unit<'a, R, const N: usize, const NX: usize, const NS: usize>(
    description: &DriveDescription,
    robot: &'a R,
    plant: &'a Plant<'a, N, NX, NS>,
) -> Result<DriveUnit<Body<'a, R, N, NX, NS>>, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let found = description.coordinates.len();
    if found != N {
        return Err(Error::Coordinates { found, expected: N });
    }
    let body = Body::new(robot, plant, Stance::default());
    Ok(DriveUnit::new(description, body, YawAxis::default()))
}

/// Logs all frames of all buses as `candump -L` does, each under its bus' name.
pub fn log_to<R, const N: usize, const NX: usize, const NS: usize>(
    world: &mut World<'_, R, N, NX, NS>,
    description: &DriveDescription,
    log: impl Write + Clone + Send + 'static,
) where
    R: Robot<f64, N, NX, NS>,
{
    for (index, bus) in description.buses.iter().enumerate() {
        if let Some(wire) = world.bus(index) {
            wire.observe(candump::observer(log.clone(), &bus.name));
        }
    }
}

/// Whether a node is a drive that may give torque.
pub(crate) fn is_driven(node: &Node) -> bool {
    node.power_state() == Some(PowerState::OperationEnabled)
}

/// Holds a robot without legs by hand as long as none of its drives may give torque.
pub fn hold_unless_driven<R, const N: usize, const NX: usize, const NS: usize>(
    world: &mut World<'_, R, N, NX, NS>,
) where
    R: Robot<f64, N, NX, NS>,
{
    let driven = (0..world.len()).any(|index| world.node(index).is_some_and(is_driven));
    world.plant_now().mechanism_mut().set_legs(f64::from(u8::from(!driven)));
}
