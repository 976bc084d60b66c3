//! A simulated node: the parts together.

use shapebot_drive::id::Function;
use shapebot_drive::{Frame, NodeId, Object};

use crate::cia402::{Drive, DriveSettings, PowerState};
use crate::core::{Core, NmtState};
use crate::legs::Legs;
use crate::sdo::{Objects, Server};
use crate::sensor::{Channel, Sensor};
use crate::{Abort, Dictionary, Physical, pdo};

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeKind {
    /// A CiA 402 drive.
    Drive(DriveSettings),
    /// An IMU or encoder.
    Sensor(Vec<Channel>),
    /// Legs that take so many microseconds from one end to the other.
    Legs {
        /// Travel time, µs.
        travel_us: u64,
    },
}

/// A node as it is built, before any set-up.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeSettings {
    /// Name, as object 0x1008 tells it.
    pub name: String,
    /// Node-ID.
    pub id: NodeId,
    /// From power-up or reset to the boot-up message, µs.
    pub boot_us: u64,
    /// What it is.
    pub kind: NodeKind,
}

/// A fault of a node to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NodeFault {
    /// Power fails: no frames, no torque, legs by their springs. Never comes back.
    Dead,
    /// It restarts, as after a brown-out.
    Reset,
    /// It sends no more heartbeats.
    HeartbeatLoss,
    /// It sends no more transmit PDOs.
    NoInputs,
    /// A fault of the drive with an emergency code, for example 0x2310 overcurrent.
    Emergency(u16),
    /// Position and velocity stay what they are.
    StuckEncoder,
    /// The motor is wired the wrong way round.
    FlippedSign,
    /// The power stage gives no more than this part of the rated torque.
    Saturation(f64),
    /// No new samples: values and sequence stay.
    StaleSensor,
    /// Values that are not numbers.
    InvalidSensor,
    /// The sensor says so itself.
    Unhealthy(u8),
    /// The legs do not move.
    StuckLegs,
    /// An object is missing, as with other firmware than the description's.
    Missing(Object),
    /// An object has another value.
    Value(Object, i64),
}

#[derive(Clone, Debug)]
enum Behaviour {
    Drive(Drive),
    Sensor(Sensor),
    Legs(Legs),
}

/// A simulated CANopen node: frames and time in, frames out.
#[derive(Clone, Debug)]
pub struct Node {
    core: Core,
    server: Server,
    behaviour: Behaviour,
    /// Objects that others wrote and that have not yet taken effect.
    written: bool,
    dead: bool,
    now: u64,
}

impl Node {
    /// A node that is switched on at time zero.
    #[must_use]
    pub fn new(settings: &NodeSettings) -> Self {
        let device_type = match settings.kind {
            // Servo drive of the profile 402.
            NodeKind::Drive(_) => 0x0002_0192,
            // No standard profile.
            NodeKind::Sensor(_) | NodeKind::Legs { .. } => 0,
        };
        let mut core = Core::new(settings.id, &settings.name, device_type, settings.boot_us);
        let behaviour = match &settings.kind {
            NodeKind::Drive(drive) => Behaviour::Drive(Drive::new(*drive, &mut core.dictionary)),
            NodeKind::Sensor(channels) => {
                Behaviour::Sensor(Sensor::new(channels, &mut core.dictionary))
            }
            NodeKind::Legs { travel_us } => {
                Behaviour::Legs(Legs::new(*travel_us, &mut core.dictionary))
            }
        };
        core.keep_as_factory();
        Self { core, server: Server::default(), behaviour, written: false, dead: false, now: 0 }
    }

    /// Node-ID.
    #[must_use]
    pub const fn id(&self) -> NodeId {
        self.core.id
    }

    /// State of the NMT slave.
    #[must_use]
    pub const fn nmt(&self) -> NmtState {
        self.core.nmt
    }

    /// State of the power drive system; `None` unless the node is a drive.
    #[must_use]
    pub const fn power_state(&self) -> Option<PowerState> {
        match &self.behaviour {
            Behaviour::Drive(drive) => Some(drive.state),
            Behaviour::Sensor(_) | Behaviour::Legs(_) => None,
        }
    }

    /// The object dictionary.
    #[must_use]
    pub const fn dictionary(&self) -> &Dictionary {
        &self.core.dictionary
    }

    /// Takes a frame. What the node sends is added to `out`.
    pub fn receive(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        self.now = physical.now();
        let started = !matches!(self.core.nmt, NmtState::Initialising { .. });
        let Some(id) = frame.standard_id().filter(|_| started && !self.dead) else { return };
        match Function::of(id) {
            Function::Nmt => self.command(frame, physical, out),
            Function::Sync => self.synchronise(physical, out),
            Function::SdoRequest(node) if node == self.core.id => self.serve(frame, physical, out),
            Function::Heartbeat(node) => {
                self.core.note_heartbeat(node.raw(), self.now);
                self.hear();
            }
            _ => self.take_pdo(frame, physical, out),
        }
        self.core.send_events(self.now, out);
    }

    /// Lets timers run up to now. What the node sends is added to `out`.
    pub fn poll(&mut self, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        self.now = physical.now();
        if let NmtState::Initialising { ready_at } = self.core.nmt
            && ready_at <= self.now
            && !self.dead
        {
            self.core.boot(self.now, out);
            if let Behaviour::Drive(drive) = &mut self.behaviour {
                drive.boot(&mut self.core);
            }
        }
        if !self.dead {
            self.core.beat(self.now, out);
            while let Some(error) = self.core.lost(self.now) {
                match &mut self.behaviour {
                    Behaviour::Drive(drive) => drive.lost(error, &mut self.core, physical, out),
                    Behaviour::Legs(legs) => {
                        legs.release(true);
                        self.core.emergency(error.code(), out);
                    }
                    Behaviour::Sensor(_) => self.core.emergency(error.code(), out),
                }
            }
        }
        self.act(physical, out, false);
        if self.has_event_timer() {
            self.sample(physical);
        }
        if !self.dead {
            self.core.send_events(self.now, out);
        }
    }

    /// The next time at which [`Node::poll`] has something to do, µs.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        let own = match &self.behaviour {
            Behaviour::Drive(drive) => drive.next(self.now),
            Behaviour::Legs(legs) => legs.next(&self.core),
            Behaviour::Sensor(_) => None,
        };
        let core = if self.dead { None } else { self.core.next() };
        own.into_iter().chain(core).min()
    }

    /// Makes a fault.
    pub fn inject(&mut self, fault: NodeFault, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        self.now = physical.now();
        match (fault, &mut self.behaviour) {
            (NodeFault::Dead, _) => {
                self.restart(true, physical);
                self.dead = true;
            }
            (NodeFault::Reset, _) => self.restart(true, physical),
            (NodeFault::HeartbeatLoss, _) => self.core.sends_heartbeat = false,
            (NodeFault::NoInputs, _) => self.core.sends_pdos = false,
            (NodeFault::Missing(object), _) => self.core.dictionary.remove(object),
            (NodeFault::Value(object, value), _) => {
                self.core.dictionary.set(object, value);
                self.core.keep_as_factory();
            }
            (NodeFault::Emergency(code), Behaviour::Drive(drive)) => {
                drive.fault(code, &mut self.core, self.now, out);
                self.act(physical, out, false);
            }
            (NodeFault::Emergency(code), _) => self.core.emergency(code, out),
            (NodeFault::StuckEncoder, Behaviour::Drive(drive)) => {
                drive.faults.stuck = Some(physical.here().motor(drive.settings.motor));
            }
            (NodeFault::FlippedSign, Behaviour::Drive(drive)) => drive.faults.flipped = true,
            (NodeFault::Saturation(part), Behaviour::Drive(drive)) => {
                drive.faults.strength = Some(part);
            }
            (NodeFault::StaleSensor | NodeFault::StuckEncoder, Behaviour::Sensor(sensor)) => {
                sensor.faults.stale = true;
            }
            (NodeFault::InvalidSensor, Behaviour::Sensor(sensor)) => sensor.faults.invalid = true,
            (NodeFault::Unhealthy(health), Behaviour::Sensor(sensor)) => {
                sensor.faults.health = health;
            }
            (NodeFault::StuckLegs, Behaviour::Legs(legs)) => legs.stuck = true,
            _ => {}
        }
    }

    /// Ends the faults that are switches; a dead node stays dead, a missing object missing.
    pub fn heal(&mut self) {
        self.core.sends_heartbeat = true;
        self.core.sends_pdos = true;
        match &mut self.behaviour {
            Behaviour::Drive(drive) => drive.faults = Default::default(),
            Behaviour::Sensor(sensor) => sensor.faults = Default::default(),
            Behaviour::Legs(legs) => legs.stuck = false,
        }
    }

    fn command(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        let Some([command, node]) = frame.exactly::<2>() else { return };
        if node != 0 && node != self.core.id.raw() {
            return;
        }
        match command {
            1 => {
                self.core.nmt = NmtState::Operational;
                self.core.refresh(self.now);
                self.hear();
                self.sample(physical);
            }
            2 => self.leave_operational(NmtState::Stopped, physical, out),
            128 => self.leave_operational(NmtState::PreOperational, physical, out),
            129 => self.restart(true, physical),
            130 => self.restart(false, physical),
            _ => {}
        }
    }

    /// Without PDOs there are no commands: as if the connection was lost.
    fn leave_operational(
        &mut self,
        next: NmtState,
        physical: &mut Physical<'_>,
        out: &mut Vec<Frame>,
    ) {
        let was = std::mem::replace(&mut self.core.nmt, next);
        if let Behaviour::Drive(drive) = &mut self.behaviour
            && was == NmtState::Operational
            && drive.state == PowerState::OperationEnabled
        {
            drive.lost(crate::core::CommunicationError::Heartbeat, &mut self.core, physical, out);
        }
        self.act(physical, out, false);
    }

    fn restart(&mut self, all: bool, physical: &mut Physical<'_>) {
        self.core.reset(all, self.now);
        self.server.reset();
        match &mut self.behaviour {
            Behaviour::Drive(drive) => drive.reset(&mut self.core, physical),
            Behaviour::Legs(legs) => legs.release(true),
            Behaviour::Sensor(_) => {}
        }
    }

    /// Somebody who is listened to is there.
    fn hear(&mut self) {
        if let Behaviour::Legs(legs) = &mut self.behaviour {
            legs.release(false);
        }
    }

    /// SYNC k: inputs are sampled and sent, then what came after SYNC k − 1 takes effect.
    fn synchronise(&mut self, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        if !self.core.is_operational() {
            return;
        }
        self.core.last_sync = Some(self.now);
        self.sample(physical);
        self.core.send_synchronous(self.now, out);
        self.core.apply_pdos();
        self.act(physical, out, true);
    }

    fn serve(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        if self.core.nmt == NmtState::Stopped {
            return;
        }
        self.sample(physical);
        let mut server = std::mem::take(&mut self.server);
        if let Some(answer) = server.answer(frame, self) {
            out.push(Frame::new(self.core.id.sdo_response(), &answer));
        }
        self.server = server;
        if std::mem::take(&mut self.written) {
            self.act(physical, out, true);
        }
    }

    fn take_pdo(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        if self.core.is_operational() && self.core.take_pdo(frame, self.now, out) {
            self.act(physical, out, true);
        }
    }

    fn has_event_timer(&self) -> bool {
        self.core.is_operational()
            && self.core.transmit.iter().any(|t| !t.pdo.is_synchronous() && t.pdo.event_us > 0)
    }

    fn sample(&mut self, physical: &mut Physical<'_>) {
        match &mut self.behaviour {
            Behaviour::Drive(drive) => drive.sample(&mut self.core, physical),
            Behaviour::Sensor(sensor) => sensor.sample(&mut self.core, physical),
            Behaviour::Legs(legs) => legs.step(&mut self.core, physical),
        }
    }

    /// Lets objects and time have their effect; `commanded` if objects may have changed.
    fn act(&mut self, physical: &mut Physical<'_>, out: &mut Vec<Frame>, commanded: bool) {
        match &mut self.behaviour {
            Behaviour::Drive(drive) if commanded => drive.step(&mut self.core, physical, out),
            Behaviour::Drive(drive) => drive.act(&mut self.core, physical),
            Behaviour::Legs(legs) => legs.step(&mut self.core, physical),
            Behaviour::Sensor(_) => {}
        }
    }
}

impl Objects for Node {
    fn read(&self, object: Object) -> Result<Vec<u8>, Abort> {
        self.core.dictionary.read(object)
    }

    fn write(&mut self, object: Object, bytes: &[u8]) -> Result<(), Abort> {
        let number = self.core.dictionary.check_write(object, bytes)?;
        pdo::check(&self.core.dictionary, object, number)?;
        if let Behaviour::Drive(drive) = &self.behaviour {
            drive.check(object, number)?;
        }
        self.core.dictionary.set(object, number);
        if pdo::is_ours(object.index) || matches!(object.index, 0x1016 | 0x1017) {
            self.core.refresh(self.now);
        }
        self.written = true;
        Ok(())
    }
}
