//! LAWICEL's ASCII protocol ("slcan"): lines to frames and back, without heap.
//!
//! A line is a letter and hexadecimal digits up to a carriage return. Frames are `tiiildd…` (11-bit
//! identifier), `Tiiiiiiiildd…` (29-bit), `riiil` and `Riiiiiiiil` (remote), from an adapter optionally
//! with four digits of milliseconds after the data. An adapter answers a carriage return if it agrees,
//! a bell if not.

use core::fmt;

use embedded_can::{ExtendedId, Id, StandardId};
use shapebot_drive::Frame;

/// Longest line: a 29-bit frame with eight bytes and a time stamp.
const LINE: usize = 1 + 8 + 1 + 16 + 4;

/// A line, or the answer that a line gets.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Text {
    bytes: [u8; LINE + 1],
    length: usize,
}

impl Text {
    const EMPTY: Self = Self { bytes: [0; LINE + 1], length: 0 };

    /// The characters.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }

    pub(super) fn of(text: &[u8]) -> Self {
        let mut line = Self::EMPTY;
        for byte in text {
            line.push(*byte);
        }
        line
    }

    /// False if there is no more room.
    fn push(&mut self, byte: u8) -> bool {
        let Some(place) = self.bytes.get_mut(self.length) else { return false };
        *place = byte;
        self.length += 1;
        true
    }

    fn push_hexadecimal(&mut self, value: u32, digits: u32) {
        for k in (0..digits).rev() {
            let digit = (value >> (4 * k)) & 0xF;
            let letter = char::from_digit(digit, 16).unwrap_or('0').to_ascii_uppercase();
            self.push(u8::try_from(letter).unwrap_or(b'0'));
        }
    }
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\"", self.as_bytes().escape_ascii())
    }
}

/// What a [`Decoder`] makes of the bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token {
    /// A line without its carriage return.
    Line(Text),
    /// A bell: the adapter refused.
    Bell,
    /// A line that was longer than any line can be; it is left out.
    TooLong,
}

/// Bytes to lines. Holds one line at most, whatever comes in.
#[derive(Clone, Debug)]
pub struct Decoder {
    line: Text,
    too_long: bool,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { line: Text::EMPTY, too_long: false }
    }
}

impl Decoder {
    /// Takes a byte; a token if the byte ends one. Line feeds are left out.
    pub fn push(&mut self, byte: u8) -> Option<Token> {
        match byte {
            b'\r' => {
                let token = if self.too_long { Token::TooLong } else { Token::Line(self.line) };
                *self = Self::default();
                Some(token)
            }
            0x07 => {
                *self = Self::default();
                Some(Token::Bell)
            }
            b'\n' => None,
            _ => {
                self.too_long |= self.line.length >= LINE || !self.line.push(byte);
                None
            }
        }
    }
}

/// A line that is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// The first letter is no command.
    UnknownCommand,
    /// A digit is missing or none.
    Digit,
    /// The identifier has too many bits.
    Identifier,
    /// More than eight bytes.
    Length,
    /// Characters after the end.
    Trailing,
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::UnknownCommand => "unknown command",
            Self::Digit => "a hexadecimal digit is missing",
            Self::Identifier => "the identifier has too many bits",
            Self::Length => "more than eight bytes",
            Self::Trailing => "characters after the end of the line",
        })
    }
}

impl core::error::Error for LineError {}

/// What a host asks of an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Nothing: an empty line.
    Nothing,
    /// `Sn`: one of the nine bit rates, [`BITRATES`].
    Bitrate(u8),
    /// `sxxyy`: bit timing registers.
    Timing(u16),
    /// `O`: open the channel.
    Open,
    /// `L`: open it for listening only.
    Listen,
    /// `C`: close it.
    Close,
    /// A frame to send.
    Send(Frame),
    /// `F`: status flags.
    Status,
    /// `V` or `v`: version.
    Version,
    /// `N`: serial number.
    Serial,
    /// `Z0` or `Z1`: time stamps.
    Timestamps(bool),
    /// `Mxxxxxxxx`, `mxxxxxxxx`, `Wn`, `Xn`, `Un`, `Qn`: acceptance filter, polling, settings of the port.
    Setting,
}

/// What an adapter says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// An empty line: done.
    Done,
    /// `z` or `Z`: the frame was taken for sending.
    Sent,
    /// A frame from the bus, with its time stamp in ms if there is one.
    Frame(Frame, Option<u16>),
    /// `Fxx`: status flags, [`STATUS_BUS_ERROR`] and others.
    Status(u8),
    /// `V…` or `N…`: version or serial number.
    Information(Text),
}

/// Bit rates of `S0` to `S8`, bit/s.
pub const BITRATES: [u32; 9] =
    [10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000];

/// Status flag: the receive queue is full.
pub const STATUS_RECEIVE_FULL: u8 = 1 << 0;
/// Status flag: the transmit queue is full.
pub const STATUS_TRANSMIT_FULL: u8 = 1 << 1;
/// Status flag: an error counter passed 95.
pub const STATUS_WARNING: u8 = 1 << 2;
/// Status flag: data overrun.
pub const STATUS_OVERRUN: u8 = 1 << 3;
/// Status flag: error-passive.
pub const STATUS_PASSIVE: u8 = 1 << 5;
/// Status flag: bus error, which here means bus-off.
pub const STATUS_BUS_ERROR: u8 = 1 << 7;

/// A frame as a line with its carriage return; `timestamp` in ms.
#[must_use]
pub fn encode(frame: &Frame, timestamp: Option<u16>) -> Text {
    let mut line = Text::EMPTY;
    let remote = frame.is_remote();
    match frame.id() {
        Id::Standard(id) => {
            line.push(if remote { b'r' } else { b't' });
            line.push_hexadecimal(u32::from(id.as_raw()), 3);
        }
        Id::Extended(id) => {
            line.push(if remote { b'R' } else { b'T' });
            line.push_hexadecimal(id.as_raw(), 8);
        }
    }
    line.push_hexadecimal(u32::try_from(frame.len()).unwrap_or(8), 1);
    for byte in frame.bytes() {
        line.push_hexadecimal(u32::from(*byte), 2);
    }
    if let Some(milliseconds) = timestamp {
        line.push_hexadecimal(u32::from(milliseconds), 4);
    }
    line.push(b'\r');
    line
}

/// The answer to `F`, with its carriage return.
#[must_use]
pub fn encode_status(flags: u8) -> Text {
    let mut line = Text::of(b"F");
    line.push_hexadecimal(u32::from(flags), 2);
    line.push(b'\r');
    line
}

/// A short text as a line with its carriage return.
#[must_use]
pub fn encode_text(text: &[u8]) -> Text {
    let mut line = Text::of(text.get(..LINE).unwrap_or(text));
    line.push(b'\r');
    line
}

/// What a host's line asks for.
///
/// # Errors
///
/// [`LineError`]; an adapter answers with a bell.
pub fn command(line: &Text) -> Result<Command, LineError> {
    let Some((letter, rest)) = line.as_bytes().split_first() else { return Ok(Command::Nothing) };
    let mut digits = Digits(rest);
    let command = match letter {
        b't' | b'T' | b'r' | b'R' => Command::Send(frame(*letter, &mut digits)?),
        b'S' => match digits.number(1)? {
            rate @ 0..=8 => Command::Bitrate(u8::try_from(rate).unwrap_or(8)),
            _ => return Err(LineError::Digit),
        },
        b's' => Command::Timing(u16::try_from(digits.number(4)?).unwrap_or(0)),
        b'O' => Command::Open,
        b'L' => Command::Listen,
        b'C' => Command::Close,
        b'F' => Command::Status,
        b'V' | b'v' => Command::Version,
        b'N' => Command::Serial,
        b'Z' => Command::Timestamps(digits.number(1)? != 0),
        b'M' | b'm' => digits.number(8).map(|_| Command::Setting)?,
        b'W' | b'X' | b'U' | b'Q' => digits.number(1).map(|_| Command::Setting)?,
        _ => return Err(LineError::UnknownCommand),
    };
    digits.end().map(|()| command)
}

/// What an adapter's line says.
///
/// # Errors
///
/// [`LineError`]; a host leaves such a line out.
pub fn reply(line: &Text) -> Result<Reply, LineError> {
    let Some((letter, rest)) = line.as_bytes().split_first() else { return Ok(Reply::Done) };
    let mut digits = Digits(rest);
    let reply = match letter {
        // Some adapters put their `z` before the next frame without a carriage return between.
        b'z' | b'Z' => Reply::Sent,
        b't' | b'T' | b'r' | b'R' => {
            let frame = frame(*letter, &mut digits)?;
            let stamp = if digits.0.is_empty() { None } else { Some(digits.number(4)?) };
            Reply::Frame(frame, stamp.map(|ms| u16::try_from(ms).unwrap_or(u16::MAX)))
        }
        b'F' => Reply::Status(u8::try_from(digits.number(2)?).unwrap_or(0)),
        b'V' | b'v' | b'N' => return Ok(Reply::Information(*line)),
        _ => return Err(LineError::UnknownCommand),
    };
    digits.end().map(|()| reply)
}

fn frame(letter: u8, digits: &mut Digits<'_>) -> Result<Frame, LineError> {
    let id = if letter.is_ascii_lowercase() {
        let raw = u16::try_from(digits.number(3)?).unwrap_or(u16::MAX);
        Id::Standard(StandardId::new(raw).ok_or(LineError::Identifier)?)
    } else {
        let raw = digits.number(8)?;
        Id::Extended(ExtendedId::new(raw).ok_or(LineError::Identifier)?)
    };
    let length = usize::try_from(digits.number(1)?).unwrap_or(usize::MAX);
    if letter.eq_ignore_ascii_case(&b'r') {
        return Frame::remote(id, length).ok_or(LineError::Length);
    }
    let mut data = [0; 8];
    let bytes = data.get_mut(..length).ok_or(LineError::Length)?;
    for byte in bytes.iter_mut() {
        *byte = u8::try_from(digits.number(2)?).unwrap_or(0);
    }
    Frame::checked(id, bytes).ok_or(LineError::Length)
}

/// Hexadecimal digits that are left of a line.
struct Digits<'a>(&'a [u8]);

impl Digits<'_> {
    fn number(&mut self, digits: u32) -> Result<u32, LineError> {
        let mut value = 0_u32;
        for _ in 0..digits {
            let (first, rest) = self.0.split_first().ok_or(LineError::Digit)?;
            let digit = char::from(*first).to_digit(16).ok_or(LineError::Digit)?;
            value = (value << 4) | digit;
            self.0 = rest;
        }
        Ok(value)
    }

    const fn end(&self) -> Result<(), LineError> {
        if self.0.is_empty() { Ok(()) } else { Err(LineError::Trailing) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapebot_drive::{extended, standard};

    fn lines(bytes: &[u8]) -> Vec<Token> {
        let mut decoder = Decoder::default();
        bytes.iter().filter_map(|byte| decoder.push(*byte)).collect()
    }

    fn line(text: &str) -> Text {
        Text::of(text.as_bytes())
    }

    #[test]
    fn lines_of_the_manual_are_read_as_the_manual_says() {
        // LAWICEL CAN232/CANUSB manual: `t10021133`, `T0000010021133`, `r1002`, `R000001002`.
        let bytes = [0x11, 0x33];
        let short = Frame::new(0x100, &bytes);
        let long = Frame::checked(extended(0x100).unwrap(), &bytes).unwrap();
        assert_eq!(command(&line("t10021133")), Ok(Command::Send(short)));
        assert_eq!(command(&line("T0000010021133")), Ok(Command::Send(long)));
        let remote = Frame::remote(standard(0x100).unwrap(), 2).unwrap();
        assert_eq!(command(&line("r1002")), Ok(Command::Send(remote)));
        let remote = Frame::remote(extended(0x100).unwrap(), 2).unwrap();
        assert_eq!(command(&line("R000001002")), Ok(Command::Send(remote)));
        assert_eq!(encode(&short, None).as_bytes(), b"t10021133\r");
        assert_eq!(encode(&long, None).as_bytes(), b"T0000010021133\r");
        assert_eq!(encode(&short, Some(0x0A3C)).as_bytes(), b"t100211330A3C\r");
    }

    #[test]
    fn settings_are_read() {
        let cases = [
            ("", Command::Nothing),
            ("S8", Command::Bitrate(8)),
            ("s031C", Command::Timing(0x031C)),
            ("O", Command::Open),
            ("L", Command::Listen),
            ("C", Command::Close),
            ("Z1", Command::Timestamps(true)),
            ("M00000000", Command::Setting),
        ];
        for (text, expected) in cases {
            assert_eq!(command(&line(text)), Ok(expected), "{text}");
        }
    }

    #[test]
    fn bad_lines_are_refused_with_their_reason() {
        let cases = [
            ("t8000", LineError::Identifier),
            ("T200000000", LineError::Identifier),
            ("t1009", LineError::Length),
            ("t10021", LineError::Digit),
            ("t1002112", LineError::Digit),
            ("t10g0", LineError::Digit),
            ("t100211330", LineError::Trailing),
            ("S9", LineError::Digit),
            ("OO", LineError::Trailing),
            ("?", LineError::UnknownCommand),
        ];
        for (text, expected) in cases {
            let found = command(&line(text)).unwrap_err();
            assert_eq!(found, expected, "{text}");
        }
    }

    #[test]
    fn replies_are_told_apart() {
        let found = lines(b"\r\x07z\rF80\rt0800\rV1013\r");
        assert_eq!(found.len(), 6);
        let replies: Vec<_> = found
            .iter()
            .map(|token| match token {
                Token::Line(text) => reply(text).ok(),
                _ => None,
            })
            .collect();
        assert_eq!(replies[0], Some(Reply::Done));
        assert_eq!(replies[1], None);
        assert_eq!(replies[2], Some(Reply::Sent));
        assert_eq!(replies[3], Some(Reply::Status(STATUS_BUS_ERROR)));
        assert_eq!(replies[4], Some(Reply::Frame(Frame::new(0x80, &[]), None)));
    }

    #[test]
    fn a_line_without_end_is_left_out_and_the_next_one_read() {
        let mut bytes = vec![b't'; 100_000];
        bytes.extend_from_slice(b"\rt0800\r");
        let expected = [Token::TooLong, Token::Line(line("t0800"))];
        assert_eq!(lines(&bytes), expected);
    }

    #[test]
    fn the_longest_line_fits() {
        let frame = Frame::checked(extended(0x1FFF_FFFF).unwrap(), &[0xFF; 8]).unwrap();
        let text = encode(&frame, Some(u16::MAX));
        assert_eq!(text.as_bytes(), b"T1FFFFFFF8FFFFFFFFFFFFFFFFFFFF\r");
        let [Token::Line(back)] = lines(text.as_bytes())[..] else { panic!("one line") };
        assert_eq!(reply(&back), Ok(Reply::Frame(frame, Some(u16::MAX))));
    }
}
