//! The buses of a drive, together.

use shapebot_bus::{Bus, BusError, Frame, Health, Received};
use shapebot_nodes::{Network, Plant};

/// All buses of a drive, as one party sees them.
pub trait Buses {
    /// Time, µs; it never goes back.
    fn now(&self) -> u64;

    /// Hands a frame to the controller of a bus.
    ///
    /// # Errors
    ///
    /// Those of [`Bus::send`].
    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError>;

    /// The next frame with the number of its bus, or `None` once time has reached `deadline`, µs.
    ///
    /// # Errors
    ///
    /// Those of [`Bus::receive`].
    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError>;

    /// State of the controller of a bus, as far as it tells; one that recovers by itself is bus-off for
    /// some milliseconds only.
    fn health(&self, _bus: usize) -> Health {
        Health::default()
    }
}

impl<P: Plant> Buses for Network<P> {
    fn now(&self) -> u64 {
        Bus::now(self)
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        Self::send(self, bus, frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        Ok(Self::receive(self, deadline))
    }

    fn health(&self, bus: usize) -> Health {
        self.master_health(bus)
    }
}

/// Longest wait for one of several buses before the others are looked at, µs.
const TURN: u64 = 100;

/// Buses in real time, each with a clock of its own.
pub struct Wired {
    buses: Vec<Box<dyn Bus>>,
    /// Time of each bus when the first one's was zero here.
    starts: Vec<u64>,
}

impl std::fmt::Debug for Wired {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wired").field("buses", &self.buses.len()).finish_non_exhaustive()
    }
}

impl Wired {
    /// Buses in the order of the drive description; time begins now.
    #[must_use]
    pub fn new(buses: Vec<Box<dyn Bus>>) -> Self {
        let starts = buses.iter().map(|bus| bus.now()).collect();
        Self { buses, starts }
    }

    fn look(&mut self, index: usize, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        let (Some(bus), Some(start)) = (self.buses.get_mut(index), self.starts.get(index)) else {
            return Ok(None);
        };
        let received = bus.receive(start.saturating_add(deadline))?;
        Ok(received.map(|received| {
            (index, Received { time: received.time.saturating_sub(*start), ..received })
        }))
    }
}

impl Buses for Wired {
    fn health(&self, bus: usize) -> Health {
        self.buses.get(bus).map(|bus| bus.health()).unwrap_or_default()
    }

    fn now(&self) -> u64 {
        match (self.buses.first(), self.starts.first()) {
            (Some(bus), Some(start)) => bus.now().saturating_sub(*start),
            _ => 0,
        }
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        self.buses.get_mut(bus).ok_or(BusError::UnknownEndpoint(bus))?.send(frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        loop {
            // What is there already, from each bus.
            for index in 0..self.buses.len() {
                if let Some(found) = self.look(index, 0)? {
                    return Ok(Some(found));
                }
            }
            let now = self.now();
            if now >= deadline || self.buses.is_empty() {
                return Ok(None);
            }
            let until = if self.buses.len() == 1 { deadline } else { deadline.min(now + TURN) };
            if let Some(found) = self.look(0, until)? {
                return Ok(Some(found));
            }
        }
    }
}
