//! Expedited SDO transfers (CiA 301), the client's side.

use crate::frame::Frame;
use crate::id::NodeId;
use crate::object::{DataType, Object};

/// The request that writes an object.
#[must_use]
pub fn download(node: NodeId, object: Object, kind: DataType, value: u32) -> Frame {
    let command = match kind.bytes() {
        1 => 0x2F,
        2 => 0x2B,
        _ => 0x23,
    };
    let mut bytes = request(command, object);
    for (to, from) in bytes.iter_mut().skip(4).zip(value.to_le_bytes().iter().take(kind.bytes())) {
        *to = *from;
    }
    Frame::new(node.sdo_request(), &bytes)
}

/// The request that reads an object.
#[must_use]
pub fn upload(node: NodeId, object: Object) -> Frame {
    Frame::new(node.sdo_request(), &request(0x40, object))
}

/// The message that ends a transfer.
#[must_use]
pub fn abort(node: NodeId, object: Object, code: u32) -> Frame {
    let mut bytes = request(0x80, object);
    for (to, from) in bytes.iter_mut().skip(4).zip(code.to_le_bytes()) {
        *to = from;
    }
    Frame::new(node.sdo_request(), &bytes)
}

/// Abort code: the protocol timed out.
pub const TIMED_OUT: u32 = 0x0504_0000;

const fn request(command: u8, object: Object) -> [u8; 8] {
    let [low, high] = object.index.to_le_bytes();
    [command, low, high, object.sub, 0, 0, 0, 0]
}

/// What a server answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Written.
    Written(Object),
    /// Read: so many bytes, the rest zero.
    Read {
        /// Which.
        object: Object,
        /// Bytes, 1 to 4; `None` if the server does not say.
        bytes: Option<u8>,
        /// Little-endian.
        value: u32,
    },
    /// Refused.
    Aborted {
        /// Which.
        object: Object,
        /// Why.
        code: u32,
    },
    /// Something else: a segmented transfer, or nonsense.
    Other,
}

/// Reads what a server sent; `None` unless it has eight bytes.
#[must_use]
pub fn answer(frame: &Frame) -> Option<Answer> {
    let [command, low, high, sub, a, b, c, d] = frame.exactly::<8>()?;
    let object = Object { index: u16::from_le_bytes([low, high]), sub };
    let value = u32::from_le_bytes([a, b, c, d]);
    Some(match command {
        0x60 => Answer::Written(object),
        0x42 => Answer::Read { object, bytes: None, value },
        0x43 => Answer::Read { object, bytes: Some(4), value },
        0x47 => Answer::Read { object, bytes: Some(3), value: value & 0x00FF_FFFF },
        0x4B => Answer::Read { object, bytes: Some(2), value: value & 0xFFFF },
        0x4F => Answer::Read { object, bytes: Some(1), value: value & 0xFF },
        0x80 => Answer::Aborted { object, code: value },
        _ => Answer::Other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::object::object;

    /// Bytes as in CiA 301, figures of the expedited transfers.
    #[test]
    fn transfers_are_those_of_the_standard() {
        let node = NodeId::clamped(3);
        let frame = download(node, Object::CYCLE_PERIOD, DataType::U32, 2000);
        assert_eq!(frame.standard_id(), Some(0x603));
        assert_eq!(frame.bytes(), [0x23, 0x06, 0x10, 0x00, 0xD0, 0x07, 0, 0]);
        let frame = download(node, Object::PRODUCER_HEARTBEAT, DataType::U16, 100);
        assert_eq!(frame.bytes(), [0x2B, 0x17, 0x10, 0x00, 0x64, 0, 0, 0]);
        let frame = download(node, Object::MODE, DataType::I8, 0xFFFF_FFFD);
        assert_eq!(frame.bytes(), [0x2F, 0x60, 0x60, 0x00, 0xFD, 0, 0, 0]);
        assert_eq!(upload(node, Object::SERIAL).bytes(), [0x40, 0x18, 0x10, 4, 0, 0, 0, 0]);
        let read = Frame::new(0x583, &[0x4B, 0x17, 0x10, 0, 0x64, 0, 0xFF, 0xFF]);
        let (object, bytes) = (object(0x1017, 0), Some(2));
        assert_eq!(answer(&read), Some(Answer::Read { object, bytes, value: 100 }));
        let aborted = Frame::new(0x583, &[0x80, 0x17, 0x10, 0, 0, 0, 0x02, 0x06]);
        assert_eq!(answer(&aborted), Some(Answer::Aborted { object, code: 0x0602_0000 }));
        assert_eq!(answer(&Frame::new(0x583, &[0x60])), None);
    }
}
