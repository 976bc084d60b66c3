//! Numbers for people.

use std::time::Duration;

/// A length with as many decimals as tenths of a millimetre, more where it is shorter than that.
pub(crate) fn metres(value: f64) -> String {
    if value == 0.0 || value.abs() >= 5e-5 { format!("{value:.4}") } else { format!("{value:.1e}") }
}

/// About `digits` significant digits.
pub(crate) fn significant(value: f64, digits: usize) -> String {
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

/// A duration in the unit that suits it.
pub(crate) fn duration(value: Duration) -> String {
    let seconds = value.as_secs_f64();
    match seconds {
        s if s >= 1.0 => format!("{s:.3} s"),
        s if s >= 1e-3 => format!("{:.2} ms", s * 1e3),
        s => format!("{:.1} µs", s * 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::{duration, metres, significant};
    use std::time::Duration;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!(metres(0.02113), "0.0211");
        assert_eq!(metres(0.000_012), "1.2e-5");
        assert_eq!(significant(82.162_65, 4), "82.16");
        assert_eq!(significant(-0.001_234_5, 3), "-0.00123");
        assert_eq!(significant(1.5e-9, 3), "1.50e-9");
        assert_eq!(duration(Duration::from_micros(1520)), "1.52 ms");
    }
}
