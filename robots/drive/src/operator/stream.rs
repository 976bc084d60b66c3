//! Frames of the operator protocol in a stream of bytes, for a socket.
//!
//! ```text
//! 0xC5   length, 1 to 8   bytes   CRC-16 (CCITT) of length and bytes, little-endian
//! ```
//!
//! A reader that is out of step looks for the next 0xC5 with a right checksum.

use crate::crc::Crc16;

/// First byte of a record.
pub const MARK: u8 = 0xC5;

/// Longest record.
pub const LONGEST: usize = 12;

/// Writes a record; gives the bytes used. More than eight bytes are cut off.
#[must_use]
pub fn encode(bytes: &[u8], record: &mut [u8; LONGEST]) -> usize {
    let used = bytes.get(..8).unwrap_or(bytes);
    let len = used.len() as u8;
    let mut crc = Crc16::new();
    crc.add(&[len]);
    crc.add(used);
    let [low, high] = crc.value().to_le_bytes();
    let all = [MARK, len].into_iter().chain(used.iter().copied()).chain([low, high]);
    for (to, from) in record.iter_mut().zip(all) {
        *to = from;
    }
    used.len().saturating_add(4)
}

/// Reads records, byte by byte.
#[derive(Clone, Debug, Default)]
pub struct Reader {
    record: [u8; LONGEST],
    len: usize,
    /// Bytes that belonged to no record.
    pub skipped: u32,
}

impl Reader {
    /// Takes a byte; gives the frame that it completes.
    pub fn push(&mut self, byte: u8) -> Option<([u8; 8], usize)> {
        if let Some(place) = self.record.get_mut(self.len) {
            *place = byte;
            self.len = self.len.saturating_add(1);
        }
        // Each round drops a byte or ends.
        for _ in 0..=LONGEST {
            match self.judge() {
                Judgement::More => return None,
                Judgement::Wrong => self.drop_first(),
                Judgement::Frame(bytes, len) => {
                    self.len = 0;
                    return Some((bytes, len));
                }
            }
        }
        None
    }

    fn judge(&self) -> Judgement {
        let record = self.record.get(..self.len).unwrap_or_default();
        let Some((mark, rest)) = record.split_first() else { return Judgement::More };
        if *mark != MARK {
            return Judgement::Wrong;
        }
        let Some((len, rest)) = rest.split_first() else { return Judgement::More };
        let len = usize::from(*len);
        if !(1..=8).contains(&len) {
            return Judgement::Wrong;
        }
        let Some((bytes, rest)) = rest.split_at_checked(len) else { return Judgement::More };
        let Some((found, _)) = rest.split_first_chunk::<2>() else { return Judgement::More };
        let mut crc = Crc16::new();
        crc.add(&[len as u8]);
        crc.add(bytes);
        if crc.value() != u16::from_le_bytes(*found) {
            return Judgement::Wrong;
        }
        let mut frame = [0; 8];
        for (to, from) in frame.iter_mut().zip(bytes) {
            *to = *from;
        }
        Judgement::Frame(frame, len)
    }

    fn drop_first(&mut self) {
        self.record.rotate_left(1);
        self.len = self.len.saturating_sub(1);
        self.skipped = self.skipped.saturating_add(1);
    }
}

enum Judgement {
    /// Not complete.
    More,
    /// No record begins here.
    Wrong,
    Frame([u8; 8], usize),
}
