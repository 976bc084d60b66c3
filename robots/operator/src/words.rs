//! Numbers of the protocol in words.

use shapebot_drive::Fault;
use shapebot_drive::operator::Refusal;
use shapebot_drive::safety::{Request, STATES, State};

/// Requests by the names that an operator types.
const REQUESTS: [(&str, Request); 8] = [
    ("start", Request::Start),
    ("stop", Request::Stop),
    ("e-stop", Request::EmergencyStop),
    ("reset", Request::Reset),
    ("balance", Request::Balance),
    ("keep-station", Request::KeepStation),
    ("track", Request::Track),
    ("yaw", Request::Yaw),
];

/// The request of a name.
#[must_use]
pub fn request(name: &str) -> Option<Request> {
    REQUESTS.iter().find(|(known, _)| *known == name).map(|(_, request)| *request)
}

/// A state's number in words.
#[must_use]
pub fn state(number: u8) -> &'static str {
    let known = STATES.iter().find(|state| **state as u8 == number);
    known.map_or("unknown state", |state| match state {
        State::Off => "off",
        State::LegsDown => "legs down",
        State::Enabling => "enabling",
        State::Rising => "rising",
        State::Balancing => "balancing",
        State::StationKeeping => "keeping station",
        State::Tracking => "tracking a plan",
        State::Yawing => "yawing",
        State::LegsLowering => "legs lowering",
        State::FaultLowering => "legs lowering after a fault",
        State::FaultDown => "down after a fault",
    })
}

/// A refusal in words.
#[must_use]
pub const fn refusal(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::None => "nothing",
        Refusal::Length => "wrong length",
        Refusal::Checksum => "wrong checksum: corrupt, or for another drive",
        Refusal::Opcode => "no such command",
        Refusal::NoSession => "no session was begun",
        Refusal::Sequence => "its number is not ahead of the last one",
        Refusal::State => "the robot's state does not allow it",
        Refusal::Bounds => "out of bounds",
        Refusal::Plan => "the plan does not fit, is not complete or is corrupt",
    }
}

/// All faults in their order, in words.
const FAULTS: [(Fault, &str); 26] = [
    (Fault::NoBoot, "no boot-up"),
    (Fault::Setup, "set-up refused"),
    (Fault::Heartbeat, "heartbeat lost"),
    (Fault::NotOperational, "not operational"),
    (Fault::Reboot, "node was reset"),
    (Fault::MissedInputs, "inputs missed"),
    (Fault::Emergency, "emergency message"),
    (Fault::DriveFault, "drive in fault state"),
    (Fault::NotEnabled, "drive not enabled"),
    (Fault::WrongMode, "wrong mode"),
    (Fault::PairDisagrees, "drives of an axis disagree"),
    (Fault::SensorStale, "sensor is stale"),
    (Fault::SensorUnhealthy, "sensor is not well"),
    (Fault::SensorInvalid, "impossible measurement"),
    (Fault::Lean, "leans too far"),
    (Fault::NotFinite, "torque not finite"),
    (Fault::ControllerSilent, "controller is silent"),
    (Fault::SyncJitter, "SYNC too late"),
    (Fault::Bus, "bus off"),
    (Fault::ForeignMaster, "another master"),
    (Fault::Legs, "legs do not obey"),
    (Fault::Deadline, "legs or drives took too long"),
    (Fault::EmergencyStop, "emergency stop"),
    (Fault::OperatorSilent, "operator is silent"),
    (Fault::Process, "process ended"),
    (Fault::BusErrors, "errors on a bus"),
];

/// A fault's number in words.
#[must_use]
pub fn fault(number: u8) -> &'static str {
    let known = FAULTS.iter().find(|(fault, _)| *fault as u8 == number);
    known.map_or("unknown fault", |(_, words)| *words)
}
