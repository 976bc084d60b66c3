//! Numbers with a unit: `"5 s"`, `"2, 0 m"`.

use std::f64::consts::PI;

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Seconds.
    Time,
    /// Metres.
    Length,
    /// Radians.
    Angle,
    /// Newtons.
    Force,
    /// Newton metres.
    Torque,
    /// Radians per second.
    AngularRate,
    /// Newton metres per radian per second.
    AngularFriction,
    /// Newtons per metre per second.
    LinearFriction,
}

impl Dimension {
    /// The unit that values are converted to.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Length => "m",
            Self::Angle => "rad",
            Self::Force => "N",
            Self::Torque => "N*m",
            Self::AngularRate => "rad/s",
            Self::AngularFriction => "N*m*s",
            Self::LinearFriction => "N*s/m",
        }
    }
}

/// Unit, what it measures, and how much of the base unit it is.
const UNITS: [(&str, Dimension, f64); 17] = [
    ("s", Dimension::Time, 1.0),
    ("ms", Dimension::Time, 1e-3),
    ("min", Dimension::Time, 60.0),
    ("m", Dimension::Length, 1.0),
    ("cm", Dimension::Length, 1e-2),
    ("mm", Dimension::Length, 1e-3),
    ("rad", Dimension::Angle, 1.0),
    ("deg", Dimension::Angle, PI / 180.0),
    ("N", Dimension::Force, 1.0),
    ("N m", Dimension::Torque, 1.0),
    ("N*m", Dimension::Torque, 1.0),
    ("rad/s", Dimension::AngularRate, 1.0),
    ("deg/s", Dimension::AngularRate, PI / 180.0),
    ("N m s", Dimension::AngularFriction, 1.0),
    ("N*m*s", Dimension::AngularFriction, 1.0),
    ("N s/m", Dimension::LinearFriction, 1.0),
    ("N*s/m", Dimension::LinearFriction, 1.0),
];

/// One or several numbers of one unit, in the SI unit of what they measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantities {
    /// The numbers.
    pub values: Vec<f64>,
    /// What they measure.
    pub dimension: Dimension,
}

impl Quantities {
    /// From text such as `2, 0 m`: numbers with commas between them, then the unit.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let trimmed = text.trim();
        let Some((numbers, dimension, factor)) = split_unit(trimmed) else {
            let at = trimmed.rfind(|c: char| !c.is_ascii_alphabetic()).map_or(0, |at| at + 1);
            let unit = &trimmed[at..];
            let known: Vec<&str> = UNITS.iter().map(|(name, ..)| *name).collect();
            let found = if unit.is_empty() { "no unit".into() } else { format!("unit `{unit}`") };
            return Err(format!("{found} in \"{text}\"; units: {}", known.join(", ")));
        };
        let number = |text: &str| match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value * factor),
            _ => Err(format!("`{}` is no finite number", text.trim())),
        };
        let values = numbers.split(',').map(number).collect::<Result<_, _>>()?;
        Ok(Self { values, dimension })
    }
}

/// The numbers ahead of the longest unit that a text ends with, and what the unit is.
fn split_unit(text: &str) -> Option<(&str, Dimension, f64)> {
    let rest = |name: &str| {
        let rest = text.strip_suffix(name)?;
        (!rest.ends_with(|c: char| c.is_ascii_alphabetic())).then_some(rest)
    };
    let fitting =
        UNITS.iter().filter_map(|&(name, kind, factor)| Some((rest(name)?, kind, factor)));
    fitting.min_by_key(|(rest, ..)| rest.len())
}

#[cfg(test)]
mod tests {
    use super::{Dimension, Quantities};

    #[test]
    fn units_are_converted_and_demanded() {
        let read = |text| Quantities::parse(text).map(|q| (q.values, q.dimension));
        assert_eq!(read("2, -0.5 m"), Ok((vec![2.0, -0.5], Dimension::Length)));
        assert_eq!(read("180deg").unwrap().0[0], std::f64::consts::PI);
        assert_eq!(read("1e3 ms"), Ok((vec![1.0], Dimension::Time)));
        assert_eq!(read("20 N m"), Ok((vec![20.0], Dimension::Torque)));
        assert_eq!(read("20 N*m"), read("20 N m"));
        assert_eq!(read("0.3 N m s"), Ok((vec![0.3], Dimension::AngularFriction)));
        assert_eq!(read("3 N s/m"), Ok((vec![3.0], Dimension::LinearFriction)));
        assert_eq!(
            read("360 deg/s"),
            Ok((vec![2.0 * std::f64::consts::PI], Dimension::AngularRate))
        );
        assert_eq!(read("-1, 20N"), Ok((vec![-1.0, 20.0], Dimension::Force)));
        for wrong in [
            "5", "5 N N m", "5 k m", "5 ft", "m", "", "1,,2 m", "nan s", "inf m", "1e999 s",
            "2 m 3",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
