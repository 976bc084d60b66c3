//! Names of buses, as a user gives them.

use crate::Error;
#[cfg(unix)]
use shapebot_bus::serial::Serial;
#[cfg(unix)]
use shapebot_bus::slcan::Adapter;
use shapebot_bus::{BAUD, Bus, PortName, Recorded, Slowed, Wired};
use shapebot_drive_build::DriveDescription;
use std::io::Write;
use std::path::PathBuf;

#[derive(Clone, Debug, PartialEq, Eq)]
enum Port {
    /// One that is there.
    Named(PortName),
    /// A new pseudo-terminal.
    Terminal,
}

/// Opens a port for a bus of a description.
type Opener<'o> = dyn FnMut(&Port, &shapebot_drive_build::Bus) -> Result<Box<dyn Bus>, Error> + 'o;

/// Which buses a drive is on: `virtual`, or for each bus of the drive a port: `vcan0`, `/dev/ttyACM0`,
/// `/dev/pts/3`, for simulated nodes also `pty`, which makes a new pseudo-terminal. Several ports are
/// separated by commas, in the order of the description or as `drive=vcan0,body=vcan1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BusList {
    /// None: virtual time.
    ports: Option<Vec<Port>>,
    /// How many times slower time runs than that of the computer.
    slow: u32,
}

impl BusList {
    /// Reads a list for the buses of a drive.
    ///
    /// # Errors
    ///
    /// [`Error::Buses`] for names that the drive does not have, and for too few or too many ports.
    pub fn parse(text: &str, description: &DriveDescription) -> Result<Self, Error> {
        if text == "virtual" {
            return Ok(Self { ports: None, slow: 1 });
        }
        let names: Vec<&str> = description.buses.iter().map(|bus| bus.name.as_str()).collect();
        let all = names.join(", ");
        let mut ports: Vec<Option<Port>> = vec![None; names.len()];
        for (place, item) in text.split(',').enumerate() {
            let (index, port) = match item.split_once('=') {
                Some((name, port)) => (names.iter().position(|known| *known == name), port),
                None => (Some(place), item),
            };
            let slot = index
                .and_then(|index| ports.get_mut(index))
                .ok_or_else(|| Error::Buses(format!("`{item}`: the drive's buses are {all}")))?;
            if port.is_empty() || slot.replace(port_of(port)).is_some() {
                return Err(Error::Buses(format!("`{item}`: one port for each bus of {all}")));
            }
        }
        let ports: Option<Vec<Port>> = ports.into_iter().collect();
        let missing = || Error::Buses(format!("`{text}`: a port for each bus of {all} expected"));
        Ok(Self { ports: Some(ports.ok_or_else(missing)?), slow: 1 })
    }

    /// The same with time that runs `factor` times slower, on both sides of the buses.
    ///
    /// # Errors
    ///
    /// [`Error::Buses`] in virtual time, which waits for nobody.
    pub fn slowed(self, factor: u32) -> Result<Self, Error> {
        if factor > 1 && self.is_virtual() {
            return Err(Error::Buses("virtual time cannot be slowed: no bus is named".to_owned()));
        }
        Ok(Self { slow: factor, ..self })
    }

    /// Whether the buses are in this process and in virtual time.
    #[must_use]
    pub const fn is_virtual(&self) -> bool {
        self.ports.is_none()
    }

    /// Opens the ports as the master does; frames are logged as candump does if there is a log.
    ///
    /// # Errors
    ///
    /// [`Error::Buses`] in virtual time; what opening says.
    pub fn open<W>(&self, description: &DriveDescription, log: Option<&W>) -> Result<Wired, Error>
    where
        W: Write + Clone + 'static,
    {
        let mut open = |port: &Port, bus: &shapebot_drive_build::Bus| match port {
            Port::Named(name) => Ok(name.open(bus.bit_rate)?),
            Port::Terminal => Err(Error::Buses("`pty` is for simulated nodes".to_owned())),
        };
        self.all(description, log, &mut open)
    }

    /// Opens the ports for simulated nodes. Also gives the paths of pseudo-terminals that were made, to
    /// be opened by a master.
    ///
    /// # Errors
    ///
    /// Those of [`Self::open`].
    pub fn open_nodes<W>(
        &self,
        description: &DriveDescription,
        log: Option<&W>,
    ) -> Result<(Wired, Vec<String>), Error>
    where
        W: Write + Clone + 'static,
    {
        let mut paths = Vec::new();
        let mut open = |port: &Port, bus: &shapebot_drive_build::Bus| match port {
            Port::Named(name @ PortName::Interface(_)) => Ok(name.open(bus.bit_rate)?),
            Port::Named(PortName::Serial(path)) => adapter(Some(path)).map(|(bus, _)| bus),
            Port::Terminal => adapter(None).map(|(bus, path)| {
                paths.push(path);
                bus
            }),
        };
        let wired = self.all(description, log, &mut open)?;
        Ok((wired, paths))
    }

    fn all<W>(
        &self,
        description: &DriveDescription,
        log: Option<&W>,
        open: &mut Opener<'_>,
    ) -> Result<Wired, Error>
    where
        W: Write + Clone + 'static,
    {
        let ports = self.ports.as_ref();
        let ports = ports.ok_or_else(|| Error::Buses("virtual buses have no ports".to_owned()))?;
        let mut buses: Vec<Box<dyn Bus>> = Vec::new();
        for (port, bus) in ports.iter().zip(&description.buses) {
            let opened = open(port, bus)?;
            let opened: Box<dyn Bus> =
                if self.slow > 1 { Box::new(Slowed::new(opened, self.slow)) } else { opened };
            buses.push(match log {
                Some(log) => Box::new(Recorded::new(opened, log.clone(), &bus.name)),
                None => opened,
            });
        }
        Ok(Wired::new(buses))
    }
}

fn port_of(text: &str) -> Port {
    match text {
        "pty" => Port::Terminal,
        name => Port::Named(name.into()),
    }
}

#[cfg(unix)]
fn adapter(path: Option<&PathBuf>) -> Result<(Box<dyn Bus>, String), Error> {
    let port = match path {
        Some(path) => Serial::open(path, BAUD)?,
        None => Serial::pseudo_terminal()?,
    };
    let place = port.path().to_owned();
    Ok((Box::new(Adapter::new(port, &place)), place))
}

#[cfg(not(unix))]
fn adapter(_: Option<&PathBuf>) -> Result<(Box<dyn Bus>, String), Error> {
    Err(Error::Buses("serial ports are for Unix".to_owned()))
}
