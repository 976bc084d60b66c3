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
    let size = PlanView::<'_, T, NX, NS, F>::NODE * T::SIZE;
    let mut times = [0.0; 2];
    // Rates of the forces are differences of the samples around a node.
    let mut recent: [Option<SVector<U, F>>; 2] = [None; 2];
    let mut period = 0.0;
    for (index, row) in rows.enumerate() {
        let here = force(&row);
        let time = row.plan.time.to_f64();
        if index == 1 {
            period = time - times[0];
        }
        times[usize::from(index > 0)] = time;
        let content = &mut file[HEADER_BYTES..expected - 4];
        if index.is_multiple_of(stride) {
            let node = &mut content[index / stride * size..];
            write_node::<T, U, NX, NS, F>(&row, &here, node)?;
        }
        if let Some(previous) = recent[1]
            && (index - 1).is_multiple_of(stride)
        {
            let (from, span) = recent[0].map_or((previous, 1.0), |oldest| (oldest, 2.0));
            write_rate::<T, U, F>(&((here - from) / U::from_f64(span * period)), &mut content
                [((index - 1) / stride + 1) * size - F * T::SIZE..]);
        }
        if let Some(previous) = recent[1]
            && index + 1 == count
        {
            let rate = (here - previous) / U::from_f64(period);
            write_rate::<T, U, F>(&rate, &mut content[(index / stride + 1) * size - F * T::SIZE..]);
        }
        recent = [recent[1], Some(here)];
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

fn write_node<T: Stored, U: Ordered, const NX: usize, const NS: usize, const F: usize>(
    row: &Row<U, NX, NS>,
    force: &SVector<U, F>,
    bytes: &mut [u8],
) -> Result<(), FileError> {
    if !(is_finite(&row.position) && is_finite(&row.plan.shape_acceleration) && is_finite(force)) {
        return Err(FileError::NonFinite);
    }
    let plan = &row.plan;
    let positions = row.position.iter().chain(row.velocity.iter()).chain(row.acceleration.iter());
    let shapes = plan.shape.iter().chain(plan.shape_velocity.iter());
    let shapes = shapes.chain(plan.shape_acceleration.iter());
    for (value, chunk) in
        positions.chain(shapes).chain(force.iter()).zip(bytes.chunks_exact_mut(T::SIZE))
    {
        convert::<U, T>(*value).write(chunk);
    }
    Ok(())
}

fn write_rate<T: Stored, U: Ordered, const F: usize>(rate: &SVector<U, F>, bytes: &mut [u8]) {
    for (value, chunk) in rate.iter().zip(bytes.chunks_exact_mut(T::SIZE)) {
        convert::<U, T>(*value).write(chunk);
    }
}
