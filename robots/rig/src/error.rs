//! What can go wrong on a rig.

use shapebot_bus::BusError;
use shapebot_drive::safety::State;
use shapebot_drive::{FaultRecord, Faults};
use shapebot_planner::value::FileError;
use std::fmt;

/// Why a rig cannot be built, or a run did not come to its end.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The drive is for a robot with another number of coordinates.
    Coordinates {
        /// Those of the drive.
        found: usize,
        /// Those of the robot.
        expected: usize,
    },
    /// More coordinates than a drive has telemetry of.
    TooLarge {
        /// Those of the robot.
        coordinates: usize,
    },
    /// The task, or what it says of its simulation, does not fit the robot.
    Task(shapebot_experiments::Error),
    /// The simulated plant is refused.
    Plant(shapebot_sim::Error),
    /// Buses that do not fit the drive, or cannot be opened as they are named.
    Buses(String),
    /// A bus failed.
    Bus(BusError),
    /// The runtime refuses its parts.
    Runtime(shapebot_runtime::Error),
    /// The plan is not one of the robot.
    Plan(FileError),
    /// The loop under an operator ended.
    #[cfg(target_os = "linux")]
    Loop(shapebot_host::Error),
    /// A state was not reached in time.
    Late {
        /// The state that was waited for.
        wanted: State,
        /// The state that the robot is in.
        state: State,
        /// Faults of the drive.
        faults: Faults,
        /// Index of the node and step of its set-up that failed.
        failed_step: Option<(u8, u16)>,
    },
    /// The request was refused in this state.
    Refused(State),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Coordinates { found, expected } => {
                write!(f, "the drive has {found} coordinates, the robot {expected}")
            }
            Self::TooLarge { coordinates } => {
                write!(f, "a drive has telemetry of 8 coordinates, the robot has {coordinates}")
            }
            Self::Task(error) => write!(f, "{error}"),
            Self::Plant(error) => write!(f, "{error}"),
            Self::Buses(what) => f.write_str(what),
            Self::Bus(error) => write!(f, "{error}"),
            Self::Runtime(error) => write!(f, "{error}"),
            Self::Plan(error) => write!(f, "{error}"),
            #[cfg(target_os = "linux")]
            Self::Loop(error) => write!(f, "{error}"),
            Self::Late { wanted, state, faults, failed_step } => {
                write!(f, "the robot is in {state:?}, not in {wanted:?}")?;
                if let Some(FaultRecord { fault, node, detail, .. }) = faults.first() {
                    write!(f, ": {fault:?}")?;
                    if let Some(node) = node {
                        write!(f, " of node {node}")?;
                    }
                    write!(f, " ({detail:#x})")?;
                }
                match failed_step {
                    Some((node, step)) => write!(f, ", set-up of node {node} at step {step}"),
                    None => Ok(()),
                }
            }
            Self::Refused(state) => write!(f, "refused in state {state:?}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Bus(error) => Some(error),
            Self::Runtime(error) => Some(error),
            Self::Plan(error) => Some(error),
            #[cfg(target_os = "linux")]
            Self::Loop(error) => Some(error),
            _ => None,
        }
    }
}

impl From<shapebot_experiments::Error> for Error {
    fn from(error: shapebot_experiments::Error) -> Self {
        Self::Task(error)
    }
}

impl From<shapebot_sim::Error> for Error {
    fn from(error: shapebot_sim::Error) -> Self {
        Self::Plant(error)
    }
}

impl From<BusError> for Error {
    fn from(error: BusError) -> Self {
        Self::Bus(error)
    }
}

impl From<shapebot_runtime::Error> for Error {
    fn from(error: shapebot_runtime::Error) -> Self {
        Self::Runtime(error)
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::Plan(error)
    }
}

#[cfg(target_os = "linux")]
impl From<shapebot_host::Error> for Error {
    fn from(error: shapebot_host::Error) -> Self {
        Self::Loop(error)
    }
}
