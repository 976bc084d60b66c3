//! Simulated nodes on buses in real time.

use crate::{Body, Error, world};
use shapebot_bus::{BusError, Buses as _, Frame, Wired};
use shapebot_drive::Role;
use shapebot_drive_build::DriveDescription;
use shapebot_dynamics::Robot;
use shapebot_nodes::{DriveUnit, Mechanism as _, Node, NodeFault, Physical, described};
use shapebot_sim::Plant;

/// Frames that are heard in a row before the nodes' timers are looked at.
const MOST_FRAMES: usize = 64;

/// Simulated nodes of a drive over a body, on buses in real time: the other side of a master in another
/// process. Nodes on one bus hear each other as well.
pub struct DriveSim<'a, R, const N: usize, const NX: usize, const NS: usize> {
    buses: Wired,
    /// Each with its bus.
    nodes: Vec<(usize, Node)>,
    unit: DriveUnit<Body<'a, R, N, NX, NS>>,
    plant_time: u64,
    lost: u64,
    /// Without legs it is held by hand until a drive is enabled.
    legs: bool,
}

impl<R, const N: usize, const NX: usize, const NS: usize> std::fmt::Debug
    for DriveSim<'_, R, N, NX, NS>
{
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("DriveSim").field("buses", &self.buses).finish_non_exhaustive()
    }
}

impl<'a, R, const N: usize, const NX: usize, const NS: usize> DriveSim<'a, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    /// Switches the nodes on, now.
    ///
    /// # Errors
    ///
    /// A description for a robot with another number of coordinates.
    pub fn new(
        description: &DriveDescription,
        robot: &'a R,
        plant: &'a Plant<'a, N, NX, NS>,
        buses: Wired,
    ) -> Result<Self, Error> {
        let unit = world::drive_unit(description, robot, plant)?;
        let nodes = described(&description.simulated);
        let nodes = nodes.iter().map(|(bus, settings)| (*bus, Node::new(settings))).collect();
        let legs = description.nodes.iter().any(|node| node.role == Role::Legs);
        Ok(Self { buses, nodes, unit, plant_time: 0, lost: 0, legs })
    }

    /// The same with nodes that forgive SYNC and receive PDOs that are late by so many µs more.
    #[must_use]
    pub fn forgiving(mut self, micros: u64) -> Self {
        self.nodes.iter_mut().for_each(|(_, node)| node.forgive(micros));
        self
    }

    /// The body.
    #[must_use]
    pub const fn body(&self) -> &Body<'a, R, N, NX, NS> {
        self.unit.mechanism()
    }

    /// A node, by its place in the description.
    #[must_use]
    pub fn node(&self, index: usize) -> Option<&Node> {
        self.nodes.get(index).map(|(_, node)| node)
    }

    /// Frames that a bus had no room for.
    #[must_use]
    pub const fn lost(&self) -> u64 {
        self.lost
    }

    /// Time since the buses were opened, µs.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.buses.now()
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

    /// Waits for frames and timers and serves them, until `deadline`, µs of [`Self::now`].
    ///
    /// # Errors
    ///
    /// Those of the buses.
    pub fn run(&mut self, deadline: u64) -> Result<(), BusError> {
        loop {
            let next = self.nodes.iter().filter_map(|(_, node)| node.next()).min();
            let until = next.map_or(deadline, |next| next.min(deadline));
            // All that has come goes before the timers: a late turn of this process is no late SYNC.
            let mut wait = until;
            for _ in 0..MOST_FRAMES {
                let Some((bus, received)) = self.buses.receive(wait)? else { break };
                self.hear(bus, None, &received.frame)?;
                wait = 0;
            }
            let now = self.now();
            for index in 0..self.nodes.len() {
                if self.node(index).and_then(Node::next).is_some_and(|next| next <= now) {
                    let out = self.with_node(index, Node::poll);
                    self.spread(index, out)?;
                }
            }
            if !self.legs {
                let driven = self.nodes.iter().any(|(_, node)| world::is_driven(node));
                self.unit.mechanism_mut().set_legs(f64::from(u8::from(!driven)));
            }
            if now >= deadline {
                return Ok(());
            }
        }
    }

    /// A frame on a bus, from outside or from a node, to all (other) nodes on it.
    fn hear(&mut self, bus: usize, from: Option<usize>, frame: &Frame) -> Result<(), BusError> {
        let on = |(index, (at, _)): (usize, &(usize, Node))| {
            (*at == bus && Some(index) != from).then_some(index)
        };
        let hearers: Vec<usize> = self.nodes.iter().enumerate().filter_map(on).collect();
        let mut answers = Vec::new();
        for index in hearers {
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
        let Some(bus) = self.nodes.get(from).map(|(bus, _)| *bus) else { return Ok(()) };
        for frame in out {
            match self.buses.send(bus, &frame) {
                Ok(()) => {}
                Err(BusError::QueueFull { .. } | BusError::BusOff) => self.lost += 1,
                Err(error) => return Err(error),
            }
            self.hear(bus, Some(from), &frame)?;
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
        if let Some((_, node)) = self.nodes.get_mut(index) {
            what(node, &mut Physical::new(&mut self.unit, &mut self.plant_time, now), &mut out);
        }
        out
    }
}
