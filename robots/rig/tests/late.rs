//! Simulated nodes in real time, when the other side or their own process is late.

mod common;

use common::wire::{Port, Wire};
use shapebot_bus::{Frame, Wired};
use shapebot_dynamics::LagrangianSystem as _;
use shapebot_generated::ballbot_planar::BallbotPlanar;
use shapebot_rig::DriveSim;
use shapebot_sim::{Plant, Scenario};
use std::cell::RefCell;
use std::rc::Rc;

/// Emergency codes that the first drive sends when SYNC comes at these times, µs, each after a heartbeat.
fn emergencies(syncs: &[u64], stall: Option<(u64, u64)>, slack: u64) -> Vec<u16> {
    let robot = BallbotPlanar::<f64>::from_model();
    let description = common::drive("ballbot_planar", robot.description());
    let scenario = Scenario::default();
    let plant = Plant::new(&robot, &robot, &scenario, 0.0005).unwrap();
    let wire = Rc::new(RefCell::new(Wire { stall, ..Wire::default() }));
    let buses = Wired::new(vec![Box::new(Port(Rc::clone(&wire)))]);
    let mut nodes = DriveSim::new(&description, &robot, &plant, buses).unwrap().forgiving(slack);
    nodes.run(50_000).unwrap();
    {
        let mut wire = wire.borrow_mut();
        // Communication cycle period of 2 ms, then start.
        let period = Frame::new(0x601, &[0x23, 0x06, 0x10, 0, 0xD0, 0x07, 0, 0]);
        wire.coming.push_back((51_000, period));
        wire.coming.push_back((52_000, Frame::new(0x000, &[1, 1])));
        for time in syncs {
            wire.coming.push_back((*time, Frame::new(0x77F, &[5])));
            wire.coming.push_back((*time, Frame::new(0x080, &[])));
        }
    }
    let last = syncs.last().copied().unwrap_or(0);
    nodes.run(last + 1000).unwrap();
    let sent = std::mem::take(&mut wire.borrow_mut().sent);
    let emergencies = sent.iter().filter(|frame| frame.standard_id() == Some(0x081));
    emergencies.map(|f| u16::from_le_bytes([f.bytes()[0], f.bytes()[1]])).collect()
}

const NONE: [u16; 0] = [];

/// SYNC each 2 ms, but for those from `first` to `last`.
fn without(first: u64, last: u64) -> Vec<u64> {
    let times = (0..20).map(|k| 60_000 + 2000 * k);
    times.filter(|time| !(first..=last).contains(time)).collect()
}

#[test]
fn sync_that_stays_away_is_an_emergency() {
    assert_eq!(emergencies(&without(0, 0), None, 0), NONE);
    // 4 ms without, then 6 ms.
    assert_eq!(emergencies(&without(70_000, 70_000), None, 0), NONE);
    assert_eq!(emergencies(&without(70_000, 72_000), None, 0), [0x8700]);
}

#[test]
fn what_is_forgiven_is_no_emergency() {
    assert_eq!(emergencies(&without(70_000, 72_000), None, 2000), NONE);
    assert_eq!(emergencies(&without(70_000, 76_000), None, 2000), [0x8700]);
}

#[test]
fn nodes_that_do_not_run_do_not_blame_the_master() {
    assert_eq!(emergencies(&without(0, 0), Some((70_100, 79_900)), 0), NONE);
}
