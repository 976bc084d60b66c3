//! What carries commands and telemetry.

use crate::Error;
use shapebot_bus::{Bus, PortName};
use shapebot_drive::operator::stream::{self, LONGEST, Reader};
use shapebot_drive::{Frame, OperatorTable};
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
#[cfg(unix)]
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

/// Carries eight bytes either way.
pub trait Link {
    /// Sends a command.
    ///
    /// # Errors
    ///
    /// Of the socket or bus.
    fn send(&mut self, bytes: &[u8; 8]) -> Result<(), Error>;

    /// Time to leave from part to part of a plan; zero if the link holds back who sends too fast.
    fn pace(&self) -> Duration;

    /// The next page of telemetry, or `None` if none comes in time.
    ///
    /// # Errors
    ///
    /// Of the socket or bus.
    fn receive(&mut self, patience: Duration) -> Result<Option<[u8; 8]>, Error>;
}

impl<L: Link + ?Sized> Link for Box<L> {
    fn send(&mut self, bytes: &[u8; 8]) -> Result<(), Error> {
        (**self).send(bytes)
    }

    fn pace(&self) -> Duration {
        (**self).pace()
    }

    fn receive(&mut self, patience: Duration) -> Result<Option<[u8; 8]>, Error> {
        (**self).receive(patience)
    }
}

/// Frames on the robot's bus.
#[derive(Debug)]
pub struct BusLink<B> {
    bus: B,
    table: OperatorTable,
}

impl<B: Bus> BusLink<B> {
    /// On a bus that is in real time.
    pub const fn new(bus: B, table: OperatorTable) -> Self {
        Self { bus, table }
    }
}

impl<B: Bus> Link for BusLink<B> {
    fn send(&mut self, bytes: &[u8; 8]) -> Result<(), Error> {
        Ok(self.bus.send(&Frame::new(self.table.command, bytes))?)
    }

    /// A bus with motors on it must not be flooded.
    fn pace(&self) -> Duration {
        Duration::from_micros(800)
    }

    fn receive(&mut self, patience: Duration) -> Result<Option<[u8; 8]>, Error> {
        let micros = u64::try_from(patience.as_micros()).unwrap_or(u64::MAX);
        let deadline = self.bus.now().saturating_add(micros);
        while let Some(received) = self.bus.receive(deadline)? {
            if received.frame.standard_id() == Some(self.table.telemetry)
                && let Some(page) = received.frame.exactly::<8>()
            {
                return Ok(Some(page));
            }
        }
        Ok(None)
    }
}

impl BusLink<Box<dyn Bus>> {
    /// On a port: a SocketCAN interface such as `can0`, or the path of a serial adapter that speaks slcan
    /// at this bit rate.
    ///
    /// # Errors
    ///
    /// A port that cannot be opened.
    pub fn open(port: &str, bit_rate: u32, table: OperatorTable) -> Result<Self, Error> {
        Ok(Self::new(PortName::from(port).open(bit_rate)?, table))
    }
}

/// Records of a local socket.
#[cfg(unix)]
#[derive(Debug)]
pub struct SocketLink {
    stream: UnixStream,
    reader: Reader,
    pages: VecDeque<[u8; 8]>,
}

#[cfg(unix)]
impl SocketLink {
    /// Over a stream.
    #[must_use]
    pub fn new(stream: UnixStream) -> Self {
        Self { stream, reader: Reader::default(), pages: VecDeque::new() }
    }

    /// To the socket of a robot on this computer.
    ///
    /// # Errors
    ///
    /// [`Error::Io`].
    pub fn open(path: &std::path::Path) -> Result<Self, Error> {
        Ok(Self::new(UnixStream::connect(path)?))
    }
}

#[cfg(unix)]
impl Link for SocketLink {
    fn send(&mut self, bytes: &[u8; 8]) -> Result<(), Error> {
        let mut record = [0; LONGEST];
        let used = stream::encode(bytes, &mut record);
        Ok(self.stream.write_all(record.get(..used).unwrap_or_default())?)
    }

    fn pace(&self) -> Duration {
        Duration::ZERO
    }

    fn receive(&mut self, patience: Duration) -> Result<Option<[u8; 8]>, Error> {
        let end = Instant::now() + patience;
        while self.pages.is_empty() {
            // A time of zero would mean to wait for ever.
            let rest = end.saturating_duration_since(Instant::now());
            if rest.is_zero() {
                return Ok(None);
            }
            self.stream.set_read_timeout(Some(rest.max(Duration::from_millis(1))))?;
            let mut buffer = [0; 512];
            match self.stream.read(&mut buffer) {
                Ok(0) => return Err(std::io::Error::from(ErrorKind::UnexpectedEof).into()),
                Ok(count) => self.take(buffer.get(..count).unwrap_or_default()),
                Err(error) if again(error.kind()) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(self.pages.pop_front())
    }
}

#[cfg(unix)]
impl SocketLink {
    fn take(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some((page, 8)) = self.reader.push(*byte) {
                self.pages.push_back(page);
            }
        }
    }
}

fn again(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
