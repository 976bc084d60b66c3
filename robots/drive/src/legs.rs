//! The legs, as a node of their own: 0x2000:01 is the command, 0x2001:01 the state.
//!
//! A leg node lowers the legs by itself when the master's heartbeat stops (0x1016) or its own process
//! fails: down is where it goes without being told.

/// Command to the legs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum LegsCommand {
    /// Lower them and hold them down.
    Lower = 0,
    /// Retract them.
    Retract = 1,
}

/// Command object.
pub const COMMAND: crate::Object = crate::object(0x2000, 1);
/// State object.
pub const STATE: crate::Object = crate::object(0x2001, 1);

/// State of the legs, from the byte that they send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LegsState(pub u8);

impl LegsState {
    /// All legs are on the floor, by their switches.
    pub const DOWN: Self = Self(1);
    /// All legs are up, by their switches.
    pub const UP: Self = Self(2);
    /// On the way.
    pub const MOVING: Self = Self(0);
    /// A leg does not obey.
    pub const FAULT: Self = Self(4);

    /// On the floor and sound.
    #[must_use]
    pub const fn is_down(self) -> bool {
        self.0 == Self::DOWN.0
    }

    /// Up and sound.
    #[must_use]
    pub const fn is_up(self) -> bool {
        self.0 == Self::UP.0
    }

    /// Broken, or both switches at once, or unknown bits.
    #[must_use]
    pub const fn is_faulty(self) -> bool {
        self.0 > Self::UP.0
    }
}
