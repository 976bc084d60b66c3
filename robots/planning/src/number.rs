//! Numbers for people.

use std::time::Duration;

/// A length in tenths of millimetres, in two digits where it is short.
#[must_use]
pub fn metres(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        short if short < 1e-4 => format!("{value:.1e}"),
        short if short < 5e-3 => significant(value, 2),
        _ => format!("{value:.4}"),
    }
}

/// A share of the whole, without zeros at its end.
#[must_use]
pub fn share(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// About `digits` significant digits.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (digits as f64 - 1.0 - magnitude).max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// Values for people: angles in degrees, four digits.
#[must_use]
pub fn shown<const N: usize>(unit: &str, values: [f64; N]) -> (&str, [String; N]) {
    let text = |value: f64| {
        let text = significant(value, 4);
        let fraction = text.contains('.') && !text.contains('e');
        if fraction { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    match unit {
        "rad" => ("deg", values.map(|value| text(value.to_degrees()))),
        _ => (unit, values.map(text)),
    }
}

/// A duration in the unit that suits it.
#[must_use]
pub fn duration(value: Duration) -> String {
    let seconds = value.as_secs_f64();
    match seconds {
        s if s >= 1.0 => format!("{s:.3} s"),
        s if s >= 1e-3 => format!("{:.2} ms", s * 1e3),
        s => format!("{:.1} µs", s * 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::{duration, metres, share, shown, significant};
    use std::time::Duration;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!(metres(0.02113), "0.0211");
        assert_eq!(metres(0.000_012), "1.2e-5");
        assert_eq!(metres(0.000_247), "0.00025");
        assert_eq!((share(1.0 / 3.0), share(1.0)), ("0.3333".to_owned(), "1".to_owned()));
        assert_eq!(significant(82.162_65, 4), "82.16");
        assert_eq!(significant(-0.001_234_5, 3), "-0.00123");
        assert_eq!(significant(1.5e-9, 3), "1.50e-9");
        let range = [0.548_558, -30_f64.to_radians(), f64::INFINITY];
        assert_eq!(shown("rad", range), ("deg", ["31.43", "-30", "inf"].map(str::to_owned)));
        assert_eq!(duration(Duration::from_micros(1520)), "1.52 ms");
    }
}
