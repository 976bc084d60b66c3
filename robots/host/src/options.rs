//! The command line of a robot's program.

use crate::Error;
use shapebot_bus::PortName;
use std::path::PathBuf;

/// Usage.
pub const HELP: &str = "\
Options:
  --bus NAME=PORT    port of a bus of the drive, once for each: can0, or a path such as /dev/ttyACM0 (slcan)
  --plan FILE        plan to be followed, as the operator may ask; instead of the built-in one
  --socket PATH      Unix socket for operators
  --priority N       priority of SCHED_FIFO, 1 to 99: 80 if not given
  --ordinary         neither SCHED_FIFO nor locked memory
  --help

SIGTERM and SIGINT bring the robot to rest and lower its legs; a second one switches the torque off.
Exit codes: 0 stopped as asked, 1 stopped at once or failed, 2 wrong usage.";

/// What a robot's program is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Names of buses with their ports.
    pub ports: Vec<(String, PortName)>,
    /// Plan file.
    pub plan: Option<PathBuf>,
    /// Path of the operators' socket.
    pub socket: Option<PathBuf>,
    /// Priority of SCHED_FIFO; `None`: neither that nor locked memory.
    pub priority: Option<u8>,
}

impl Options {
    /// Reads arguments, without the program's name. `None` if help is asked for.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`].
    pub fn parse(arguments: impl IntoIterator<Item = String>) -> Result<Option<Self>, Error> {
        let mut options = Self { ports: Vec::new(), plan: None, socket: None, priority: Some(80) };
        let mut arguments = arguments.into_iter();
        while let Some(argument) = arguments.next() {
            let mut value = || {
                arguments.next().ok_or_else(|| Error::Usage(format!("`{argument}` takes a value")))
            };
            match argument.as_str() {
                "--help" => return Ok(None),
                "--ordinary" => options.priority = None,
                "--bus" => options.ports.push(port(&value()?)?),
                "--plan" => options.plan = Some(value()?.into()),
                "--socket" => options.socket = Some(value()?.into()),
                "--priority" => {
                    let text = value()?;
                    let number = text.parse().ok().filter(|number| (1..=99).contains(number));
                    let wrong = || Error::Usage(format!("priority `{text}` is not in 1 to 99"));
                    options.priority = Some(number.ok_or_else(wrong)?);
                }
                other => return Err(Error::Usage(format!("no option `{other}`"))),
            }
        }
        Ok(Some(options))
    }
}

fn port(text: &str) -> Result<(String, PortName), Error> {
    let parts = text.split_once('=').filter(|(name, port)| !name.is_empty() && !port.is_empty());
    let (name, port) = parts.ok_or_else(|| Error::Usage(format!("`{text}` is not NAME=PORT")))?;
    Ok((name.to_owned(), port.into()))
}

#[cfg(test)]
mod tests {
    use super::Options;
    use shapebot_bus::PortName;

    fn parse(line: &str) -> Result<Option<Options>, String> {
        let parsed = Options::parse(line.split_whitespace().map(str::to_owned));
        parsed.map_err(|error| error.to_string())
    }

    #[test]
    fn ports_are_interfaces_or_paths() {
        let options = parse("--bus a=can0 --bus b=/dev/ttyACM0 --priority 7").unwrap().unwrap();
        let expected = [
            ("a".to_owned(), PortName::Interface("can0".to_owned())),
            ("b".to_owned(), PortName::Serial("/dev/ttyACM0".into())),
        ];
        assert_eq!(options.ports, expected);
        assert_eq!(options.priority, Some(7));
        assert_eq!(parse("--ordinary").unwrap().unwrap().priority, None);
        assert_eq!(parse("--plan x --help"), Ok(None));
    }

    #[test]
    fn each_mistake_is_named() {
        for (line, message) in [
            ("--bus", "`--bus` takes a value"),
            ("--bus can0", "`can0` is not NAME=PORT"),
            ("--priority 0", "priority `0` is not in 1 to 99"),
            ("--plna x", "no option `--plna`"),
        ] {
            assert_eq!(parse(line), Err(message.to_owned()));
        }
    }
}
