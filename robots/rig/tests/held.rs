//! Simulated nodes of a robot without legs: it is held by hand until a drive is enabled.

mod common;

use common::wire::{Port, Wire};
use shapebot_bus::{Frame, Wired};
use shapebot_dynamics::Robot;
use shapebot_generated::{ballbot_planar, cartpole_planar, segway_planar};
use shapebot_rig::DriveSim;
use shapebot_sim::{Plant, Push, Scenario};
use std::cell::RefCell;
use std::rc::Rc;

/// Controlwords for the first drive, each with its time, ms.
const CONTROLWORDS: [(u64, u16); 4] = [(1000, 0x06), (1001, 0x07), (1002, 0x0F), (2000, 0x06)];

/// Before the drive is enabled, while it is, and after it.
const MOMENTS: [u64; 3] = [1000, 1990, 2990];

/// A robot at a moment.
#[derive(Debug)]
struct Seen {
    /// Degrees.
    lean: f64,
    /// Of its legs, or of the hand that holds it: 0 or 1.
    extension: f64,
}

/// What a master sends, with times in µs: NMT start, SYNC each millisecond, controlwords by SDO.
fn frames() -> impl Iterator<Item = (u64, Frame)> {
    let sync = (51..=MOMENTS[2]).map(|time| (time, Frame::new(0x080, &[])));
    let words = CONTROLWORDS.map(|(time, word)| {
        let [low, high] = word.to_le_bytes();
        (time, Frame::new(0x601, &[0x2B, 0x40, 0x60, 0, low, high, 0, 0]))
    });
    let mut all: Vec<(u64, Frame)> = sync.chain(words).collect();
    all.sort_by_key(|(time, _)| *time);
    let start = (50, Frame::new(0x000, &[1, 0]));
    std::iter::once(start).chain(all).map(|(time, frame)| (1000 * time, frame))
}

/// A robot that is pushed by a newton at its highest point all the time and gets no torque, at the moments.
fn pushed<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    drive: &str,
) -> [Seen; MOMENTS.len()]
where
    R: Robot<f64, N, NX, NS>,
{
    let description = common::drive(drive, robot.description());
    let at = robot.description().points.len() - 1;
    let push = Push { point: at, force: [1.0, 0.0, 0.0].into(), start: 0.0, duration: 10.0 };
    let scenario = Scenario { pushes: vec![push], ..Scenario::default() };
    let plant = Plant::new(robot, robot, &scenario, 0.0005).unwrap();
    let wire = Rc::new(RefCell::new(Wire::default()));
    wire.borrow_mut().coming.extend(frames());
    let buses = Wired::new(vec![Box::new(Port(Rc::clone(&wire)))]);
    let mut nodes = DriveSim::new(&description, robot, &plant, buses).unwrap();
    MOMENTS.map(|millisecond| {
        nodes.run(1000 * millisecond).unwrap();
        let body = nodes.body();
        Seen { lean: body.lean().to_degrees(), extension: body.extension() }
    })
}

fn is_let_go<R, const N: usize, const NX: usize, const NS: usize>(robot: &R, drive: &str)
where
    R: Robot<f64, N, NX, NS>,
{
    let [before, enabled, after] = pushed(robot, drive);
    common::say(&format!("{drive}: {before:?}, enabled {enabled:?}, after {after:?}"));
    assert!(before.extension == 1.0 && before.lean < 1.0, "{before:?}");
    assert!(enabled.extension == 0.0 && enabled.lean > 10.0, "{enabled:?}");
    assert!(after.extension == 1.0 && after.lean < 1.0, "{after:?}");
}

#[test]
fn robots_without_legs_are_held_while_no_drive_is_enabled() {
    is_let_go(&cartpole_planar::CartpolePlanar::from_model(), "cartpole_planar");
    is_let_go(&segway_planar::SegwayPlanar::from_model(), "segway_planar");
}

#[test]
fn a_robot_with_legs_stays_on_them_when_a_drive_is_enabled() {
    let seen = pushed(&ballbot_planar::BallbotPlanar::from_model(), "ballbot_planar");
    for Seen { lean, extension } in &seen {
        assert!(*extension == 1.0 && *lean < 1.0, "{seen:?}");
    }
}
