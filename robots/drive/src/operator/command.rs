//! Commands as bytes, both ways.

use super::Refusal;
use crate::crc::Crc16;
use crate::safety::Request;

/// What an operator orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Begins a session.
    Hello,
    /// Asks for another state.
    Ask(Request),
    /// Heading to turn to, rad.
    Heading(f32),
    /// Sets a gain.
    Gain(u8, f32),
    /// Begins the upload of a plan of so many bytes.
    PlanBegin(u32),
    /// Ends it with the CRC-32 of all of its bytes.
    PlanEnd(u32),
    /// Forgets an upload.
    PlanForget,
    /// From now on silence of the operator is a fault while the robot balances, or no more.
    Watch(bool),
}

/// Bytes of the plan in a frame.
pub const CHUNK: usize = 7;

const REQUESTS: [(u8, Request); 8] = [
    (0x01, Request::Start),
    (0x02, Request::Stop),
    (0x03, Request::EmergencyStop),
    (0x04, Request::Reset),
    (0x05, Request::Balance),
    (0x06, Request::KeepStation),
    (0x07, Request::Track),
    (0x08, Request::Yaw),
];

/// The bytes of a command for the drive with this fingerprint.
#[must_use]
pub fn encode(order: Order, sequence: u8, fingerprint: u32) -> [u8; 8] {
    let (opcode, argument) = match order {
        Order::Hello => (0x00, fingerprint),
        Order::Ask(request) => {
            let found = REQUESTS.iter().find(|(_, other)| *other == request);
            (found.map_or(0x03, |(opcode, _)| *opcode), 0)
        }
        Order::Heading(heading) => (0x09, heading.to_bits()),
        Order::PlanBegin(length) => (0x10, length),
        Order::PlanEnd(checksum) => (0x11, checksum),
        Order::PlanForget => (0x12, 0),
        Order::Watch(on) => (0x13, on as u32),
        Order::Gain(index, value) => (0x40 | (index & 0x3F), value.to_bits()),
    };
    let [a, b, c, d] = argument.to_le_bytes();
    let [low, high] = checksum([opcode, sequence, a, b, c, d], fingerprint).to_le_bytes();
    [opcode, sequence, a, b, c, d, low, high]
}

/// The bytes of part `index` of a plan, filled up with zeros.
#[must_use]
pub fn encode_chunk(index: u32, data: &[u8]) -> [u8; 8] {
    let mut bytes = [0; 8];
    let head = 0x80 | (index & 0x7F) as u8;
    for (to, from) in bytes.iter_mut().zip([head].iter().chain(data)) {
        *to = *from;
    }
    bytes
}

fn checksum(bytes: [u8; 6], fingerprint: u32) -> u16 {
    let mut crc = Crc16::new();
    crc.add(&bytes);
    crc.add(&fingerprint.to_le_bytes());
    crc.value()
}

/// A part of a plan: its number modulo 128 and its bytes.
pub(super) fn chunk(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let (head, data) = bytes.split_first()?;
    (bytes.len() == 8 && head & 0x80 != 0).then_some((head & 0x7F, data))
}

/// Command and sequence of eight bytes.
///
/// # Errors
///
/// Length, checksum, opcode.
pub fn decode(bytes: &[u8], fingerprint: u32) -> Result<(Order, u8), Refusal> {
    let &[opcode, sequence, a, b, c, d, low, high] = bytes else {
        return Err(Refusal::Length);
    };
    let own = checksum([opcode, sequence, a, b, c, d], fingerprint);
    if own != u16::from_le_bytes([low, high]) {
        return Err(Refusal::Checksum);
    }
    let argument = u32::from_le_bytes([a, b, c, d]);
    let order = match opcode {
        0x00 if argument == fingerprint => Order::Hello,
        0x00 => return Err(Refusal::Checksum),
        0x09 => Order::Heading(f32::from_bits(argument)),
        0x10 => Order::PlanBegin(argument),
        0x11 => Order::PlanEnd(argument),
        0x12 => Order::PlanForget,
        0x13 => Order::Watch(argument != 0),
        0x40..=0x7F => Order::Gain(opcode & 0x3F, f32::from_bits(argument)),
        _ => {
            let found = REQUESTS.iter().find(|(other, _)| *other == opcode);
            Order::Ask(found.ok_or(Refusal::Opcode)?.1)
        }
    };
    Ok((order, sequence))
}
