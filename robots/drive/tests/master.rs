//! The master with simulated CiA 402 drives, IMU and legs, over buses in virtual time.

mod common;

use common::{INERTIA, PLANAR, Run, SPATIAL, description};
use shapebot_bus::Frame;
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{Command, Fault};
use shapebot_nodes::NodeFault;

/// Runs a test with the planar ballbot's bundled drive.
fn planar(test: impl FnOnce(&mut Run<'_>)) {
    let description = description("ballbot_planar", &PLANAR);
    let tables = description.tables();
    let table = tables.table();
    test(&mut Run::new(&description, &table));
}

#[test]
fn it_boots_stands_and_comes_down() {
    planar(|run| {
        run.stand();
        let way: Vec<State> = run.states.iter().map(|(state, _)| *state).collect();
        let expected =
            [State::Off, State::LegsDown, State::Enabling, State::Rising, State::Balancing];
        assert_eq!(way, expected);
        run.pass(100_000);
        assert_eq!(run.master.state(), State::StationKeeping);
        assert!(run.mechanism().legs < 0.01);
        run.ask(Request::Stop);
        run.reach(State::LegsDown, 2_000_000);
        run.pass(10_000);
        assert!(!run.master.faults().any());
        assert!(run.mechanism().legs > 0.99);
        assert_eq!(run.sent_torque(0, 0x201), 0);
        assert_eq!(run.master.counters().missed, 0, "{:?}", run.master.counters());
    });
}

/// 10 N·m at the ball are 10/(2 · 105.8/6.335) N·m at each motor of 1 N·m: 299.4 per mille.
#[test]
fn a_force_goes_to_both_drives_with_their_signs() {
    planar(|run| {
        run.stand();
        let (begin, start) = (run.now(), run.last.position(0));
        run.forces = vec![10.0];
        run.pass(100_000);
        assert_eq!(run.sent_torque(0, 0x201), 299);
        assert_eq!(run.sent_torque(0, 0x202), -299);
        let seconds = (run.now() - begin) as f64 * 1e-6;
        let expected = 0.5 * 10.0 / INERTIA * seconds * seconds;
        let moved = run.last.position(0) - start;
        assert!((moved / expected - 1.0).abs() < 0.1, "{moved} {expected}");
        assert!((f64::from(run.last.velocity(0)) / (10.0 / INERTIA * seconds) - 1.0).abs() < 0.1);
        assert!((run.master.applied()[0] - 10.0).abs() < 1e-3);
    });
}

#[test]
fn torques_are_slewed_clamped_and_never_not_a_number() {
    planar(|run| {
        run.stand();
        run.forces = vec![1e9];
        run.pass(2_100);
        // 6000 N·m/s are 12 N·m in a cycle of 2 ms: 359 counts of 1/33.40 N·m.
        assert_eq!(run.sent_torque(0, 0x201), 359);
        run.pass(20_000);
        // 60 N·m are 1796.3 counts.
        assert_eq!(run.sent_torque(0, 0x201), 1796);
        run.forces = vec![f32::NAN];
        run.pass(4_000);
        assert_eq!(run.sent_torque(0, 0x201), 0);
        assert_eq!(run.master.state(), State::FaultDown);
        assert!(run.master.faults().has(Fault::NotFinite));
        run.forces = vec![0.0];
        run.wait(2_000_000, |run| run.master.legs().is_some_and(|legs| legs.is_down()));
        // Nothing starts it again but reset and start.
        let now = run.now();
        assert!(!run.master.request(Request::Start, now));
        run.ask(Request::Reset);
        run.reach(State::LegsDown, 1_000_000);
        run.pass(50_000);
        assert_eq!(run.master.state(), State::LegsDown);
    });
}

/// The last statusword makes the drives enabled; forces that come with it were meant for a robot on its
/// legs.
#[test]
fn forces_given_before_the_state_permits_torque_are_not_sent() {
    planar(|run| {
        run.reach(State::LegsDown, 3_000_000);
        run.pass(20_000);
        run.ask(Request::Start);
        let end = run.now() + 1_000_000;
        let (mut early, mut sent) = (run.master.clone(), Vec::new());
        while early.state() != State::Rising {
            assert!(run.now() < end && run.master.state() == State::Enabling);
            let wake = run.master.next_wake().max(run.now() + 1);
            if let Some((bus, received)) = run.network.receive(wake) {
                run.master.receive(bus, &received.frame, run.now());
            }
            early = run.master.clone();
            sent.clear();
            early.command(&Command::new(&[10.0]), run.now(), &mut |_, frame| sent.push(frame));
            run.act();
        }
        let torques: Vec<&[u8]> = sent
            .iter()
            .filter(|frame| frame.standard_id().is_some_and(|id| id & !3 == 0x200))
            .map(|frame| &frame.bytes()[..2])
            .collect();
        assert_eq!(torques, [[0, 0]; 2]);
        assert_eq!(early.torque_counts(0), 0);
        run.forces = vec![10.0];
        run.pass(4_000);
        assert_eq!(run.sent_torque(0, 0x201), 299);
    });
}

/// What each fault of a node leads to, and how soon, in cycles of 2 ms.
#[test]
fn faults_of_nodes_are_noticed_in_time() {
    let [front, _back, imu, legs] = [0, 1, 2, 3];
    for (node, fault, expected, cycles) in [
        (front, NodeFault::Reset, Fault::MissedInputs, 6),
        (front, NodeFault::NoInputs, Fault::MissedInputs, 6),
        (front, NodeFault::Emergency(0x2310), Fault::Emergency, 2),
        (front, NodeFault::Dead, Fault::MissedInputs, 6),
        (front, NodeFault::HeartbeatLoss, Fault::Heartbeat, 130),
        (imu, NodeFault::StaleSensor, Fault::SensorStale, 6),
        (imu, NodeFault::InvalidSensor, Fault::SensorInvalid, 2),
        (imu, NodeFault::Unhealthy(3), Fault::SensorUnhealthy, 2),
        (legs, NodeFault::Dead, Fault::Heartbeat, 130),
    ] {
        planar(|run| {
            run.stand();
            run.forces = vec![1.0];
            run.pass(50_000);
            let begin = run.now();
            run.network.inject(node, fault);
            run.wait(1_000_000, |run| run.master.faults().any());
            let took = (run.now() - begin).div_ceil(2000);
            let first = run.master.faults().first().expect("a fault");
            assert_eq!((first.fault, first.node), (expected, Some(node as u8)), "{fault:?}");
            assert!(took <= cycles, "{fault:?}: {took} cycles");
            let state = if node == legs { State::FaultLowering } else { State::FaultDown };
            assert_eq!(run.master.state(), state, "{fault:?}");
            // The legs are told at once.
            let (_, legs, at) = run
                .sent
                .iter()
                .rev()
                .find(|(_, frame, _)| frame.standard_id() == Some(0x211))
                .expect("a frame to the legs");
            assert_eq!(legs.bytes(), [0]);
            assert!(*at + 2000 >= run.now(), "{fault:?}");
            run.pass(2_500);
            if state == State::FaultDown {
                assert_eq!((run.sent_torque(0, 0x201), run.sent_torque(0, 0x202)), (0, 0));
            }
            run.reach(State::FaultDown, 2_000_000);
        });
    }
}

/// Also one that is faster than its inputs are missed.
#[test]
fn a_boot_up_message_while_it_is_used_is_a_fault() {
    planar(|run| {
        run.stand();
        let now = run.now();
        run.master.receive(0, &Frame::new(0x702, &[0]), now);
        let first = run.master.faults().first().expect("a fault");
        assert_eq!((first.fault, first.node), (Fault::Reboot, Some(1)));
        assert_eq!(run.master.state(), State::FaultDown);
    });
}

#[test]
fn drives_of_a_pair_that_part_are_a_fault() {
    planar(|run| {
        run.stand();
        run.network.inject(1, NodeFault::StuckEncoder);
        run.forces = vec![20.0];
        run.wait(1_000_000, |run| run.master.faults().any());
        assert!(run.master.faults().has(Fault::PairDisagrees));
        assert_eq!(run.master.state(), State::FaultDown);
    });
}

#[test]
fn a_silent_controller_is_a_fault_and_its_last_torque_is_held_meanwhile() {
    planar(|run| {
        run.stand();
        run.forces = vec![10.0];
        run.pass(10_000);
        run.is_silent = true;
        run.pass(3_900);
        assert_eq!((run.master.state(), run.sent_torque(0, 0x201)), (State::StationKeeping, 299));
        run.pass(6_000);
        assert!(run.master.faults().has(Fault::ControllerSilent));
        assert_eq!((run.master.state(), run.sent_torque(0, 0x201)), (State::FaultDown, 0));
    });
}

#[test]
fn leaning_too_far_lowers_the_legs_and_balancing_goes_on() {
    planar(|run| {
        run.stand();
        run.forces = vec![10.0];
        run.mechanism().position[1] = 0.4;
        run.wait(10_000, |run| run.master.state() == State::FaultLowering);
        run.pass(4_000);
        assert_eq!(run.sent_torque(0, 0x201), 299);
        run.reach(State::FaultDown, 1_000_000);
        run.pass(4_000);
        assert_eq!(run.sent_torque(0, 0x201), 0);
    });
}

#[test]
fn it_does_not_start_when_leaning() {
    planar(|run| {
        run.reach(State::LegsDown, 3_000_000);
        run.mechanism().position[1] = 0.1;
        run.pass(20_000);
        let now = run.now();
        assert!(!run.master.request(Request::Start, now));
        run.pass(20_000);
        assert_eq!(run.master.state(), State::LegsDown);
    });
}

#[test]
fn a_wrong_drive_does_not_pass_its_set_up() {
    for (object, value) in [
        (shapebot_drive::Object::RATED_TORQUE, 900),
        (shapebot_drive::Object::DEVICE_TYPE, 0x0002_0191),
    ] {
        planar(|run| {
            run.network.inject(0, NodeFault::Value(object, value));
            run.wait(3_000_000, |run| run.master.faults().any());
            let first = run.master.faults().first().expect("a fault");
            assert_eq!((first.fault, first.node), (Fault::Setup, Some(0)));
            assert_eq!(first.detail, value as u32);
            run.pass(100_000);
            assert_eq!(run.master.state(), State::FaultDown);
        });
    }
}

#[test]
fn somebody_else_that_sends_the_masters_frames_is_a_fault() {
    for frame in [
        Frame::new(0x000, &[0x01, 0]),
        Frame::new(0x080, &[]),
        Frame::new(0x201, &[0xFF, 0x7F, 0x0F, 0x00]),
        Frame::new(0x601, &[0x2F, 0x60, 0x60, 0, 1, 0, 0, 0]),
        Frame::new(0x77F, &[5]),
    ] {
        planar(|run| {
            run.stand();
            let now = run.now();
            run.master.receive(0, &frame, now);
            assert_eq!(run.master.state(), State::FaultLowering, "{frame:?}");
        });
    }
}

/// The drive unit is turned by a quarter: a force along x of the body is one along −y of the drive unit,
/// and what the drive unit measures along its own axes comes back as motion along x.
#[test]
fn forces_and_rates_are_turned_by_the_yaw_angle() {
    let description = description("ballbot3d", &SPATIAL);
    let tables = description.tables();
    let table = tables.table();
    let mut run = Run::new(&description, &table);
    run.network.plant_now().set_heading(-std::f64::consts::FRAC_PI_2);
    run.stand();
    let begin = run.now();
    run.forces = vec![10.0, 0.0];
    run.pass(100_000);
    assert_eq!(run.sent_torque(0, 0x201), 0);
    assert_eq!(run.sent_torque(0, 0x203), -299);
    assert_eq!(run.sent_torque(0, 0x204), 299);
    let seconds = (run.now() - begin) as f64 * 1e-6;
    let expected = 0.5 * 10.0 / INERTIA * seconds * seconds;
    assert!((run.last.position(0) / expected - 1.0).abs() < 0.1, "{}", run.last.position(0));
    assert!(run.last.position(1).abs() < 0.02 * expected, "{}", run.last.position(1));
    assert!((run.master.applied()[0] - 10.0).abs() < 0.01);
}

#[test]
fn headings_are_held_and_turned_to() {
    let description = description("ballbot3d", &SPATIAL);
    let tables = description.tables();
    let table = tables.table();
    let mut run = Run::new(&description, &table);
    run.stand();
    run.master.aim(0.5);
    run.ask(Request::Yaw);
    run.reach(State::StationKeeping, 5_000_000);
    assert!((run.last.heading - 0.5).abs() < 0.03, "{}", run.last.heading);
    run.pass(1_000_000);
    assert!((run.last.heading - 0.5).abs() < 0.02, "{}", run.last.heading);
}

/// At 1 kHz with one shared frame: 10 N·m are 299 counts for both drives, whose signs are their own.
#[test]
fn drives_that_share_a_frame_obey_it() {
    let description = description("ballbot3d_1khz", &SPATIAL);
    let tables = description.tables();
    let table = tables.table();
    let mut run = Run::new(&description, &table);
    run.stand();
    let begin = run.now();
    run.forces = vec![10.0, 0.0];
    run.pass(50_000);
    assert_eq!(run.sent_torque(0, 0x191), 299);
    let seconds = (run.now() - begin) as f64 * 1e-6;
    let expected = 0.5 * 10.0 / INERTIA * seconds * seconds;
    assert!((run.last.position(0) / expected - 1.0).abs() < 0.15, "{}", run.last.position(0));
    assert_eq!(run.master.counters().missed, 0);
}
