//! The buses of a drive, together.

use crate::{Bus, BusError, ErrorState, Frame, Health, Received};
use shapebot_drive::Fault;
#[cfg(unix)]
use std::time::Duration;

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

/// Longest wait for one of several buses that cannot be waited for together, before the others are looked
/// at, µs.
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

    /// Waits for a frame of any of two buses, `micros` at most; false if they cannot be waited for
    /// together.
    fn wait_for_either(&self, micros: u64) -> Result<bool, BusError> {
        #[cfg(unix)]
        if let [one, two] = self.buses.as_slice()
            && let (Some(one), Some(two)) = (one.descriptor(), two.descriptor())
        {
            let waited = crate::wait::either_readable([one, two], Duration::from_micros(micros));
            return waited.map(|()| true).map_err(|error| BusError::io("buses", error));
        }
        let _ = micros;
        Ok(false)
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
            if self.wait_for_either(deadline - now)? {
                continue;
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

#[cfg(all(test, unix))]
mod tests {
    use super::{Buses, Wired};
    use crate::{Bus, BusError, Frame, Received};
    use std::cell::Cell;
    use std::io::{Read, Write};
    use std::os::fd::{AsFd, BorrowedFd};
    use std::os::unix::net::UnixStream;
    use std::rc::Rc;
    use std::time::{Duration, Instant};

    /// A frame for each byte of a stream; counts how often it is asked.
    struct Bytes {
        stream: UnixStream,
        start: Instant,
        asked: Rc<Cell<u32>>,
    }

    impl Bus for Bytes {
        fn now(&self) -> u64 {
            self.start.elapsed().as_micros() as u64
        }

        fn send(&mut self, _: &Frame) -> Result<(), BusError> {
            Ok(())
        }

        fn receive(&mut self, _: u64) -> Result<Option<Received>, BusError> {
            self.asked.set(self.asked.get() + 1);
            let mut byte = [0];
            let found = self.stream.read(&mut byte).is_ok_and(|count| count == 1);
            let received = Received { frame: Frame::new(byte[0].into(), &[]), time: self.now() };
            Ok(found.then_some(received))
        }

        fn descriptor(&self) -> Option<BorrowedFd<'_>> {
            Some(self.stream.as_fd())
        }
    }

    #[test]
    fn two_buses_are_waited_for_together() {
        let (asked, start) = (Rc::new(Cell::new(0)), Instant::now());
        let (mut far, mut buses): (Vec<UnixStream>, Vec<Box<dyn Bus>>) = (Vec::new(), Vec::new());
        for _ in 0..2 {
            let (here, there) = UnixStream::pair().unwrap();
            here.set_nonblocking(true).unwrap();
            buses.push(Box::new(Bytes { stream: here, start, asked: asked.clone() }));
            far.push(there);
        }
        let mut wired = Wired::new(buses);
        let deadline = wired.now() + 20_000;
        assert!(wired.receive(deadline).unwrap().is_none());
        assert!(wired.now() >= deadline);
        let mut second = far.remove(1);
        let sender = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(20));
            second.write_all(&[0x12]).unwrap();
            second
        });
        let deadline = wired.now() + 10_000_000;
        let (bus, received) = wired.receive(deadline).unwrap().expect("a frame");
        assert_eq!((bus, received.frame.standard_id()), (1, Some(0x12)));
        assert!(wired.now() < deadline);
        // A few times each, and not all the while.
        assert!(asked.get() <= 16, "asked {} times", asked.get());
        drop(sender.join());
    }
}
