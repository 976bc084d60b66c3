//! Reading plan files in place.

use super::FileError;
use super::binary::Header;
use super::robot::RobotId;
use crate::linear_algebra::{exceeds, norm};
use crate::plan::Row;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// A scalar of plan files: f32 or f64, little-endian.
pub trait Stored: Ordered {
    /// Bytes.
    const SIZE: usize;
    /// From the first [`SIZE`](Self::SIZE) bytes; zero if there are fewer.
    fn read(bytes: &[u8]) -> Self;
    /// To the first [`SIZE`](Self::SIZE) bytes; nothing if there are fewer.
    fn write(self, bytes: &mut [u8]);
    /// The integer part as an index; zero for what is negative or not a number.
    fn to_index(self) -> usize;
    /// An index as a number.
    fn from_index(index: usize) -> Self;
}

macro_rules! stored {
    ($t:ty, $size:literal) => {
        impl Stored for $t {
            const SIZE: usize = $size;
            #[inline]
            fn read(bytes: &[u8]) -> Self {
                bytes.first_chunk::<$size>().map_or(0.0, |bytes| <$t>::from_le_bytes(*bytes))
            }
            #[inline]
            fn write(self, bytes: &mut [u8]) {
                if let Some(chunk) = bytes.first_chunk_mut::<$size>() {
                    *chunk = self.to_le_bytes();
                }
            }
            #[inline]
            fn to_index(self) -> usize {
                self as usize
            }
            #[inline]
            fn from_index(index: usize) -> Self {
                index as $t
            }
        }
    };
}

stored!(f32, 4);
stored!(f64, 8);

/// A plan at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanState<T: Ordered, const NX: usize, const NS: usize, const F: usize> {
    /// q_x, q̇_x, q̈_x.
    pub position: [SVector<T, NX>; 3],
    /// q_s, q̇_s, q̈_s.
    pub shape: [SVector<T, NS>; 3],
    /// The forces that the plan was written with.
    pub force: SVector<T, F>,
}

/// How far a plan file is from the rows it came from: largest norms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation<T> {
    /// Of q_x.
    pub position: T,
    /// Of q_s.
    pub shape: T,
    /// Of q̈_s.
    pub shape_acceleration: T,
    /// Of the forces.
    pub force: T,
}

/// A plan in the bytes of its file, checked once and evaluated in place.
#[derive(Clone, Copy, Debug)]
pub struct PlanView<'a, T, const NX: usize, const NS: usize, const F: usize> {
    nodes: &'a [u8],
    header: Header,
    robot: RobotId<'a>,
    // Of the header, in the plan's scalar: doubles are slow where only singles have hardware.
    start: T,
    end: T,
    step: T,
}

impl<'a, T: Stored, const NX: usize, const NS: usize, const F: usize> PlanView<'a, T, NX, NS, F> {
    /// Scalars of a node: three derivatives of the coordinates, forces and their rates.
    pub(super) const NODE: usize = 3 * NX + 3 * NS + 2 * F;

    /// # Errors
    ///
    /// A [`FileError`] for bytes that are not, whole and unaltered, a plan of this version for the robot
    /// with its parameters, n_x, n_s, number of forces and scalar.
    pub fn open(bytes: &'a [u8], robot: &RobotId<'_>) -> Result<Self, FileError> {
        let view = Self::open_any(bytes)?;
        robot.check(&view.robot)?;
        Ok(view)
    }

    /// The same for a plan of whatever robot: see [`robot`](Self::robot).
    ///
    /// # Errors
    ///
    /// Those of [`open`](Self::open), but for [`FileError::OtherRobot`].
    pub fn open_any(bytes: &'a [u8]) -> Result<Self, FileError> {
        let header = Header::read(bytes)?;
        for (field, found, expected) in [
            ("bytes per number", usize::from(header.scalar), T::SIZE),
            ("position coordinates", usize::from(header.positions), NX),
            ("shape coordinates", usize::from(header.shapes), NS),
            ("forces", usize::from(header.forces), F),
        ] {
            if found != expected {
                return Err(FileError::Mismatch { field, found, expected });
            }
        }
        let nodes = header.nodes(bytes)?;
        let robot = header.robot(bytes).ok_or(FileError::NotAPlan)?;
        let end = header.start + header.step * f64::from(header.nodes - 1);
        let [start, end, step] = [header.start, end, header.step].map(T::from_f64);
        Ok(Self { nodes, header, robot, start, end, step })
    }

    /// The robot that the plan is for.
    pub fn robot(&self) -> &RobotId<'a> {
        &self.robot
    }

    /// When the plan opens, seconds since the motion's start.
    pub fn start_time(&self) -> T {
        self.start
    }

    /// When the plan closes.
    pub fn end_time(&self) -> T {
        self.end
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.header.nodes as usize
    }

    /// The plan at time `t`, seconds since the motion's start. Before the plan and after it the robot
    /// stands as at its ends.
    pub fn at(&self, t: T) -> PlanState<T, NX, NS, F> {
        let place = self.place(t);
        let (position, shape) = self.motion(&place);
        PlanState { position, shape, force: self.force(&place) }
    }

    /// q_x and q_s with their rates and accelerations, [`at`](Self::at) without the forces.
    pub fn motion_at(&self, t: T) -> ([SVector<T, NX>; 3], [SVector<T, NS>; 3]) {
        self.motion(&self.place(t))
    }

    /// The forces of [`at`](Self::at) alone.
    pub fn force_at(&self, t: T) -> SVector<T, F> {
        self.force(&self.place(t))
    }

    #[inline]
    fn place(&self, t: T) -> Place<'a, T> {
        let place = (t - self.start) / self.step;
        let last = self.nodes() - 1;
        if !exceeds(place, T::zero()) {
            let moving = t == self.start;
            return Place::Resting { node: self.node(0), moving };
        }
        if place >= T::from_index(last) {
            return Place::Resting { node: self.node(last), moving: t <= self.end };
        }
        let node = place.to_index().min(last - 1);
        let sigma = place - T::from_index(node);
        Place::Between { before: self.node(node), after: self.node(node + 1), sigma }
    }

    /// The bytes of a node.
    #[inline]
    fn node(&self, node: usize) -> &'a [u8] {
        let size = Self::NODE * T::SIZE;
        self.nodes.get(node * size..).unwrap_or(&[])
    }

    /// The node with nothing after it, so that the compiler knows its length; the file is as long as its
    /// header says.
    #[inline]
    fn exactly(node: &[u8]) -> Option<&[u8]> {
        node.get(..Self::NODE * T::SIZE)
    }

    #[inline]
    fn motion(&self, place: &Place<'_, T>) -> ([SVector<T, NX>; 3], [SVector<T, NS>; 3]) {
        let mut position = [SVector::from_element(T::zero()); 3];
        let mut shape = [SVector::from_element(T::zero()); 3];
        match *place {
            Place::Resting { node, moving } => {
                if let Some(node) = Self::exactly(node) {
                    let keep = if moving { T::one() } else { T::zero() };
                    resting(node, 0, keep, &mut position);
                    resting(node, 3 * NX, keep, &mut shape);
                }
            }
            Place::Between { before, after, sigma } => {
                if let (Some(before), Some(after)) = (Self::exactly(before), Self::exactly(after)) {
                    let at = [sigma, self.step];
                    quintic([before, after], 0, at, &mut position);
                    quintic([before, after], 3 * NX, at, &mut shape);
                }
            }
        }
        (position, shape)
    }

    #[inline]
    fn force(&self, place: &Place<'_, T>) -> SVector<T, F> {
        let first = 3 * (NX + NS);
        match *place {
            Place::Resting { node, .. } => Self::exactly(node)
                .map_or(SVector::from_element(T::zero()), |node| {
                    SVector::from_fn(|i, _| scalar(node, first + i))
                }),
            Place::Between { before, after, sigma } => {
                match (Self::exactly(before), Self::exactly(after)) {
                    (Some(before), Some(after)) => {
                        cubic([before, after], first, [sigma, self.step])
                    }
                    _ => SVector::from_element(T::zero()),
                }
            }
        }
    }

    /// The largest deviation from rows of the plan that the file was written from, and their forces.
    pub fn deviation<U: Ordered>(
        &self,
        rows: impl Iterator<Item = Row<U, NX, NS>>,
        force: impl Fn(&Row<U, NX, NS>) -> SVector<U, F>,
    ) -> Deviation<T> {
        let mut deviation = Deviation {
            position: T::zero(),
            shape: T::zero(),
            shape_acceleration: T::zero(),
            force: T::zero(),
        };
        for row in rows {
            let state = self.at(convert(row.plan.time));
            let position = state.position[0] - row.position.map(convert);
            let shape = state.shape[0] - row.plan.shape.map(convert);
            let second = state.shape[2] - row.plan.shape_acceleration.map(convert);
            let force = state.force - force(&row).map(convert);
            for (largest, found) in [
                (&mut deviation.position, norm(&position)),
                (&mut deviation.shape, norm(&shape)),
                (&mut deviation.shape_acceleration, norm(&second)),
                (&mut deviation.force, norm(&force)),
            ] {
                if found > *largest {
                    *largest = found;
                }
            }
        }
        deviation
    }
}

/// Where a time falls: bytes that begin with a node.
#[derive(Clone, Copy)]
enum Place<'a, T> {
    /// At an end, or outside, where rates and accelerations are zero.
    Resting { node: &'a [u8], moving: bool },
    /// A share of the way from one node to the next.
    Between { before: &'a [u8], after: &'a [u8], sigma: T },
}

#[inline(always)]
fn scalar<T: Stored>(node: &[u8], index: usize) -> T {
    node.get(index * T::SIZE..).map_or_else(T::zero, T::read)
}

/// A node's value, rate and acceleration.
#[inline(always)]
fn resting<T: Stored, const D: usize>(
    node: &[u8],
    first: usize,
    keep: T,
    to: &mut [SVector<T, D>; 3],
) {
    for i in 0..D {
        to[0][i] = scalar(node, first + i);
        to[1][i] = scalar::<T>(node, first + D + i) * keep;
        to[2][i] = scalar::<T>(node, first + 2 * D + i) * keep;
    }
}

/// Quintic through value, rate and acceleration of two nodes.
#[inline(always)]
fn quintic<T: Stored, const D: usize>(
    nodes: [&[u8]; 2],
    first: usize,
    [s, step]: [T; 2],
    to: &mut [SVector<T, D>; 3],
) {
    let c = T::from_f64;
    let (half, square) = (c(0.5), step * step);
    for i in 0..D {
        // One coordinate after the other, which is what registers have room for.
        let [[a, da, dda], [b, db, ddb]] = nodes.map(|node| {
            let [value, rate, second] = [0, 1, 2].map(|r| scalar::<T>(node, first + r * D + i));
            [value, rate * step, second * square]
        });
        // What value, rate and acceleration miss at the far end.
        let value = b - a - da - dda * half;
        let rate = db - da - dda;
        let second = ddb - dda;
        let c3 = value * c(10.0) - rate * c(4.0) + second * half;
        let c4 = value * c(-15.0) + rate * c(7.0) - second;
        let c5 = value * c(6.0) - rate * c(3.0) + second * half;
        to[0][i] = a + (da + (dda * half + (c3 + (c4 + c5 * s) * s) * s) * s) * s;
        to[1][i] =
            (da + (dda + (c3 * c(3.0) + (c4 * c(4.0) + c5 * (c(5.0) * s)) * s) * s) * s) / step;
        to[2][i] = (dda + (c3 * c(6.0) + (c4 * c(12.0) + c5 * (c(20.0) * s)) * s) * s) / square;
    }
}

/// Cubic through value and rate of two nodes.
#[inline(always)]
fn cubic<T: Stored, const D: usize>(
    nodes: [&[u8]; 2],
    first: usize,
    [s, step]: [T; 2],
) -> SVector<T, D> {
    let (two, three) = (T::from_f64(2.0), T::from_f64(3.0));
    SVector::from_fn(|i, _| {
        let [(a, da), (b, db)] = nodes
            .map(|node| (scalar::<T>(node, first + i), scalar::<T>(node, first + D + i) * step));
        let way = b - a;
        let c2 = way * three - da * two - db;
        let c3 = da + db - way * two;
        a + (da + (c2 + c3 * s) * s) * s
    })
}

/// From one scalar to another.
pub(super) fn convert<U: Ordered, T: Ordered>(value: U) -> T {
    T::from_f64(value.to_f64())
}
