//! One controller of a shared bus in virtual time, as a [`Bus`].

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{EndpointId, VirtualBus};
use crate::{Bus, BusError, Frame, Health, Received};

/// A controller on a [`VirtualBus`] that others hold too.
///
/// To receive lets virtual time pass, so a port suits one active party and passive others; a master with
/// simulated nodes that act by themselves wants their network instead.
#[derive(Clone, Debug)]
pub struct Port {
    bus: Arc<Mutex<VirtualBus>>,
    endpoint: EndpointId,
}

impl Port {
    /// The port of `endpoint`.
    #[must_use]
    pub const fn new(bus: Arc<Mutex<VirtualBus>>, endpoint: EndpointId) -> Self {
        Self { bus, endpoint }
    }

    fn bus(&self) -> MutexGuard<'_, VirtualBus> {
        // A panic elsewhere leaves queues and times valid: every change is a single assignment.
        self.bus.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Bus for Port {
    fn now(&self) -> u64 {
        self.bus().now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.bus().send(self.endpoint, *frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        let mut bus = self.bus();
        loop {
            if let Some(received) = bus.take(self.endpoint) {
                return Ok(Some(received));
            }
            let Some(next) = bus.next_event().filter(|next| *next <= deadline) else {
                bus.advance(deadline);
                return Ok(bus.take(self.endpoint));
            };
            bus.advance(next);
        }
    }

    fn health(&self) -> Health {
        self.bus().health(self.endpoint).unwrap_or_default()
    }
}
