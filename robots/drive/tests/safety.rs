//! The safety state machine, enumerated: every state with every input.

use shapebot_drive::safety::{Inputs, REQUESTS, Request, STATES, State};

/// Every combination of inputs.
fn all_inputs() -> impl Iterator<Item = Inputs> {
    let requests = REQUESTS.iter().copied().map(Some).chain([None]);
    requests.flat_map(|request| {
        (0_u32..1 << 10).map(move |bits| {
            let bit = |at: u32| bits & 1 << at != 0;
            Inputs {
                request,
                ready: bit(0),
                enabled: bit(1),
                fault: bit(2),
                can_balance: bit(3),
                upright: bit(4),
                legs_down: bit(5),
                legs_up: bit(6),
                late: bit(7),
                finished: bit(8),
                plan_ready: bit(9),
            }
        })
    })
}

/// All transitions: state, inputs, next state.
fn transitions() -> impl Iterator<Item = (State, Inputs, State)> {
    let every = |state: State| all_inputs().map(move |inputs| (state, inputs, state.next(&inputs)));
    STATES.into_iter().flat_map(every)
}

#[test]
fn there_are_as_many_as_there_should_be() {
    assert_eq!(transitions().count(), 11 * 9 * 1024);
    for state in STATES {
        assert_eq!(State::of(state as u8), Some(state));
    }
    assert_eq!(State::of(11), None);
}

#[test]
fn what_lasts_is_left_for_a_request_a_fault_or_an_end() {
    for (from, inputs, to) in transitions() {
        // A robot without faults can balance.
        let quiet = inputs.request.is_none() && !inputs.fault && inputs.can_balance;
        if from.lasts() && quiet && !inputs.finished {
            assert_eq!(to, from, "{inputs:?}");
        }
    }
    assert_eq!(STATES.into_iter().filter(|state| state.lasts()).count(), 3);
}

#[test]
fn torque_begins_only_when_all_drives_are_enabled_upright_on_the_legs_and_sound() {
    for (from, inputs, to) in transitions() {
        if !from.permits_torque() && to.permits_torque() {
            assert_eq!((from, to), (State::Enabling, State::Rising));
            let sound = inputs.enabled && inputs.can_balance && inputs.upright && inputs.legs_down;
            assert!(sound && !inputs.fault && !inputs.late, "{inputs:?}");
        }
    }
}

#[test]
fn a_fault_commands_the_legs_down_in_the_same_step() {
    for (from, inputs, to) in transitions() {
        if inputs.fault || inputs.request == Some(Request::EmergencyStop) {
            assert!(!to.retracts_legs(), "{from:?} {inputs:?} {to:?}");
        }
        if inputs.request == Some(Request::EmergencyStop) {
            assert!(!to.permits_torque(), "{from:?}");
        }
        if !inputs.can_balance {
            assert!(!to.permits_torque(), "{from:?} {inputs:?} {to:?}");
        }
        if inputs.fault && to.permits_torque() {
            assert_eq!(to, State::FaultLowering, "{from:?}");
        }
    }
}

#[test]
fn nothing_but_a_reset_leaves_a_fault_and_a_reset_enables_nothing() {
    for (from, inputs, to) in transitions() {
        if from == State::FaultDown && to != from {
            assert_eq!((inputs.request, to), (Some(Request::Reset), State::Off));
        }
        if from == State::FaultLowering && to != from {
            assert_eq!(to, State::FaultDown);
        }
        if inputs.request == Some(Request::Reset) && !from.enables_drives() {
            assert!(!to.enables_drives(), "{from:?}");
        }
        if to == State::Enabling && from != to {
            assert_eq!((from, inputs.request), (State::LegsDown, Some(Request::Start)));
        }
    }
}

#[test]
fn torque_and_retracted_legs_imply_enabled_drives() {
    for state in STATES {
        assert!(!state.permits_torque() || state.enables_drives());
        assert!(!state.retracts_legs() || state.permits_torque());
    }
}

/// With a fault that lasts, with and without the ability to balance, each state is at rest with its legs
/// down within two steps once the deadline has passed, and stays there.
#[test]
fn every_state_comes_to_rest() {
    for state in STATES {
        for can_balance in [false, true] {
            for legs_down in [false, true] {
                let inputs =
                    Inputs { fault: true, can_balance, legs_down, late: true, ..Inputs::default() };
                let last = (0..2).fold(state, |state, _| state.next(&inputs));
                assert_eq!(last, State::FaultDown, "{state:?}");
            }
        }
    }
}

/// Asked to stop while all is well, every state gets to the legs.
#[test]
fn every_state_can_be_stopped() {
    for state in STATES {
        let stop = Inputs {
            request: Some(Request::Stop),
            ready: true,
            enabled: true,
            can_balance: true,
            upright: true,
            legs_down: true,
            ..Inputs::default()
        };
        let last = (0..2).fold(state, |state, _| state.next(&stop));
        let expected = match state {
            State::FaultLowering | State::FaultDown => State::FaultDown,
            _ => State::LegsDown,
        };
        assert_eq!(last, expected, "{state:?}");
    }
}

/// The whole way, and every state is reachable from the first.
#[test]
fn every_state_is_reached() {
    let mut reached = vec![State::Off];
    let mut at = 0;
    while let Some(state) = reached.get(at).copied() {
        at += 1;
        for inputs in all_inputs() {
            let next = state.next(&inputs);
            if !reached.contains(&next) {
                reached.push(next);
            }
        }
    }
    assert_eq!(reached.len(), STATES.len());
}

/// Modes are changed one by one, as the diagram shows.
#[test]
fn plans_and_turns_begin_and_end_on_station() {
    for (from, inputs, to) in transitions() {
        if matches!(to, State::Tracking | State::Yawing) && from != to {
            assert_eq!(from, State::StationKeeping);
            assert!(to != State::Tracking || inputs.plan_ready);
        }
        if matches!(from, State::Tracking | State::Yawing) && from != to {
            let ends = [
                State::StationKeeping,
                State::LegsLowering,
                State::FaultLowering,
                State::FaultDown,
            ];
            assert!(ends.contains(&to), "{to:?}");
        }
    }
}
