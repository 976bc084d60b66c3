//! Logs as `candump -L` writes them: `(seconds.microseconds) interface identifier#data`.

use std::fmt;
use std::io::{BufRead, Read as _, Write};
use std::path::{Path, PathBuf};

use embedded_can::Id;

use crate::{Bus, BusError, Event, EventKind, Frame, Health, Received};

/// Longest line that is read.
const LONGEST: usize = 256;

/// Identifier of an error frame in a log: the error flag and the class "bus error".
const ERROR_FRAME: &str = "20000080#0000000000000000";

/// Who sent a frame, where a log says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Received by the one who logged.
    Received,
    /// Transmitted by the one who logged.
    Transmitted,
}

/// A line of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Time, µs.
    pub time: u64,
    /// Interface.
    pub interface: String,
    /// The frame; `None` for an error frame.
    pub frame: Option<Frame>,
    /// Direction, if it is written.
    pub direction: Option<Direction>,
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, micros) = (self.time / 1_000_000, self.time % 1_000_000);
        write!(f, "({seconds:010}.{micros:06}) {} ", self.interface)?;
        match &self.frame {
            Some(frame) => write_frame(f, frame)?,
            None => f.write_str(ERROR_FRAME)?,
        }
        match self.direction {
            Some(Direction::Received) => f.write_str(" R"),
            Some(Direction::Transmitted) => f.write_str(" T"),
            None => Ok(()),
        }
    }
}

fn write_frame(f: &mut fmt::Formatter<'_>, frame: &Frame) -> fmt::Result {
    match frame.id() {
        Id::Standard(id) => write!(f, "{:03X}#", id.as_raw())?,
        Id::Extended(id) => write!(f, "{:08X}#", id.as_raw())?,
    }
    if frame.is_remote() {
        f.write_str("R")?;
        return if frame.is_empty() { Ok(()) } else { write!(f, "{}", frame.len()) };
    }
    frame.bytes().iter().try_for_each(|byte| write!(f, "{byte:02X}"))
}

/// What is wrong with a log, and where.
#[derive(Debug)]
pub struct LogError {
    /// The log.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: String,
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.what)
    }
}

impl std::error::Error for LogError {}

/// Reads a log; `file` names it in errors. Empty lines are left out.
///
/// # Errors
///
/// [`LogError`] at the first line that is none.
pub fn read(file: &Path, mut input: impl BufRead) -> Result<Vec<Entry>, LogError> {
    let mut entries = Vec::new();
    for line in 1.. {
        let error = |what: String| LogError { file: file.to_owned(), line, what };
        let mut bytes = Vec::new();
        let mut limited = input.by_ref().take(LONGEST as u64);
        limited.read_until(b'\n', &mut bytes).map_err(|e| error(e.to_string()))?;
        if bytes.is_empty() {
            break;
        }
        if bytes.len() == LONGEST {
            return Err(error(format!("longer than {LONGEST} characters")));
        }
        let text = String::from_utf8_lossy(&bytes);
        if !text.trim().is_empty() {
            entries.push(entry(text.trim()).map_err(|what| error(what.to_owned()))?);
        }
    }
    Ok(entries)
}

/// Reads one line.
///
/// # Errors
///
/// What is wrong with it.
pub fn entry(line: &str) -> Result<Entry, &'static str> {
    let mut words = line.split_ascii_whitespace();
    let mut word = || words.next().ok_or("`(time) interface identifier#data` expected");
    let time = time(word()?)?;
    let interface = word()?.to_owned();
    let frame = frame(word()?)?;
    let direction = match words.next() {
        None => None,
        Some("R") => Some(Direction::Received),
        Some("T") => Some(Direction::Transmitted),
        Some(_) => return Err("`R` or `T` expected after the frame"),
    };
    Ok(Entry { time, interface, frame, direction })
}

fn time(word: &str) -> Result<u64, &'static str> {
    const WRONG: &str = "a time such as (0000000012.345678) expected";
    let inside = word.strip_prefix('(').and_then(|w| w.strip_suffix(')')).ok_or(WRONG)?;
    let (seconds, micros) = inside.split_once('.').ok_or(WRONG)?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    if !digits(seconds) || !digits(micros) || micros.len() != 6 {
        return Err(WRONG);
    }
    let seconds: u64 = seconds.parse().map_err(|_| WRONG)?;
    let micros: u64 = micros.parse().map_err(|_| WRONG)?;
    seconds.checked_mul(1_000_000).and_then(|s| s.checked_add(micros)).ok_or(WRONG)
}

fn frame(word: &str) -> Result<Option<Frame>, &'static str> {
    let (id, data) = word.split_once('#').ok_or("`identifier#data` expected")?;
    if data.starts_with('#') {
        return Err("a CAN FD frame, which is not supported");
    }
    let raw = u32::from_str_radix(id, 16).map_err(|_| "a hexadecimal identifier expected")?;
    let id = match id.len() {
        3 => u16::try_from(raw).ok().and_then(shapebot_drive::standard),
        8 if raw & 0x2000_0000 != 0 => return Ok(None),
        8 => shapebot_drive::extended(raw),
        _ => return Err("an identifier of three or eight digits expected"),
    };
    let id = id.ok_or("the identifier has too many bits")?;
    if let Some(length) = data.strip_prefix('R') {
        let length = if length.is_empty() { Ok(0) } else { length.parse() };
        let remote = length.ok().and_then(|length| Frame::remote(id, length));
        return remote.map(Some).ok_or("a remote frame of at most eight bytes expected");
    }
    let mut bytes = Vec::with_capacity(8);
    let digits: Vec<u8> = data.bytes().filter(|byte| *byte != b'.').collect();
    for pair in digits.chunks(2) {
        let text = std::str::from_utf8(pair).ok().filter(|text| text.len() == 2);
        let byte = text.and_then(|text| u8::from_str_radix(text, 16).ok());
        bytes.push(byte.ok_or("pairs of hexadecimal digits expected")?);
    }
    Frame::checked(id, &bytes).map(Some).ok_or("more than eight bytes")
}

/// An observer of a bus in virtual time that logs all frames and error frames. Lines that cannot be
/// written are left out.
pub fn observer<W: Write + Send>(
    mut log: W,
    interface: &str,
) -> impl FnMut(&Event) + Send + use<W> {
    let interface = interface.to_owned();
    move |event| {
        let frame = match event.kind {
            EventKind::Frame { frame, .. } => Some(frame),
            EventKind::Error { .. } => None,
            EventKind::BusOff(_) | EventKind::Recovered(_) => return,
        };
        let entry =
            Entry { time: event.time, interface: interface.clone(), frame, direction: None };
        let _ = writeln!(log, "{entry}");
    }
}

/// A bus whose frames are logged as they are sent and received.
#[derive(Debug)]
pub struct Recorded<B, W> {
    bus: B,
    log: W,
    interface: String,
    unwritten: u64,
}

impl<B: Bus, W: Write> Recorded<B, W> {
    /// Logs `bus` to `log` under the name of an interface.
    #[must_use]
    pub fn new(bus: B, log: W, interface: &str) -> Self {
        Self { bus, log, interface: interface.to_owned(), unwritten: 0 }
    }

    /// Lines that could not be written: a full disk does not stop the bus.
    #[must_use]
    pub const fn unwritten(&self) -> u64 {
        self.unwritten
    }

    /// The bus.
    #[must_use]
    pub const fn bus(&self) -> &B {
        &self.bus
    }

    /// The bus and the log.
    #[must_use]
    pub fn into_parts(self) -> (B, W) {
        (self.bus, self.log)
    }

    fn note(&mut self, time: u64, frame: Frame, direction: Direction) {
        let interface = std::mem::take(&mut self.interface);
        let entry = Entry { time, interface, frame: Some(frame), direction: Some(direction) };
        self.unwritten += u64::from(writeln!(self.log, "{entry}").is_err());
        self.interface = entry.interface;
    }
}

impl<B: Bus, W: Write> Bus for Recorded<B, W> {
    fn now(&self) -> u64 {
        self.bus.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.bus.send(frame)?;
        self.note(self.bus.now(), *frame, Direction::Transmitted);
        Ok(())
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        let received = self.bus.receive(deadline)?;
        if let Some(received) = received {
            self.note(received.time, received.frame, Direction::Received);
        }
        Ok(received)
    }

    fn health(&self) -> Health {
        self.bus.health()
    }
}

/// A log as a bus: what the one who logged received comes in at its time; what is sent goes nowhere.
#[derive(Debug)]
pub struct Replay {
    entries: std::vec::IntoIter<Entry>,
    now: u64,
    sent: u64,
}

impl Replay {
    /// Plays a log in the time of the log. Frames marked as transmitted are left out.
    #[must_use]
    pub fn new(mut entries: Vec<Entry>) -> Self {
        entries.retain(|entry| {
            entry.frame.is_some() && entry.direction != Some(Direction::Transmitted)
        });
        let now = entries.first().map_or(0, |entry| entry.time);
        Self { entries: entries.into_iter(), now, sent: 0 }
    }

    /// Whether the log is over.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.entries.as_slice().is_empty()
    }

    /// Frames sent to nowhere.
    #[must_use]
    pub const fn sent(&self) -> u64 {
        self.sent
    }
}

impl Bus for Replay {
    fn now(&self) -> u64 {
        self.now
    }

    fn send(&mut self, _: &Frame) -> Result<(), BusError> {
        self.sent += 1;
        Ok(())
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        let due = self.entries.as_slice().first().is_some_and(|entry| entry.time <= deadline);
        let next = if due { self.entries.next() } else { None };
        let Some((entry, frame)) = next.and_then(|entry| entry.frame.map(|frame| (entry, frame)))
        else {
            self.now = self.now.max(deadline);
            return Ok(None);
        };
        self.now = self.now.max(entry.time);
        Ok(Some(Received { frame, time: entry.time }))
    }
}
