//! What comes of an injection.

use crate::Touchdown;
use crate::campaign::Expect;
use shapebot_drive::safety::State;
use shapebot_drive::{Fault, FaultRecord};
use shapebot_nodes::PowerState;
use std::fmt;

/// Something that must hold and did not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Violation {
    /// A motor's torque is above its limit.
    Torque {
        /// Motor, in the order of the description's drives.
        motor: usize,
        /// N·m.
        torque: f64,
        /// N·m.
        limit: f64,
        /// µs since the injection.
        at: u64,
    },
    /// The master commands torque in a state that does not permit it.
    Commanded {
        /// The state.
        state: State,
        /// µs since the injection.
        at: u64,
    },
    /// A drive gives torque that is not in "operation enabled".
    NotEnabled {
        /// The motor.
        motor: usize,
        /// The drive's state.
        state: PowerState,
        /// µs since the injection.
        at: u64,
    },
    /// A drive gives torque too long after the state that permitted it.
    TorqueRemains {
        /// The motor.
        motor: usize,
        /// µs since the state ended.
        after: u64,
    },
    /// The fault was not noticed.
    NotNoticed,
    /// It was noticed late.
    Late {
        /// Cycles since its first effect.
        cycles: f64,
    },
    /// Something that is nothing was taken for a fault.
    NotTolerated(Fault),
    /// The lean went astray, rad.
    Lean(f64),
    /// The legs were told late, or not at all.
    Legs {
        /// µs since the state with legs up ended.
        after: Option<u64>,
    },
    /// A state followed that needs a reset.
    Enabled(State),
    /// The robot was set up in spite of the fault.
    NotBlocked(State),
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torque { motor, torque, limit, at } => {
                write!(f, "motor {motor} gives {torque:.3} N·m of {limit:.3} after {at} µs")
            }
            Self::Commanded { state, at } => write!(f, "torque in {state:?} after {at} µs"),
            Self::NotEnabled { motor, state, at } => {
                write!(f, "motor {motor} gives torque in {state:?} after {at} µs")
            }
            Self::TorqueRemains { motor, after } => {
                write!(f, "motor {motor} gives torque {after} µs after the end")
            }
            Self::NotNoticed => write!(f, "not noticed"),
            Self::Late { cycles } => write!(f, "noticed after {cycles:.2} cycles"),
            Self::NotTolerated(fault) => write!(f, "taken for {fault:?}"),
            Self::Lean(lean) => write!(f, "lean astray by {:.2}°", lean.to_degrees()),
            Self::Legs { after: Some(micros) } => write!(f, "legs told after {micros} µs"),
            Self::Legs { after: None } => write!(f, "legs not told"),
            Self::Enabled(state) => write!(f, "{state:?} without a reset"),
            Self::NotBlocked(state) => write!(f, "set up, and in {state:?}"),
        }
    }
}

/// How an injection went.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The checkpoint.
    pub checkpoint: String,
    /// The case.
    pub case: String,
    /// Safety state at the injection.
    pub state: State,
    /// What had to follow.
    pub expect: Expect,
    /// The first fault that was noticed.
    pub noticed: Option<FaultRecord>,
    /// Cycles from the first SYNC after the injection to that.
    pub cycles: Option<f64>,
    /// From the end of a state with legs up to the legs' command, µs.
    pub legs_us: Option<u64>,
    /// How the legs met the floor.
    pub touchdown: Option<Touchdown>,
    /// The state in the end.
    pub end: State,
    /// What did not hold.
    pub violations: Vec<Violation>,
}

impl Verdict {
    /// Checkpoint and case.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}; {}", self.checkpoint, self.case)
    }
}
