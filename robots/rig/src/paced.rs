//! Virtual time that passes like real time.

use shapebot_bus::{BusError, Buses, Frame, Health, Received};
use std::time::{Duration, Instant};

/// Buses in virtual time that lets itself be waited for: it passes as fast as real time, or slower where
/// the computer does not keep up. Nobody on the buses is ever late because of that.
#[derive(Debug)]
pub struct Paced<B> {
    buses: B,
    start: Instant,
    /// Virtual time at the start, µs.
    begun: u64,
}

impl<B: Buses> Paced<B> {
    /// Time begins to pass now.
    pub fn new(buses: B) -> Self {
        let begun = buses.now();
        Self { buses, start: Instant::now(), begun }
    }

    /// Virtual time that the clock allows, µs.
    fn allowed(&self) -> u64 {
        let passed = u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX);
        self.begun.saturating_add(passed)
    }
}

impl<B: Buses> Buses for Paced<B> {
    fn count(&self) -> usize {
        self.buses.count()
    }

    fn now(&self) -> u64 {
        self.buses.now()
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        self.buses.send(bus, frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        loop {
            let until = self.allowed().min(deadline);
            if let Some(received) = self.buses.receive(until)? {
                return Ok(Some(received));
            }
            if self.now() >= deadline {
                return Ok(None);
            }
            let rest = deadline.saturating_sub(self.allowed());
            std::thread::sleep(Duration::from_micros(rest));
        }
    }

    fn health(&self, bus: usize) -> Health {
        self.buses.health(bus)
    }
}

#[cfg(test)]
mod tests {
    use super::Paced;
    use shapebot_bus::{BusError, Buses, Frame, Health, Received};
    use std::time::{Duration, Instant};

    /// A bus that is silent.
    struct Silent(u64);

    impl Buses for Silent {
        fn count(&self) -> usize {
            1
        }

        fn now(&self) -> u64 {
            self.0
        }

        fn send(&mut self, _: usize, _: &Frame) -> Result<(), BusError> {
            Ok(())
        }

        fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
            self.0 = self.0.max(deadline);
            Ok(None)
        }

        fn health(&self, _: usize) -> Health {
            Health::default()
        }
    }

    #[test]
    fn virtual_time_is_never_ahead() {
        let start = Instant::now();
        let mut paced = Paced::new(Silent(700));
        for deadline in [1_000, 500, 20_700] {
            assert!(paced.receive(deadline).expect("a silent bus").is_none());
            let passed = Duration::from_micros(paced.now() - 700);
            assert!(start.elapsed() >= passed, "{passed:?}");
        }
        assert_eq!(paced.now(), 20_700);
    }
}
