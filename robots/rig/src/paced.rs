//! Virtual time that passes like real time.

use shapebot_bus::{BusError, Buses, Frame, Health, Received};
use std::time::{Duration, Instant};

/// Buses in virtual time that lets itself be waited for: it passes as fast as real time, or slower where
/// the computer does not keep up. Nobody on the buses is ever late because of that.
pub struct Paced<B, F> {
    buses: B,
    /// Looks after what is beside the buses, whenever time has passed.
    attend: F,
    start: Instant,
    /// Virtual time at the start, µs.
    begun: u64,
}

impl<B: Buses, F: FnMut(&mut B)> Paced<B, F> {
    /// Time begins to pass now; `attend` is called whenever it has.
    pub fn new(buses: B, attend: F) -> Self {
        let begun = buses.now();
        Self { buses, attend, start: Instant::now(), begun }
    }

    /// Virtual time that the clock allows, µs.
    fn allowed(&self) -> u64 {
        let passed = u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX);
        self.begun.saturating_add(passed)
    }
}

impl<B: Buses, F: FnMut(&mut B)> Buses for Paced<B, F> {
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
            let received = self.buses.receive(until)?;
            (self.attend)(&mut self.buses);
            if let Some(received) = received {
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
        let (start, mut calls) = (Instant::now(), 0);
        let mut paced = Paced::new(Silent(700), |_| calls += 1);
        for deadline in [1_000, 500, 20_700] {
            assert!(paced.receive(deadline).expect("a silent bus").is_none());
            let passed = Duration::from_micros(paced.now() - 700);
            assert!(start.elapsed() >= passed, "{passed:?}");
        }
        assert_eq!(paced.now(), 20_700);
        assert!(calls >= 3, "{calls}");
    }
}
