//! A bus by hand, for nodes in real time: nothing waits.

use shapebot_bus::{Bus, BusError, Frame, Received};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// A bus whose clock moves while somebody waits, and the frames that come and went.
#[derive(Default)]
pub(crate) struct Wire {
    pub(crate) now: u64,
    /// With the times at which they come, µs, in their order.
    pub(crate) coming: VecDeque<(u64, Frame)>,
    pub(crate) sent: Vec<Frame>,
    /// The process does not run from the first to the second time.
    pub(crate) stall: Option<(u64, u64)>,
}

/// The nodes' end of it.
pub(crate) struct Port(pub(crate) Rc<RefCell<Wire>>);

impl Bus for Port {
    fn now(&self) -> u64 {
        self.0.borrow().now
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.0.borrow_mut().sent.push(*frame);
        Ok(())
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        let mut wire = self.0.borrow_mut();
        let next = wire.coming.front().map_or(u64::MAX, |(time, _)| *time);
        wire.now = wire.now.max(deadline.min(next));
        if let Some((from, to)) = wire.stall
            && wire.now >= from
        {
            (wire.now, wire.stall) = (wire.now.max(to), None);
        }
        if next > wire.now {
            return Ok(None);
        }
        let (time, now) = (next, wire.now);
        let frame = wire.coming.pop_front().map(|(_, frame)| frame);
        assert!(time <= now);
        Ok(frame.map(|frame| Received { frame, time: now }))
    }
}
