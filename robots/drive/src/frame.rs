//! A classical CAN frame.

use embedded_can::{ExtendedId, Id, StandardId};

/// A CAN 2.0 frame: identifier and up to eight bytes, or a remote request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    id: Id,
    remote: bool,
    len: u8,
    data: [u8; 8],
}

impl Frame {
    /// A data frame with an 11-bit identifier. Bits above the eleventh are cut off, and so are bytes
    /// after the eighth: for identifiers and lengths that are known to fit. [`Self::checked`] refuses.
    #[must_use]
    pub fn new(id: u16, bytes: &[u8]) -> Self {
        let id = StandardId::new(id & 0x7FF).unwrap_or(StandardId::ZERO);
        let mut frame = Self { id: Id::Standard(id), remote: false, len: 0, data: [0; 8] };
        for (to, from) in frame.data.iter_mut().zip(bytes) {
            *to = *from;
            frame.len += 1;
        }
        frame
    }

    /// A data frame of the first `len` bytes, at most eight; the identifier as in [`Self::new`].
    pub(crate) fn of(id: u16, data: [u8; 8], len: u8) -> Self {
        let id = StandardId::new(id & 0x7FF).unwrap_or(StandardId::ZERO);
        Self { id: Id::Standard(id), remote: false, len: len.min(8), data }
    }

    /// A data frame with any identifier, or `None` if there are more than eight bytes.
    #[must_use]
    pub fn checked(id: Id, bytes: &[u8]) -> Option<Self> {
        (bytes.len() <= 8).then(|| Self { id, ..Self::new(0, bytes) })
    }

    /// A remote request for `len` bytes, or `None` for more than eight.
    #[must_use]
    pub fn remote(id: Id, len: usize) -> Option<Self> {
        let len = u8::try_from(len).ok().filter(|len| *len <= 8)?;
        Some(Self { id, remote: true, len, data: [0; 8] })
    }

    /// Identifier.
    #[must_use]
    pub const fn id(&self) -> Id {
        self.id
    }

    /// Identifier if it is an 11-bit one: all that CANopen uses.
    #[must_use]
    pub fn standard_id(&self) -> Option<u16> {
        match self.id {
            Id::Standard(id) => Some(id.as_raw()),
            Id::Extended(_) => None,
        }
    }

    /// Identifier as a number, 11 or 29 bits.
    #[must_use]
    pub fn raw_id(&self) -> u32 {
        match self.id {
            Id::Standard(id) => u32::from(id.as_raw()),
            Id::Extended(id) => id.as_raw(),
        }
    }

    /// The bytes; empty for a remote request.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        let len = if self.remote { 0 } else { usize::from(self.len) };
        self.data.get(..len).unwrap_or(&self.data)
    }

    /// All eight bytes of a data frame, zeros after its own.
    pub(crate) fn data(&self) -> Option<&[u8; 8]> {
        (!self.remote).then_some(&self.data)
    }

    /// Data length code.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len as usize
    }

    /// Whether the data length code is zero.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether this is a remote request.
    #[must_use]
    pub const fn is_remote(&self) -> bool {
        self.remote
    }

    /// The bytes if there are exactly `N` of them and the frame is a data frame.
    #[must_use]
    pub fn exactly<const N: usize>(&self) -> Option<[u8; N]> {
        self.bytes().try_into().ok()
    }
}

impl embedded_can::Frame for Frame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        Self::checked(id.into(), data)
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        Self::remote(id.into(), dlc)
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.len()
    }

    fn data(&self) -> &[u8] {
        self.bytes()
    }
}

/// A 29-bit identifier, or `None` if the number has more bits.
#[must_use]
pub fn extended(id: u32) -> Option<Id> {
    ExtendedId::new(id).map(Id::Extended)
}

/// An 11-bit identifier, or `None` if the number has more bits.
#[must_use]
pub fn standard(id: u16) -> Option<Id> {
    StandardId::new(id).map(Id::Standard)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_hold_at_most_eight_bytes() {
        let id = standard(0x7FF).unwrap();
        assert!(Frame::checked(id, &[0; 9]).is_none());
        assert!(Frame::remote(id, 9).is_none());
        assert!(standard(0x800).is_none());
        assert!(extended(0x2000_0000).is_none());
        let frame = Frame::new(0x181, &[1, 2, 3]);
        assert_eq!(
            (frame.standard_id(), frame.bytes(), frame.len()),
            (Some(0x181), &[1, 2, 3][..], 3)
        );
        assert_eq!(frame.exactly::<3>(), Some([1, 2, 3]));
        assert_eq!(frame.exactly::<2>(), None);
        let remote = Frame::remote(id, 8).unwrap();
        assert_eq!((remote.len(), remote.bytes().len()), (8, 0));
    }
}
