//! A bus whose time runs slower.

use crate::{Bus, BusError, Frame, Health, Received};

/// A bus on which a second takes several: for programs on computers that other work holds up. All parties
/// on the bus have to be slowed alike.
#[derive(Debug)]
pub struct Slowed<B> {
    bus: B,
    factor: u64,
}

impl<B: Bus> Slowed<B> {
    /// Time runs `factor` times slower; a factor of zero is one.
    #[must_use]
    pub fn new(bus: B, factor: u32) -> Self {
        Self { bus, factor: u64::from(factor.max(1)) }
    }
}

impl<B: Bus> Bus for Slowed<B> {
    fn now(&self) -> u64 {
        self.bus.now() / self.factor
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.bus.send(frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        let received = self.bus.receive(deadline.saturating_mul(self.factor))?;
        Ok(received.map(|received| Received { time: received.time / self.factor, ..received }))
    }

    fn health(&self) -> Health {
        self.bus.health()
    }

    #[cfg(unix)]
    fn descriptor(&self) -> Option<std::os::fd::BorrowedFd<'_>> {
        self.bus.descriptor()
    }
}

#[cfg(test)]
mod tests {
    use super::Slowed;
    use crate::{Bus, BusError, Frame, Received};

    /// Time passes in `receive` alone; a frame comes at 50 µs.
    struct Clock(u64);

    impl Bus for Clock {
        fn now(&self) -> u64 {
            self.0
        }

        fn send(&mut self, _: &Frame) -> Result<(), BusError> {
            Ok(())
        }

        fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
            if self.0 < 50 && deadline >= 50 {
                self.0 = 50;
                return Ok(Some(Received { frame: Frame::new(0x123, &[]), time: 50 }));
            }
            self.0 = self.0.max(deadline);
            Ok(None)
        }
    }

    #[test]
    fn deadlines_and_times_are_those_of_the_slowed_clock() {
        let mut bus = Slowed::new(Clock(0), 5);
        assert_eq!(bus.receive(9).unwrap(), None);
        assert_eq!(bus.now(), 9);
        assert_eq!(bus.receive(20).unwrap().map(|received| received.time), Some(10));
        assert_eq!(bus.receive(20).unwrap(), None);
        assert_eq!(bus.now(), 20);
    }
}
