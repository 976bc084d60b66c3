//! The binary form.
//!
//! ```text
//! offset  bytes  content (little-endian)
//!      0      4  "SBPL"
//!      4      2  version
//!      6      1  bytes per number: 4 or 8
//!      7      1  0
//!      8      2  n_x
//!     10      2  n_s
//!     12      2  number of forces n_f
//!     14      2  0
//!     16      4  number of nodes
//!     20      4  0
//!     24      8  time of the first node, seconds since the motion's start (f64)
//!     32      8  seconds from node to node (f64)
//!     40      …  nodes: q_x, q̇_x, q̈_x, q_s, q̇_s, q̈_s, forces, their rates
//!    end      4  CRC-32 (IEEE) of all before it
//! ```

use super::FileError;
use super::crc::crc32;
use super::view::{PlanView, Stored, convert};
use crate::linear_algebra::is_finite;
use crate::plan::Row;
use core::marker::PhantomData;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Version of the format.
pub const VERSION: u16 = 1;

/// Bytes ahead of the nodes: numbers are aligned if the file is.
pub const HEADER_BYTES: usize = 40;

const MAGIC: [u8; 4] = *b"SBPL";

#[derive(Clone, Copy, Debug)]
pub(super) struct Header {
    pub(super) scalar: u8,
    pub(super) positions: u16,
    pub(super) shapes: u16,
    pub(super) forces: u16,
    pub(super) nodes: u32,
    pub(super) start: f64,
    pub(super) step: f64,
}

impl Header {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, FileError> {
        let Some(header) = bytes.first_chunk::<HEADER_BYTES>() else {
            return Err(FileError::Truncated { found: bytes.len(), expected: HEADER_BYTES });
        };
        let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
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
            nodes: u32::from_le_bytes([header[16], header[17], header[18], header[19]]),
            start: f64::read(&header[24..]),
            step: f64::read(&header[32..]),
        })
    }

    fn write(&self, bytes: &mut [u8; HEADER_BYTES]) {
        *bytes = [0; HEADER_BYTES];
        bytes[..4].copy_from_slice(&MAGIC);
        bytes[4..6].copy_from_slice(&VERSION.to_le_bytes());
        bytes[6] = self.scalar;
        bytes[8..10].copy_from_slice(&self.positions.to_le_bytes());
        bytes[10..12].copy_from_slice(&self.shapes.to_le_bytes());
        bytes[12..14].copy_from_slice(&self.forces.to_le_bytes());
        bytes[16..20].copy_from_slice(&self.nodes.to_le_bytes());
        self.start.write(&mut bytes[24..]);
        self.step.write(&mut bytes[32..]);
    }

    /// Bytes of the whole file, as far as they can be counted.
    pub(super) fn file_len(&self, node: usize) -> usize {
        (self.nodes as usize).saturating_mul(node).saturating_add(HEADER_BYTES + 4)
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
    let step = (times[1] - times[0]) / f64::from(nodes - 1);
    let header = Header {
        scalar: T::SIZE as u8,
        positions: NX as u16,
        shapes: NS as u16,
        forces: F as u16,
        nodes,
        start: times[0],
        step,
    };
    if let Some(bytes) = file.first_chunk_mut::<HEADER_BYTES>() {
        header.write(bytes);
    }
    let checksum = crc32(&file[..expected - 4]).to_le_bytes();
    file[expected - 4..].copy_from_slice(&checksum);
    Ok(expected)
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
