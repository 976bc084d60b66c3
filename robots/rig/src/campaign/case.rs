//! The faults.

use shapebot_bus::{Effect, Frame};
use shapebot_drive::safety::State;
use shapebot_drive::{Entry, NodeId, Object, Pdo, Role, SdoStep, Signal, id};
use shapebot_drive_build::{DriveDescription, Node};
use shapebot_nodes::NodeFault;
use std::ops::RangeInclusive;

/// What is done.
#[derive(Clone, Debug, PartialEq)]
pub enum Injection {
    /// A fault of a node.
    Node(usize, NodeFault),
    /// A fault of a node that shows after it is reset.
    AfterReset(usize, NodeFault),
    /// Something happens to frames on a bus.
    Wire {
        /// The bus.
        bus: usize,
        /// Identifiers.
        ids: RangeInclusive<u32>,
        /// The node that sends, if one's frames are meant.
        from: Option<usize>,
        /// The node that receives, if one is meant.
        to: Option<usize>,
        /// Cycles for which it lasts; `None` for ever.
        cycles: Option<u32>,
        /// Probability for each frame.
        probability: f64,
        /// What happens.
        effect: Effect,
    },
    /// The controller of a node, or of the master on a bus, is off.
    BusOff {
        /// The bus.
        bus: usize,
        /// The node; `None` for the master.
        node: Option<usize>,
    },
    /// The master's process does not run for so many microseconds.
    Stall(u64),
    /// An operator's emergency stop.
    EmergencyStop,
    /// Somebody else sends frames.
    Spoof(usize, Vec<Frame>),
    /// Two nodes have each other's node-ID from the start.
    Swapped(usize, usize),
}

/// What has to follow, beside what must always hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// It is noticed within five cycles of its first effect.
    Cycles,
    /// It is noticed within so many microseconds.
    Within(u64),
    /// It is nothing: not noticed, and the lean hardly changes.
    Tolerated,
    /// The robot is not set up.
    Blocked,
    /// Whatever: it may be noticed or not.
    Open,
}

/// A fault and what has to follow.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Words for it.
    pub name: String,
    /// What is done.
    pub injection: Injection,
    /// What has to follow while the robot balances.
    pub expect: Expect,
    /// Whether the master can still tell the drives what to do.
    pub reaches_drives: bool,
    /// Whether it can still tell the legs.
    pub reaches_legs: bool,
}

impl Case {
    /// Whether it can be injected in a state; `powered_up`: nothing has been sent yet.
    #[must_use]
    pub fn fits(&self, _state: State, powered_up: bool) -> bool {
        let at_start = matches!(
            self.injection,
            Injection::Swapped(..)
                | Injection::Node(_, NodeFault::Missing(_) | NodeFault::Value(..))
        );
        at_start == powered_up
    }
}

/// Identifiers of PDOs.
const PDOS: RangeInclusive<u32> = 0x181..=0x57F;

/// All faults of a drive.
#[must_use]
pub fn cases(description: &DriveDescription) -> Vec<Case> {
    let mut list = List { description, cases: Vec::new() };
    for (index, node) in description.nodes.iter().enumerate() {
        list.of_node(index, node);
        match node.role {
            Role::Drive => list.of_drive(index, node),
            Role::Imu | Role::Encoder => list.of_sensor(index, node),
            Role::Legs => list.of_legs(index, node),
        }
        list.of_set_up(index, node);
    }
    for bus in 0..description.buses.len() {
        list.of_bus(bus);
    }
    list.of_master();
    list.swapped();
    list.cases
}

struct List<'a> {
    description: &'a DriveDescription,
    cases: Vec<Case>,
}

impl List<'_> {
    fn add(&mut self, name: String, injection: Injection, expect: Expect) {
        let case = Case { name, injection, expect, reaches_drives: true, reaches_legs: true };
        self.cases.push(case);
    }

    /// The master cannot tell nodes any more.
    fn add_deaf(&mut self, name: String, injection: Injection, expect: Expect, drives: bool) {
        let case = Case { name, injection, expect, reaches_drives: !drives, reaches_legs: false };
        self.cases.push(case);
    }

    /// Error frames fill a bus until a controller gives up: nodes on it cannot be told meanwhile.
    fn add_jam(&mut self, name: String, injection: Injection, expect: Expect, bus: usize) {
        let is_on = |role: Role| {
            let nodes = self.description.nodes.iter();
            nodes.filter(|node| usize::from(node.bus) == bus).any(|node| node.role == role)
        };
        let (reaches_drives, reaches_legs) = (!is_on(Role::Drive), !is_on(Role::Legs));
        self.cases.push(Case { name, injection, expect, reaches_drives, reaches_legs });
    }

    fn wire(&self, index: usize, ids: RangeInclusive<u32>, to_node: bool) -> Injection {
        let bus = self.description.nodes.get(index).map_or(0, |node| usize::from(node.bus));
        let (from, to) = if to_node { (None, Some(index)) } else { (Some(index), None) };
        let effect = Effect::Drop;
        Injection::Wire { bus, ids, from, to, cycles: None, probability: 1.0, effect }
    }

    fn of_node(&mut self, index: usize, node: &Node) {
        let name = &node.name;
        let cyclic = node.transmit.iter().any(|pdo| pdo.transmission == 1);
        let heartbeat = Expect::Within(u64::from(node.heartbeat_timeout_us) + 100_000);
        let seen = if cyclic { Expect::Cycles } else { heartbeat };
        let legs = node.role == Role::Legs;
        for (what, fault, expect) in [
            ("no power", NodeFault::Dead, seen),
            ("reset", NodeFault::Reset, seen),
            ("no heartbeat", NodeFault::HeartbeatLoss, heartbeat),
            ("no inputs", NodeFault::NoInputs, if cyclic { seen } else { Expect::Open }),
            ("emergency 0x1000", NodeFault::Emergency(0x1000), Expect::Cycles),
        ] {
            let deaf = legs && matches!(fault, NodeFault::Dead | NodeFault::Reset);
            let what = format!("{name}: {what}");
            if deaf {
                self.add_deaf(what, Injection::Node(index, fault), expect, false);
            } else {
                self.add(what, Injection::Node(index, fault), expect);
            }
        }
        if !cyclic {
            return;
        }
        let lost = self.wire(index, PDOS, false);
        self.add(format!("{name}: inputs dropped"), lost.clone(), Expect::Cycles);
        self.add(
            format!("{name}: inputs dropped for up to 4 cycles"),
            lasting(&lost, 4),
            Expect::Tolerated,
        );
        let sync = u32::from(id::SYNC);
        let deaf = self.wire(index, sync..=sync, true);
        self.add(format!("{name}: SYNC dropped"), deaf, Expect::Cycles);
        let bus = usize::from(node.bus);
        let jam = with(&lost, Effect::Corrupt);
        self.add_jam(format!("{name}: inputs corrupted"), jam, Expect::Cycles, bus);
        for (what, effect, cycles, expect) in [
            ("inputs 300 µs late", Effect::Delay(300), None, Expect::Tolerated),
            ("inputs 1.5 ms late for 3 cycles", Effect::Delay(1500), Some(3), Expect::Tolerated),
            ("inputs 5 ms late", Effect::Delay(5000), None, Expect::Open),
            ("inputs doubled", Effect::Duplicate, Some(20), Expect::Tolerated),
            ("inputs in another order", Effect::Reorder, Some(3), Expect::Open),
            ("inputs altered", Effect::Alter([0x40; 8]), Some(2), Expect::Open),
        ] {
            let mut injection = with(&lost, effect);
            if let Some(cycles) = cycles {
                injection = lasting(&injection, cycles);
            }
            self.add(format!("{name}: {what}"), injection, expect);
        }
        let off = Injection::BusOff { bus, node: Some(index) };
        self.add(format!("{name}: bus-off"), off, Expect::Open);
        let stopped = Frame::new(node.id.heartbeat(), &[4]);
        let spoof = Injection::Spoof(bus, vec![stopped]);
        self.add(format!("{name}: forged heartbeat"), spoof, Expect::Cycles);
    }

    fn of_drive(&mut self, index: usize, node: &Node) {
        let name = &node.name;
        for (what, fault, expect) in [
            ("overcurrent", NodeFault::Emergency(0x2310), Expect::Cycles),
            ("stuck encoder", NodeFault::StuckEncoder, Expect::Open),
            ("flipped sign", NodeFault::FlippedSign, Expect::Open),
            ("saturated at 0.3", NodeFault::Saturation(0.3), Expect::Open),
        ] {
            self.add(format!("{name}: {what}"), Injection::Node(index, fault), expect);
        }
        let torque = |entry: &Entry| entry.signal == Signal::Torque;
        let carries = |pdo: &&Pdo| pdo.entries().iter().any(torque);
        let Some(pdo) = node.receive.iter().find(carries) else { return };
        let ids = u32::from(pdo.cob_id)..=u32::from(pdo.cob_id);
        let deaf = self.wire(index, ids, true);
        self.cases.push(Case {
            name: format!("{name}: commands dropped"),
            injection: deaf,
            expect: Expect::Cycles,
            reaches_drives: false,
            reaches_legs: true,
        });
        // It collides with the master's own: where nothing but error frames is left on the wire, nobody
        // hears a foreign command.
        let most = [0xFF, 0x7F, 0x0F, 0, 0xFF, 0x7F, 0xFF, 0x7F];
        let most = Frame::new(pdo.cob_id, most.get(..pdo.bytes()).unwrap_or_default());
        let bus = usize::from(node.bus);
        let spoof = Injection::Spoof(bus, vec![most; 8]);
        self.add_jam(format!("{name}: forged command"), spoof, Expect::Cycles, bus);
    }

    fn of_sensor(&mut self, index: usize, node: &Node) {
        for (what, fault) in [
            ("stale", NodeFault::StaleSensor),
            ("not a number", NodeFault::InvalidSensor),
            ("unhealthy", NodeFault::Unhealthy(1)),
        ] {
            let injection = Injection::Node(index, fault);
            self.add(format!("{}: {what}", node.name), injection, Expect::Cycles);
        }
    }

    fn of_legs(&mut self, index: usize, node: &Node) {
        let stuck = Injection::Node(index, NodeFault::StuckLegs);
        self.add_deaf(format!("{}: stuck", node.name), stuck, Expect::Open, false);
    }

    /// Other firmware than described: seen at the set-up.
    fn of_set_up(&mut self, index: usize, node: &Node) {
        let places = [0, node.setup.len() / 3, 2 * node.setup.len() / 3];
        for step in places.iter().filter_map(|place| node.setup.get(*place)) {
            let (SdoStep::Write { object, .. } | SdoStep::Expect { object, .. }) = *step;
            let text = shown(object);
            let missing = NodeFault::Missing(object);
            let name = format!("{}: no object {text}", node.name);
            self.add(name, Injection::Node(index, missing), Expect::Blocked);
            let name = format!("{}: no object {text} after a reset", node.name);
            let cyclic = node.transmit.iter().any(|pdo| pdo.transmission == 1);
            let expect = if cyclic { Expect::Cycles } else { Expect::Open };
            if node.role == Role::Legs {
                self.add_deaf(name, Injection::AfterReset(index, missing), expect, false);
            } else {
                self.add(name, Injection::AfterReset(index, missing), expect);
            }
        }
        let expected = node.setup.iter().find_map(|step| match *step {
            SdoStep::Expect { object, value, .. } => Some((object, value)),
            SdoStep::Write { .. } => None,
        });
        if let Some((object, value)) = expected {
            let wrong = NodeFault::Value(object, i64::from(value ^ 1));
            let name = format!("{}: another {}", node.name, shown(object));
            self.add(name, Injection::Node(index, wrong), Expect::Blocked);
        }
    }

    fn of_bus(&mut self, bus: usize) {
        let name = self.description.buses.get(bus).map_or("", |bus| bus.name.as_str()).to_owned();
        let all = |effect, cycles, probability| {
            let (from, to) = (None, None);
            Injection::Wire { bus, ids: 0..=u32::MAX, from, to, cycles, probability, effect }
        };
        for (what, effect, cycles, probability) in [
            ("5 % of frames dropped", Effect::Drop, None, 0.05),
            ("half of frames dropped", Effect::Drop, Some(10), 0.5),
            ("all frames dropped", Effect::Drop, None, 1.0),
            ("frames late by 1 ms", Effect::Delay(1000), Some(10), 0.3),
            ("frames doubled", Effect::Duplicate, Some(10), 1.0),
            ("frames in another order", Effect::Reorder, Some(10), 0.3),
            ("2 % of frames corrupted", Effect::Corrupt, None, 0.02),
            ("all frames corrupted", Effect::Corrupt, None, 1.0),
            ("senders late by 200 µs", Effect::Jitter(200), None, 1.0),
        ] {
            let injection = all(effect, cycles, probability);
            self.add_deaf(format!("{name}: {what}"), injection, Expect::Open, true);
        }
        let off = Injection::BusOff { bus, node: None };
        self.add_deaf(format!("{name}: master is bus-off"), off, Expect::Cycles, true);
        for (what, frame) in [
            ("forged SYNC", Frame::new(id::SYNC, &[])),
            ("forged NMT stop", Frame::new(id::NMT, &[2, 0])),
            ("forged SDO answer", forged_answer(self.description, bus)),
        ] {
            let stops = what == "forged NMT stop";
            let expect =
                if what == "forged SDO answer" { Expect::Tolerated } else { Expect::Cycles };
            let spoof = Injection::Spoof(bus, vec![frame]);
            if stops {
                self.add_deaf(format!("{name}: {what}"), spoof, expect, true);
            } else {
                self.add(format!("{name}: {what}"), spoof, expect);
            }
        }
    }

    fn of_master(&mut self) {
        self.add("emergency stop".to_owned(), Injection::EmergencyStop, Expect::Cycles);
        for (micros, expect) in [(300, Expect::Open), (3_000, Expect::Open), (30_000, Expect::Open)]
        {
            let name = format!("SYNC late by {micros} µs");
            self.add_deaf(name, Injection::Stall(micros), expect, true);
        }
    }

    fn swapped(&mut self) {
        let nodes = &self.description.nodes;
        let mut pairs = Vec::new();
        for (first, a) in nodes.iter().enumerate() {
            for (second, b) in nodes.iter().enumerate().skip(first + 1) {
                if a.bus == b.bus {
                    let name = format!("{} and {} have each other's node-ID", a.name, b.name);
                    let expects = |node: &Node| {
                        let steps = node.setup.iter().copied();
                        steps.filter(|s| matches!(s, SdoStep::Expect { .. })).collect::<Vec<_>>()
                    };
                    let told_apart = expects(a) != expects(b);
                    let expect = if told_apart { Expect::Blocked } else { Expect::Open };
                    pairs.push((name, Injection::Swapped(first, second), expect));
                }
            }
        }
        for (name, injection, expect) in pairs {
            self.add(name, injection, expect);
        }
    }
}

fn shown(object: Object) -> String {
    format!("{:#06x}:{:02x}", object.index, object.sub)
}

fn forged_answer(description: &DriveDescription, bus: usize) -> Frame {
    let on = |node: &&Node| usize::from(node.bus) == bus;
    let node = description.nodes.iter().find(on).map_or(NodeId::clamped(1), |node| node.id);
    Frame::new(node.sdo_response(), &[0x60, 0x00, 0x14, 0x01, 0, 0, 0, 0])
}

fn lasting(injection: &Injection, count: u32) -> Injection {
    let mut injection = injection.clone();
    if let Injection::Wire { cycles, .. } = &mut injection {
        *cycles = Some(count);
    }
    injection
}

fn with(injection: &Injection, what: Effect) -> Injection {
    let mut injection = injection.clone();
    if let Injection::Wire { effect, .. } = &mut injection {
        *effect = what;
    }
    injection
}
