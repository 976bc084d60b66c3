//! A frame as the bits on the wire: classical CAN, ISO 11898-1.
//!
//! Start of frame, identifier, control field, data and the 15-bit CRC are stuffed: after five equal
//! bits the sender inserts their complement. What follows (CRC delimiter, ACK slot and delimiter, seven
//! bits end of frame) and the three bits intermission are not.

use embedded_can::{Frame, Id};

/// Generator polynomial of the CRC of classical CAN, x¹⁵ + x¹⁴ + x¹⁰ + x⁸ + x⁷ + x⁴ + x³ + 1, without
/// its leading term.
const CRC_POLYNOMIAL: u16 = 0x4599;

/// CRC delimiter, ACK slot, ACK delimiter and end of frame.
pub const TAIL_BITS: u32 = 10;

/// Bits between two frames.
pub const INTERMISSION_BITS: u32 = 3;

/// An error flag with the flags of the other nodes after it (6 to 12 bits; the longest is assumed) and
/// the error delimiter.
pub const ERROR_FRAME_BITS: u32 = 12 + 8;

/// Bits of a frame before stuffing, from start of frame to the end of the CRC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sequence {
    /// The bits; the last one sent is the least significant.
    bits: u128,
    length: u32,
}

impl Sequence {
    const EMPTY: Self = Self { bits: 0, length: 0 };

    fn push(&mut self, value: u32, width: u32) {
        self.bits = (self.bits << width) | u128::from(value);
        self.length += width;
    }

    fn iter(self) -> impl Iterator<Item = bool> {
        (0..self.length).rev().map(move |k| (self.bits >> k) & 1 == 1)
    }

    fn crc(self) -> u16 {
        self.iter().fold(0, |crc, bit| {
            let feedback = bit != (crc & 0x4000 != 0);
            ((crc << 1) & 0x7fff) ^ if feedback { CRC_POLYNOMIAL } else { 0 }
        })
    }
}

/// The bits that decide arbitration, then DLC and data: start of frame to the last data bit.
fn header_and_data<F: Frame>(frame: &F) -> Sequence {
    let mut sequence = Sequence::EMPTY;
    sequence.push(0, 1);
    let remote = u32::from(frame.is_remote_frame());
    match frame.id() {
        Id::Standard(id) => {
            sequence.push(u32::from(id.as_raw()), 11);
            // RTR; then IDE and r0, both dominant.
            sequence.push(remote, 1);
            sequence.push(0, 2);
        }
        Id::Extended(id) => {
            sequence.push(id.as_raw() >> 18, 11);
            // SRR and IDE, both recessive; after the rest of the identifier RTR, r1 and r0.
            sequence.push(0b11, 2);
            sequence.push(id.as_raw() & 0x3_ffff, 18);
            sequence.push(remote, 1);
            sequence.push(0, 2);
        }
    }
    let length = frame.dlc().min(8);
    sequence.push(u32::try_from(length).unwrap_or(8), 4);
    if !frame.is_remote_frame() {
        for byte in frame.data().iter().take(8) {
            sequence.push(u32::from(*byte), 8);
        }
    }
    sequence
}

fn stuffed_region<F: Frame>(frame: &F) -> Sequence {
    let mut sequence = header_and_data(frame);
    sequence.push(u32::from(sequence.crc()), 15);
    sequence
}

/// The 15-bit CRC of a frame.
#[must_use]
pub fn crc<F: Frame>(frame: &F) -> u16 {
    header_and_data(frame).crc()
}

/// The stuffed part of a frame as it is on the wire, start of frame first; `true` is recessive.
#[cfg(feature = "std")]
#[must_use]
pub fn stuffed<F: Frame>(frame: &F) -> Vec<bool> {
    let region = stuffed_region(frame);
    let mut wire = Vec::with_capacity(160);
    let (mut last, mut run) = (true, 0);
    for bit in region.iter() {
        run = if bit == last { run + 1 } else { 1 };
        last = bit;
        wire.push(bit);
        if run == 5 {
            last = !bit;
            run = 1;
            wire.push(last);
        }
    }
    wire
}

/// Number of stuff bits in a frame.
#[must_use]
pub fn stuff_bits<F: Frame>(frame: &F) -> u32 {
    stuff_bits_of(stuffed_region(frame))
}

fn stuff_bits_of(region: Sequence) -> u32 {
    let (mut last, mut run, mut count) = (true, 0, 0);
    for bit in region.iter() {
        run = if bit == last { run + 1 } else { 1 };
        last = bit;
        if run == 5 {
            last = !bit;
            run = 1;
            count += 1;
        }
    }
    count
}

/// Bits from start of frame to the end of frame, stuffing included, intermission not.
#[must_use]
pub fn frame_bits<F: Frame>(frame: &F) -> u32 {
    let region = stuffed_region(frame);
    region.length + stuff_bits_of(region) + TAIL_BITS
}

/// Bits that a frame takes of the bus: stuffing and intermission included.
#[must_use]
pub fn bus_bits<F: Frame>(frame: &F) -> u32 {
    frame_bits(frame) + INTERMISSION_BITS
}

/// The most bits that a standard data frame of `length` bytes can take of the bus, whatever it holds:
/// 47 + 8 n + ⌊(34 + 8 n − 1) / 4⌋.
#[must_use]
pub const fn worst_case_bits(length: u32) -> u32 {
    47 + 8 * length + (34 + 8 * length - 1) / 4
}

/// The arbitration field as a number: of two frames that start together the smaller one goes on.
///
/// A data frame wins against the remote frame of its identifier, a standard frame against the extended
/// frames with the same first eleven bits.
#[must_use]
pub fn arbitration<F: Frame>(frame: &F) -> u64 {
    let remote = u64::from(frame.is_remote_frame());
    match frame.id() {
        Id::Standard(id) => (u64::from(id.as_raw()) << 21) | (remote << 20),
        Id::Extended(id) => {
            let (base, rest) = (id.as_raw() >> 18, id.as_raw() & 0x3_ffff);
            (u64::from(base) << 21) | (0b11 << 19) | (u64::from(rest) << 1) | remote
        }
    }
}

/// The first bit, counted from start of frame on the wire, in which two frames differ.
#[cfg(feature = "std")]
pub(crate) fn first_difference<F: Frame>(a: &F, b: &F) -> Option<u32> {
    let (a, b) = (stuffed(a), stuffed(b));
    let position = a.iter().zip(&b).position(|(x, y)| x != y)?;
    u32::try_from(position).ok()
}

#[cfg(test)]
mod tests {
    use super::{Sequence, bus_bits, stuffed, worst_case_bits};
    use crate::Frame;
    use embedded_can::ExtendedId;

    fn text(bits: &[bool]) -> String {
        bits.iter().map(|bit| if *bit { '1' } else { '0' }).collect()
    }

    #[test]
    fn crc_has_the_check_value_of_the_catalogue() {
        let mut sequence = Sequence::EMPTY;
        for byte in b"123456789" {
            sequence.push(u32::from(*byte), 8);
        }
        assert_eq!(sequence.crc(), 0x059e, "CRC-15/CAN");
    }

    #[test]
    fn a_frame_of_zeros_has_the_bits_counted_by_hand() {
        // 1 + 11 + 1 + 1 + 1 + 4 zeros, whose CRC is zero: 34 zeros, a one after every fifth.
        let frame = Frame::new(0, &[]);
        let wire = text(&stuffed(&frame));
        assert_eq!(wire, "000001".repeat(6) + "0000");
        assert_eq!(bus_bits(&frame), 34 + 6 + 10 + 3);
    }

    #[test]
    fn eight_bytes_of_zeros_have_the_bits_counted_by_hand() {
        // 15 zeros, the DLC 1000, 64 zeros, then the CRC: three stuff bits before the one of the DLC and
        // thirteen in the 67 zeros after it.
        let frame = Frame::new(0, &[0; 8]);
        let wire = text(&stuffed(&frame));
        let head = "000001".repeat(3) + "1" + &"000001".repeat(13) + "00";
        assert!(wire.starts_with(&head), "{wire}");
        assert!(bus_bits(&frame) <= worst_case_bits(8));
    }

    #[test]
    fn worst_cases_are_the_55_95_and_135_bits_of_the_bus_budget() {
        assert_eq!([0, 4, 8].map(worst_case_bits), [55, 95, 135]);
    }

    #[test]
    fn extended_frames_are_twenty_bits_longer_before_stuffing() {
        let id = ExtendedId::new(0x1555_5555).unwrap();
        let frame = Frame::checked(id.into(), &[0x55; 8]).unwrap();
        assert_eq!(super::stuffed_region(&frame).length, 34 + 64 + 20);
    }
}
