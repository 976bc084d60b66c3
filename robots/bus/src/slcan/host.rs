//! The host's side of slcan.

use std::collections::VecDeque;
use std::io::{Read, Write};

use super::codec::{
    BITRATES, Reply, STATUS_BUS_ERROR, STATUS_PASSIVE, Token, encode, encode_text, reply,
};
use super::lines::{Lines, Wait};
use crate::{Bus, BusError, ErrorState, Frame, Health, Received};

/// Frames that wait to be taken at most.
const INBOX: usize = 256;

/// The bus behind a serial adapter.
///
/// The port's reads and writes must not block: they say `WouldBlock` or `TimedOut` when nothing can be
/// done now.
#[derive(Debug)]
pub struct Slcan<P: Read + Write + Wait> {
    lines: Lines<P>,
    inbox: VecDeque<Received>,
    health: Health,
    refused: u64,
    unreadable: u64,
}

impl<P: Read + Write + Wait> Slcan<P> {
    /// Closes the adapter's channel if it is open, sets the bit rate and opens it. `place` names the
    /// port in errors.
    ///
    /// # Errors
    ///
    /// [`BusError::Unsupported`] for a bit rate that is not one of [`BITRATES`]; errors of the port.
    pub fn open(port: P, place: &str, bitrate: u32) -> Result<Self, BusError> {
        let code = BITRATES.iter().zip(b'0'..).find(|(rate, _)| **rate == bitrate);
        let (_, digit) = code.ok_or(BusError::Unsupported("this bit rate"))?;
        let mut bus = Self::attach(port, place);
        for line in [&b""[..], b"C", &[b'S', digit], b"O"] {
            bus.lines.write(&encode_text(line))?;
        }
        Ok(bus)
    }

    /// Takes an adapter as it is, its channel open already.
    #[must_use]
    pub fn attach(port: P, place: &str) -> Self {
        let lines = Lines::new(port, place);
        Self { lines, inbox: VecDeque::new(), health: Health::default(), refused: 0, unreadable: 0 }
    }

    /// Lines that the adapter refused with a bell.
    #[must_use]
    pub const fn refused(&self) -> u64 {
        self.refused
    }

    /// Lines from the adapter that are none of the protocol's.
    #[must_use]
    pub const fn unreadable(&self) -> u64 {
        self.unreadable
    }

    /// Asks the adapter for its status flags; the answer shows in [`Bus::health`].
    ///
    /// # Errors
    ///
    /// Errors of the port.
    pub fn ask_status(&mut self) -> Result<(), BusError> {
        self.lines.write(&encode_text(b"F"))
    }

    /// The port.
    #[must_use]
    pub const fn port(&self) -> &P {
        self.lines.port()
    }

    fn read(&mut self) -> Result<bool, BusError> {
        let time = self.lines.now();
        let Self { lines, inbox, health, refused, unreadable } = self;
        lines.read(|token| match token {
            Token::Bell => *refused += 1,
            Token::TooLong => *unreadable += 1,
            Token::Line(text) => match reply(&text) {
                Ok(Reply::Frame(frame, _)) if inbox.len() < INBOX => {
                    inbox.push_back(Received { frame, time });
                }
                Ok(Reply::Frame(..)) => health.overruns += 1,
                Ok(Reply::Status(flags)) => health.state = state(flags),
                Ok(Reply::Done | Reply::Sent | Reply::Information(_)) => {}
                Err(_) => *unreadable += 1,
            },
        })
    }
}

const fn state(flags: u8) -> ErrorState {
    if flags & STATUS_BUS_ERROR != 0 {
        ErrorState::BusOff
    } else if flags & STATUS_PASSIVE != 0 {
        ErrorState::Passive
    } else {
        ErrorState::Active
    }
}

impl<P: Read + Write + Wait> Bus for Slcan<P> {
    fn now(&self) -> u64 {
        self.lines.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.lines.write(&encode(frame, None))
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        loop {
            if let Some(received) = self.inbox.pop_front() {
                return Ok(Some(received));
            }
            self.lines.flush()?;
            if !self.read()? && !self.lines.wait(deadline)? {
                return Ok(None);
            }
        }
    }

    fn health(&self) -> Health {
        self.health
    }

    #[cfg(unix)]
    fn descriptor(&self) -> Option<std::os::fd::BorrowedFd<'_>> {
        self.lines.descriptor()
    }
}
