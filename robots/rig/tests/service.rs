//! The loop over simulated nodes in virtual time: how it ends.
#![cfg(target_os = "linux")]

use shapebot_bus::{BusError, Buses, ErrorState, Frame, Health, Received};
use shapebot_control::Gains;
use shapebot_drive::Fault;
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
    /// What goes wrong, and when, µs.
    trouble: (u64, Trouble),
}

/// What goes wrong with a bus.
#[derive(Clone, Copy, PartialEq)]
enum Trouble {
    /// Frames are refused.
    Closed,
    /// The controller is in this state.
    Controller(ErrorState),
}

impl Bench<'_> {
    fn trouble(&self) -> Option<Trouble> {
        (self.now() >= self.trouble.0).then_some(self.trouble.1)
    }
}

impl Buses for Bench<'_> {
    fn count(&self) -> usize {
        self.world.count()
    }

    fn now(&self) -> u64 {
        Buses::now(&self.world)
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        if self.trouble() == Some(Trouble::Closed) {
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
        match self.trouble() {
            Some(Trouble::Controller(state)) => Health { state, ..Health::default() },
            _ => self.world.health(bus),
        }
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
    /// The first fault and when it was noticed, µs.
    fault: Option<(Fault, u64)>,
}

/// What happens beside signals.
#[derive(Clone)]
struct Script {
    trouble: (u64, Trouble),
    /// Orders after those that make the robot keep its station, with their times, µs.
    orders: Vec<(u64, Order)>,
}

impl Default for Script {
    fn default() -> Self {
        Self { trouble: (u64::MAX, Trouble::Closed), orders: Vec::new() }
    }
}

/// Starts the robot, lets it stand, and goes on as the script, and `signals`, say.
fn run(script: Script, mut signals: impl FnMut(u64) -> usize) -> End {
    let robot = Robot::from_model();
    let description = drive(&robot);
    let tables = description.tables();
    let table = tables.table();
    let scenario = Scenario::default();
    let plant = Plant::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let world = network(&description, &robot, &plant, 1).expect("a world");
    let begin = [
        (2_000_000, Order::Hello),
        (2_100_000, Order::Ask(Request::Start)),
        (5_000_000, Order::Ask(Request::KeepStation)),
    ];
    let orders = begin.into_iter().chain(script.orders).zip(1..);
    let orders = orders
        .map(|((time, order), sequence)| (time, encode(order, sequence, table.fingerprint)))
        .collect();
    let command = table.operator.command;
    let bench = Bench { world, orders, command, telemetry: 0, trouble: script.trouble };
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
    let fault = master.faults().first().map(|record| (record.fault, record.at_us));
    assert_eq!(service.deadlines().missed, 0);
    let telemetry = service.buses().telemetry;
    End { ending, state, counts, legs_down, telemetry, lean, fault }
}

/// When something happens, µs: the robot keeps its station then.
const THEN: u64 = 8_000_000;
const SECOND: u64 = 1_000_000;

#[test]
fn a_signal_lowers_the_legs_while_balancing() {
    let end = run(Script::default(), |now| usize::from(now >= THEN));
    assert_eq!(end.ending, Ok(Ending::Stopped));
    assert_eq!((end.state, end.counts, end.legs_down), (State::LegsDown, 0, true));
    assert!(end.telemetry > 500, "{}", end.telemetry);
    assert!(end.lean < 0.05, "{}", end.lean);
}

#[test]
fn a_second_signal_does_not_wait() {
    let end =
        run(Script::default(), |now| usize::from(now >= THEN) + usize::from(now >= THEN + 20_000));
    assert_eq!(end.ending, Ok(Ending::AtOnce));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
}

#[test]
fn a_panic_switches_the_torque_off_and_lowers_the_legs() {
    let end = run(Script::default(), |now| {
        assert!(now < THEN, "planted");
        0
    });
    assert_eq!(end.ending, Ok(Ending::Panicked));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
}

#[test]
fn a_bus_that_fails_ends_the_loop() {
    let trouble = (THEN, Trouble::Closed);
    let end = run(Script { trouble, ..Script::default() }, |_| 0);
    assert_eq!(end.ending, Err("bench: closed by the other side".to_owned()));
    assert_eq!((end.state, end.counts), (State::FaultDown, 0));
}

/// A period of the drive and what a turn takes, µs.
const CYCLE: u64 = 2_500;

#[test]
fn errors_on_a_bus_lower_the_legs_while_balancing() {
    let trouble = (THEN, Trouble::Controller(ErrorState::Passive));
    let end = run(Script { trouble, ..Script::default() }, |now| usize::from(now >= THEN + SECOND));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
    let (fault, at) = end.fault.expect("a fault");
    assert_eq!(fault, Fault::BusErrors);
    assert!((THEN..THEN + CYCLE).contains(&at), "{at}");
    assert!(end.lean < 0.05, "{}", end.lean);
}

#[test]
fn a_controller_that_is_off_is_noticed_between_two_frames() {
    let trouble = (THEN, Trouble::Controller(ErrorState::BusOff));
    let end = run(Script { trouble, ..Script::default() }, |now| usize::from(now >= THEN + SECOND));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
    let (fault, at) = end.fault.expect("a fault");
    assert_eq!(fault, Fault::Bus);
    assert!((THEN..THEN + CYCLE).contains(&at), "{at}");
}

#[test]
fn a_controller_alone_on_its_bus_at_power_up_is_no_fault() {
    let trouble = (0, Trouble::Controller(ErrorState::Passive));
    let end = run(Script { trouble, ..Script::default() }, |now| usize::from(now >= SECOND));
    assert_eq!((end.ending, end.state, end.fault), (Ok(Ending::Stopped), State::LegsDown, None));
}

#[test]
fn who_gives_single_commands_need_not_stay() {
    let end = run(Script::default(), |now| usize::from(now >= THEN + SECOND));
    assert_eq!((end.ending, end.state, end.fault), (Ok(Ending::Stopped), State::LegsDown, None));
}

#[test]
fn silence_on_watch_lowers_the_legs() {
    let watch = |on, times: [u64; 3]| times.map(|time| (THEN + time, Order::Watch(on))).to_vec();
    // Three signs of life, and then no more.
    let orders = watch(true, [0, 400_000, 800_000]);
    let silent = THEN + 800_000 + Settings::<f64>::default().operator_timeout_us;
    let script = Script { orders, ..Script::default() };
    let end = run(script.clone(), |now| usize::from(now >= THEN + 3 * SECOND));
    assert_eq!((end.state, end.counts, end.legs_down), (State::FaultDown, 0, true));
    let (fault, at) = end.fault.expect("a fault");
    assert_eq!(fault, Fault::OperatorSilent);
    assert!((silent..silent + 2 * CYCLE).contains(&at), "{at}");
    assert!(end.lean < 0.05, "{}", end.lean);
    // The same, but for a last order that ends the watch.
    let mut script = script;
    script.orders.push((THEN + 900_000, Order::Watch(false)));
    let end = run(script, |now| usize::from(now >= THEN + 3 * SECOND));
    assert_eq!((end.ending, end.state, end.fault), (Ok(Ending::Stopped), State::LegsDown, None));
}
