//! Lines over something that reads and writes bytes.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
#[cfg(unix)]
use std::os::fd::BorrowedFd;
use std::time::{Duration, Instant};

use super::codec::{Decoder, Text, Token};
use crate::BusError;

/// Bytes that wait to be written at most.
const OUTBOX: usize = 8192;

/// Waiting for bytes, on ports whose reads do not block.
pub trait Wait {
    /// Returns when bytes may be there, at the latest after `timeout`.
    ///
    /// # Errors
    ///
    /// Whatever the system says.
    fn wait(&self, timeout: Duration) -> io::Result<()>;

    /// What becomes readable when bytes are there, if there is such a thing.
    #[cfg(unix)]
    fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        None
    }
}

/// A port whose reads do not block, asked again after a short sleep.
#[derive(Debug)]
pub struct Sleeping<T>(pub T);

impl<T> Wait for Sleeping<T> {
    fn wait(&self, timeout: Duration) -> io::Result<()> {
        std::thread::sleep(timeout.min(Duration::from_micros(200)));
        Ok(())
    }
}

impl<T: Read> Read for Sleeping<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl<T: Write> Write for Sleeping<T> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Lines in, lines out, and a clock.
#[derive(Debug)]
pub(super) struct Lines<P> {
    port: P,
    place: String,
    decoder: Decoder,
    outbox: VecDeque<u8>,
    start: Instant,
}

impl<P: Read + Write + Wait> Lines<P> {
    pub(super) fn new(port: P, place: &str) -> Self {
        let (decoder, outbox) = (Decoder::default(), VecDeque::new());
        Self { port, place: place.to_owned(), decoder, outbox, start: Instant::now() }
    }

    /// µs since the port was opened.
    pub(super) fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    pub(super) const fn port(&self) -> &P {
        &self.port
    }

    /// Writes a line, or keeps it until the port takes it.
    pub(super) fn write(&mut self, line: &Text) -> Result<(), BusError> {
        let bytes = line.as_bytes();
        self.flush()?;
        if self.outbox.len() + bytes.len() > OUTBOX {
            return Err(BusError::QueueFull { waiting: self.outbox.len() / bytes.len().max(1) });
        }
        self.outbox.extend(bytes);
        self.flush()
    }

    pub(super) fn flush(&mut self) -> Result<(), BusError> {
        while !self.outbox.is_empty() {
            let (head, _) = self.outbox.as_slices();
            match self.port.write(head) {
                Ok(0) => return Err(BusError::Closed(self.place.clone())),
                Ok(count) => drop(self.outbox.drain(..count.min(self.outbox.len()))),
                Err(error) if is_not_now(&error) => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(BusError::io(&self.place, error)),
            }
        }
        Ok(())
    }

    /// Hands the tokens that are there to `take`; false if there were no bytes.
    pub(super) fn read(&mut self, mut take: impl FnMut(Token)) -> Result<bool, BusError> {
        let mut buffer = [0; 512];
        match self.port.read(&mut buffer) {
            Ok(0) => Err(BusError::Closed(self.place.clone())),
            Ok(count) => {
                for byte in buffer.iter().take(count) {
                    self.decoder.push(*byte).into_iter().for_each(&mut take);
                }
                Ok(true)
            }
            Err(error) if is_not_now(&error) || error.kind() == ErrorKind::Interrupted => Ok(false),
            Err(error) => Err(BusError::io(&self.place, error)),
        }
    }

    /// That of the port, unless bytes could not be written and want another try.
    #[cfg(unix)]
    pub(super) fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        if self.outbox.is_empty() { self.port.descriptor() } else { None }
    }

    /// Waits for bytes up to `deadline`, µs; false if it has passed.
    pub(super) fn wait(&self, deadline: u64) -> Result<bool, BusError> {
        let Some(left) = deadline.checked_sub(self.now()).filter(|left| *left > 0) else {
            return Ok(false);
        };
        // Bytes that could not be written want another try soon.
        let most = if self.outbox.is_empty() { left } else { left.min(500) };
        let wait = self.port.wait(Duration::from_micros(most));
        wait.map_err(|error| BusError::io(&self.place, error)).map(|()| true)
    }
}

fn is_not_now(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}
