//! The adapter's side of slcan.

use std::collections::VecDeque;
use std::io::{Read, Write};

use super::codec::{
    BITRATES, Command, STATUS_RECEIVE_FULL, Text, Token, command, encode, encode_status,
    encode_text,
};
use super::lines::{Lines, Wait};
use crate::{Bus, BusError, Frame, Health, Received};

/// Frames that wait to be taken at most.
const INBOX: usize = 256;

/// What a host sees as a serial CAN adapter; to those on this side it is a bus with the host on it.
///
/// Frames sent while the host's channel is closed, or that the host does not read, are lost, as on an
/// adapter's bus.
#[derive(Debug)]
pub struct Adapter<P: Read + Write + Wait> {
    lines: Lines<P>,
    inbox: VecDeque<Received>,
    channel: Channel,
    overruns: u64,
    lost: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Channel {
    open: bool,
    listen: bool,
    bitrate: u32,
    timestamps: bool,
}

const DONE: &[u8] = b"";
const BELL: u8 = 0x07;

impl<P: Read + Write + Wait> Adapter<P> {
    /// An adapter on a port; `place` names the port in errors.
    #[must_use]
    pub fn new(port: P, place: &str) -> Self {
        let channel = Channel { open: false, listen: false, bitrate: 1_000_000, timestamps: false };
        let lines = Lines::new(port, place);
        Self { lines, inbox: VecDeque::new(), channel, overruns: 0, lost: 0 }
    }

    /// Whether the host has opened the channel.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.channel.open
    }

    /// Bit rate that the host has chosen, bit/s.
    #[must_use]
    pub const fn bitrate(&self) -> u32 {
        self.channel.bitrate
    }

    /// Frames that the host did not take.
    #[must_use]
    pub const fn lost(&self) -> u64 {
        self.lost
    }

    /// The port.
    #[must_use]
    pub const fn port(&self) -> &P {
        self.lines.port()
    }

    fn read(&mut self) -> Result<bool, BusError> {
        let time = self.lines.now();
        let mut tokens = Vec::new();
        let any = self.lines.read(|token| tokens.push(token))?;
        for token in tokens {
            let answer = match token {
                Token::Line(line) => self.obey(&line, time),
                Token::Bell => None,
                Token::TooLong => Some(Text::bell()),
            };
            if let Some(answer) = answer {
                self.answer(&answer)?;
            }
        }
        Ok(any)
    }

    /// A host that does not read its answers loses them.
    fn answer(&mut self, answer: &Text) -> Result<(), BusError> {
        match self.lines.write(answer) {
            Err(BusError::QueueFull { .. }) => {
                self.lost += 1;
                Ok(())
            }
            other => other,
        }
    }

    fn obey(&mut self, line: &Text, time: u64) -> Option<Text> {
        let channel = &mut self.channel;
        let Ok(command) = command(line) else { return Some(Text::bell()) };
        match command {
            Command::Nothing => return None,
            // The bit rate cannot change while the channel is open.
            Command::Bitrate(_) | Command::Timing(_) if channel.open => return Some(Text::bell()),
            Command::Bitrate(code) => {
                channel.bitrate = BITRATES.get(usize::from(code)).copied().unwrap_or(1_000_000);
            }
            Command::Open | Command::Listen if channel.open => return Some(Text::bell()),
            Command::Open => (channel.open, channel.listen) = (true, false),
            Command::Listen => (channel.open, channel.listen) = (true, true),
            Command::Close => channel.open = false,
            Command::Timestamps(on) => channel.timestamps = on,
            Command::Timing(_) | Command::Setting => {}
            Command::Status => {
                let full = self.inbox.len() >= INBOX;
                return Some(encode_status(if full { STATUS_RECEIVE_FULL } else { 0 }));
            }
            Command::Version => return Some(encode_text(b"V1013")),
            Command::Serial => return Some(encode_text(b"NSB01")),
            Command::Send(frame) => return Some(self.take(frame, time)),
        }
        Some(encode_text(DONE))
    }

    fn take(&mut self, frame: Frame, time: u64) -> Text {
        if !self.channel.open || self.channel.listen {
            return Text::bell();
        }
        if self.inbox.len() >= INBOX {
            self.overruns += 1;
            return Text::bell();
        }
        self.inbox.push_back(Received { frame, time });
        encode_text(if frame.standard_id().is_some() { b"z" } else { b"Z" })
    }
}

impl Text {
    fn bell() -> Self {
        Self::of(&[BELL])
    }
}

impl<P: Read + Write + Wait> Bus for Adapter<P> {
    fn now(&self) -> u64 {
        self.lines.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        if !self.channel.open {
            self.lost += 1;
            return Ok(());
        }
        let milliseconds = self.lines.now() / 1000 % 60_000;
        let stamp = self.channel.timestamps.then(|| u16::try_from(milliseconds).unwrap_or(0));
        self.answer(&encode(frame, stamp))
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
        Health { overruns: self.overruns, ..Health::default() }
    }
}
