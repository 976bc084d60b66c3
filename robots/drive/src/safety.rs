//! The safety state machine, as a pure function.
//!
//! Torque off is not safe on a robot that balances: it falls. Safe is legs on the floor *and* torque
//! off; the way there goes through [`State::LegsLowering`] while the drives can balance, and straight
//! down if they cannot.
//!
//! ```text
//! Off → LegsDown → Enabling → Rising → Balancing ⇄ StationKeeping ⇄ Tracking, Yawing
//!          ↑                    └───────────┴───────────┴──────────────────┴→ LegsLowering → LegsDown
//!          └─ Off ← reset ─ FaultDown ← FaultLowering ← a fault while the robot can balance
//!                               └← any other fault in any state, and e-stop
//! ```

/// State of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum State {
    /// Nodes are not all there and set up.
    #[default]
    Off = 0,
    /// On the legs, drives ready, no torque.
    LegsDown = 1,
    /// On the legs, drives go to "operation enabled", no torque.
    Enabling = 2,
    /// Balancing while the legs retract.
    Rising = 3,
    /// Balancing.
    Balancing = 4,
    /// Holding a position.
    StationKeeping = 5,
    /// Following a plan.
    Tracking = 6,
    /// Turning to a heading.
    Yawing = 7,
    /// Balancing while the legs come down, as asked for.
    LegsLowering = 8,
    /// Balancing while the legs come down, after a fault and with a deadline.
    FaultLowering = 9,
    /// Legs down or on their way, torque off, until an operator's reset.
    FaultDown = 10,
}

/// All states.
pub const STATES: [State; 11] = [
    State::Off,
    State::LegsDown,
    State::Enabling,
    State::Rising,
    State::Balancing,
    State::StationKeeping,
    State::Tracking,
    State::Yawing,
    State::LegsLowering,
    State::FaultLowering,
    State::FaultDown,
];

/// What an operator asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Rise and balance.
    Start,
    /// Lower the legs and stop.
    Stop,
    /// Torque off and legs down at once.
    EmergencyStop,
    /// Leave [`State::FaultDown`].
    Reset,
    /// Balance without holding a position.
    Balance,
    /// Hold the position.
    KeepStation,
    /// Follow the plan.
    Track,
    /// Turn to the commanded heading.
    Yaw,
}

/// All requests.
pub const REQUESTS: [Request; 8] = [
    Request::Start,
    Request::Stop,
    Request::EmergencyStop,
    Request::Reset,
    Request::Balance,
    Request::KeepStation,
    Request::Track,
    Request::Yaw,
];

/// What the machine looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Inputs {
    /// What an operator asks for.
    pub request: Option<Request>,
    /// All nodes are set up and alive, drives are sound.
    pub ready: bool,
    /// All drives are in "operation enabled" and in their mode.
    pub enabled: bool,
    /// Something is wrong; see [`crate::Fault`].
    pub fault: bool,
    /// Drives and lean sensor are such that the robot can balance.
    pub can_balance: bool,
    /// Lean and its rate are known and small enough to start.
    pub upright: bool,
    /// The legs are on the floor; a robot without legs says yes.
    pub legs_down: bool,
    /// The legs are up; a robot without legs says yes.
    pub legs_up: bool,
    /// The state's own deadline has passed.
    pub late: bool,
    /// Plan or turn is finished.
    pub finished: bool,
    /// There is a plan that begins where the robot is.
    pub plan_ready: bool,
}

impl State {
    /// Whether drives may give torque. In all other states it is zero.
    #[must_use]
    pub const fn permits_torque(self) -> bool {
        matches!(
            self,
            Self::Rising
                | Self::Balancing
                | Self::StationKeeping
                | Self::Tracking
                | Self::Yawing
                | Self::LegsLowering
                | Self::FaultLowering
        )
    }

    /// Whether the legs are told to be up. In all other states they are told to be down.
    #[must_use]
    pub const fn retracts_legs(self) -> bool {
        matches!(
            self,
            Self::Rising | Self::Balancing | Self::StationKeeping | Self::Tracking | Self::Yawing
        )
    }

    /// Whether drives are told to be in "operation enabled".
    #[must_use]
    pub const fn enables_drives(self) -> bool {
        self.permits_torque() || matches!(self, Self::Enabling)
    }

    /// From its number.
    #[must_use]
    pub const fn of(number: u8) -> Option<Self> {
        Some(match number {
            0 => Self::Off,
            1 => Self::LegsDown,
            2 => Self::Enabling,
            3 => Self::Rising,
            4 => Self::Balancing,
            5 => Self::StationKeeping,
            6 => Self::Tracking,
            7 => Self::Yawing,
            8 => Self::LegsLowering,
            9 => Self::FaultLowering,
            10 => Self::FaultDown,
            _ => return None,
        })
    }

    /// Whether it is left for nothing but a request, a fault or the end of a plan.
    #[must_use]
    pub const fn lasts(self) -> bool {
        matches!(self, Self::Balancing | Self::StationKeeping | Self::Tracking)
    }

    /// The next state.
    #[must_use]
    pub const fn next(self, inputs: &Inputs) -> Self {
        if matches!(inputs.request, Some(Request::EmergencyStop)) {
            return Self::FaultDown;
        }
        match self {
            Self::Off => {
                if inputs.fault {
                    Self::FaultDown
                } else if inputs.ready && inputs.legs_down {
                    Self::LegsDown
                } else {
                    Self::Off
                }
            }
            Self::LegsDown => from_legs_down(inputs),
            Self::Enabling => from_enabling(inputs),
            Self::FaultLowering => {
                if !inputs.can_balance || inputs.late || inputs.legs_down {
                    Self::FaultDown
                } else {
                    Self::FaultLowering
                }
            }
            Self::FaultDown => {
                if matches!(inputs.request, Some(Request::Reset)) {
                    Self::Off
                } else {
                    Self::FaultDown
                }
            }
            _ => from_balancing(self, inputs),
        }
    }
}

const fn from_legs_down(inputs: &Inputs) -> State {
    if inputs.fault {
        return State::FaultDown;
    }
    let may_start = inputs.ready && inputs.can_balance && inputs.upright && inputs.legs_down;
    if may_start && matches!(inputs.request, Some(Request::Start)) {
        State::Enabling
    } else {
        State::LegsDown
    }
}

const fn from_enabling(inputs: &Inputs) -> State {
    if inputs.fault || inputs.late {
        State::FaultDown
    } else if matches!(inputs.request, Some(Request::Stop)) {
        State::LegsDown
    } else if inputs.enabled && inputs.can_balance && inputs.upright && inputs.legs_down {
        State::Rising
    } else {
        State::Enabling
    }
}

/// From the states that balance, but for [`State::FaultLowering`].
const fn from_balancing(state: State, inputs: &Inputs) -> State {
    if !inputs.can_balance {
        return State::FaultDown;
    }
    if inputs.fault {
        return State::FaultLowering;
    }
    match state {
        State::LegsLowering => {
            if inputs.legs_down {
                State::LegsDown
            } else if inputs.late {
                State::FaultLowering
            } else {
                State::LegsLowering
            }
        }
        _ if matches!(inputs.request, Some(Request::Stop)) => State::LegsLowering,
        State::Rising => {
            if inputs.legs_up {
                State::Balancing
            } else if inputs.late {
                State::FaultLowering
            } else {
                State::Rising
            }
        }
        _ => moving(state, inputs),
    }
}

/// Between the modes in which the robot stands on its own.
const fn moving(state: State, inputs: &Inputs) -> State {
    match (state, inputs.request) {
        (State::Balancing, Some(Request::KeepStation)) => State::StationKeeping,
        (State::StationKeeping, Some(Request::Balance)) => State::Balancing,
        (State::StationKeeping, Some(Request::Track)) if inputs.plan_ready => State::Tracking,
        (State::StationKeeping, Some(Request::Yaw)) => State::Yawing,
        (State::Tracking | State::Yawing, Some(Request::KeepStation)) => State::StationKeeping,
        (State::Tracking | State::Yawing, _) if inputs.finished => State::StationKeeping,
        _ => state,
    }
}
