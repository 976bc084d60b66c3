//! What can be wrong with a parameter.

use crate::{Ordered, Parameter};
use core::fmt;

/// A parameter, or a requirement on parameters, that fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterError {
    /// The value is infinite or NaN.
    NotFinite {
        /// Identifier: `r_w`.
        name: &'static str,
        /// SI unit.
        unit: &'static str,
        /// The value.
        value: f64,
    },
    /// The value leaves its declared range.
    OutOfRange {
        /// Identifier: `r_w`.
        name: &'static str,
        /// SI unit.
        unit: &'static str,
        /// The value.
        value: f64,
        /// Smallest allowed value.
        lower: f64,
        /// Largest allowed value.
        upper: f64,
    },
    /// A requirement of the model does not hold.
    Requirement {
        /// As the model writes it.
        text: &'static str,
    },
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { name, unit, value } => {
                write!(f, "parameter `{name}` is {value} {unit}: it must be finite")
            }
            Self::OutOfRange { name, unit, value, lower, upper } => {
                write!(f, "parameter `{name}` is {value} {unit}: it must be in {lower}..{upper}")
            }
            Self::Requirement { text } => write!(f, "the model requires `{text}`"),
        }
    }
}

impl core::error::Error for ParameterError {}

impl Parameter {
    /// Whether a value is finite and in the declared range, both rounded to the scalar.
    ///
    /// # Errors
    ///
    /// [`ParameterError::NotFinite`] or [`ParameterError::OutOfRange`].
    pub fn check<T: Ordered>(&self, value: T) -> Result<(), ParameterError> {
        let Self { name, unit, lower, upper, .. } = *self;
        if !value.is_finite() {
            return Err(ParameterError::NotFinite { name, unit, value: value.to_f64() });
        }
        if value < T::from_f64(lower) || value > T::from_f64(upper) {
            return Err(ParameterError::OutOfRange {
                name,
                unit,
                value: value.to_f64(),
                lower,
                upper,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS: Parameter =
        Parameter { name: "r", unit: "m", value: 0.3, lower: 0.1, upper: 0.3, docs: "" };

    #[test]
    fn bounds_are_inside_in_every_precision() {
        assert_eq!(RADIUS.check(0.3_f64), Ok(()));
        assert_eq!(RADIUS.check(0.3_f32), Ok(()));
        assert_eq!(RADIUS.check(0.1_f32), Ok(()));
    }

    #[test]
    fn values_outside_and_not_finite_are_told_apart() {
        assert!(matches!(RADIUS.check(0.31_f64), Err(ParameterError::OutOfRange { .. })));
        assert!(matches!(RADIUS.check(f64::NAN), Err(ParameterError::NotFinite { .. })));
        assert!(matches!(RADIUS.check(f64::INFINITY), Err(ParameterError::NotFinite { .. })));
    }
}
