//! The binary form.
//!
//! ```text
//! offset  bytes  content (little-endian)
//!      0      4  "SBPL"
//!      4      2  version
//!      6      1  bytes per number: 4 or 8
//!      7      1  bytes of the robot's name, up to 32
//!      8      2  n_x
//!     10      2  n_s
//!     12      2  number of forces n_f
//!     14      2  0
//!     16      4  number of nodes
//!     20      4  fingerprint: CRC-32 of the robot's name and its parameters
//!     24      8  time of the first node, seconds since the motion's start (f64)
//!     32      8  seconds from node to node (f64)
//!     40     32  the robot's name (UTF-8), then zeros
//!     72      …  nodes: q_x, q̇_x, q̈_x, q_s, q̇_s, q̈_s, forces, their rates
//!    end      4  CRC-32 (IEEE) of all before it
//! ```

use super::FileError;
use super::crc::crc32;
use super::robot::{NAME_BYTES, RobotId};
use super::view::{PlanView, Stored, convert};
use crate::linear_algebra::is_finite;
use crate::plan::Row;
use core::marker::PhantomData;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Version of the format.
pub const VERSION: u16 = 2;

/// Bytes ahead of the nodes: numbers are aligned if the file is.
pub const HEADER_BYTES: usize = 72;

const MAGIC: [u8; 4] = *b"SBPL";

/// Where the robot's name begins.
const NAME: usize = HEADER_BYTES - NAME_BYTES;

/// Numbers of coordinates and forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// n_x.
    pub positions: usize,
    /// n_s.
    pub shapes: usize,
    /// n_f.
    pub forces: usize,
}

impl Sizes {
    /// Numbers of a node without the rates of the forces: q_x, q̇_x, q̈_x, q_s, q̇_s, q̈_s, forces.
    pub const fn values(&self) -> usize {
        3 * (self.positions + self.shapes) + self.forces
    }

    /// Numbers of a node as stored.
    pub(super) const fn stored(&self) -> usize {
        self.values() + self.forces
    }

    fn fit(&self) -> bool {
        [self.positions, self.shapes, self.forces].iter().all(|&size| size <= u16::MAX as usize)
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Header {
    pub(super) scalar: u8,
    pub(super) positions: u16,
    pub(super) shapes: u16,
    pub(super) forces: u16,
    pub(super) nodes: u32,
    pub(super) fingerprint: u32,
    pub(super) start: f64,
    pub(super) step: f64,
}

impl Header {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, FileError> {
        let Some(header) = bytes.first_chunk::<HEADER_BYTES>() else {
            return Err(FileError::Truncated { found: bytes.len(), expected: HEADER_BYTES });
        };
        let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
        let long = |at: usize| {
            u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
        };
        if header[..4] != MAGIC {
            return Err(FileError::NotAPlan);
        }
        if short(4) != VERSION {
            return Err(FileError::Version { found: short(4) });
        }
        Ok(Self {
            scalar: header[6],
            positions: short(8),
            shapes: short(10),
            forces: short(12),
            nodes: long(16),
            fingerprint: long(20),
            start: f64::read(&header[24..]),
            step: f64::read(&header[32..]),
        })
    }

    fn write(&self, name: &str, bytes: &mut [u8; HEADER_BYTES]) {
        *bytes = [0; HEADER_BYTES];
        bytes[..4].copy_from_slice(&MAGIC);
        bytes[4..6].copy_from_slice(&VERSION.to_le_bytes());
        bytes[6] = self.scalar;
        bytes[7] = name.len() as u8;
        bytes[8..10].copy_from_slice(&self.positions.to_le_bytes());
        bytes[10..12].copy_from_slice(&self.shapes.to_le_bytes());
        bytes[12..14].copy_from_slice(&self.forces.to_le_bytes());
        bytes[16..20].copy_from_slice(&self.nodes.to_le_bytes());
        bytes[20..24].copy_from_slice(&self.fingerprint.to_le_bytes());
        self.start.write(&mut bytes[24..]);
        self.step.write(&mut bytes[32..]);
        for (byte, letter) in bytes[NAME..].iter_mut().zip(name.bytes()) {
            *byte = letter;
        }
    }

    pub(super) fn sizes(&self) -> Sizes {
        Sizes {
            positions: self.positions.into(),
            shapes: self.shapes.into(),
            forces: self.forces.into(),
        }
    }

    /// Bytes of the whole file, as far as they can be counted.
    fn file_len(&self) -> usize {
        let node = self.sizes().stored() * usize::from(self.scalar);
        (self.nodes as usize).saturating_mul(node).saturating_add(HEADER_BYTES + 4)
    }

    /// Checks a file's length, checksum and times; its nodes.
    pub(super) fn nodes<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], FileError> {
        let expected = self.file_len();
        if bytes.len() != expected {
            return Err(FileError::Truncated { found: bytes.len(), expected });
        }
        let (content, checksum) = bytes.split_at(expected - 4);
        if checksum != crc32(content).to_le_bytes() {
            return Err(FileError::Checksum);
        }
        let sensible = self.nodes >= 2
            && matches!(self.scalar, 4 | 8)
            && self.start.is_finite()
            && self.step.is_finite()
            && self.step > 0.0;
        if !sensible || self.robot(bytes).is_none() {
            return Err(FileError::NotAPlan);
        }
        content.get(HEADER_BYTES..).ok_or(FileError::NotAPlan)
    }

    /// The robot that the file is for.
    pub(super) fn robot<'a>(&self, bytes: &'a [u8]) -> Option<RobotId<'a>> {
        let name = bytes.get(NAME..HEADER_BYTES)?.get(..usize::from(*bytes.get(7)?))?;
        Some(RobotId::from_file(core::str::from_utf8(name).ok()?, self.fingerprint))
    }
}

/// Bytes that [`encode`] takes for `nodes` nodes.
pub const fn encoded_len<T: Stored, const NX: usize, const NS: usize, const F: usize>(
    nodes: usize,
) -> usize {
    HEADER_BYTES + nodes * PlanView::<'static, T, NX, NS, F>::NODE * T::SIZE + 4
}

/// Writes every `stride`-th row as a node, in numbers of type `T`, and returns the bytes used.
///
/// `force` gives the forces to store with a row: [`actuator_force`](crate::actuator_force), or nothing
/// at all for F = 0.
///
/// # Errors
///
/// [`FileError::Nodes`] if the rows do not end with a node, [`FileError::BufferTooSmall`],
/// [`FileError::NonFinite`].
pub fn encode<T, U, const NX: usize, const NS: usize, const F: usize>(
    robot: &RobotId<'_>,
    rows: impl ExactSizeIterator<Item = Row<U, NX, NS>>,
    stride: usize,
    mut force: impl FnMut(&Row<U, NX, NS>) -> SVector<U, F>,
    buffer: &mut [u8],
) -> Result<usize, FileError>
where
    T: Stored,
    U: Ordered,
{
    let count = rows.len();
    if stride == 0 || count < 2 || !(count - 1).is_multiple_of(stride) {
        return Err(FileError::Nodes { rows: count, stride });
    }
    let nodes = (count - 1) / stride + 1;
    let (found, expected) = (buffer.len(), encoded_len::<T, NX, NS, F>(nodes));
    let nodes = u32::try_from(nodes).map_err(|_| FileError::Nodes { rows: count, stride })?;
    let Some(file) = buffer.get_mut(..expected) else {
        return Err(FileError::BufferTooSmall { found, expected });
    };
    let mut writer = Writer::<T, F> {
        content: &mut file[HEADER_BYTES..expected - 4],
        size: PlanView::<'_, T, NX, NS, F>::NODE * T::SIZE,
        stride,
        scalar: PhantomData,
    };
    let mut times = [0.0; 2];
    let mut differences = Differences { last: count - 1, period: 0.0, recent: [None; 2] };
    for (index, row) in rows.enumerate() {
        let here = force(&row);
        let time = row.plan.time.to_f64();
        times[usize::from(index > 0)] = time;
        if index == 1 {
            differences.period = time - times[0];
        }
        writer.node(index, &row, &here)?;
        differences.add(index, here, |index, rate| writer.rate(index, rate));
    }
    let sizes = Sizes { positions: NX, shapes: NS, forces: F };
    seal::<T>(file, robot, &sizes, nodes, times)?;
    Ok(expected)
}

/// Writes header and checksum around nodes; `times` are those of the first and the last.
fn seal<T: Stored>(
    file: &mut [u8],
    robot: &RobotId<'_>,
    sizes: &Sizes,
    nodes: u32,
    times: [f64; 2],
) -> Result<(), FileError> {
    let step = (times[1] - times[0]) / f64::from(nodes - 1);
    let sensible = times[0].is_finite() && step.is_finite() && step > 0.0 && sizes.fit();
    let Some((content, end)) = file.split_last_chunk_mut::<4>().filter(|_| sensible) else {
        return Err(FileError::NonFinite);
    };
    let header = Header {
        scalar: T::SIZE as u8,
        positions: sizes.positions as u16,
        shapes: sizes.shapes as u16,
        forces: sizes.forces as u16,
        nodes,
        fingerprint: robot.fingerprint(),
        start: times[0],
        step,
    };
    if let Some(bytes) = content.first_chunk_mut::<HEADER_BYTES>() {
        header.write(robot.kept(), bytes);
    }
    *end = crc32(content).to_le_bytes();
    Ok(())
}

/// Bytes that [`encode_values`] takes.
pub const fn encoded_values_len<T: Stored>(sizes: &Sizes, nodes: usize) -> usize {
    HEADER_BYTES + nodes * sizes.stored() * T::SIZE + 4
}

/// Writes nodes of any size and returns the bytes used: for tools that read plans of robots they do not
/// know at compile time. `times` gives the time of a node, `value` a number of a node in the order of
/// [`Sizes::values`]. Rates of forces are differences of neighbouring nodes.
///
/// # Errors
///
/// Those of [`encode`].
pub fn encode_values<T: Stored>(
    robot: &RobotId<'_>,
    sizes: &Sizes,
    nodes: usize,
    time: impl Fn(usize) -> f64,
    value: impl Fn(usize, usize) -> f64,
    buffer: &mut [u8],
) -> Result<usize, FileError> {
    let unfit = FileError::Nodes { rows: nodes, stride: 1 };
    let Some(count) = u32::try_from(nodes).ok().filter(|&count| count >= 2) else {
        return Err(unfit);
    };
    let (found, expected) = (buffer.len(), encoded_values_len::<T>(sizes, nodes));
    let Some(file) = buffer.get_mut(..expected) else {
        return Err(FileError::BufferTooSmall { found, expected });
    };
    let (last, values) = (nodes - 1, sizes.values());
    let period = time(1) - time(0);
    let content = file.get_mut(HEADER_BYTES..expected - 4).unwrap_or_default();
    for (node, bytes) in content.chunks_exact_mut(sizes.stored() * T::SIZE).enumerate() {
        for (index, chunk) in bytes.chunks_exact_mut(T::SIZE).enumerate() {
            let number = if index < values {
                value(node, index)
            } else {
                let force = |node: usize| value(node, index - sizes.forces);
                rate(node, last, period, force)
            };
            if !number.is_finite() {
                return Err(FileError::NonFinite);
            }
            T::from_f64(number).write(chunk);
        }
    }
    seal::<T>(file, robot, sizes, count, [time(0), time(last)])?;
    Ok(expected)
}

/// The rate of a force at a node: a difference of three neighbours, one-sided at the ends.
fn rate(node: usize, last: usize, period: f64, force: impl Fn(usize) -> f64) -> f64 {
    match (node, last) {
        (_, 1) => (force(1) - force(0)) / period,
        (0, _) => (force(1) * 4.0 - force(0) * 3.0 - force(2)) / (period * 2.0),
        (node, last) if node == last => {
            (force(last) * 3.0 - force(last - 1) * 4.0 + force(last - 2)) / (period * 2.0)
        }
        (node, _) => (force(node + 1) - force(node - 1)) / (period * 2.0),
    }
}

/// The nodes of a file.
struct Writer<'b, T, const F: usize> {
    content: &'b mut [u8],
    /// Bytes of a node.
    size: usize,
    stride: usize,
    scalar: PhantomData<T>,
}

impl<T: Stored, const F: usize> Writer<'_, T, F> {
    /// The bytes of a row's node, if it is one.
    fn bytes(&mut self, index: usize) -> Option<&mut [u8]> {
        let begin = index / self.stride * self.size;
        let node = self.content.get_mut(begin..begin + self.size);
        node.filter(|_| index.is_multiple_of(self.stride))
    }

    fn node<U: Ordered, const NX: usize, const NS: usize>(
        &mut self,
        index: usize,
        row: &Row<U, NX, NS>,
        force: &SVector<U, F>,
    ) -> Result<(), FileError> {
        let plan = &row.plan;
        if !(is_finite(&row.position) && is_finite(&plan.shape_acceleration) && is_finite(force)) {
            return Err(FileError::NonFinite);
        }
        let Some(bytes) = self.bytes(index) else {
            return Ok(());
        };
        let positions =
            row.position.iter().chain(row.velocity.iter()).chain(row.acceleration.iter());
        let shapes = plan.shape.iter().chain(plan.shape_velocity.iter());
        let values = positions.chain(shapes).chain(plan.shape_acceleration.iter());
        for (value, chunk) in values.chain(force.iter()).zip(bytes.chunks_exact_mut(T::SIZE)) {
            convert::<U, T>(*value).write(chunk);
        }
        Ok(())
    }

    /// Rates of the forces come last in a node.
    fn rate<U: Ordered>(&mut self, index: usize, rate: SVector<U, F>) {
        let Some(bytes) = self.bytes(index) else {
            return;
        };
        let begin = bytes.len().saturating_sub(F * T::SIZE);
        let chunks = bytes[begin..].chunks_exact_mut(T::SIZE);
        for (value, chunk) in rate.iter().zip(chunks) {
            convert::<U, T>(*value).write(chunk);
        }
    }
}

/// Rates of the forces: differences of three neighbouring samples, one-sided at the ends.
struct Differences<U: Ordered, const F: usize> {
    last: usize,
    /// Seconds from sample to sample.
    period: f64,
    /// The forces two samples ago, and one sample ago.
    recent: [Option<SVector<U, F>>; 2],
}

impl<U: Ordered, const F: usize> Differences<U, F> {
    /// Passes on the rates that a further sample determines.
    fn add(
        &mut self,
        index: usize,
        here: SVector<U, F>,
        mut pass: impl FnMut(usize, SVector<U, F>),
    ) {
        let (two, three, four) = (U::from_f64(2.0), U::from_f64(3.0), U::from_f64(4.0));
        let span = U::from_f64(self.period);
        match self.recent {
            [Some(oldest), Some(middle)] => {
                if index == 2 {
                    pass(0, (middle * four - oldest * three - here) / (span * two));
                }
                pass(index - 1, (here - oldest) / (span * two));
                if index == self.last {
                    pass(index, (here * three - middle * four + oldest) / (span * two));
                }
            }
            [None, Some(middle)] if index == self.last => {
                let rate = (here - middle) / span;
                pass(0, rate);
                pass(index, rate);
            }
            _ => {}
        }
        self.recent = [self.recent[1], Some(here)];
    }
}
