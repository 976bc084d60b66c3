//! Numbers with a unit: `"2 ms"`, `"60 N*m"`, `"12 N*m*s/rad"`.

use std::f64::consts::PI;

/// Exponents of s, m, rad, N, A and bit.
type Exponents = [i8; 6];

/// Unit, its exponents, and how much of the base units it is.
const UNITS: [(&str, Exponents, f64); 20] = [
    ("s", [1, 0, 0, 0, 0, 0], 1.0),
    ("ms", [1, 0, 0, 0, 0, 0], 1e-3),
    ("us", [1, 0, 0, 0, 0, 0], 1e-6),
    ("min", [1, 0, 0, 0, 0, 0], 60.0),
    ("m", [0, 1, 0, 0, 0, 0], 1.0),
    ("cm", [0, 1, 0, 0, 0, 0], 1e-2),
    ("mm", [0, 1, 0, 0, 0, 0], 1e-3),
    ("um", [0, 1, 0, 0, 0, 0], 1e-6),
    ("rad", [0, 0, 1, 0, 0, 0], 1.0),
    ("mrad", [0, 0, 1, 0, 0, 0], 1e-3),
    ("urad", [0, 0, 1, 0, 0, 0], 1e-6),
    ("deg", [0, 0, 1, 0, 0, 0], PI / 180.0),
    ("rev", [0, 0, 1, 0, 0, 0], 2.0 * PI),
    ("N", [0, 0, 0, 1, 0, 0], 1.0),
    ("mN", [0, 0, 0, 1, 0, 0], 1e-3),
    ("A", [0, 0, 0, 0, 1, 0], 1.0),
    ("mA", [0, 0, 0, 0, 1, 0], 1e-3),
    ("bit", [0, 0, 0, 0, 0, 1], 1.0),
    ("kbit", [0, 0, 0, 0, 0, 1], 1e3),
    ("Mbit", [0, 0, 0, 0, 0, 1], 1e6),
];

/// A unit: what it measures and how much of the base units it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unit {
    exponents: Exponents,
    factor: f64,
}

impl Unit {
    /// From `N*m*s/rad`: products and quotients, from left to right.
    fn parse(text: &str) -> Result<Self, String> {
        let mut unit = Self { exponents: [0; 6], factor: 1.0 };
        let mut rest = text;
        let mut sign = 1;
        loop {
            let end = rest.find(['*', '/']).unwrap_or(rest.len());
            let name = rest[..end].trim();
            let Some((_, exponents, factor)) = UNITS.iter().find(|(known, ..)| *known == name)
            else {
                let known: Vec<&str> = UNITS.iter().map(|(name, ..)| *name).collect();
                return Err(format!("unit `{name}`; units: {}", known.join(", ")));
            };
            for (sum, exponent) in unit.exponents.iter_mut().zip(exponents) {
                *sum = sum.saturating_add(sign * exponent);
            }
            unit.factor *= if sign > 0 { *factor } else { 1.0 / factor };
            let Some(separator) = rest[end..].chars().next() else {
                return Ok(unit);
            };
            sign = if separator == '/' { -1 } else { 1 };
            rest = &rest[end + 1..];
        }
    }
}

/// A number in base units (s, m, rad, N, A, bit) from text with a unit of the dimension of `like`.
pub(crate) fn quantity(text: &str, like: &str) -> Result<f64, String> {
    let trimmed = text.trim();
    let split = trimmed
        .char_indices()
        .find(|&(at, c)| c.is_ascii_alphabetic() && !is_exponent(trimmed, at))
        .map_or(trimmed.len(), |(at, _)| at);
    let (number, unit) = trimmed.split_at(split);
    let value = number.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    let value = value.ok_or_else(|| format!("\"{text}\" does not begin with a finite number"))?;
    if unit.is_empty() {
        return Err(format!("no unit in \"{text}\"; expected one like {like}"));
    }
    let unit = Unit::parse(unit)?;
    if unit.exponents != Unit::parse(like)?.exponents {
        return Err(format!("\"{text}\" is no quantity in {like}"));
    }
    Ok(value * unit.factor)
}

/// Whether the letter is the `e` of a number such as `2e-5`.
fn is_exponent(text: &str, at: usize) -> bool {
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let mut after = text[at..].chars().skip(1);
    let next = after.next();
    text[at..].starts_with(['e', 'E'])
        && digit(text[..at].chars().next_back())
        && (digit(next) || next.is_some_and(|c| c == '-' || c == '+') && digit(after.next()))
}

#[cfg(test)]
mod tests {
    use super::quantity;

    #[test]
    fn units_are_converted_multiplied_and_demanded() {
        assert_eq!(quantity("2 ms", "s"), Ok(0.002));
        assert_eq!(quantity("2e-5 rad", "rad"), Ok(2e-5));
        assert_eq!(quantity("180deg", "rad"), Ok(std::f64::consts::PI));
        assert_eq!(quantity("1 Mbit/s", "bit/s"), Ok(1e6));
        assert_eq!(quantity("5 mN*m", "N*m"), Ok(0.005));
        assert_eq!(quantity("3 N*m*s/rad", "N*m*s/rad"), Ok(3.0));
        assert_eq!(quantity("60 N*m/ms", "N*m/s"), Ok(60_000.0));
        for wrong in ["5", "5 ft", "s", "", "nan s", "inf s", "1e999 s", "2 m", "2 s*", "2 s/s"] {
            assert!(quantity(wrong, "s").is_err(), "{wrong}");
        }
    }
}
