//! Objects of the dictionary, their types, and the indices that are used (CiA 301, CiA 402).

/// An object: index and sub-index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Object {
    /// Index.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
}

/// An object, short.
#[must_use]
pub const fn object(index: u16, sub: u8) -> Object {
    Object { index, sub }
}

impl Object {
    /// Device type: the low half is the profile, 402 for drives.
    pub const DEVICE_TYPE: Self = object(0x1000, 0);
    /// Error register.
    pub const ERROR_REGISTER: Self = object(0x1001, 0);
    /// COB-ID of SYNC.
    pub const SYNC_COB_ID: Self = object(0x1005, 0);
    /// Communication cycle period, µs.
    pub const CYCLE_PERIOD: Self = object(0x1006, 0);
    /// First consumer heartbeat time: producer's node-ID in bits 16 to 22, milliseconds below.
    pub const CONSUMER_HEARTBEAT: Self = object(0x1016, 1);
    /// Producer heartbeat time, ms.
    pub const PRODUCER_HEARTBEAT: Self = object(0x1017, 0);
    /// Vendor-ID.
    pub const VENDOR: Self = object(0x1018, 1);
    /// Product code.
    pub const PRODUCT: Self = object(0x1018, 2);
    /// Serial number.
    pub const SERIAL: Self = object(0x1018, 4);
    /// Reaction to a lost connection: abort connection option code.
    pub const ABORT_CONNECTION: Self = object(0x6007, 0);
    /// Controlword.
    pub const CONTROLWORD: Self = object(0x6040, 0);
    /// Statusword.
    pub const STATUSWORD: Self = object(0x6041, 0);
    /// Quick stop option code.
    pub const QUICK_STOP_OPTION: Self = object(0x605A, 0);
    /// Shutdown option code.
    pub const SHUTDOWN_OPTION: Self = object(0x605B, 0);
    /// Disable operation option code.
    pub const DISABLE_OPTION: Self = object(0x605C, 0);
    /// Halt option code.
    pub const HALT_OPTION: Self = object(0x605D, 0);
    /// Fault reaction option code.
    pub const FAULT_OPTION: Self = object(0x605E, 0);
    /// Modes of operation.
    pub const MODE: Self = object(0x6060, 0);
    /// Modes of operation display.
    pub const MODE_DISPLAY: Self = object(0x6061, 0);
    /// Position actual value, counts.
    pub const POSITION: Self = object(0x6064, 0);
    /// Velocity actual value.
    pub const VELOCITY: Self = object(0x606C, 0);
    /// Target torque, per mille of rated torque.
    pub const TARGET_TORQUE: Self = object(0x6071, 0);
    /// Max torque, per mille of rated torque.
    pub const MAX_TORQUE: Self = object(0x6072, 0);
    /// Motor rated torque, mN·m.
    pub const RATED_TORQUE: Self = object(0x6076, 0);
    /// Torque actual value, per mille of rated torque.
    pub const ACTUAL_TORQUE: Self = object(0x6077, 0);
    /// Polarity: bit 7 position, bit 6 velocity, bit 5 torque.
    pub const POLARITY: Self = object(0x607E, 0);
    /// Interpolation time period: value.
    pub const INTERPOLATION_VALUE: Self = object(0x60C2, 1);
    /// Interpolation time period: power of ten, seconds.
    pub const INTERPOLATION_EXPONENT: Self = object(0x60C2, 2);

    /// Communication parameters of receive PDO `number`, from 1.
    #[must_use]
    pub const fn receive_parameters(number: u8, sub: u8) -> Self {
        object(0x13FF + number as u16, sub)
    }

    /// Mapping of receive PDO `number`, from 1.
    #[must_use]
    pub const fn receive_mapping(number: u8, sub: u8) -> Self {
        object(0x15FF + number as u16, sub)
    }

    /// Communication parameters of transmit PDO `number`, from 1.
    #[must_use]
    pub const fn transmit_parameters(number: u8, sub: u8) -> Self {
        object(0x17FF + number as u16, sub)
    }

    /// Mapping of transmit PDO `number`, from 1.
    #[must_use]
    pub const fn transmit_mapping(number: u8, sub: u8) -> Self {
        object(0x19FF + number as u16, sub)
    }

    /// The entry of a PDO mapping for this object.
    #[must_use]
    pub const fn mapping(self, kind: DataType) -> u32 {
        ((self.index as u32) << 16) | ((self.sub as u32) << 8) | (8 * kind.bytes() as u32)
    }
}

/// Integer types of objects, little-endian on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DataType {
    /// INTEGER8.
    I8,
    /// INTEGER16.
    I16,
    /// INTEGER32.
    I32,
    /// UNSIGNED8.
    U8,
    /// UNSIGNED16.
    U16,
    /// UNSIGNED32.
    U32,
}

impl DataType {
    /// Bytes on the bus.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 => 4,
        }
    }

    /// Smallest and largest value.
    #[must_use]
    pub const fn range(self) -> (i64, i64) {
        match self {
            Self::I8 => (i8::MIN as i64, i8::MAX as i64),
            Self::I16 => (i16::MIN as i64, i16::MAX as i64),
            Self::I32 => (i32::MIN as i64, i32::MAX as i64),
            Self::U8 => (0, u8::MAX as i64),
            Self::U16 => (0, u16::MAX as i64),
            Self::U32 => (0, u32::MAX as i64),
        }
    }

    /// Whether negative values exist.
    #[must_use]
    pub const fn is_signed(self) -> bool {
        matches!(self, Self::I8 | Self::I16 | Self::I32)
    }

    /// What an extended value is.
    pub(crate) const fn value(self, extended: u32) -> i64 {
        match self {
            Self::U32 => extended as i64,
            _ => extended as i32 as i64,
        }
    }

    /// The same in single precision.
    pub(crate) const fn single(self, extended: u32) -> f32 {
        match self {
            Self::U32 => extended as f32,
            _ => extended as i32 as f32,
        }
    }

    /// The way from one extended value to another, the short one across the type's wrap.
    pub(crate) const fn way(self, from: u32, to: u32) -> i32 {
        let way = to.wrapping_sub(from);
        match self {
            Self::I8 | Self::U8 => way as i8 as i32,
            Self::I16 | Self::U16 => way as i16 as i32,
            Self::I32 | Self::U32 => way as i32,
        }
    }

    /// The most negative value of a signed type, extended.
    pub(crate) const fn lowest(self) -> Option<u32> {
        match self {
            Self::I8 => Some(i8::MIN as u32),
            Self::I16 => Some(i16::MIN as u32),
            Self::I32 => Some(i32::MIN as u32),
            Self::U8 | Self::U16 | Self::U32 => None,
        }
    }

    /// Its object in the dictionary (CiA 301, data types): mapped into a PDO it is a gap, "dummy mapping".
    #[must_use]
    pub const fn dummy(self) -> Object {
        object(
            match self {
                Self::I8 => 2,
                Self::I16 => 3,
                Self::I32 => 4,
                Self::U8 => 5,
                Self::U16 => 6,
                Self::U32 => 7,
            },
            0,
        )
    }

    /// The value whose low bytes, from the first, are given; missing bytes count as zero.
    #[must_use]
    pub fn decode(self, bytes: &[u8]) -> i64 {
        // Byte by byte: a loop becomes a call, for two bytes.
        let at = |index: usize| bytes.get(index).copied().unwrap_or(0);
        let short = || [at(0), at(1)];
        let long = || [at(0), at(1), at(2), at(3)];
        match self {
            Self::I8 => i64::from(at(0) as i8),
            Self::I16 => i64::from(i16::from_le_bytes(short())),
            Self::I32 => i64::from(i32::from_le_bytes(long())),
            Self::U8 => i64::from(at(0)),
            Self::U16 => i64::from(u16::from_le_bytes(short())),
            Self::U32 => i64::from(u32::from_le_bytes(long())),
        }
    }

    /// The value brought into the type's range, little-endian; only [`Self::bytes`] of the four count.
    #[must_use]
    pub fn encode(self, value: i64) -> [u8; 4] {
        let (low, high) = self.range();
        (value.max(low).min(high) as u32).to_le_bytes()
    }

    /// The same for what has 32 bits, with zeros behind the type's own bytes.
    #[inline(always)]
    #[must_use]
    pub fn low_bytes(self, value: i32) -> [u8; 4] {
        let word = match self {
            Self::I8 => value.max(i8::MIN.into()).min(i8::MAX.into()) as u32 & 0xFF,
            Self::I16 => value.max(i16::MIN.into()).min(i16::MAX.into()) as u32 & 0xFFFF,
            Self::I32 => value as u32,
            Self::U8 => value.max(0).min(u8::MAX.into()) as u32,
            Self::U16 => value.max(0).min(u16::MAX.into()) as u32,
            Self::U32 => value.max(0) as u32,
        };
        word.to_le_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_little_endian_and_saturate() {
        assert_eq!(DataType::I16.encode(-2), [0xFE, 0xFF, 0xFF, 0xFF]);
        assert_eq!(DataType::I16.encode(40_000)[..2], [0xFF, 0x7F]);
        assert_eq!(DataType::I16.decode(&[0xFE, 0xFF, 0x12]), -2);
        assert_eq!(DataType::U16.decode(&[0xFE, 0xFF]), 65_534);
        assert_eq!(DataType::I32.decode(&[0, 0, 0, 0x80]), -2_147_483_648);
        assert_eq!(DataType::U8.encode(-1)[0], 0);
        assert_eq!(DataType::I16.low_bytes(-40_000), [0, 0x80, 0, 0]);
        assert_eq!(DataType::U8.low_bytes(300), [255, 0, 0, 0]);
    }

    #[test]
    fn extended_values_keep_their_sign_and_ways_cross_the_wrap() {
        assert_eq!(DataType::U32.value(u32::MAX), i64::from(u32::MAX));
        assert_eq!(DataType::I32.value(u32::MAX), -1);
        assert_eq!(DataType::U32.single(u32::MAX), 4_294_967_296.0);
        assert_eq!(DataType::I16.way(32_000, -32_000_i32 as u32), 1536);
        assert_eq!(DataType::U8.way(3, 250), -9);
        assert_eq!(DataType::I32.way(i32::MIN as u32, i32::MAX as u32), -1);
        assert_eq!(DataType::I8.lowest().map(|low| low as i32), Some(-128));
    }

    #[test]
    fn mapping_entries_are_those_of_the_standard() {
        assert_eq!(Object::TARGET_TORQUE.mapping(DataType::I16), 0x6071_0010);
        assert_eq!(Object::POSITION.mapping(DataType::I32), 0x6064_0020);
        assert_eq!(DataType::I16.dummy().mapping(DataType::I16), 0x0003_0010);
        assert_eq!(Object::receive_parameters(1, 2), object(0x1400, 2));
        assert_eq!(Object::transmit_mapping(2, 0), object(0x1A01, 0));
    }
}
