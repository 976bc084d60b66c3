//! The numbers of a PDO, one by one: what readers say of a node.

use super::Measurement;
use super::node::NodeState;
use crate::legs::LegsState;
use crate::object::DataType;
use crate::table::{Entry, Pdo, Signal};

/// Straight-line code that reads the bytes of one PDO, in their order.
///
/// `shapebot-drive-build` writes one for each transmit PDO; without one the master goes through the
/// PDO's entries, with the same result.
pub type Reader = fn(&[u8; 8], &mut Readings<'_>);

/// A number of a PDO with its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    kind: DataType,
    /// Extended to 32 bits by its sign.
    raw: u32,
}

/// From each type of object.
macro_rules! count_from {
    ($($integer:ty => $kind:ident),*) => {$(
        impl From<$integer> for Count {
            #[inline(always)]
            fn from(value: $integer) -> Self {
                Self { kind: DataType::$kind, raw: value as u32 }
            }
        }
    )*};
}
count_from!(i8 => I8, i16 => I16, i32 => I32, u8 => U8, u16 => U16, u32 => U32);

impl Count {
    #[inline(always)]
    fn single(self) -> f32 {
        self.kind.single(self.raw)
    }

    /// The most negative number stands for "no value".
    #[inline(always)]
    fn is_none(self) -> bool {
        self.kind.lowest() == Some(self.raw)
    }
}

/// Where the numbers of a node's PDO go; see [`Signal`] for each.
///
/// `scale` is the SI value of one count, with the sign that turns the node's direction into that of the
/// signal.
#[derive(Debug)]
pub struct Readings<'m> {
    pub(super) node: &'m mut NodeState,
    pub(super) measurement: &'m mut Measurement,
    /// Numbers that stand for no value.
    pub(super) invalid: u8,
}

impl Readings<'_> {
    /// [`Signal::Statusword`].
    #[inline(always)]
    pub fn statusword(&mut self, count: impl Into<Count>) {
        self.node.set_statusword(count.into().raw as u16);
    }

    /// [`Signal::ModeDisplay`].
    #[inline(always)]
    pub fn mode_display(&mut self, count: impl Into<Count>) {
        self.node.set_mode(count.into().raw as i8);
    }

    /// [`Signal::ErrorRegister`].
    #[inline(always)]
    pub fn error_register(&mut self, count: impl Into<Count>) {
        self.node.set_error_register(count.into().raw as u8);
    }

    /// [`Signal::Position`]: adds what the object went since it last came, across its own wrap.
    #[inline(always)]
    pub fn position(&mut self, count: impl Into<Count>, scale: f32) {
        let (Count { kind, raw }, node) = (count.into(), &mut *self.node);
        let step = match node.counts {
            None => kind.value(raw),
            Some(last) => kind.way(last, raw).into(),
        };
        node.counts = Some(raw);
        node.unit = scale;
        node.travel = node.travel.wrapping_add(step);
    }

    /// [`Signal::Velocity`].
    #[inline(always)]
    pub fn velocity(&mut self, count: impl Into<Count>, scale: f32) {
        self.node.velocity = Some(count.into().single() * scale);
    }

    /// [`Signal::ActualTorque`].
    #[inline(always)]
    pub fn actual_torque(&mut self, count: impl Into<Count>, scale: f32) {
        self.node.torque = count.into().single() * scale;
    }

    /// [`Signal::Coordinate`], by its index in q.
    #[inline(always)]
    pub fn coordinate(&mut self, index: usize, count: impl Into<Count>, scale: f32) {
        let count = count.into();
        if self.is_value(count) {
            self.measurement.set_position(index, count.kind.value(count.raw), scale);
            self.measurement.set_age(index, 0);
        }
    }

    /// [`Signal::Rate`], by its index in q.
    #[inline(always)]
    pub fn rate(&mut self, index: usize, count: impl Into<Count>, scale: f32) {
        let count = count.into();
        if self.is_value(count) {
            self.measurement.set_velocity(index, count.single() * scale);
        }
    }

    /// [`Signal::Heading`].
    #[inline(always)]
    pub fn heading(&mut self, count: impl Into<Count>, scale: f32) {
        let count = count.into();
        if self.is_value(count) {
            self.measurement.heading = count.single() * scale;
        }
    }

    /// [`Signal::HeadingRate`].
    #[inline(always)]
    pub fn heading_rate(&mut self, count: impl Into<Count>, scale: f32) {
        let count = count.into();
        if self.is_value(count) {
            self.measurement.heading_rate = count.single() * scale;
        }
    }

    /// [`Signal::Yaw`].
    #[inline(always)]
    pub fn yaw(&mut self, count: impl Into<Count>, scale: f32) {
        let count = count.into();
        if self.is_value(count) {
            self.measurement.yaw = count.single() * scale;
        }
    }

    /// [`Signal::Sequence`].
    #[inline(always)]
    pub fn sequence(&mut self, count: impl Into<Count>) {
        let (sequence, node) = (count.into().raw as u8, &mut *self.node);
        let same = node.sequence == Some(sequence);
        node.stale = if same { node.stale.saturating_add(1) } else { 0 };
        node.sequence = Some(sequence);
    }

    /// [`Signal::Health`].
    #[inline(always)]
    pub fn health(&mut self, count: impl Into<Count>) {
        self.node.health = count.into().raw as u8;
    }

    /// [`Signal::LegsState`].
    #[inline(always)]
    pub fn legs_state(&mut self, count: impl Into<Count>) {
        self.node.legs = Some(LegsState(count.into().raw as u8));
    }

    #[inline(always)]
    fn is_value(&mut self, count: Count) -> bool {
        let none = count.is_none();
        self.invalid = self.invalid.wrapping_add(none.into());
        !none
    }

    /// All numbers of a PDO, as its entries say.
    pub(super) fn interpret(&mut self, pdo: &Pdo, data: &[u8; 8]) {
        let mut rest = &data[..];
        for entry in pdo.entries() {
            let Some(count) = next(&mut rest, entry.kind) else { break };
            self.take(entry, count);
        }
    }

    fn take(&mut self, entry: &Entry, count: Count) {
        let scale = entry.scale;
        match entry.signal {
            Signal::Statusword => self.statusword(count),
            Signal::ModeDisplay => self.mode_display(count),
            Signal::ErrorRegister => self.error_register(count),
            Signal::Position => self.position(count, scale),
            Signal::Velocity => self.velocity(count, scale),
            Signal::ActualTorque => self.actual_torque(count, scale),
            Signal::Health => self.health(count),
            Signal::LegsState => self.legs_state(count),
            Signal::Sequence => self.sequence(count),
            Signal::Coordinate(index) => self.coordinate(index.into(), count, scale),
            Signal::Rate(index) => self.rate(index.into(), count, scale),
            Signal::Heading => self.heading(count, scale),
            Signal::HeadingRate => self.heading_rate(count, scale),
            Signal::Yaw => self.yaw(count, scale),
            Signal::Gap
            | Signal::Controlword
            | Signal::Mode
            | Signal::Torque
            | Signal::LegsCommand => {}
        }
    }
}

/// The next number of a type in a frame's bytes; `None` after their end.
fn next(rest: &mut &[u8], kind: DataType) -> Option<Count> {
    Some(match kind {
        DataType::I8 => i8::from_le_bytes(chunk(rest)?).into(),
        DataType::I16 => i16::from_le_bytes(chunk(rest)?).into(),
        DataType::I32 => i32::from_le_bytes(chunk(rest)?).into(),
        DataType::U8 => u8::from_le_bytes(chunk(rest)?).into(),
        DataType::U16 => u16::from_le_bytes(chunk(rest)?).into(),
        DataType::U32 => u32::from_le_bytes(chunk(rest)?).into(),
    })
}

fn chunk<const BYTES: usize>(rest: &mut &[u8]) -> Option<[u8; BYTES]> {
    let (own, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*own)
}
