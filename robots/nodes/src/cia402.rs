//! A simulated drive: CiA 402, cyclic synchronous torque.

use shapebot_drive::{DataType, Frame, Object, object};

use crate::device::{CommunicationError, Device};
use crate::{Abort, Access, Dictionary, Mappable, Motion, Physical};

/// Mode of operation "cyclic synchronous torque".
pub const CYCLIC_SYNCHRONOUS_TORQUE: i8 = 10;

/// A drive and its motor as they are built, before any set-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveSettings {
    /// The motor's number in the plant.
    pub motor: usize,
    /// Object that takes the torque (0x6071, or a manufacturer's).
    pub torque_object: Object,
    /// Its type.
    pub torque_kind: DataType,
    /// Torque at the shaft for one of its counts, N·m.
    pub torque_per_count: f64,
    /// Motor rated torque, mN·m: 0x6076.
    pub rated_torque: u32,
    /// The most that motor and amplifier give, N·m.
    pub peak_torque: f64,
    /// Counts of the encoder per turn of the shaft.
    pub counts_per_revolution: u32,
    /// Rate for one count of 0x606C, rad/s.
    pub rate_per_count: f64,
    /// The mode in which the torque object acts.
    pub mode: i8,
}

impl Default for DriveSettings {
    /// Rated torque 1 N·m, peak 3 N·m, per mille of the rated one; 4096 counts per turn, rate in counts per second.
    fn default() -> Self {
        Self {
            motor: 0,
            torque_object: Object::TARGET_TORQUE,
            torque_kind: DataType::I16,
            torque_per_count: 0.001,
            rated_torque: 1000,
            peak_torque: 3.0,
            counts_per_revolution: 4096,
            rate_per_count: std::f64::consts::TAU / 4096.0,
            mode: CYCLIC_SYNCHRONOUS_TORQUE,
        }
    }
}

/// State of the power drive system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerState {
    /// Until the node has started.
    NotReadyToSwitchOn,
    /// No voltage.
    SwitchOnDisabled,
    /// Voltage may be switched on.
    ReadyToSwitchOn,
    /// Voltage is on, no torque.
    SwitchedOn,
    /// Torque follows the command.
    OperationEnabled,
    /// On the way to standstill by command.
    QuickStopActive,
    /// On the way to standstill after a fault.
    FaultReactionActive,
    /// No torque until a reset.
    Fault,
}

impl PowerState {
    /// Bits 0 to 6 of the statusword, from the table of the standard.
    const fn bits(self) -> u16 {
        match self {
            Self::NotReadyToSwitchOn => 0b000_0000,
            Self::SwitchOnDisabled => 0b100_0000,
            Self::ReadyToSwitchOn => 0b011_0001,
            Self::SwitchedOn => 0b011_0011,
            Self::OperationEnabled => 0b011_0111,
            Self::QuickStopActive => 0b001_0111,
            Self::FaultReactionActive => 0b000_1111,
            Self::Fault => 0b000_1000,
        }
    }
}

/// Faults of a drive that can be injected, as switches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DriveFaults {
    /// What the encoder says forever.
    pub(crate) stuck: Option<Motion>,
    /// The motor turns the other way.
    pub(crate) flipped: bool,
    /// The most of the rated torque that the power stage gives.
    pub(crate) strength: Option<f64>,
}

/// A stop that takes its time.
#[derive(Clone, Copy, Debug)]
struct Stop {
    next: PowerState,
    from: f64,
    since: u64,
}

#[derive(Clone, Debug)]
pub(crate) struct Drive {
    pub(crate) settings: DriveSettings,
    pub(crate) state: PowerState,
    pub(crate) faults: DriveFaults,
    /// Controlword of the step before: resets act on an edge.
    previous: i64,
    stop: Option<Stop>,
    /// Torque that is commanded to the power stage, counts.
    demand: f64,
    /// Torque that was given to the plant, N·m.
    applied: f64,
    limited: bool,
}

const ERROR_CODE: Object = object(0x603F, 0);
const DEMAND: Object = object(0x6074, 0);
const SLOPE: Object = object(0x6087, 0);

/// Controlword bits.
const SWITCH_ON: i64 = 1 << 0;
const ENABLE_VOLTAGE: i64 = 1 << 1;
const NO_QUICK_STOP: i64 = 1 << 2;
const ENABLE_OPERATION: i64 = 1 << 3;
const FAULT_RESET: i64 = 1 << 7;
const HALT: i64 = 1 << 8;

impl Drive {
    pub(crate) fn new(settings: DriveSettings, dictionary: &mut Dictionary) -> Self {
        add_objects(&settings, dictionary);
        Self {
            settings,
            state: PowerState::NotReadyToSwitchOn,
            faults: DriveFaults::default(),
            previous: 0,
            stop: None,
            demand: 0.0,
            applied: 0.0,
            limited: false,
        }
    }

    /// Whether another value may be written to an object of the profile.
    pub(crate) fn check(&self, at: Object, value: i64) -> Result<(), Abort> {
        let ok = match at.index {
            0x6060 => value == 0 || value == i64::from(self.settings.mode),
            0x605A => matches!(value, 0..=2 | 5..=6),
            0x605B | 0x605C => matches!(value, 0..=1),
            0x605D => matches!(value, 1..=2),
            0x605E => matches!(value, 0..=2),
            0x6007 => matches!(value, 0..=3),
            _ => true,
        };
        if ok { Ok(()) } else { Err(Abort::Value) }
    }

    /// Start-up is over.
    pub(crate) fn boot(&mut self, device: &mut Device) {
        self.state = PowerState::SwitchOnDisabled;
        self.publish(device);
    }

    /// Power fails or the node restarts: no torque at once.
    pub(crate) fn reset(&mut self, device: &mut Device, physical: &mut Physical<'_>) {
        self.state = PowerState::NotReadyToSwitchOn;
        (self.previous, self.stop) = (0, None);
        self.act(device, physical);
    }

    /// SYNC: encoder and statusword as they are now.
    pub(crate) fn sample(&mut self, device: &mut Device, physical: &mut Physical<'_>) {
        let actual = physical.here().motor(self.settings.motor);
        let motion = self.faults.stuck.unwrap_or(actual);
        let polarity = device.dictionary.get(Object::POLARITY);
        let sign = |bit: i64| if polarity & bit == 0 { 1.0 } else { -1.0 };
        let turns = motion.angle / std::f64::consts::TAU;
        let counts = (turns * f64::from(self.settings.counts_per_revolution)).floor();
        let rate = (motion.rate / self.settings.rate_per_count).round();
        device.dictionary.set(Object::POSITION, wrapped(counts * sign(1 << 7)));
        device.dictionary.set(Object::VELOCITY, whole(rate * sign(1 << 6)));
        self.publish(device);
    }

    /// The objects may have changed: state machine, then torque.
    pub(crate) fn step(
        &mut self,
        device: &mut Device,
        physical: &mut Physical<'_>,
        out: &mut Vec<Frame>,
    ) {
        let mode = device.dictionary.get(Object::MODE);
        device.dictionary.set(Object::MODE_DISPLAY, mode);
        let controlword = device.dictionary.get(Object::CONTROLWORD);
        let reset = controlword & FAULT_RESET != 0 && self.previous & FAULT_RESET == 0;
        self.previous = controlword;
        if reset && self.state == PowerState::Fault {
            self.state = PowerState::SwitchOnDisabled;
            device.dictionary.set(ERROR_CODE, 0);
            device.emergency(0, out);
        }
        self.obey(controlword, device, physical, out);
        self.act(device, physical);
        self.publish(device);
    }

    /// Transitions 2 to 12 and 16 of the standard.
    fn obey(
        &mut self,
        controlword: i64,
        device: &mut Device,
        physical: &Physical<'_>,
        out: &mut Vec<Frame>,
    ) {
        use PowerState::{
            OperationEnabled, QuickStopActive, ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn,
        };
        let set = |bits: i64| controlword & bits == bits;
        let dictionary = &device.dictionary;
        match self.state {
            ReadyToSwitchOn | SwitchedOn | OperationEnabled | QuickStopActive
                if !set(ENABLE_VOLTAGE) =>
            {
                self.leave(SwitchOnDisabled);
            }
            ReadyToSwitchOn | SwitchedOn if !set(NO_QUICK_STOP) => self.leave(SwitchOnDisabled),
            OperationEnabled if !set(NO_QUICK_STOP) => self.quick_stop(device, physical.now()),
            SwitchOnDisabled if set(ENABLE_VOLTAGE | NO_QUICK_STOP) && !set(SWITCH_ON) => {
                self.state = ReadyToSwitchOn;
            }
            SwitchedOn if !set(SWITCH_ON) => self.state = ReadyToSwitchOn,
            OperationEnabled if !set(SWITCH_ON) => {
                let option = dictionary.get(Object::SHUTDOWN_OPTION);
                self.stop_to(ReadyToSwitchOn, option, dictionary, physical.now());
            }
            OperationEnabled if !set(ENABLE_OPERATION) => {
                let option = dictionary.get(Object::DISABLE_OPTION);
                self.stop_to(SwitchedOn, option, dictionary, physical.now());
            }
            ReadyToSwitchOn | SwitchedOn if set(SWITCH_ON | ENABLE_OPERATION) => {
                self.enable(device, physical, out);
            }
            ReadyToSwitchOn if set(SWITCH_ON) => self.state = SwitchedOn,
            QuickStopActive
                if set(NO_QUICK_STOP | ENABLE_OPERATION)
                    && dictionary.get(Object::QUICK_STOP_OPTION) >= 5 =>
            {
                self.leave(OperationEnabled);
            }
            _ => {}
        }
    }

    const fn leave(&mut self, next: PowerState) {
        self.stop = None;
        self.state = next;
    }

    /// Communication cycle and interpolation period must agree before torque is given.
    fn enable(&mut self, device: &mut Device, physical: &Physical<'_>, out: &mut Vec<Frame>) {
        let cycle = device.cycle_period();
        if cycle > 0 && interpolation_us(&device.dictionary) != Some(cycle) {
            self.fault(CommunicationError::Sync.code(), device, physical.now(), out);
        } else {
            self.leave(PowerState::OperationEnabled);
        }
    }

    fn quick_stop(&mut self, device: &Device, now: u64) {
        let option = device.dictionary.get(Object::QUICK_STOP_OPTION);
        if option == 0 {
            return self.leave(PowerState::SwitchOnDisabled);
        }
        let stays = option >= 5;
        let next = if stays { PowerState::QuickStopActive } else { PowerState::SwitchOnDisabled };
        self.state = PowerState::QuickStopActive;
        self.stop_to(next, 1, &device.dictionary, now);
    }

    /// Goes to `next` at once, or down the torque slope if the option says so.
    fn stop_to(&mut self, next: PowerState, option: i64, dictionary: &Dictionary, now: u64) {
        if option == 0 || dictionary.get(SLOPE) == 0 {
            self.leave(next);
        } else if self.stop.is_none_or(|stop| stop.next != next) {
            self.stop = Some(Stop { next, from: self.demand, since: now });
        }
    }

    /// A fault of the drive: reaction by 0x605E, emergency, latched.
    pub(crate) fn fault(&mut self, code: u16, device: &mut Device, now: u64, out: &mut Vec<Frame>) {
        if matches!(self.state, PowerState::Fault | PowerState::FaultReactionActive) {
            return;
        }
        device.dictionary.set(ERROR_CODE, i64::from(code));
        device.emergency(code, out);
        let torque =
            matches!(self.state, PowerState::OperationEnabled | PowerState::QuickStopActive);
        let option = if torque { device.dictionary.get(Object::FAULT_OPTION) } else { 0 };
        self.stop = None;
        self.stop_to(PowerState::Fault, option, &device.dictionary, now);
        if self.stop.is_some() {
            self.state = PowerState::FaultReactionActive;
        }
    }

    /// Reaction of 0x6007 to an error of the communication.
    pub(crate) fn lost(
        &mut self,
        error: CommunicationError,
        device: &mut Device,
        physical: &mut Physical<'_>,
        out: &mut Vec<Frame>,
    ) {
        match device.dictionary.get(Object::ABORT_CONNECTION) {
            1 => self.fault(error.code(), device, physical.now(), out),
            2 if self.state != PowerState::Fault => {
                device.emergency(error.code(), out);
                self.leave(PowerState::SwitchOnDisabled);
            }
            3 if self.state == PowerState::OperationEnabled => {
                device.emergency(error.code(), out);
                self.quick_stop(device, physical.now());
            }
            _ => device.emergency(error.code(), out),
        }
        self.act(device, physical);
        self.publish(device);
    }

    /// Brings torque to the plant.
    pub(crate) fn act(&mut self, device: &mut Device, physical: &mut Physical<'_>) {
        self.demand = self.demanded(&device.dictionary, physical.now());
        let settings = &self.settings;
        let rated = f64::from(settings.rated_torque) * 1e-3;
        let strength = self.faults.strength.map_or(f64::MAX, |part| (part * rated).abs());
        let most = settings.peak_torque.abs().min(strength);
        let torque = (self.demand * settings.torque_per_count).clamp(-most, most);
        let actual = (torque / settings.torque_per_count).round();
        device.dictionary.set(DEMAND, whole(self.demand));
        device.dictionary.set(Object::ACTUAL_TORQUE, whole(actual));
        let polarity = device.dictionary.get(Object::POLARITY) & (1 << 5) != 0;
        let shaft = if polarity == self.faults.flipped { torque } else { -torque };
        #[expect(clippy::float_cmp, reason = "any change is to reach the plant")]
        if shaft != self.applied {
            self.applied = shaft;
            physical.here().drive(settings.motor, shaft);
        }
    }

    /// Torque in counts that the state allows.
    fn demanded(&mut self, dictionary: &Dictionary, now: u64) -> f64 {
        self.limited = false;
        if let Some(stop) = self.stop {
            let slope = count(dictionary.get(SLOPE));
            #[expect(clippy::cast_precision_loss, reason = "2⁵³ µs are 285 years")]
            let seconds = now.saturating_sub(stop.since) as f64 * 1e-6;
            let left = (stop.from.abs() - slope * seconds).max(0.0);
            if left > 0.0 {
                return left.copysign(stop.from);
            }
            self.leave(stop.next);
        }
        let enabled = self.state == PowerState::OperationEnabled
            && dictionary.get(Object::MODE) == i64::from(self.settings.mode)
            && dictionary.get(Object::CONTROLWORD) & HALT == 0;
        if !enabled {
            return 0.0;
        }
        let target = count(dictionary.get(self.settings.torque_object));
        let most = count(dictionary.get(Object::MAX_TORQUE));
        self.limited = target.abs() > most;
        target.clamp(-most, most)
    }

    /// While torque goes down a slope, the next point of it.
    pub(crate) fn next(&self, now: u64) -> Option<u64> {
        self.stop.map(|_| now + 1000)
    }

    fn publish(&self, device: &mut Device) {
        let follows = self.state == PowerState::OperationEnabled
            && device.dictionary.get(Object::MODE) == i64::from(self.settings.mode);
        let voltage = 1 << 4;
        let remote = 1 << 9;
        let mut word = i64::from(self.state.bits()) | voltage | remote;
        word |= i64::from(self.limited) << 11;
        word |= i64::from(follows) << 12;
        device.dictionary.set(Object::STATUSWORD, word);
    }
}

/// Interpolation time period 0x60C2, µs, if it is a whole number of them.
fn interpolation_us(dictionary: &Dictionary) -> Option<u64> {
    let value = dictionary.get(Object::INTERPOLATION_VALUE).unsigned_abs();
    let exponent = dictionary.get(Object::INTERPOLATION_EXPONENT) + 6;
    let power = 10_u64.checked_pow(u32::try_from(exponent).ok()?)?;
    value.checked_mul(power)
}

#[expect(clippy::cast_precision_loss, reason = "objects have 32 bits at most")]
const fn count(number: i64) -> f64 {
    number as f64
}

/// A position counter overflows.
#[expect(clippy::cast_possible_truncation, reason = "the counter of a drive has 32 bits")]
const fn wrapped(counts: f64) -> i64 {
    counts as i64 as i32 as i64
}

#[expect(clippy::cast_possible_truncation, reason = "`as` saturates; objects saturate further")]
const fn whole(number: f64) -> i64 {
    number as i64
}

fn add_objects(settings: &DriveSettings, dictionary: &mut Dictionary) {
    use Access::{Constant, Read, ReadWrite};
    use DataType::{I8, I16, I32, U8, U16, U32};
    use Mappable::{Both, No, Receive, Transmit};
    let torque = i64::from(settings.rated_torque);
    let mode = i64::from(settings.mode);
    let mut add = |at, kind, value, access, mappable| {
        dictionary.number(at, kind, value, access, mappable);
    };
    add(Object::ABORT_CONNECTION, I16, 1, ReadWrite, No);
    add(ERROR_CODE, U16, 0, Read, Transmit);
    add(Object::CONTROLWORD, U16, 0, ReadWrite, Receive);
    add(Object::STATUSWORD, U16, 0, Read, Transmit);
    add(Object::QUICK_STOP_OPTION, I16, 2, ReadWrite, No);
    add(Object::SHUTDOWN_OPTION, I16, 0, ReadWrite, No);
    add(Object::DISABLE_OPTION, I16, 1, ReadWrite, No);
    add(Object::HALT_OPTION, I16, 1, ReadWrite, No);
    add(Object::FAULT_OPTION, I16, 2, ReadWrite, No);
    add(Object::MODE, I8, 0, ReadWrite, Receive);
    add(Object::MODE_DISPLAY, I8, 0, Read, Transmit);
    add(Object::POSITION, I32, 0, Read, Transmit);
    add(Object::VELOCITY, I32, 0, Read, Transmit);
    add(Object::MAX_TORQUE, U16, 1000, ReadWrite, Both);
    add(DEMAND, I16, 0, Read, Transmit);
    add(object(0x6075, 0), U32, 1000, ReadWrite, No);
    add(Object::RATED_TORQUE, U32, torque, ReadWrite, No);
    add(Object::ACTUAL_TORQUE, I16, 0, Read, Transmit);
    add(Object::POLARITY, U8, 0, ReadWrite, No);
    add(SLOPE, U32, 0, ReadWrite, No);
    add(object(0x608F, 0), U8, 2, Constant, No);
    add(object(0x608F, 1), U32, i64::from(settings.counts_per_revolution), ReadWrite, No);
    add(object(0x608F, 2), U32, 1, ReadWrite, No);
    add(object(0x60C2, 0), U8, 2, Constant, No);
    add(Object::INTERPOLATION_VALUE, U8, 1, ReadWrite, No);
    add(Object::INTERPOLATION_EXPONENT, I8, -3, ReadWrite, No);
    add(object(0x6402, 0), U16, 0xFFFF, ReadWrite, No);
    let supported = if (1..=32).contains(&mode) { 1 << (mode - 1) } else { 1 << 16 };
    add(object(0x6502, 0), U32, supported, Constant, No);
    add(Object::TARGET_TORQUE, I16, 0, ReadWrite, Receive);
    add(settings.torque_object, settings.torque_kind, 0, ReadWrite, Receive);
}
