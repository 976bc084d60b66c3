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

    fn scalar(&self, node: usize, index: usize) -> T {
        let begin = (node * Self::NODE + index) * T::SIZE;
        self.nodes.get(begin..).map_or_else(T::zero, T::read)
    }

    fn vector<const D: usize>(&self, node: usize, first: usize) -> SVector<T, D> {
        SVector::from_fn(|i, _| self.scalar(node, first + i))
    }

    /// The plan at time `t`, seconds since the motion's start. Before the plan and after it the robot
    /// stands as at its ends.
    pub fn at(&self, t: T) -> PlanState<T, NX, NS, F> {
        let step = self.step;
        let place = (t - self.start_time()) / step;
        let last = self.nodes() - 1;
        if !exceeds(place, T::zero()) {
            return self.resting(0, t == self.start_time());
        }
        if place >= T::from_index(last) {
            return self.resting(last, t <= self.end_time());
        }
        let node = place.to_index().min(last - 1);
        let sigma = place - T::from_index(node);
        let force = 3 * (NX + NS);
        PlanState {
            position: self.quintic(node, 0, sigma, step),
            shape: self.quintic(node, 3 * NX, sigma, step),
            force: self.cubic(node, force, sigma, step),
        }
    }

    /// A node; outside of the plan with rates and accelerations zero.
    fn resting(&self, node: usize, moving: bool) -> PlanState<T, NX, NS, F> {
        let keep = if moving { T::one() } else { T::zero() };
        PlanState {
            position: [
                self.vector(node, 0),
                self.vector(node, NX) * keep,
                self.vector(node, 2 * NX) * keep,
            ],
            shape: [
                self.vector(node, 3 * NX),
                self.vector(node, 3 * NX + NS) * keep,
                self.vector(node, 3 * NX + 2 * NS) * keep,
            ],
            force: self.vector(node, 3 * (NX + NS)),
        }
    }

    /// Quintic through value, rate and acceleration of two nodes.
    fn quintic<const D: usize>(
        &self,
        node: usize,
        first: usize,
        sigma: T,
        step: T,
    ) -> [SVector<T, D>; 3] {
        let number = T::from_f64;
        let end = |node: usize| {
            let [value, rate, second]: [SVector<T, D>; 3] =
                core::array::from_fn(|r| self.vector(node, first + r * D));
            [value, rate * step, second * (step * step)]
        };
        let ([a, da, dda], [b, db, ddb]) = (end(node), end(node + 1));
        let half = number(0.5);
        // What value, rate and acceleration miss at the far end.
        let value = b - a - da - dda * half;
        let rate = db - da - dda;
        let second = ddb - dda;
        let c3 = value * number(10.0) - rate * number(4.0) + second * half;
        let c4 = value * number(-15.0) + rate * number(7.0) - second;
        let c5 = value * number(6.0) - rate * number(3.0) + second * half;
        let s = sigma;
        [
            a + (da + (dda * half + (c3 + (c4 + c5 * s) * s) * s) * s) * s,
            (da + (dda + (c3 * number(3.0) + (c4 * number(4.0) + c5 * (number(5.0) * s)) * s) * s)
                * s)
                / step,
            (dda + (c3 * number(6.0) + (c4 * number(12.0) + c5 * (number(20.0) * s)) * s) * s)
                / (step * step),
        ]
    }

    /// Cubic through value and rate of two nodes.
    fn cubic<const D: usize>(&self, node: usize, first: usize, sigma: T, step: T) -> SVector<T, D> {
        let (two, three) = (T::from_f64(2.0), T::from_f64(3.0));
        let end =
            |node: usize| (self.vector::<D>(node, first), self.vector::<D>(node, first + D) * step);
        let ((a, da), (b, db)) = (end(node), end(node + 1));
        let way = b - a;
        let c2 = way * three - da * two - db;
        let c3 = da + db - way * two;
        a + (da + (c2 + c3 * sigma) * sigma) * sigma
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

/// From one scalar to another.
pub(super) fn convert<U: Ordered, T: Ordered>(value: U) -> T {
    T::from_f64(value.to_f64())
}
