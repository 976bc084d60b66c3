//! What every simulated node has: NMT, heartbeats, emergencies, PDO bookkeeping.

use shapebot_drive::{DataType, Frame, NodeId, Object, object};

use crate::pdo::{self, Direction, Pdo};
use crate::{Access, Dictionary, Mappable};

/// State of the NMT slave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmtState {
    /// Until `ready_at`, µs, when the boot-up message goes out.
    Initialising {
        /// End of the start-up.
        ready_at: u64,
    },
    /// SDO only.
    PreOperational,
    /// SDO and PDO.
    Operational,
    /// Neither.
    Stopped,
}

impl NmtState {
    const fn heartbeat(self) -> u8 {
        match self {
            Self::Initialising { .. } => 0,
            Self::Stopped => 4,
            Self::Operational => 5,
            Self::PreOperational => 127,
        }
    }
}

/// Errors of the communication that a node notices by itself, with their emergency codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CommunicationError {
    /// A heartbeat that is listened to stopped.
    Heartbeat,
    /// A receive PDO did not come in time.
    Deadline,
    /// SYNC stopped.
    Sync,
}

impl CommunicationError {
    pub(crate) const fn code(self) -> u16 {
        match self {
            Self::Heartbeat => 0x8130,
            Self::Deadline => 0x8250,
            Self::Sync => 0x8700,
        }
    }
}

/// Emergency code: a receive PDO was too short.
pub(crate) const PDO_TOO_SHORT: u16 = 0x8210;
/// Emergency code: a receive PDO was too long.
pub(crate) const PDO_TOO_LONG: u16 = 0x8220;

#[derive(Clone, Copy, Debug)]
struct Consumer {
    node: u8,
    timeout: u64,
    /// Last heartbeat; none is missed before the first.
    last: Option<u64>,
}

/// A receive PDO and what came in for it.
#[derive(Clone, Debug)]
pub(crate) struct Reception {
    pub(crate) pdo: Pdo,
    /// Waits for the next SYNC.
    pub(crate) waiting: Option<Vec<(Object, i64)>>,
    last: Option<u64>,
}

/// A transmit PDO and when it went out.
#[derive(Clone, Debug)]
pub(crate) struct Transmission {
    pub(crate) pdo: Pdo,
    syncs: u8,
    last: u64,
    sent: Option<Frame>,
}

/// Shortest time between two event-driven PDOs, µs: no node floods the bus.
const INHIBIT: u64 = 1000;

#[derive(Clone, Debug)]
pub(crate) struct Device {
    pub(crate) id: NodeId,
    pub(crate) dictionary: Dictionary,
    factory: Dictionary,
    pub(crate) nmt: NmtState,
    boot_us: u64,
    pub(crate) receive: Vec<Reception>,
    pub(crate) transmit: Vec<Transmission>,
    heartbeat_at: Option<u64>,
    consumers: Vec<Consumer>,
    pub(crate) last_sync: Option<u64>,
    /// Lateness of SYNC and receive PDOs that is forgiven, µs.
    pub(crate) slack: u64,
    pub(crate) sends_heartbeat: bool,
    pub(crate) sends_pdos: bool,
}

const ERROR_REGISTER: Object = object(0x1001, 0);
const CONSUMERS: u8 = 4;

impl Device {
    /// The communication objects of a node with a device type; others are added to them.
    pub(crate) fn new(id: NodeId, name: &str, device_type: u32, boot_us: u64) -> Self {
        let mut dictionary = Dictionary::default();
        communication_objects(&mut dictionary, id, name, device_type);
        let nmt = NmtState::Initialising { ready_at: boot_us };
        Self {
            id,
            factory: dictionary.clone(),
            dictionary,
            nmt,
            boot_us,
            receive: Vec::new(),
            transmit: Vec::new(),
            heartbeat_at: None,
            consumers: Vec::new(),
            last_sync: None,
            slack: 0,
            sends_heartbeat: true,
            sends_pdos: true,
        }
    }

    /// Takes the dictionary as it is for what a reset restores.
    pub(crate) fn keep_as_factory(&mut self) {
        self.factory = self.dictionary.clone();
    }

    /// Starts again with the objects of the factory: all, or those of the communication.
    pub(crate) fn reset(&mut self, all: bool, now: u64) {
        let indices = if all { 0..=u16::MAX } else { 0x1000..=0x1FFF };
        let factory = self.factory.clone();
        self.dictionary.restore(&factory, indices);
        self.nmt = NmtState::Initialising { ready_at: now + self.boot_us };
        self.last_sync = None;
        self.refresh(now);
    }

    /// End of the start-up: boot-up message.
    pub(crate) fn boot(&mut self, now: u64, out: &mut Vec<Frame>) {
        self.nmt = NmtState::PreOperational;
        out.push(Frame::new(self.id.heartbeat(), &[0]));
        self.refresh(now);
    }

    /// Takes over PDOs and timers from their objects.
    pub(crate) fn refresh(&mut self, now: u64) {
        self.refresh_pdos(now);
        self.refresh_consumers();
        self.refresh_heartbeat(now);
    }

    /// Takes over PDOs after their objects have changed.
    pub(crate) fn refresh_pdos(&mut self, now: u64) {
        let dictionary = &self.dictionary;
        let receive = pdo::in_use(dictionary, Direction::Receive).into_iter();
        self.receive = receive.map(|pdo| Reception { pdo, waiting: None, last: None }).collect();
        let transmit = pdo::in_use(dictionary, Direction::Transmit).into_iter();
        let start = |pdo| Transmission { pdo, syncs: 0, last: now, sent: None };
        self.transmit = transmit.map(start).collect();
    }

    /// Takes over 0x1016.
    pub(crate) fn refresh_consumers(&mut self) {
        let dictionary = &self.dictionary;
        self.consumers = (1..=CONSUMERS).filter_map(|sub| consumer(dictionary, sub)).collect();
    }

    /// Takes over 0x1017.
    pub(crate) fn refresh_heartbeat(&mut self, now: u64) {
        let period = self.heartbeat_period();
        self.heartbeat_at = (period > 0).then_some(now + period);
    }

    fn heartbeat_period(&self) -> u64 {
        1000 * self.dictionary.get(Object::PRODUCER_HEARTBEAT).unsigned_abs()
    }

    /// Communication cycle period, µs; zero if SYNC is not watched.
    pub(crate) fn cycle_period(&self) -> u64 {
        self.dictionary.get(Object::CYCLE_PERIOD).unsigned_abs()
    }

    pub(crate) fn is_operational(&self) -> bool {
        self.nmt == NmtState::Operational
    }

    pub(crate) fn note_heartbeat(&mut self, node: u8, now: u64) {
        for consumer in self.consumers.iter_mut().filter(|consumer| consumer.node == node) {
            consumer.last = Some(now);
        }
    }

    /// Stores a receive PDO; true if objects have changed at once.
    pub(crate) fn take_pdo(&mut self, frame: &Frame, now: u64, out: &mut Vec<Frame>) -> bool {
        let id = frame.standard_id();
        let mut applied = false;
        let mut emergencies = Vec::new();
        for reception in &mut self.receive {
            if id != Some(reception.pdo.cob_id) || frame.is_remote() {
                continue;
            }
            let expected = reception.pdo.bytes();
            if frame.len() < expected {
                emergencies.push(PDO_TOO_SHORT);
                continue;
            }
            if frame.len() > expected {
                emergencies.push(PDO_TOO_LONG);
            }
            reception.last = Some(now);
            let values = reception.pdo.unpack(frame.bytes());
            if reception.pdo.is_synchronous() {
                reception.waiting = Some(values);
            } else {
                store(&mut self.dictionary, &values);
                applied = true;
            }
        }
        for code in emergencies {
            self.emergency(code, out);
        }
        applied
    }

    /// SYNC: what synchronous receive PDOs brought takes effect.
    pub(crate) fn apply_pdos(&mut self) {
        for reception in &mut self.receive {
            if let Some(values) = reception.waiting.take() {
                store(&mut self.dictionary, &values);
            }
        }
    }

    /// SYNC: synchronous transmit PDOs that are due.
    pub(crate) fn send_synchronous(&mut self, now: u64, out: &mut Vec<Frame>) {
        if !self.sends_pdos {
            return;
        }
        for transmission in self.transmit.iter_mut().filter(|t| t.pdo.is_synchronous()) {
            transmission.syncs += 1;
            if transmission.syncs >= transmission.pdo.transmission.max(1) {
                transmission.syncs = 0;
                transmission.last = now;
                out.push(transmission.pdo.pack(&self.dictionary));
            }
        }
    }

    /// Event-driven transmit PDOs whose content changed or whose timer is over.
    pub(crate) fn send_events(&mut self, now: u64, out: &mut Vec<Frame>) {
        if !self.is_operational() || !self.sends_pdos {
            return;
        }
        for transmission in self.transmit.iter_mut().filter(|t| !t.pdo.is_synchronous()) {
            let frame = transmission.pdo.pack(&self.dictionary);
            let changed = transmission.sent != Some(frame);
            let elapsed = now.saturating_sub(transmission.last);
            let timer = transmission.pdo.event_us;
            if (changed && (elapsed >= INHIBIT || transmission.sent.is_none()))
                || (timer > 0 && elapsed >= timer)
            {
                transmission.last = now;
                transmission.sent = Some(frame);
                out.push(frame);
            }
        }
    }

    /// Sends the heartbeat if it is due.
    pub(crate) fn beat(&mut self, now: u64, out: &mut Vec<Frame>) {
        let Some(at) = self.heartbeat_at.filter(|at| *at <= now) else { return };
        let period = self.heartbeat_period().max(1);
        self.heartbeat_at = Some(if now - at < period { at + period } else { now + period });
        if self.sends_heartbeat {
            out.push(Frame::new(self.id.heartbeat(), &[self.nmt.heartbeat()]));
        }
    }

    /// An error of the communication that has just come up.
    pub(crate) fn lost(&mut self, now: u64) -> Option<CommunicationError> {
        for consumer in &mut self.consumers {
            if consumer.last.is_some_and(|last| now >= last + consumer.timeout) {
                consumer.last = None;
                return Some(CommunicationError::Heartbeat);
            }
        }
        if !self.is_operational() {
            return None;
        }
        let slack = self.slack;
        for reception in self.receive.iter_mut().filter(|r| r.pdo.event_us > 0) {
            let deadline = reception.pdo.event_us + slack;
            if reception.last.is_some_and(|last| now >= last + deadline) {
                reception.last = None;
                return Some(CommunicationError::Deadline);
            }
        }
        if self.sync_deadline().is_some_and(|deadline| now >= deadline) {
            self.last_sync = None;
            return Some(CommunicationError::Sync);
        }
        None
    }

    /// Two and a half cycles after the last SYNC, and what is forgiven.
    fn sync_deadline(&self) -> Option<u64> {
        let period = self.cycle_period();
        self.last_sync.filter(|_| period > 0).map(|last| last + period * 5 / 2 + self.slack)
    }

    /// The next time at which a timer is over, µs.
    pub(crate) fn next(&self) -> Option<u64> {
        if let NmtState::Initialising { ready_at } = self.nmt {
            return Some(ready_at);
        }
        let consumers = self.consumers.iter().filter_map(|c| c.last.map(|last| last + c.timeout));
        let heartbeat = self.heartbeat_at.into_iter().chain(consumers);
        if !self.is_operational() {
            return heartbeat.min();
        }
        let deadlines = self.receive.iter().filter(|r| r.pdo.event_us > 0);
        let slack = self.slack;
        let deadlines = deadlines.filter_map(|r| Some(r.last? + r.pdo.event_us + slack));
        let events = self.transmit.iter().filter(|t| !t.pdo.is_synchronous());
        let events = events.filter_map(|t| {
            let changed = t.sent != Some(t.pdo.pack(&self.dictionary));
            let timer = (t.pdo.event_us > 0).then_some(t.last + t.pdo.event_us);
            let change = changed.then_some(t.last + INHIBIT);
            timer.into_iter().chain(change).min()
        });
        let events = events.filter(|_| self.sends_pdos);
        heartbeat.chain(deadlines).chain(events).chain(self.sync_deadline()).min()
    }

    /// Sends an emergency and sets the error register, if the state of the node allows it.
    pub(crate) fn emergency(&mut self, code: u16, out: &mut Vec<Frame>) {
        let class = match code >> 12 {
            0 => 0,
            2 => 0b0011,
            3 => 0b0101,
            4 => 0b1001,
            8 => 0b1_0001,
            _ => 0b0001,
        };
        let register = if code == 0 { 0 } else { self.dictionary.get(ERROR_REGISTER) | class };
        self.dictionary.set(ERROR_REGISTER, register);
        if code != 0 {
            self.remember(code);
        }
        if matches!(self.nmt, NmtState::PreOperational | NmtState::Operational) {
            let [low, high] = code.to_le_bytes();
            let register = u8::try_from(register & 0xFF).unwrap_or(0);
            out.push(Frame::new(self.id.emergency(), &[low, high, register, 0, 0, 0, 0, 0]));
        }
    }

    /// Error field 0x1003: the newest first.
    fn remember(&mut self, code: u16) {
        let count = (self.dictionary.get(object(0x1003, 0)) + 1).min(i64::from(CONSUMERS));
        for sub in (2..=CONSUMERS).rev() {
            let newer = self.dictionary.get(object(0x1003, sub - 1));
            self.dictionary.set(object(0x1003, sub), newer);
        }
        self.dictionary.set(object(0x1003, 1), i64::from(code));
        self.dictionary.set(object(0x1003, 0), count);
    }
}

fn store(dictionary: &mut Dictionary, values: &[(Object, i64)]) {
    for (object, value) in values {
        dictionary.set(*object, *value);
    }
}

fn consumer(dictionary: &Dictionary, sub: u8) -> Option<Consumer> {
    let entry = u32::try_from(dictionary.get(object(0x1016, sub))).ok()?;
    let [low, high, node, _] = entry.to_le_bytes();
    let milliseconds = u16::from_le_bytes([low, high]);
    let used = node > 0 && milliseconds > 0;
    used.then_some(Consumer { node, timeout: 1000 * u64::from(milliseconds), last: None })
}

fn communication_objects(dictionary: &mut Dictionary, id: NodeId, name: &str, device_type: u32) {
    use DataType::{U8, U16, U32};
    let (constant, read, rw) = (Access::Constant, Access::Read, Access::ReadWrite);
    let no = Mappable::No;
    let mut add = |index, sub, kind, value: u32, access| {
        dictionary.number(object(index, sub), kind, i64::from(value), access, no);
    };
    add(0x1000, 0, U32, device_type, constant);
    add(0x1003, 0, U8, 0, rw);
    for sub in 1..=CONSUMERS {
        add(0x1003, sub, U32, 0, read);
        add(0x1016, sub, U32, 0, rw);
    }
    add(0x1005, 0, U32, 0x80, rw);
    add(0x1006, 0, U32, 0, rw);
    add(0x1014, 0, U32, u32::from(id.emergency()), constant);
    add(0x1016, 0, U8, u32::from(CONSUMERS), constant);
    add(0x1017, 0, U16, 0, rw);
    add(0x1018, 0, U8, 4, constant);
    // Vendor zero is nobody's.
    add(0x1018, 1, U32, 0, constant);
    add(0x1018, 2, U32, 0x5342_0001, constant);
    add(0x1018, 3, U32, 0x0001_0000, constant);
    add(0x1018, 4, U32, u32::from(id.raw()), constant);
    add(0x1200, 0, U8, 2, constant);
    add(0x1200, 1, U32, u32::from(id.sdo_request()), constant);
    add(0x1200, 2, U32, u32::from(id.sdo_response()), constant);
    dictionary.limit(object(0x1003, 0), (0, 0));
    dictionary.number(ERROR_REGISTER, U8, 0, read, Mappable::Transmit);
    dictionary.text(object(0x1008, 0), name);
    pdo::add_objects(dictionary, id.raw());
}
