//! The buses of a drive, together.

use crate::{Bus, BusError, ErrorState, Frame, Health, Received};
use shapebot_drive::Fault;

/// All buses of a drive, as one party sees them.
pub trait Buses {
    /// Number of buses.
    fn count(&self) -> usize;

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
    fn health(&self, bus: usize) -> Health;

    /// Hands over all frames, each with its bus, whatever becomes of those before it. Gives the fault of
    /// the drive that this shows: [`Fault::Bus`] if a bus takes no frames now, else what [`Self::fault`]
    /// says.
    ///
    /// # Errors
    ///
    /// The first error after which a bus cannot be used any more.
    fn send_all(
        &mut self,
        frames: impl IntoIterator<Item = (usize, Frame)>,
    ) -> Result<Option<Fault>, BusError>
    where
        Self: Sized,
    {
        let (mut refused, mut failed) = (false, Ok(()));
        for (bus, frame) in frames {
            match self.send(bus, &frame) {
                Ok(()) => {}
                Err(BusError::QueueFull { .. } | BusError::BusOff) => refused = true,
                Err(error) => failed = failed.and(Err(error)),
            }
        }
        failed.map(|()| if refused { Some(Fault::Bus) } else { self.fault() })
    }

    /// What the controllers' states mean to the drive: [`Fault::Bus`] if one is bus-off,
    /// [`Fault::BusErrors`] if one is error-passive.
    fn fault(&self) -> Option<Fault> {
        let worst = (0..self.count()).map(|bus| self.health(bus).state).max();
        match worst {
            Some(ErrorState::BusOff) => Some(Fault::Bus),
            Some(ErrorState::Passive) => Some(Fault::BusErrors),
            Some(ErrorState::Active) | None => None,
        }
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
    fn count(&self) -> usize {
        self.buses.len()
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

    fn health(&self, bus: usize) -> Health {
        self.buses.get(bus).map(|bus| bus.health()).unwrap_or_default()
    }
}
