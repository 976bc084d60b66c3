//! A bus in virtual time, bit by bit as ISO 11898-1 has it.
//!
//! Frames take the time of their actual bits, stuffing and CRC included. Controllers that want to send
//! when the bus falls idle arbitrate by identifier. Errors are signalled by error frames, counted and
//! followed by a new try; a controller whose transmit error counter passes 255 is bus-off. Two
//! controllers that send the same identifier at once with different data collide, as on a real bus.
//!
//! Nothing depends on the wall clock: the same calls and the same seed give the same frames at the same
//! nanoseconds. Queues are bounded, so a flood costs neither memory nor more than its share of time.

mod endpoint;
mod faults;
mod port;
mod wire;

use std::collections::BTreeMap;
use std::fmt;

pub use faults::{Effect, Rule, Select};
pub use port::Port;

use crate::{BusError, Frame, Health, Received};
use endpoint::Endpoint;
use faults::{Faults, Stage};
use wire::Transmission;

/// A controller on a [`VirtualBus`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct EndpointId(pub usize);

/// What a controller on the bus holds at most, and what it does after bus-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Frames that wait to be sent; further ones are refused.
    pub transmit: usize,
    /// Frames that wait to be taken; further ones are lost and counted as overruns.
    pub receive: usize,
    /// Whether the controller comes back by itself after 128 × 11 recessive bits.
    pub recover: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self { transmit: 64, receive: 256, recover: true }
    }
}

/// Something that happened on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// When it was over, µs.
    pub time: u64,
    /// What it was.
    pub kind: EventKind,
}

/// Kinds of [`Event`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A frame got through.
    Frame {
        /// The sender.
        from: EndpointId,
        /// The frame.
        frame: Frame,
    },
    /// An error frame.
    Error {
        /// The sender whose frame was destroyed.
        from: EndpointId,
        /// The frame.
        frame: Frame,
    },
    /// A controller went bus-off.
    BusOff(EndpointId),
    /// A controller came back from bus-off.
    Recovered(EndpointId),
}

/// Gets every [`Event`] of a bus.
pub type Observer = Box<dyn FnMut(&Event) + Send>;

/// Most frames under way to late receivers; further ones arrive without delay.
const LATE_LIMIT: usize = 1024;

/// A bus in virtual time with any number of controllers.
///
/// ```
/// use shapebot_bus::{Frame, VirtualBus};
///
/// let mut bus = VirtualBus::new(1_000_000, 0);
/// let [master, drive] = ["master", "drive"].map(|name| bus.attach(name));
/// bus.send(master, Frame::new(0x080, &[]))?;
/// bus.advance(1000);
/// let received = bus.take(drive).unwrap();
/// // 34 bits, two stuff bits and the end of the frame at 1 Mbit/s.
/// assert_eq!((received.frame.raw_id(), received.time), (0x080, 48));
/// # Ok::<(), shapebot_bus::BusError>(())
/// ```
pub struct VirtualBus {
    bit_ns: u64,
    /// Virtual time, ns.
    now: u64,
    /// Since when the bus is idle, or from when it will be, ns.
    idle_at: u64,
    /// Recessive bits up to here are counted for recovery, ns.
    counted_to: u64,
    busy: u64,
    endpoints: Vec<Endpoint>,
    current: Option<Transmission>,
    late: BTreeMap<(u64, u64), (EndpointId, Received)>,
    deliveries: u64,
    faults: Faults,
    observers: Vec<Observer>,
}

/// The same bus in the same state, without its observers.
impl Clone for VirtualBus {
    fn clone(&self) -> Self {
        Self {
            endpoints: self.endpoints.clone(),
            current: self.current.clone(),
            late: self.late.clone(),
            faults: self.faults.clone(),
            observers: Vec::new(),
            ..*self
        }
    }
}

impl fmt::Debug for VirtualBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("VirtualBus")
            .field("now", &self.now)
            .field("endpoints", &self.endpoints)
            .field("current", &self.current)
            .finish_non_exhaustive()
    }
}

impl VirtualBus {
    /// A bus of `bitrate` bit/s at time zero; `seed` decides what injected faults leave to chance.
    #[must_use]
    pub fn new(bitrate: u32, seed: u64) -> Self {
        Self {
            bit_ns: 1_000_000_000 / u64::from(bitrate.max(1)),
            now: 0,
            idle_at: 0,
            counted_to: 0,
            busy: 0,
            endpoints: Vec::new(),
            current: None,
            late: BTreeMap::new(),
            deliveries: 0,
            faults: Faults::new(seed),
            observers: Vec::new(),
        }
    }

    /// Attaches a controller with the usual [`Limits`].
    pub fn attach(&mut self, name: &str) -> EndpointId {
        self.attach_with(name, Limits::default())
    }

    /// Attaches a controller.
    pub fn attach_with(&mut self, name: &str, limits: Limits) -> EndpointId {
        self.endpoints.push(Endpoint::new(name, limits));
        EndpointId(self.endpoints.len() - 1)
    }

    /// Virtual time, µs.
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.now / 1000
    }

    /// Time in which the bus carried something, µs: with [`VirtualBus::now`] the bus load.
    #[must_use]
    pub const fn busy(&self) -> u64 {
        self.busy / 1000
    }

    /// Name of a controller.
    #[must_use]
    pub fn name(&self, id: EndpointId) -> Option<&str> {
        self.endpoints.get(id.0).map(|endpoint| endpoint.name.as_str())
    }

    /// State and error counters of a controller.
    #[must_use]
    pub fn health(&self, id: EndpointId) -> Option<Health> {
        self.endpoints.get(id.0).map(Endpoint::health)
    }

    /// Frames of a controller that wait to be sent.
    #[must_use]
    pub fn waiting(&self, id: EndpointId) -> usize {
        self.endpoints.get(id.0).map_or(0, Endpoint::waiting)
    }

    /// Lets `observer` see all that happens on the wire from now on.
    pub fn observe(&mut self, observer: impl FnMut(&Event) + Send + 'static) {
        self.observers.push(Box::new(observer));
    }

    /// Adds a fault to be made.
    pub fn inject(&mut self, select: Select, effect: Effect) {
        self.faults.add(Rule { select, effect });
    }

    /// Removes all faults to be made.
    pub fn clear_faults(&mut self) {
        self.faults.clear();
    }

    /// Faults made so far by the rules that are in force.
    #[must_use]
    pub fn faults_made(&self) -> u64 {
        self.faults.made()
    }

    /// Hands a frame to a controller at the present virtual time.
    ///
    /// # Errors
    ///
    /// [`BusError::QueueFull`], [`BusError::BusOff`], [`BusError::UnknownEndpoint`].
    pub fn send(&mut self, from: EndpointId, frame: Frame) -> Result<(), BusError> {
        let now = self.now();
        let mut release = self.now;
        for effect in self.faults.effects(Stage::Queue, &frame, from, now) {
            if let Effect::Jitter(most) = effect {
                release += self.faults.random.below(most.saturating_mul(1000).saturating_add(1));
            }
        }
        self.endpoint(from)?.queue(frame, release)
    }

    /// The oldest frame that a controller has received.
    pub fn take(&mut self, id: EndpointId) -> Option<Received> {
        self.endpoints.get_mut(id.0)?.take()
    }

    /// Whether a controller has frames to be taken.
    #[must_use]
    pub fn has_received(&self, id: EndpointId) -> bool {
        self.endpoints.get(id.0).is_some_and(Endpoint::has_received)
    }

    /// Takes a controller off the bus as if its error counter had passed 255.
    ///
    /// # Errors
    ///
    /// [`BusError::UnknownEndpoint`].
    pub fn force_bus_off(&mut self, id: EndpointId) -> Result<(), BusError> {
        self.endpoint(id)?.switch_off();
        self.report(EventKind::BusOff(id));
        Ok(())
    }

    /// Brings a controller back from bus-off at once.
    ///
    /// # Errors
    ///
    /// [`BusError::UnknownEndpoint`].
    pub fn restart(&mut self, id: EndpointId) -> Result<(), BusError> {
        self.endpoint(id)?.restart();
        self.report(EventKind::Recovered(id));
        Ok(())
    }

    /// The next time at which something can change, µs, rounded up: the end of a frame, a frame that
    /// gets the bus, a late delivery, a recovery. `None` if nothing is under way.
    #[must_use]
    pub fn next_event(&self) -> Option<u64> {
        let late = self.late.keys().next().map(|(time, _)| *time);
        let (wire, recovery) = match &self.current {
            // Nobody counts recessive bits before that.
            Some(transmission) => (Some(transmission.end), None),
            // The end of its first bit: all that is sent up to its start takes part in arbitration.
            None => (self.next_start().map(|start| start + self.bit_ns), self.next_recovery()),
        };
        let times = [late, wire, recovery];
        times.into_iter().flatten().min().map(|time| time.div_ceil(1000))
    }

    /// Lets virtual time pass up to `until`, µs. Frames sent at `until` itself do not start yet, so that
    /// all who send at that time take part in the arbitration.
    pub fn advance(&mut self, until: u64) {
        let until = until.saturating_mul(1000);
        while self.step(until) {}
        self.now = self.now.max(until);
        if self.current.is_none() {
            self.count_recessive(self.now);
        }
    }

    /// One thing that happens up to `until`, ns; false if there is none left.
    fn step(&mut self, until: u64) -> bool {
        let late = self.late.first_key_value().map(|((time, _), _)| *time);
        let wire = match &self.current {
            Some(transmission) => Some(transmission.end),
            None => self.next_start().filter(|start| *start < until),
        };
        if let Some(time) = late.filter(|time| *time <= until && wire.is_none_or(|w| *time <= w)) {
            self.now = self.now.max(time);
            self.deliver_late();
            return true;
        }
        let Some(time) = wire.filter(|time| *time <= until) else { return false };
        self.now = self.now.max(time);
        match self.current.take() {
            Some(transmission) => self.finish(transmission),
            None => self.begin(time),
        }
        true
    }

    fn deliver_late(&mut self) {
        if let Some(((time, _), (to, received))) = self.late.pop_first()
            && let Some(endpoint) = self.endpoints.get_mut(to.0)
        {
            endpoint.deliver(Received { time: time / 1000, ..received });
        }
    }

    fn endpoint(&mut self, id: EndpointId) -> Result<&mut Endpoint, BusError> {
        self.endpoints.get_mut(id.0).ok_or(BusError::UnknownEndpoint(id.0))
    }

    fn report(&mut self, kind: EventKind) {
        let event = Event { time: self.now(), kind };
        for observer in &mut self.observers {
            observer(&event);
        }
    }
}
