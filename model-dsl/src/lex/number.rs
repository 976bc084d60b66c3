//! Number literals as exact rationals.

use crate::units::ratio;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Num;

/// Longest literal and largest decimal exponent.
const MAX_DIGITS: usize = 200;
const MAX_EXPONENT: i32 = 400;

/// A literal with its unit suffix, if it has one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Literal {
    pub(crate) value: BigRational,
    /// `deg` of `80deg`.
    pub(crate) suffix: Option<String>,
    /// Length of the numeric part in bytes.
    pub(crate) digits: usize,
}

/// Why a literal is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BadNumber {
    TooLong,
    ExponentTooLarge,
    Radix,
    NotANumber,
}

/// Reads `12`, `0.1058`, `1e-3`, `1_000`, `80deg`.
pub(crate) fn parse(text: &str) -> Result<Literal, BadNumber> {
    let bytes = text.as_bytes();
    if !bytes.first().is_some_and(u8::is_ascii_digit) {
        return Err(BadNumber::NotANumber);
    }
    if bytes[0] == b'0' && matches!(bytes.get(1), Some(b'x' | b'o' | b'b')) {
        return Err(BadNumber::Radix);
    }
    let whole = run(bytes, 0);
    let fraction = if bytes.get(whole) == Some(&b'.') { run(bytes, whole + 1) } else { whole };
    let (exponent, end) = exponent(text, fraction)?;
    let digits: String = text[..fraction].chars().filter(char::is_ascii_digit).collect();
    if digits.len() > MAX_DIGITS {
        return Err(BadNumber::TooLong);
    }
    let after_point = text[whole..fraction].bytes().filter(u8::is_ascii_digit).count();
    let mantissa = BigInt::from_str_radix(&digits, 10).map_err(|_| BadNumber::NotANumber)?;
    let shift = exponent - i32::try_from(after_point).map_err(|_| BadNumber::TooLong)?;
    let value = BigRational::from_integer(mantissa) * num_traits::Pow::pow(ratio(10, 1), shift);
    let suffix = (end < text.len()).then(|| text[end..].to_owned());
    Ok(Literal { value, suffix, digits: end })
}

fn run(bytes: &[u8], from: usize) -> usize {
    from + bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'_').count()
}

/// The decimal exponent and where it ends. `5eV` has none: `eV` is its suffix.
fn exponent(text: &str, at: usize) -> Result<(i32, usize), BadNumber> {
    let bytes = text.as_bytes();
    if !matches!(bytes.get(at), Some(b'e' | b'E')) {
        return Ok((0, at));
    }
    let signed = at + 1 + usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
    if !bytes.get(signed).is_some_and(u8::is_ascii_digit) {
        return Ok((0, at));
    }
    let end = run(bytes, signed);
    let digits: String = text[at + 1..end].chars().filter(|c| *c != '_').collect();
    match digits.parse::<i32>() {
        Ok(e) if e.abs() <= MAX_EXPONENT => Ok((e, end)),
        _ => Err(BadNumber::ExponentTooLarge),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::ToPrimitive;

    #[test]
    fn literals_are_exact() {
        assert_eq!(parse("0.1058").unwrap().value, ratio(1058, 10_000));
        assert_eq!(parse("1e-3").unwrap().value, ratio(1, 1000));
        assert_eq!(parse("1.5E+2").unwrap().value, ratio(150, 1));
        assert_eq!(parse("1_000").unwrap().value, ratio(1000, 1));
        assert_eq!(parse("2.").unwrap().value, ratio(2, 1));
    }

    #[test]
    fn suffixes_are_units_not_exponents() {
        let degrees = parse("80deg").unwrap();
        assert_eq!(
            (degrees.value, degrees.suffix.as_deref(), degrees.digits),
            (ratio(80, 1), Some("deg"), 2)
        );
        assert_eq!(parse("5eV").unwrap().suffix.as_deref(), Some("eV"));
    }

    #[test]
    fn monsters_are_refused() {
        assert_eq!(parse("1e999999999"), Err(BadNumber::ExponentTooLarge));
        assert_eq!(parse(&"9".repeat(5000)), Err(BadNumber::TooLong));
        assert_eq!(parse("0x1f"), Err(BadNumber::Radix));
    }

    #[test]
    fn the_nearest_double_is_what_rust_reads() {
        for text in [
            "0.1058",
            "9.81",
            "0.18415",
            "1e-7",
            "123456789.123456789",
            "0.3",
            "2.2250738585072014e-308",
        ] {
            let ours = parse(text).unwrap().value.to_f64().unwrap();
            assert_eq!(ours.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
        }
    }
}
