//! Nodes and plant on a bus in real time.

use shapebot_bus::{Bus, BusError, Frame};

use crate::{Node, NodeFault, Physical, Plant};

/// Simulated nodes over a plant on one controller of any bus: SocketCAN, or an slcan adapter that
/// somebody else talks to. They hear each other as well.
#[derive(Debug)]
pub struct Attached<B, P> {
    bus: B,
    nodes: Vec<Node>,
    plant: P,
    plant_time: u64,
    lost: u64,
    /// Time of the bus at which the nodes were switched on.
    start: u64,
}

impl<B: Bus, P: Plant> Attached<B, P> {
    /// Switches nodes on, now.
    #[must_use]
    pub fn new(bus: B, nodes: Vec<Node>, plant: P) -> Self {
        let start = bus.now();
        Self { bus, nodes, plant, plant_time: 0, lost: 0, start }
    }

    /// The plant.
    pub const fn plant(&self) -> &P {
        &self.plant
    }

    /// A node.
    #[must_use]
    pub fn node(&self, index: usize) -> Option<&Node> {
        self.nodes.get(index)
    }

    /// The bus.
    pub const fn bus(&self) -> &B {
        &self.bus
    }

    /// Frames that the bus had no room for.
    #[must_use]
    pub const fn lost(&self) -> u64 {
        self.lost
    }

    /// Time since the nodes were switched on, µs.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.bus.now().saturating_sub(self.start)
    }

    /// Makes a fault of a node, now.
    ///
    /// # Errors
    ///
    /// Those of the bus.
    pub fn inject(&mut self, index: usize, fault: NodeFault) -> Result<(), BusError> {
        let out = self.with_node(index, |node, physical, out| node.inject(fault, physical, out));
        self.spread(index, out)
    }

    /// Waits for frames and timers and serves them, until `deadline`, µs of [`Attached::now`].
    ///
    /// # Errors
    ///
    /// Those of the bus.
    pub fn run(&mut self, deadline: u64) -> Result<(), BusError> {
        loop {
            let next = self.nodes.iter().filter_map(Node::next).min();
            let until = next.map_or(deadline, |next| next.min(deadline));
            if let Some(received) = self.bus.receive(self.start + until)? {
                self.hear(None, &received.frame)?;
            }
            let now = self.now();
            for index in 0..self.nodes.len() {
                if self.nodes.get(index).and_then(Node::next).is_some_and(|next| next <= now) {
                    let out = self.with_node(index, Node::poll);
                    self.spread(index, out)?;
                }
            }
            if now >= deadline {
                return Ok(());
            }
        }
    }

    /// A frame from the bus, or from a node, to all (other) nodes.
    fn hear(&mut self, from: Option<usize>, frame: &Frame) -> Result<(), BusError> {
        let mut answers = Vec::new();
        for index in (0..self.nodes.len()).filter(|index| Some(*index) != from) {
            let out =
                self.with_node(index, |node, physical, out| node.receive(frame, physical, out));
            answers.push((index, out));
        }
        for (index, out) in answers {
            self.spread(index, out)?;
        }
        Ok(())
    }

    fn spread(&mut self, from: usize, out: Vec<Frame>) -> Result<(), BusError> {
        for frame in out {
            match self.bus.send(&frame) {
                Ok(()) => {}
                Err(BusError::QueueFull { .. } | BusError::BusOff) => self.lost += 1,
                Err(error) => return Err(error),
            }
            self.hear(Some(from), &frame)?;
        }
        Ok(())
    }

    fn with_node(
        &mut self,
        index: usize,
        what: impl FnOnce(&mut Node, &mut Physical<'_>, &mut Vec<Frame>),
    ) -> Vec<Frame> {
        let now = self.now();
        let mut out = Vec::new();
        if let Some(node) = self.nodes.get_mut(index) {
            what(node, &mut Physical::new(&mut self.plant, &mut self.plant_time, now), &mut out);
        }
        out
    }
}
