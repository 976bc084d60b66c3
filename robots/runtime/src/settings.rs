//! What a user may choose.

use crate::Error;
use shapebot_dynamics::Ordered;

/// Settings of a [`Runtime`](crate::Runtime). Start from [`Settings::default`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T> {
    /// Bandwidth of the filter that makes rates of encoder counts, rad/s.
    pub rate_bandwidth: T,
    /// Shortest time in which a motion is brought to rest, s.
    pub stop_time: T,
    /// Time in which the wanted lean follows the accelerations of such a motion, s.
    pub lean_time: T,
    /// How far from where the robot stands a plan may begin, in the output's unit.
    pub start_position: T,
    /// The same for its actuated shape coordinates.
    pub start_shape: T,
    /// Longest silence of an operator while the robot balances, µs, where the watch is armed: see
    /// [`Commanded::watch`](shapebot_drive::operator::Commanded::watch).
    pub operator_timeout_us: u64,
}

impl<T: Ordered> Default for Settings<T> {
    fn default() -> Self {
        let c = T::from_f64;
        Self {
            rate_bandwidth: c(40.0),
            stop_time: c(1.0),
            lean_time: c(0.2),
            start_position: c(0.05),
            start_shape: c(0.05),
            operator_timeout_us: 500_000,
        }
    }
}

impl<T: Ordered> Settings<T> {
    pub(crate) fn check(&self) -> Result<(), Error> {
        let numbers = [
            ("rate_bandwidth", self.rate_bandwidth),
            ("stop_time", self.stop_time),
            ("lean_time", self.lean_time),
            ("start_position", self.start_position),
            ("start_shape", self.start_shape),
        ];
        for (what, value) in numbers {
            if !(value > T::zero() && value.is_finite()) {
                return Err(Error::Setting { what });
            }
        }
        Ok(())
    }
}
