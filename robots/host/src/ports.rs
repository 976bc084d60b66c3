//! The drive's ports.

use crate::{Error, Options};
use shapebot_bus::{Bus, Wired};
use shapebot_drive::DriveTable;

/// Opens the port of each bus of the drive.
///
/// # Errors
///
/// [`Error::Usage`] unless each bus has one port; what opening says.
pub fn open(table: &DriveTable<'_>, options: &Options) -> Result<Wired, Error> {
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
            return Err(Error::Usage(format!("one `--bus {}=PORT` is needed", bus.name)));
        };
        buses.push(port.open(bus.bit_rate)?);
    }
    Ok(Wired::new(buses))
}
