//! The loop over simulated nodes in virtual time: how it ends.
#![cfg(target_os = "linux")]

use shapebot_bus::{BusError, Buses, Frame, Health, Received};
use shapebot_control::Gains;
use shapebot_drive::operator::Order;
use shapebot_drive::operator::command::encode;
use shapebot_drive::safety::{Request, State};
use shapebot_drive_build::{DriveDescription, Source};
use shapebot_dynamics::LagrangianSystem;
use shapebot_generated::ballbot_planar::{BallbotPlanar, CONTROL};
use shapebot_host::{Ending, Plans, Service};
use shapebot_planner::value::RobotId;
use shapebot_rig::{World, network};
use shapebot_runtime::{Runtime, Settings};
use shapebot_sim::{Plant, Scenario};

type Robot = BallbotPlanar<f64>;

/// The simulated buses, and an operator who sends one command each 100 ms.
struct Bench<'a> {
    world: World<'a, Robot, 2, 1, 1>,
    orders: Vec<(u64, [u8; 8])>,
    /// COB-ID of commands.
    command: u16,
    telemetry: usize,
    /// Frames are refused from here on, µs.
    broken: u64,
}

impl Buses for Bench<'_> {
    fn count(&self) -> usize {
        self.world.count()
    }

    fn now(&self) -> u64 {
        Buses::now(&self.world)
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        if self.now() >= self.broken {
            return Err(BusError::Closed("bench".to_owned()));
        }
        self.telemetry += usize::from(frame.standard_id() == Some(0x4A1));
        Buses::send(&mut self.world, bus, frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        let now = self.now();
        if let Some((time, _)) = self.orders.first()
            && *time <= now
        {
            let (time, bytes) = self.orders.remove(0);
            return Ok(Some((0, Received { frame: Frame::new(self.command, &bytes), time })));
        }
        Buses::receive(&mut self.world, deadline)
    }

    fn health(&self, bus: usize) -> Health {
        self.world.health(bus)
    }
}

fn drive(robot: &Robot) -> DriveDescription {
    let text = shapebot_drives::text("ballbot_planar").expect("a drive");
    let source = Source::parse("ballbot_planar", text).expect("a drive");
    source.check(robot.description()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// What is left of a run.
struct End {
    ending: Result<Ending, String>,
    state: State,
    counts: i32,
    legs_down: bool,
    telemetry: usize,
    /// Largest measured lean while the loop ran, rad.
    lean: f64,
}

/// Starts the robot, lets it stand, and goes on as `signals` says of the time in µs.
fn run(broken: u64, mut signals: impl FnMut(u64) -> usize) -> End {
    let robot = Robot::from_model();
    let description = drive(&robot);
    let tables = description.tables();
    let table = tables.table();
    let scenario = Scenario::default();
    let plant = Plant::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let world = network(&description, &robot, &plant, 1).expect("a world");
    let order = |order, sequence| encode(order, sequence, table.fingerprint);
    let orders = vec![
        (2_000_000, order(Order::Hello, 1)),
        (2_100_000, order(Order::Ask(Request::Start), 2)),
        (5_000_000, order(Order::Ask(Request::KeepStation), 3)),
    ];
    let command = table.operator.command;
    let bench = Bench { world, orders, command, telemetry: 0, broken };
    let mut gains = Gains::from_design(&robot, &CONTROL).expect("gains");
    gains.period = f64::from(table.timing.period_us) * 1e-6;
    let runtime = Runtime::new(&robot, &table, &gains, &Settings::default()).expect("a runtime");
    let plans = Plans::new(RobotId::of(robot.description()));
    let mut service = Service::new(runtime, bench, plans, None);
    let ending = service.run(&mut |now| signals(now)).map_err(|error| error.to_string());
    let master = service.runtime().master();
    let (state, counts) = (master.state(), master.torque_counts(0));
    let legs_down = master.legs().is_some_and(|legs| legs.is_down());
    let lean = master.measurement().position(1).abs();
    assert_eq!(service.deadlines().missed, 0);
    let telemetry = service.buses().telemetry;
    End { ending, state, counts, legs_down, telemetry, lean }
}

/// When something happens, µs: the robot keeps its station then.
const THEN: u64 = 8_000_000;

#[test]
fn a_signal_lowers_the_legs_while_balancing() {
    let end = run(u64::MAX, |now| usize::from(now >= THEN));
    assert_eq!(end.ending, Ok(Ending::Stopped));
    assert_eq!((end.state, end.counts, end.legs_down), (State::LegsDown, 0, true));
    assert!(end.telemetry > 500, "{}", end.telemetry);
    assert!(end.lean < 0.05, "{}", end.lean);
}

#[test]
fn a_second_signal_does_not_wait() {
    let end = run(u64::MAX, |now| usize::from(now >= THEN) + usize::from(now >= THEN + 20_000));
    assert_eq!(end.ending, Ok(Ending::AtOnce));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
}

#[test]
fn a_panic_switches_the_torque_off_and_lowers_the_legs() {
    let end = run(u64::MAX, |now| {
        assert!(now < THEN, "planted");
        0
    });
    assert_eq!(end.ending, Ok(Ending::Panicked));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
}

#[test]
fn a_bus_that_fails_ends_the_loop() {
    let end = run(THEN, |_| 0);
    assert_eq!(end.ending, Err("bench: closed by the other side".to_owned()));
    assert_eq!((end.state, end.counts), (State::FaultDown, 0));
}
