//! The drive's buses in real time.

use crate::options::PortName;
use crate::{Error, Options};
use shapebot_bus::serial::Serial;
use shapebot_bus::{Bus, BusError, Frame, Received, Slcan};
use shapebot_drive::DriveTable;

/// All buses of a drive, as its master sees them.
pub trait Buses {
    /// Time, µs; it never goes back.
    fn now(&self) -> u64;

    /// Hands a frame to the controller of a bus.
    ///
    /// # Errors
    ///
    /// Those of [`Bus::send`].
    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError>;

    /// The next frame with the number of its bus, or `None` once time has reached `deadline`, µs.
    ///
    /// # Errors
    ///
    /// Those of [`Bus::receive`].
    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError>;
}

/// Baud rate of serial adapters; those on USB do not care.
const BAUD: u32 = 115_200;

/// Longest wait for one of several buses before the others are looked at, µs.
const TURN: u64 = 100;

/// Buses of the system, each with a clock of its own.
pub struct Ports {
    buses: Vec<Box<dyn Bus>>,
    /// Time of each bus when the first one's was zero here.
    starts: Vec<u64>,
}

impl std::fmt::Debug for Ports {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ports").field("buses", &self.buses.len()).finish_non_exhaustive()
    }
}

impl Ports {
    /// Opens a port for each bus of the drive.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`] unless each bus has one port; what opening says.
    pub fn open(table: &DriveTable<'_>, options: &Options) -> Result<Self, Error> {
        let names: Vec<&str> = table.buses.iter().map(|bus| bus.name).collect();
        let strange = options.ports.iter().find(|port| !names.contains(&port.0.as_str()));
        if let Some((name, _)) = strange {
            let all = names.join(", ");
            return Err(Error::Usage(format!("no bus `{name}`: the drive's buses are {all}")));
        }
        let mut buses: Vec<Box<dyn Bus>> = Vec::new();
        for bus in table.buses {
            let mut found = options.ports.iter().filter(|(name, _)| name == bus.name);
            let (Some((_, port)), None) = (found.next(), found.next()) else {
                let message = format!("one `--bus {}=PORT` is needed", bus.name);
                return Err(Error::Usage(message));
            };
            buses.push(open(port, bus.bit_rate)?);
        }
        Ok(Self::new(buses))
    }

    /// Buses in the order of the drive's table; time begins now.
    #[must_use]
    pub fn new(buses: Vec<Box<dyn Bus>>) -> Self {
        let starts = buses.iter().map(|bus| bus.now()).collect();
        Self { buses, starts }
    }

    fn look(&mut self, index: usize, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        let (Some(bus), Some(start)) = (self.buses.get_mut(index), self.starts.get(index)) else {
            return Ok(None);
        };
        let received = bus.receive(start.saturating_add(deadline))?;
        Ok(received.map(|received| {
            (index, Received { time: received.time.saturating_sub(*start), ..received })
        }))
    }
}

fn open(port: &PortName, bit_rate: u32) -> Result<Box<dyn Bus>, Error> {
    match port {
        PortName::Interface(name) => interface(name),
        PortName::Serial(path) => {
            let place = path.display().to_string();
            let port = Serial::open(path, BAUD)?;
            Ok(Box::new(Slcan::open(port, &place, bit_rate)?))
        }
    }
}

#[cfg(feature = "socketcan")]
fn interface(name: &str) -> Result<Box<dyn Bus>, Error> {
    Ok(Box::new(shapebot_bus::SocketBus::open(name)?))
}

#[cfg(not(feature = "socketcan"))]
fn interface(name: &str) -> Result<Box<dyn Bus>, Error> {
    Err(Error::Usage(format!("`{name}`: built without SocketCAN (feature `socketcan`)")))
}

impl Buses for Ports {
    fn now(&self) -> u64 {
        match (self.buses.first(), self.starts.first()) {
            (Some(bus), Some(start)) => bus.now().saturating_sub(*start),
            _ => 0,
        }
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> Result<(), BusError> {
        self.buses.get_mut(bus).ok_or(BusError::UnknownEndpoint(bus))?.send(frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<(usize, Received)>, BusError> {
        loop {
            // What is there already, from each bus.
            for index in 0..self.buses.len() {
                if let Some(found) = self.look(index, 0)? {
                    return Ok(Some(found));
                }
            }
            let now = self.now();
            if now >= deadline || self.buses.is_empty() {
                return Ok(None);
            }
            let until = if self.buses.len() == 1 { deadline } else { deadline.min(now + TURN) };
            if let Some(found) = self.look(0, until)? {
                return Ok(Some(found));
            }
        }
    }
}
