//! Which robot a plan is for.

use super::FileError;
use super::crc::Crc32;
use shapebot_dynamics::Description;

/// Bytes of a robot's name that the binary form keeps.
pub(super) const NAME_BYTES: usize = 32;

/// A robot with the values of its parameters: a plan is for no other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotId<'a> {
    name: &'a str,
    fingerprint: u32,
}

impl<'a> RobotId<'a> {
    /// A robot with the model's own values.
    pub fn of(description: &Description) -> Self {
        Self::with(description, |_| None)
    }

    /// A robot some of whose parameters have another value, given by name.
    pub fn with(description: &Description, value: impl Fn(&str) -> Option<f64>) -> Self {
        let mut crc = Crc32::new();
        crc.add(description.name.as_bytes());
        for parameter in description.parameters {
            crc.add(&[0]);
            crc.add(parameter.name.as_bytes());
            crc.add(&[0]);
            // One zero, whatever its sign.
            let value = value(parameter.name).unwrap_or(parameter.value) + 0.0;
            crc.add(&value.to_le_bytes());
        }
        Self { name: description.name, fingerprint: crc.value() }
    }

    pub(super) const fn from_file(name: &'a str, fingerprint: u32) -> Self {
        Self { name, fingerprint }
    }

    /// The robot's name: as far as it is kept, if it was read from a file.
    pub const fn name(&self) -> &'a str {
        self.name
    }

    /// CRC-32 of the robot's name and of the names and values of its parameters.
    pub const fn fingerprint(&self) -> u32 {
        self.fingerprint
    }

    /// Refuses a plan of another robot, or of other parameters.
    ///
    /// # Errors
    ///
    /// [`FileError::OtherRobot`].
    pub fn check(&self, plan: &RobotId<'_>) -> Result<(), FileError> {
        let (found, expected) = (plan.fingerprint, self.fingerprint);
        if found == expected { Ok(()) } else { Err(FileError::OtherRobot { found, expected }) }
    }

    /// As much of the name as the binary form keeps.
    pub(super) fn kept(&self) -> &'a str {
        let mut end = self.name.len().min(NAME_BYTES);
        while !self.name.is_char_boundary(end) {
            end -= 1;
        }
        self.name.get(..end).unwrap_or_default()
    }
}
