//! Nodes, plant and buses in virtual time.

use std::collections::VecDeque;

use shapebot_bus::{Bus, BusError, Buses, EndpointId, Frame, Health, Received, VirtualBus};

use crate::{Node, NodeFault, Physical, Plant};

/// Frames of a node that its controller has no room for are tried again; so many are kept.
const BACKLOG: usize = 64;

#[derive(Clone, Debug)]
struct Attachment {
    node: Node,
    bus: usize,
    endpoint: EndpointId,
    backlog: VecDeque<Frame>,
    /// [`Node::next`], which changes with the node only.
    next: Option<u64>,
}

/// Simulated nodes over a plant on one or several buses in virtual time, and a place for the master on
/// each bus. To receive as the master lets virtual time pass; nodes and plant act meanwhile.
#[derive(Clone, Debug)]
pub struct Network<P> {
    buses: Vec<(VirtualBus, EndpointId)>,
    nodes: Vec<Attachment>,
    plant: P,
    /// Time of the plant's state, µs.
    plant_time: u64,
    now: u64,
}

impl<P: Plant> Network<P> {
    /// Nodes, each with the number of its bus, on `buses`. Nodes with a bus that does not exist are on
    /// the first; there is at least one bus, of 1 Mbit/s.
    #[must_use]
    pub fn new(buses: Vec<VirtualBus>, nodes: Vec<(usize, Node)>, plant: P) -> Self {
        let mut buses: Vec<_> =
            buses.into_iter().map(|mut bus| (bus.attach("master"), bus)).map(swap).collect();
        if buses.is_empty() {
            let mut bus = VirtualBus::new(1_000_000, 0);
            let master = bus.attach("master");
            buses.push((bus, master));
        }
        let mut attached = Vec::new();
        for (index, node) in nodes {
            let index = if index < buses.len() { index } else { 0 };
            if let Some((bus, _)) = buses.get_mut(index) {
                let endpoint = bus.attach(&format!("node {}", node.id().raw()));
                let backlog = VecDeque::new();
                let next = node.next();
                attached.push(Attachment { node, bus: index, endpoint, backlog, next });
            }
        }
        Self { buses, nodes: attached, plant, plant_time: 0, now: 0 }
    }

    /// The plant as it was when a node last looked at it or acted on it.
    pub const fn plant(&self) -> &P {
        &self.plant
    }

    /// The plant as it is, to change what nodes do not.
    pub const fn plant_mut(&mut self) -> &mut P {
        &mut self.plant
    }

    /// The plant brought to the present time.
    pub fn plant_now(&mut self) -> &mut P {
        Physical::new(&mut self.plant, &mut self.plant_time, self.now).here();
        &mut self.plant
    }

    /// A bus, for faults, observers and counters.
    pub fn bus(&mut self, bus: usize) -> Option<&mut VirtualBus> {
        self.buses.get_mut(bus).map(|(bus, _)| bus)
    }

    /// The master's controller on a bus.
    #[must_use]
    pub fn master(&self, bus: usize) -> Option<EndpointId> {
        self.buses.get(bus).map(|(_, master)| *master)
    }

    /// A node by its place in the list that [`Network::new`] got.
    #[must_use]
    pub fn node(&self, index: usize) -> Option<&Node> {
        self.nodes.get(index).map(|attachment| &attachment.node)
    }

    /// Bus and controller of a node.
    #[must_use]
    pub fn endpoint(&self, index: usize) -> Option<(usize, EndpointId)> {
        self.nodes.get(index).map(|attachment| (attachment.bus, attachment.endpoint))
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Makes a fault of a node, now.
    pub fn inject(&mut self, index: usize, fault: NodeFault) {
        self.with_node(index, |node, physical, out| node.inject(fault, physical, out));
    }

    /// Ends a node's faults that are switches.
    pub fn heal(&mut self, index: usize) {
        if let Some(attachment) = self.nodes.get_mut(index) {
            attachment.node.heal();
            attachment.next = attachment.node.next();
        }
    }

    /// Sends a frame as the master on a bus.
    ///
    /// # Errors
    ///
    /// Those of [`VirtualBus::send`]; [`BusError::UnknownEndpoint`] for a bus that does not exist.
    pub fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        let (bus, master) = self.buses.get_mut(bus).ok_or(BusError::UnknownEndpoint(bus))?;
        bus.send(*master, *frame)
    }

    /// Lets virtual time pass until the master gets a frame, with the number of its bus, or until
    /// `deadline`, µs.
    pub fn receive(&mut self, deadline: u64) -> Option<(usize, Received)> {
        loop {
            for (index, (bus, master)) in self.buses.iter_mut().enumerate() {
                if let Some(received) = bus.take(*master) {
                    return Some((index, received));
                }
            }
            if self.now >= deadline {
                return None;
            }
            let next = self.next_event().unwrap_or(deadline).clamp(self.now, deadline);
            self.step_to(next);
        }
    }

    fn next_event(&self) -> Option<u64> {
        let buses = self.buses.iter().filter_map(|(bus, _)| bus.next_event());
        let nodes = self.nodes.iter().filter_map(|attachment| attachment.next);
        let backlog = self.nodes.iter().any(|attachment| !attachment.backlog.is_empty());
        buses.chain(nodes).chain(backlog.then_some(self.now + 100)).min()
    }

    /// One event of buses and nodes at `time`.
    fn step_to(&mut self, time: u64) {
        self.now = time;
        for (bus, _) in &mut self.buses {
            bus.advance(time);
        }
        for index in 0..self.nodes.len() {
            while let Some(frame) = self.take(index) {
                self.with_node(index, |node, physical, out| node.receive(&frame, physical, out));
            }
            let due = self.nodes.get(index).and_then(|attachment| attachment.next);
            if due.is_some_and(|due| due <= time) {
                self.with_node(index, Node::poll);
            }
            self.send_backlog(index);
        }
    }

    fn take(&mut self, index: usize) -> Option<Frame> {
        let attachment = self.nodes.get(index)?;
        let (bus, _) = self.buses.get_mut(attachment.bus)?;
        bus.take(attachment.endpoint).map(|received| received.frame)
    }

    fn with_node(
        &mut self,
        index: usize,
        what: impl FnOnce(&mut Node, &mut Physical<'_>, &mut Vec<Frame>),
    ) {
        let Some(attachment) = self.nodes.get_mut(index) else { return };
        let mut physical = Physical::new(&mut self.plant, &mut self.plant_time, self.now);
        let mut out = Vec::new();
        what(&mut attachment.node, &mut physical, &mut out);
        attachment.next = attachment.node.next();
        attachment.backlog.extend(out);
        let excess = attachment.backlog.len().saturating_sub(BACKLOG);
        attachment.backlog.drain(..excess);
        self.send_backlog(index);
    }

    fn send_backlog(&mut self, index: usize) {
        let Some(attachment) = self.nodes.get_mut(index) else { return };
        let Some((bus, _)) = self.buses.get_mut(attachment.bus) else { return };
        while let Some(frame) = attachment.backlog.pop_front() {
            match bus.send(attachment.endpoint, frame) {
                Ok(()) => {}
                Err(BusError::QueueFull { .. }) => {
                    attachment.backlog.push_front(frame);
                    return;
                }
                // A controller that is bus-off loses what it is given.
                Err(_) => attachment.backlog.clear(),
            }
        }
    }
}

fn swap<A, B>((a, b): (A, B)) -> (B, A) {
    (b, a)
}

/// The first bus, as the master sees it.
impl<P: Plant> Bus for Network<P> {
    fn now(&self) -> u64 {
        self.now
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        Self::send(self, 0, frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        while let Some((bus, received)) = Self::receive(self, deadline) {
            if bus == 0 {
                return Ok(Some(received));
            }
        }
        Ok(None)
    }

    fn health(&self) -> Health {
        self.master_health(0)
    }
}

impl<P: Plant> Network<P> {
    /// State of the master's controller on a bus.
    #[must_use]
    pub fn master_health(&self, bus: usize) -> Health {
        let bus = self.buses.get(bus);
        bus.and_then(|(bus, master)| bus.health(*master)).unwrap_or_default()
    }
}

impl<P: Plant> Buses for Network<P> {
    fn count(&self) -> usize {
        self.buses.len()
    }

    fn now(&self) -> u64 {
        self.now
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
