//! PDOs of a simulated node: parameters, mapping, packing.

use shapebot_drive::{DataType, Frame, Object, id::is_restricted};

use crate::{Abort, Access, Dictionary, Mappable};

/// PDOs of each direction.
pub(crate) const COUNT: u8 = 4;

/// Bit of a COB-ID that says that the PDO is not used.
const INVALID: i64 = 1 << 31;
/// Bit of a COB-ID that says that the PDO is not sent on request.
const NO_REQUEST: i64 = 1 << 30;

/// A PDO that is in use, as it is set up at the moment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pdo {
    pub(crate) cob_id: u16,
    pub(crate) transmission: u8,
    /// Event timer, or deadline of a receive PDO, µs; zero is none.
    pub(crate) event_us: u64,
    pub(crate) entries: Vec<(Object, DataType)>,
}

impl Pdo {
    pub(crate) const fn is_synchronous(&self) -> bool {
        self.transmission <= 240
    }

    pub(crate) fn bytes(&self) -> usize {
        self.entries.iter().map(|(_, kind)| kind.bytes()).sum()
    }

    /// The frame that holds the objects' present values.
    pub(crate) fn pack(&self, dictionary: &Dictionary) -> Frame {
        let mut bytes = Vec::with_capacity(8);
        for (object, kind) in &self.entries {
            bytes.extend(kind.encode(dictionary.get(*object)).into_iter().take(kind.bytes()));
        }
        Frame::new(self.cob_id, &bytes)
    }

    /// Objects and values of a received frame; gaps are left out.
    pub(crate) fn unpack(&self, mut bytes: &[u8]) -> Vec<(Object, i64)> {
        let mut values = Vec::with_capacity(self.entries.len());
        for (object, kind) in &self.entries {
            let Some((head, tail)) = bytes.split_at_checked(kind.bytes()) else { break };
            if object.index > 7 {
                values.push((*object, kind.decode(head)));
            }
            bytes = tail;
        }
        values
    }
}

/// The two directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Receive,
    Transmit,
}

impl Direction {
    const fn bases(self) -> (u16, u16) {
        match self {
            Self::Receive => (0x1400, 0x1600),
            Self::Transmit => (0x1800, 0x1A00),
        }
    }

    const fn mappable(self) -> Mappable {
        match self {
            Self::Receive => Mappable::Receive,
            Self::Transmit => Mappable::Transmit,
        }
    }
}

const fn object(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

/// Adds parameters and empty mappings of all PDOs, not in use, with the predefined identifiers.
pub(crate) fn add_objects(dictionary: &mut Dictionary, node: u8) {
    let (constant, rw, no) = (Access::Constant, Access::ReadWrite, Mappable::No);
    for direction in [Direction::Receive, Direction::Transmit] {
        let (parameters, mapping) = direction.bases();
        let first = if direction == Direction::Receive { 0x200 } else { 0x180 };
        for number in 0..u16::from(COUNT) {
            let cob_id = i64::from(first + 0x100 * number + u16::from(node));
            let mut add = |sub, kind, value, access| {
                dictionary.number(object(parameters + number, sub), kind, value, access, no);
            };
            add(0, DataType::U8, 5, constant);
            add(1, DataType::U32, cob_id | INVALID | NO_REQUEST, rw);
            add(2, DataType::U8, 255, rw);
            add(3, DataType::U16, 0, rw);
            add(5, DataType::U16, 0, rw);
            dictionary.number(object(mapping + number, 0), DataType::U8, 0, rw, no);
            dictionary.limit(object(mapping + number, 0), (0, 8));
            for sub in 1..=8 {
                dictionary.number(object(mapping + number, sub), DataType::U32, 0, rw, no);
            }
        }
    }
}

/// The direction and number from zero of a PDO parameter or mapping object.
fn place(index: u16) -> Option<(Direction, u16, bool)> {
    for direction in [Direction::Receive, Direction::Transmit] {
        let (parameters, mapping) = direction.bases();
        for (base, is_mapping) in [(parameters, false), (mapping, true)] {
            let number = index.checked_sub(base).filter(|n| *n < u16::from(COUNT));
            if let Some(number) = number {
                return Some((direction, number, is_mapping));
            }
        }
    }
    None
}

/// Whether an index is a parameter or mapping of a PDO.
pub(crate) fn is_ours(index: u16) -> bool {
    place(index).is_some()
}

/// Checks a write to a PDO's parameters or mapping against CiA 301: a PDO is taken out of use, mapped
/// with its count at zero, and only then used again.
pub(crate) fn check(dictionary: &Dictionary, at: Object, value: i64) -> Result<(), Abort> {
    let Some((direction, number, is_mapping)) = place(at.index) else { return Ok(()) };
    let (parameters, mapping) = direction.bases();
    let used = dictionary.get(object(parameters + number, 1)) & INVALID == 0;
    if is_mapping {
        let count = dictionary.get(object(mapping + number, 0));
        return match at.sub {
            _ if used => Err(Abort::DeviceState),
            0 => check_mapping(dictionary, direction, mapping + number, value),
            _ if count != 0 => Err(Abort::DeviceState),
            _ if value == 0 => Ok(()),
            _ => {
                let entry = u32::try_from(value).unwrap_or(0);
                dictionary.mapped(entry, direction.mappable()).map(|_| ())
            }
        };
    }
    match at.sub {
        1 if value & INVALID != 0 => Ok(()),
        1 if used && dictionary.get(at) & 0x7FF != value & 0x7FF => Err(Abort::DeviceState),
        1 => {
            let cob_id = u16::try_from(value & 0x1FFF_FFFF).unwrap_or(u16::MAX);
            if cob_id > 0x7FF || is_restricted(cob_id) { Err(Abort::Value) } else { Ok(()) }
        }
        2 if (241..=253).contains(&value) => Err(Abort::Value),
        3 if used => Err(Abort::DeviceState),
        _ => Ok(()),
    }
}

fn check_mapping(
    dictionary: &Dictionary,
    direction: Direction,
    mapping: u16,
    count: i64,
) -> Result<(), Abort> {
    let mut bytes = 0;
    for sub in (1..=8).take(usize::try_from(count).unwrap_or(0)) {
        let entry = u32::try_from(dictionary.get(object(mapping, sub))).unwrap_or(0);
        let (_, kind) = dictionary.mapped(entry, direction.mappable())?;
        bytes += kind.bytes();
    }
    if bytes <= 8 { Ok(()) } else { Err(Abort::MappingLength) }
}

/// The PDOs of one direction that are in use.
pub(crate) fn in_use(dictionary: &Dictionary, direction: Direction) -> Vec<Pdo> {
    let (parameters, mapping) = direction.bases();
    let mut pdos = Vec::new();
    for number in 0..u16::from(COUNT) {
        let cob_id = dictionary.get(object(parameters + number, 1));
        if cob_id & INVALID != 0 {
            continue;
        }
        let count = usize::try_from(dictionary.get(object(mapping + number, 0))).unwrap_or(0);
        let entry = |sub| {
            let entry = u32::try_from(dictionary.get(object(mapping + number, sub))).unwrap_or(0);
            dictionary.mapped(entry, direction.mappable()).ok()
        };
        pdos.push(Pdo {
            cob_id: u16::try_from(cob_id & 0x7FF).unwrap_or(0),
            transmission: u8::try_from(dictionary.get(object(parameters + number, 2)))
                .unwrap_or(255),
            event_us: 1000 * dictionary.get(object(parameters + number, 5)).unsigned_abs(),
            entries: (1..=8).take(count).filter_map(entry).collect(),
        });
    }
    pdos
}
