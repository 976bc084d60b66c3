//! A master with simulated nodes on buses in virtual time.
#![allow(dead_code, reason = "each test uses a part")]

use shapebot_bus::{Bus as _, Frame, VirtualBus};
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{Command, DriveTable, Master, Measurement};
use shapebot_drive_build::{DriveDescription, read};
use shapebot_dynamics::{Actuator, Coordinate, Description, Role};
use shapebot_nodes::{DriveUnit, Mechanism, Network, Node, YawAxis, described};

const fn coordinate(name: &'static str, role: Role, actuated: bool) -> Coordinate {
    let reach = if actuated { 200.0 } else { 0.5 };
    Coordinate { name, unit: "rad", role, actuated, lower: -reach, upper: reach }
}

const fn actuator(name: &'static str) -> Actuator {
    Actuator { name, unit: "N*m", limit: 60.0 }
}

const fn model(
    name: &'static str,
    coordinates: &'static [Coordinate],
    position_count: usize,
    actuators: &'static [Actuator],
) -> Description {
    Description {
        name,
        summary: "",
        coordinates,
        position_count,
        shape_sets: &[],
        actuators,
        parameters: &[],
        outputs: &[],
        output_unit: "m",
        frames: &[],
        points: &[],
        geometry: &[],
        friction: &[],
    }
}

/// Coordinates and motors of the planar ballbot.
pub(crate) const PLANAR: Description = model(
    "ballbot_planar",
    &[coordinate("theta", Role::Position, true), coordinate("phi", Role::Shape, false)],
    1,
    &[actuator("tau")],
);

/// Coordinates and motors of the ballbot.
pub(crate) const SPATIAL: Description = model(
    "ballbot3d",
    &[
        coordinate("theta_x", Role::Position, true),
        coordinate("theta_y", Role::Position, true),
        coordinate("phi_x", Role::Shape, false),
        coordinate("phi_y", Role::Shape, false),
    ],
    2,
    &[actuator("tau_x"), actuator("tau_y")],
);

/// A bundled description.
pub(crate) fn description(name: &str, model: &Description) -> DriveDescription {
    let text = shapebot_drives::text(name).expect("a bundled drive");
    read(name, text, model).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Every coordinate is an inertia of its own; lean is set by hand.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inertias {
    pub(crate) position: Vec<f64>,
    pub(crate) rate: Vec<f64>,
    pub(crate) force: Vec<f64>,
    pub(crate) legs: f64,
}

/// kg·m² of each coordinate.
pub(crate) const INERTIA: f64 = 2.0;

impl Mechanism for Inertias {
    fn coordinate(&self, index: usize) -> f64 {
        self.position[index]
    }

    fn rate(&self, index: usize) -> f64 {
        self.rate[index]
    }

    fn set_force(&mut self, index: usize, force: f64) {
        self.force[index] = force;
    }

    fn set_legs(&mut self, extension: f64) {
        self.legs = extension;
    }

    fn advance(&mut self, seconds: f64) {
        for ((position, rate), force) in
            self.position.iter_mut().zip(&mut self.rate).zip(&self.force)
        {
            *rate += force / INERTIA * seconds;
            *position += *rate * seconds;
        }
    }
}

/// Master, nodes and plant.
pub(crate) struct Run<'a> {
    pub(crate) master: Master<'a>,
    pub(crate) network: Network<DriveUnit<Inertias>>,
    pub(crate) table: &'a DriveTable<'a>,
    /// Forces that the controller asks for.
    pub(crate) forces: Vec<f32>,
    /// Frames of the master: bus, frame, time.
    pub(crate) sent: Vec<(usize, Frame, u64)>,
    pub(crate) last: Measurement,
    /// The controller does nothing.
    pub(crate) is_silent: bool,
    /// States in their order, with times.
    pub(crate) states: Vec<(State, u64)>,
}

impl<'a> Run<'a> {
    pub(crate) fn new(description: &DriveDescription, table: &'a DriveTable<'a>) -> Self {
        let count = description.coordinates.len();
        let zeros = vec![0.0; count];
        let inertias =
            Inertias { position: zeros.clone(), rate: zeros.clone(), force: zeros, legs: 1.0 };
        let plant = DriveUnit::new(description, inertias, YawAxis::default());
        let nodes = described(&description.simulated);
        let nodes = nodes.iter().map(|(bus, settings)| (*bus, Node::new(settings))).collect();
        let buses = description.buses.iter().map(|bus| VirtualBus::new(bus.bit_rate, 1)).collect();
        Self {
            master: Master::new(table),
            network: Network::new(buses, nodes, plant),
            table,
            forces: vec![0.0; 8],
            sent: Vec::new(),
            last: Measurement::default(),
            is_silent: false,
            states: vec![(State::Off, 0)],
        }
    }

    pub(crate) fn now(&self) -> u64 {
        self.network.now()
    }

    pub(crate) fn mechanism(&mut self) -> &mut Inertias {
        self.network.plant_now().mechanism_mut()
    }

    /// Lets time pass, µs.
    pub(crate) fn pass(&mut self, micros: u64) {
        let end = self.now() + micros;
        self.until(end, |_| false);
    }

    /// Lets time pass until something holds; panics at the time.
    pub(crate) fn wait(&mut self, micros: u64, what: impl Fn(&Self) -> bool) {
        let end = self.now() + micros;
        let met = self.until(end, &what);
        assert!(
            met,
            "{:?} {:?} {:?}",
            self.master.state(),
            self.master.faults(),
            self.master.counters()
        );
    }

    /// Lets time pass until a state is reached.
    pub(crate) fn reach(&mut self, state: State, micros: u64) {
        self.wait(micros, |run| run.master.state() == state);
    }

    /// Asks for something that the state allows.
    pub(crate) fn ask(&mut self, request: Request) {
        let now = self.now();
        assert!(self.master.request(request, now), "{request:?} in {:?}", self.master.state());
    }

    /// From the beginning to holding a position.
    pub(crate) fn stand(&mut self) {
        self.reach(State::LegsDown, 3_000_000);
        self.pass(20_000);
        self.ask(Request::Start);
        self.reach(State::Balancing, 3_000_000);
        self.ask(Request::KeepStation);
    }

    fn until(&mut self, end: u64, done: impl Fn(&Self) -> bool) -> bool {
        while self.now() < end {
            let wake = self.master.next_wake().max(self.now() + 1).min(end);
            if let Some((bus, received)) = self.network.receive(wake) {
                let now = self.now();
                self.master.receive(bus, &received.frame, now);
            }
            self.act();
            if done(self) {
                return true;
            }
        }
        false
    }

    /// What the master's caller does after each frame and when it is woken.
    pub(crate) fn act(&mut self) {
        let now = self.now();
        let mut out = Vec::new();
        self.master.poll(now, &mut |bus, frame| out.push((bus, frame)));
        if self.master.inputs_due(now) {
            self.last = *self.master.measure(now);
            if !self.is_silent {
                let command = Command::new(&self.forces);
                self.master.command(&command, now, &mut |bus, frame| out.push((bus, frame)));
            }
        }
        for (bus, frame) in out {
            // A bus that is off refuses.
            let _ = self.network.send(bus, &frame);
            self.sent.push((bus, frame, now));
        }
        let state = self.master.state();
        if self.states.last().is_none_or(|(last, _)| *last != state) {
            self.states.push((state, now));
        }
    }

    /// The last torque that was sent in a frame, counts.
    pub(crate) fn sent_torque(&self, bus: usize, id: u16) -> i16 {
        let mine =
            |(on, frame, _): &&(usize, Frame, u64)| *on == bus && frame.standard_id() == Some(id);
        let (_, frame, _) = self.sent.iter().rev().find(mine).expect("such a frame");
        i16::from_le_bytes([frame.bytes()[0], frame.bytes()[1]])
    }
}
