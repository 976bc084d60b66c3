//! A whole control cycle: frames in, estimate, plan, controller, allocation, frames out.

use crate::{Digest, Inputs, Step};
use shapebot_answers::Nodes;
use shapebot_control::Gains;
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{DriveTable, Entry, Frame, NodeTable, Role, Signal};
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL};
use shapebot_planner::value::PlanView;
use shapebot_runtime::{Runtime, Settings};

/// Robot of the step.
pub(crate) type Robot = Ballbot3dArms<f32>;

type ArmsRuntime<'a> = Runtime<'a, Robot, f32, 8, 2, 6>;

/// Frames of a cycle, one way.
const ROOM: usize = 40;

/// When frames of nodes come and when their time is up, µs after SYNC; as seen by a controller that
/// looks at its inbox once.
const ARRIVAL: u64 = 1000;

/// Cycles until the robot must follow its plan.
const PATIENCE: u32 = 4000;

/// Cycles from heartbeat to heartbeat of a node.
const HEARTBEAT: u32 = 50;

/// The ballbot with arms on its two buses, following a plan with measurements that are made up.
///
/// The computation is all that the runtime does in a cycle: SYNC, every frame of every node, heartbeats
/// where they are due, controller, torque frames.
#[derive(Clone, Debug)]
pub struct FullStep<'a> {
    table: &'a DriveTable<'a>,
    runtime: ArmsRuntime<'a>,
    nodes: Nodes<'a>,
    now: u64,
    cycle: u32,
    inbox: Mailbox,
    outbox: Mailbox,
    /// Positions of axes, counts.
    axes: [i64; 8],
}

impl<'a> FullStep<'a> {
    /// A runtime that follows `plan`; `None` if it does not come to that.
    #[must_use]
    pub fn new(
        robot: &'a Robot,
        table: &'a DriveTable<'a>,
        plan: PlanView<'a, f32, 2, 6, 8>,
    ) -> Option<Self> {
        let mut gains = Gains::from_design(robot, &CONTROL).ok()?;
        gains.period = table.timing.period_us as f32 * 1e-6;
        let mut runtime = Runtime::new(robot, table, &gains, &Settings::default()).ok()?;
        runtime.load(plan).ok()?;
        let (inbox, outbox) = (Mailbox::new(), Mailbox::new());
        let nodes = Nodes::new(table);
        let (now, cycle, axes) = (0, 0, [0; 8]);
        let mut step = Self { table, runtime, nodes, now, cycle, inbox, outbox, axes };
        step.begin()?;
        Some(step)
    }

    /// Set-up, enabling, rising, standing, and the first cycle of the plan; all is at rest.
    fn begin(&mut self) -> Option<()> {
        for _ in 0..PATIENCE {
            self.next_inbox(&mut |_, _| 0);
            self.evaluate();
            let request = match self.runtime.master().state() {
                State::LegsDown => Request::Start,
                State::Balancing => Request::KeepStation,
                State::StationKeeping => Request::Track,
                State::Tracking => return Some(()),
                _ => continue,
            };
            self.runtime.request(request, self.now + ARRIVAL);
        }
        None
    }

    /// Frames of the next cycle; answers to what the master sent in the last one are among them.
    fn next_inbox(&mut self, value: &mut dyn FnMut(usize, &Entry) -> i64) {
        self.now += u64::from(self.table.timing.period_us);
        self.cycle += 1;
        let (nodes, inbox) = (&mut self.nodes, &mut self.inbox);
        inbox.clear();
        for (bus, frame) in self.outbox.frames() {
            if let Some(answer) = nodes.hear(*bus, frame) {
                inbox.put(*bus, answer);
            }
        }
        nodes.sample(value, |bus, frame| inbox.put(bus, frame));
        // A node each few cycles, never two at once.
        for (at, (bus, frame)) in (0_u32..).zip(nodes.heartbeats()) {
            if self.cycle % HEARTBEAT == 4 * at {
                inbox.put(bus, frame);
            }
        }
    }
}

impl Step for FullStep<'_> {
    const NAME: &'static str = "full_step";

    fn draw(&mut self, inputs: &mut Inputs) {
        // Axes move by some counts; both drives of a pair alike, each with the sign of its motor.
        let mut axes = self.axes;
        for axis in &mut axes {
            *axis += inputs.between(-60.0, 60.0) as i64;
        }
        self.axes = axes;
        let nodes = self.table.nodes;
        self.next_inbox(&mut |node, entry| made_up(nodes.get(node), &axes, entry, inputs));
    }

    fn evaluate(&mut self) {
        let (runtime, outbox) = (&mut self.runtime, &mut self.outbox);
        outbox.clear();
        runtime.poll(self.now, &mut |bus, frame| outbox.put(bus, frame));
        let arrival = self.now + ARRIVAL;
        for (bus, frame) in self.inbox.frames() {
            runtime.receive(*bus, frame, arrival);
        }
        runtime.poll(arrival, &mut |bus, frame| outbox.put(bus, frame));
    }

    fn digest(&self, digest: &mut Digest) {
        for (bus, frame) in self.outbox.frames() {
            digest.bytes(&[*bus as u8]);
            digest.bytes(&frame.raw_id().to_le_bytes());
            digest.bytes(frame.bytes());
        }
        digest.bytes(&[self.runtime.master().state() as u8]);
        digest.numbers(&self.runtime.master().applied());
        if let Some(command) = self.runtime.snapshot().command {
            digest.numbers(&command.force);
        }
    }
}

/// A measurement in counts: leans of up to 0.1 rad, rates of up to 0.2 rad/s, axes where they are.
fn made_up(
    node: Option<&NodeTable<'_>>,
    axes: &[i64; 8],
    entry: &Entry,
    inputs: &mut Inputs,
) -> i64 {
    let motor = node.filter(|node| node.role == Role::Drive).and_then(|node| node.motor);
    let within = match (entry.signal, motor) {
        (Signal::Position, Some(motor)) => {
            let counts = axes.get(usize::from(motor.axis)).copied().unwrap_or(0);
            return counts * i64::from(motor.sign);
        }
        (Signal::Coordinate(_) | Signal::Heading | Signal::Yaw, _) => 0.1,
        (Signal::Rate(_) | Signal::HeadingRate | Signal::Velocity, _) => 0.2,
        (Signal::ActualTorque, _) => 0.05,
        _ => 0.0,
    };
    (inputs.between(-within, within) / entry.scale) as i64
}

/// Frames with their buses.
#[derive(Clone, Copy, Debug)]
struct Mailbox {
    frames: [(usize, Frame); ROOM],
    len: usize,
}

impl Mailbox {
    fn new() -> Self {
        Self { frames: [(0, Frame::new(0, &[])); ROOM], len: 0 }
    }

    fn clear(&mut self) {
        self.len = 0;
    }

    fn put(&mut self, bus: usize, frame: Frame) {
        if let Some(place) = self.frames.get_mut(self.len) {
            *place = (bus, frame);
            self.len += 1;
        }
    }

    fn frames(&self) -> &[(usize, Frame)] {
        self.frames.get(..self.len).unwrap_or(&self.frames)
    }
}
