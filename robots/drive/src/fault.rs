//! What can go wrong.

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// A node did not report after its reset.
    NoBoot = 1,
    /// A node did not answer, refused a value, or is not what it should be.
    Setup = 2,
    /// A node's heartbeat stopped.
    Heartbeat = 3,
    /// A node reports that it is not operational.
    NotOperational = 4,
    /// A node reported its boot-up while it was in use: it was reset.
    Reboot = 5,
    /// Inputs of a node did not come for several cycles.
    MissedInputs = 6,
    /// A node sent an emergency message.
    Emergency = 7,
    /// A drive is in a fault state.
    DriveFault = 8,
    /// A drive left "operation enabled" by itself.
    NotEnabled = 9,
    /// A drive is in another mode of operation.
    WrongMode = 10,
    /// Two drives of an axis went different ways.
    PairDisagrees = 11,
    /// A sensor repeats its last sample.
    SensorStale = 12,
    /// A sensor says that it is not well.
    SensorUnhealthy = 13,
    /// A measured value is outside what is possible.
    SensorInvalid = 14,
    /// The robot leans too far.
    Lean = 15,
    /// The controller asked for a torque that is not finite.
    NotFinite = 16,
    /// The controller gave no torques for several cycles.
    ControllerSilent = 17,
    /// SYNC came too late.
    SyncJitter = 18,
    /// A controller is bus-off, or a bus takes no frames.
    Bus = 19,
    /// Somebody else sends what only the master sends.
    ForeignMaster = 20,
    /// The legs do not obey.
    Legs = 21,
    /// The legs took too long, or drives to be enabled.
    Deadline = 22,
    /// An operator's emergency stop.
    EmergencyStop = 23,
    /// The operator's link is silent while the robot moves.
    OperatorSilent = 24,
    /// A process asked for an orderly end, or panicked.
    Process = 25,
    /// A controller is error-passive: something disturbs what the master sends. Noted only while drives
    /// are told to be enabled; before, nodes may not have been switched on.
    BusErrors = 26,
}

impl Fault {
    /// Its bit among the faults that are noted.
    #[must_use]
    pub const fn bit(self) -> u32 {
        1 << (self as u8)
    }

    /// Whether a robot with this fault cannot go on balancing.
    #[must_use]
    pub const fn prevents_balance(self) -> bool {
        !matches!(
            self,
            Self::Lean
                | Self::Legs
                | Self::Deadline
                | Self::OperatorSilent
                | Self::SyncJitter
                | Self::ForeignMaster
                | Self::Process
                | Self::BusErrors
        )
    }
}

/// A fault with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultRecord {
    /// What is wrong.
    pub fault: Fault,
    /// Index of the node, if it is one's.
    pub node: Option<u8>,
    /// When it was noticed, µs.
    pub at_us: u64,
    /// Emergency code, SDO abort code, statusword, or whatever the fault is about; else 0.
    pub detail: u32,
}

/// The faults since the last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    bits: u32,
    first: Option<FaultRecord>,
    count: u32,
    falls: bool,
}

impl Faults {
    /// Notes a fault.
    pub fn add(&mut self, record: FaultRecord) {
        self.bits |= record.fault.bit();
        self.count = self.count.saturating_add(1);
        self.first = self.first.or(Some(record));
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    pub(crate) fn prevent_balance(&mut self) {
        self.falls = true;
    }

    /// Whether the robot cannot go on balancing with what happened.
    #[must_use]
    pub const fn prevents_balance(&self) -> bool {
        self.falls
    }

    /// How often a fault was noted.
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Whether there is any.
    #[must_use]
    pub const fn any(&self) -> bool {
        self.bits != 0
    }

    /// Whether there is one of this kind.
    #[must_use]
    pub const fn has(&self, fault: Fault) -> bool {
        self.bits & fault.bit() != 0
    }

    /// One bit for each kind.
    #[must_use]
    pub const fn bits(&self) -> u32 {
        self.bits
    }

    /// The first one.
    #[must_use]
    pub const fn first(&self) -> Option<FaultRecord> {
        self.first
    }
}
