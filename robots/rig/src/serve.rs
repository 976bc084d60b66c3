//! A runtime at work on buses.

use shapebot_bus::{BusError, Buses};
use shapebot_drive::{Fault, Frame};
use shapebot_dynamics::Robot;
use shapebot_planner::value::Stored;
use shapebot_runtime::Runtime;

/// Serves what is due, then lets time pass to the next frame or the next thing to do, but not beyond
/// `until`, µs. A bus that takes no frames is a fault of the drive, not an error.
///
/// # Errors
///
/// Errors after which a bus cannot be used any more; they are a fault of the drive as well.
pub fn serve<R, T, const N: usize, const NX: usize, const NS: usize>(
    runtime: &mut Runtime<'_, R, T, N, NX, NS>,
    buses: &mut impl Buses,
    until: u64,
) -> Result<(), BusError>
where
    R: Robot<T, N, NX, NS>,
    T: Stored,
{
    let now = buses.now();
    let mut frames: Vec<(usize, Frame)> = Vec::new();
    runtime.poll(now, &mut |bus, frame| frames.push((bus, frame)));
    match buses.send_all(frames) {
        Ok(None) => {}
        Ok(Some(fault)) => runtime.report(fault, now),
        Err(error) => {
            runtime.report(Fault::Bus, now);
            return Err(error);
        }
    }
    if now >= until {
        return Ok(());
    }
    let wake = runtime.next_wake().clamp(now + 1, until);
    if let Some((bus, received)) = buses.receive(wake)? {
        runtime.receive(bus, &received.frame, received.time);
    }
    Ok(())
}
