//! Plan files of sizes that are not known at compile time.

use super::FileError;
use super::binary::{Header, Sizes};
use super::robot::RobotId;
use super::view::Stored;

/// The numbers of a binary plan of any robot, checked once and read in place. To evaluate a plan between
/// its nodes, see [`PlanView`](super::PlanView).
#[derive(Clone, Copy, Debug)]
pub struct PlanBytes<'a> {
    nodes: &'a [u8],
    header: Header,
    robot: RobotId<'a>,
}

impl<'a> PlanBytes<'a> {
    /// # Errors
    ///
    /// A [`FileError`] for bytes that are not, whole and unaltered, a plan of this version.
    pub fn open(bytes: &'a [u8]) -> Result<Self, FileError> {
        let header = Header::read(bytes)?;
        let nodes = header.nodes(bytes)?;
        let robot = header.robot(bytes).ok_or(FileError::NotAPlan)?;
        Ok(Self { nodes, header, robot })
    }

    /// The robot that the plan is for.
    pub fn robot(&self) -> &RobotId<'a> {
        &self.robot
    }

    /// Numbers of coordinates and forces.
    pub fn sizes(&self) -> Sizes {
        self.header.sizes()
    }

    /// Bytes per number: 4 or 8.
    pub fn scalar(&self) -> usize {
        self.header.scalar.into()
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.header.nodes as usize
    }

    /// Time of a node, seconds since the motion's start.
    pub fn time(&self, node: usize) -> f64 {
        self.header.start + self.header.step * node as f64
    }

    /// A number of a node, in the order of [`Sizes::values`], then the rates of the forces; zero beyond.
    pub fn value(&self, node: usize, index: usize) -> f64 {
        let begin = (node * self.sizes().stored() + index) * self.scalar();
        let bytes = self.nodes.get(begin..).unwrap_or_default();
        if self.scalar() == 4 { f32::read(bytes).into() } else { f64::read(bytes) }
    }
}
