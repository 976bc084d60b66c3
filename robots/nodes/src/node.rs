//! A simulated node: the parts together.

use shapebot_drive::id::Function;
use shapebot_drive::{DataType, Frame, NodeId, Object};

use crate::cia402::{Drive, DriveSettings, PowerState};
use crate::device::{Device, NmtState};
use crate::legs::Legs;
use crate::sdo::{Objects, Server};
use crate::sensor::{Channel, Sensor};
use crate::{Abort, Access, Dictionary, Mappable, Physical, pdo};

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeKind {
    /// A CiA 402 drive.
    Drive(DriveSettings),
    /// An IMU or encoder: nothing but its channels.
    Sensor,
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
    /// What it measures besides what its kind does.
    pub channels: Vec<Channel>,
    /// Objects that it has besides, and other values of those that it has.
    pub objects: Vec<ExtraObject>,
}

impl NodeSettings {
    /// A node with no more than its kind has, which takes 20 ms to start.
    #[must_use]
    pub fn new(name: &str, id: NodeId, kind: NodeKind) -> Self {
        let (channels, objects) = (Vec::new(), Vec::new());
        Self { name: name.to_owned(), id, boot_us: 20_000, kind, channels, objects }
    }
}

/// An object of a node's dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExtraObject {
    /// Where it is.
    pub object: Object,
    /// Its type.
    pub kind: DataType,
    /// Value after power-up.
    pub value: i64,
    /// What may be done with it.
    pub access: Access,
    /// PDOs that it may be part of.
    pub mappable: Mappable,
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
    Sensor,
    Legs(Legs),
}

/// A simulated CANopen node: frames and time in, frames out.
#[derive(Clone, Debug)]
pub struct Node {
    device: Device,
    server: Server,
    behaviour: Behaviour,
    sensor: Sensor,
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
            NodeKind::Sensor | NodeKind::Legs { .. } => 0,
        };
        let mut device = Device::new(settings.id, &settings.name, device_type, settings.boot_us);
        let dictionary = &mut device.dictionary;
        let behaviour = match &settings.kind {
            NodeKind::Drive(drive) => Behaviour::Drive(Drive::new(*drive, dictionary)),
            NodeKind::Sensor => Behaviour::Sensor,
            NodeKind::Legs { travel_us } => Behaviour::Legs(Legs::new(*travel_us, dictionary)),
        };
        let sensor = Sensor::new(&settings.channels, dictionary);
        for extra in &settings.objects {
            let ExtraObject { object, kind, value, access, mappable } = *extra;
            if dictionary.contains(object) {
                dictionary.set(object, value);
            } else {
                dictionary.number(object, kind, value, access, mappable);
            }
        }
        device.keep_as_factory();
        let server = Server::default();
        Self { device, server, behaviour, sensor, written: false, dead: false, now: 0 }
    }

    /// Node-ID.
    #[must_use]
    pub const fn id(&self) -> NodeId {
        self.device.id
    }

    /// State of the NMT slave.
    #[must_use]
    pub const fn nmt(&self) -> NmtState {
        self.device.nmt
    }

    /// State of the power drive system; `None` unless the node is a drive.
    #[must_use]
    pub const fn power_state(&self) -> Option<PowerState> {
        match &self.behaviour {
            Behaviour::Drive(drive) => Some(drive.state),
            Behaviour::Sensor | Behaviour::Legs(_) => None,
        }
    }

    /// The object dictionary.
    #[must_use]
    pub const fn dictionary(&self) -> &Dictionary {
        &self.device.dictionary
    }

    /// Takes a frame. What the node sends is added to `out`.
    pub fn receive(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        self.now = physical.now();
        let started = !matches!(self.device.nmt, NmtState::Initialising { .. });
        let Some(id) = frame.standard_id().filter(|_| started && !self.dead) else { return };
        match Function::of(id) {
            Function::Nmt => self.command(frame, physical, out),
            Function::Sync => self.synchronise(physical, out),
            Function::SdoRequest(node) if node == self.device.id => {
                self.serve(frame, physical, out)
            }
            Function::Heartbeat(node) => {
                self.device.note_heartbeat(node.raw(), self.now);
                self.hear();
            }
            _ => self.take_pdo(frame, physical, out),
        }
        self.device.send_events(self.now, out);
    }

    /// Lets timers run up to now. What the node sends is added to `out`.
    pub fn poll(&mut self, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        self.now = physical.now();
        if let NmtState::Initialising { ready_at } = self.device.nmt
            && ready_at <= self.now
            && !self.dead
        {
            self.device.boot(self.now, out);
            if let Behaviour::Drive(drive) = &mut self.behaviour {
                drive.boot(&mut self.device);
            }
        }
        if !self.dead {
            self.device.beat(self.now, out);
            while let Some(error) = self.device.lost(self.now) {
                match &mut self.behaviour {
                    Behaviour::Drive(drive) => drive.lost(error, &mut self.device, physical, out),
                    Behaviour::Legs(legs) => {
                        legs.release(true);
                        self.device.emergency(error.code(), out);
                    }
                    Behaviour::Sensor => self.device.emergency(error.code(), out),
                }
            }
        }
        self.act(physical, out, false);
        if self.has_event_timer() {
            self.sample(physical);
        }
        if !self.dead {
            self.device.send_events(self.now, out);
        }
    }

    /// The next time at which [`Node::poll`] has something to do, µs.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        let own = match &self.behaviour {
            Behaviour::Drive(drive) => drive.next(self.now),
            Behaviour::Legs(legs) => legs.next(&self.device),
            Behaviour::Sensor => None,
        };
        let device = if self.dead { None } else { self.device.next() };
        own.into_iter().chain(device).min()
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
            (NodeFault::HeartbeatLoss, _) => self.device.sends_heartbeat = false,
            (NodeFault::NoInputs, _) => self.device.sends_pdos = false,
            (NodeFault::Missing(object), _) => self.device.dictionary.remove(object),
            (NodeFault::Value(object, value), _) => {
                self.device.dictionary.set(object, value);
                self.device.keep_as_factory();
            }
            (NodeFault::Emergency(code), Behaviour::Drive(drive)) => {
                drive.fault(code, &mut self.device, self.now, out);
                self.act(physical, out, false);
            }
            (NodeFault::Emergency(code), _) => self.device.emergency(code, out),
            (NodeFault::StuckEncoder, Behaviour::Drive(drive)) => {
                drive.faults.stuck = Some(physical.here().motor(drive.settings.motor));
            }
            (NodeFault::FlippedSign, Behaviour::Drive(drive)) => drive.faults.flipped = true,
            (NodeFault::Saturation(part), Behaviour::Drive(drive)) => {
                drive.faults.strength = Some(part);
            }
            (NodeFault::StaleSensor | NodeFault::StuckEncoder, _) => {
                self.sensor.faults.stale = true;
            }
            (NodeFault::InvalidSensor, _) => self.sensor.faults.invalid = true,
            (NodeFault::Unhealthy(health), _) => self.sensor.faults.health = health,
            (NodeFault::StuckLegs, Behaviour::Legs(legs)) => legs.stuck = true,
            _ => {}
        }
    }

    /// Forgives SYNC and receive PDOs that come late by so many µs more: no drive does, but a computer that
    /// plays drive and master may need it.
    pub const fn forgive(&mut self, micros: u64) {
        self.device.slack = micros;
    }

    /// Ends the faults that are switches; a dead node stays dead, a missing object missing.
    pub fn heal(&mut self) {
        self.device.sends_heartbeat = true;
        self.device.sends_pdos = true;
        self.sensor.faults = Default::default();
        match &mut self.behaviour {
            Behaviour::Drive(drive) => drive.faults = Default::default(),
            Behaviour::Legs(legs) => legs.stuck = false,
            Behaviour::Sensor => {}
        }
    }

    fn command(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        let Some([command, node]) = frame.exactly::<2>() else { return };
        if node != 0 && node != self.device.id.raw() {
            return;
        }
        match command {
            1 => {
                self.device.nmt = NmtState::Operational;
                self.device.refresh_pdos(self.now);
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
        let was = std::mem::replace(&mut self.device.nmt, next);
        if let Behaviour::Drive(drive) = &mut self.behaviour
            && was == NmtState::Operational
            && drive.state == PowerState::OperationEnabled
        {
            drive.lost(
                crate::device::CommunicationError::Heartbeat,
                &mut self.device,
                physical,
                out,
            );
        }
        self.act(physical, out, false);
    }

    fn restart(&mut self, all: bool, physical: &mut Physical<'_>) {
        self.device.reset(all, self.now);
        self.server.reset();
        match &mut self.behaviour {
            Behaviour::Drive(drive) => drive.reset(&mut self.device, physical),
            Behaviour::Legs(legs) => legs.release(true),
            Behaviour::Sensor => {}
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
        if !self.device.is_operational() {
            return;
        }
        self.device.last_sync = Some(self.now);
        self.sample(physical);
        self.device.send_synchronous(self.now, out);
        self.device.apply_pdos();
        self.act(physical, out, true);
    }

    fn serve(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        if self.device.nmt == NmtState::Stopped {
            return;
        }
        self.sample(physical);
        let mut server = std::mem::take(&mut self.server);
        if let Some(answer) = server.answer(frame, self) {
            out.push(Frame::new(self.device.id.sdo_response(), &answer));
        }
        self.server = server;
        if std::mem::take(&mut self.written) {
            self.act(physical, out, true);
        }
    }

    fn take_pdo(&mut self, frame: &Frame, physical: &mut Physical<'_>, out: &mut Vec<Frame>) {
        if self.device.is_operational() && self.device.take_pdo(frame, self.now, out) {
            self.act(physical, out, true);
        }
    }

    fn has_event_timer(&self) -> bool {
        self.device.is_operational()
            && self.device.transmit.iter().any(|t| !t.pdo.is_synchronous() && t.pdo.event_us > 0)
    }

    fn sample(&mut self, physical: &mut Physical<'_>) {
        self.sensor.sample(&mut self.device, physical);
        match &mut self.behaviour {
            Behaviour::Drive(drive) => drive.sample(&mut self.device, physical),
            Behaviour::Legs(legs) => legs.step(&mut self.device, physical),
            Behaviour::Sensor => {}
        }
    }

    /// Lets objects and time have their effect; `commanded` if objects may have changed.
    fn act(&mut self, physical: &mut Physical<'_>, out: &mut Vec<Frame>, commanded: bool) {
        match &mut self.behaviour {
            Behaviour::Drive(drive) if commanded => drive.step(&mut self.device, physical, out),
            Behaviour::Drive(drive) => drive.act(&mut self.device, physical),
            Behaviour::Legs(legs) => legs.step(&mut self.device, physical),
            Behaviour::Sensor => {}
        }
    }
}

impl Objects for Node {
    fn read(&self, object: Object) -> Result<Vec<u8>, Abort> {
        self.device.dictionary.read(object)
    }

    fn write(&mut self, object: Object, bytes: &[u8]) -> Result<(), Abort> {
        let number = self.device.dictionary.check_write(object, bytes)?;
        pdo::check(&self.device.dictionary, object, number)?;
        if let Behaviour::Drive(drive) = &self.behaviour {
            drive.check(object, number)?;
        }
        self.device.dictionary.set(object, number);
        match object.index {
            0x1016 => self.device.refresh_consumers(),
            0x1017 => self.device.refresh_heartbeat(self.now),
            index if pdo::is_ours(index) => self.device.refresh_pdos(self.now),
            _ => {}
        }
        self.written = true;
        Ok(())
    }
}
