//! The state machine of CiA 402 as seen from both ends.

/// State of a drive, from its statusword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not ready to switch on.
    NotReady,
    /// Switch on disabled.
    SwitchOnDisabled,
    /// Ready to switch on.
    ReadyToSwitchOn,
    /// Switched on.
    SwitchedOn,
    /// Operation enabled.
    OperationEnabled,
    /// Quick stop active.
    QuickStopActive,
    /// Fault reaction active.
    FaultReactionActive,
    /// Fault.
    Fault,
}

impl State {
    /// From the statusword 0x6041; `None` for a pattern that the standard does not have.
    #[must_use]
    pub const fn of(statusword: u16) -> Option<Self> {
        Some(match (statusword & 0x6F, statusword & 0x4F) {
            (_, 0x00) => Self::NotReady,
            (_, 0x40) => Self::SwitchOnDisabled,
            (0x21, _) => Self::ReadyToSwitchOn,
            (0x23, _) => Self::SwitchedOn,
            (0x27, _) => Self::OperationEnabled,
            (0x07, _) => Self::QuickStopActive,
            (_, 0x0F) => Self::FaultReactionActive,
            (_, 0x08) => Self::Fault,
            _ => return None,
        })
    }

    /// State bits of the statusword, those that the standard leaves open zero.
    #[must_use]
    pub const fn bits(self) -> u16 {
        match self {
            Self::NotReady => 0x00,
            Self::SwitchOnDisabled => 0x40,
            Self::ReadyToSwitchOn => 0x21,
            Self::SwitchedOn => 0x23,
            Self::OperationEnabled => 0x27,
            Self::QuickStopActive => 0x07,
            Self::FaultReactionActive => 0x0F,
            Self::Fault => 0x08,
        }
    }

    /// Whether the drive is in fault or about to be.
    #[must_use]
    pub const fn is_fault(self) -> bool {
        matches!(self, Self::Fault | Self::FaultReactionActive)
    }
}

/// Values of the controlword 0x6040 for the commands of the standard.
pub mod controlword {
    /// Disable voltage.
    pub const DISABLE_VOLTAGE: u16 = 0x00;
    /// Shutdown.
    pub const SHUTDOWN: u16 = 0x06;
    /// Switch on, and disable operation.
    pub const SWITCH_ON: u16 = 0x07;
    /// Enable operation.
    pub const ENABLE_OPERATION: u16 = 0x0F;
    /// Quick stop.
    pub const QUICK_STOP: u16 = 0x02;
    /// Fault reset: acts on the rising edge of this bit.
    pub const FAULT_RESET: u16 = 0x80;
}

/// What the master wants of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// No torque, no voltage.
    Off,
    /// Ready to switch on: no torque.
    Ready,
    /// Operation enabled.
    Enabled,
}

/// The controlword that brings a drive one step nearer to the goal.
///
/// A fault is left only when `reset` is set: then bit 7 rises for one call.
#[must_use]
pub const fn step(state: State, goal: Goal, reset: bool) -> u16 {
    use controlword::{DISABLE_VOLTAGE, ENABLE_OPERATION, FAULT_RESET, SHUTDOWN, SWITCH_ON};
    match (goal, state) {
        (_, State::Fault) if reset => FAULT_RESET,
        (_, State::Fault | State::FaultReactionActive | State::NotReady) => DISABLE_VOLTAGE,
        (Goal::Off, _) | (_, State::QuickStopActive) => DISABLE_VOLTAGE,
        (_, State::SwitchOnDisabled) | (Goal::Ready, _) => SHUTDOWN,
        (Goal::Enabled, State::ReadyToSwitchOn) => SWITCH_ON,
        (Goal::Enabled, State::SwitchedOn | State::OperationEnabled) => ENABLE_OPERATION,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Statuswords of the standard's table, with bits that it leaves open set and cleared.
    #[test]
    fn states_are_those_of_the_standards_table() {
        for (word, state) in [
            (0x0000, State::NotReady),
            (0x0270, State::SwitchOnDisabled),
            (0x0250, State::SwitchOnDisabled),
            (0x0231, State::ReadyToSwitchOn),
            (0x0233, State::SwitchedOn),
            (0x0237, State::OperationEnabled),
            (0x1637, State::OperationEnabled),
            (0x0217, State::QuickStopActive),
            (0x021F, State::FaultReactionActive),
            (0x0218, State::Fault),
            (0x0238, State::Fault),
        ] {
            assert_eq!(State::of(word), Some(state), "{word:#06x}");
        }
        // Operation enabled without switched on.
        assert_eq!(State::of(0x0004), None);
        for state in [State::NotReady, State::SwitchedOn, State::Fault, State::QuickStopActive] {
            assert_eq!(State::of(state.bits()), Some(state));
        }
    }

    #[test]
    fn drives_are_enabled_step_by_step_and_faults_are_reset_on_demand_only() {
        let way = [State::SwitchOnDisabled, State::ReadyToSwitchOn, State::SwitchedOn];
        assert_eq!(way.map(|state| step(state, Goal::Enabled, false)), [0x06, 0x07, 0x0F]);
        assert_eq!(step(State::Fault, Goal::Enabled, false), 0);
        assert_eq!(step(State::Fault, Goal::Ready, true), 0x80);
        assert_eq!(step(State::OperationEnabled, Goal::Ready, false), 0x06);
        assert_eq!(step(State::OperationEnabled, Goal::Off, true), 0);
    }
}
