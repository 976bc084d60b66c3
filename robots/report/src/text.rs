//! Text for HTML.

/// Escapes text for element content and quoted attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(other),
        }
    }
    out
}

/// A number with at most `digits` significant digits, without trailing zeros.
pub(crate) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return if value.is_nan() {
            "–"
        } else if value > 0.0 {
            "∞"
        } else {
            "−∞"
        }
        .to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    let text = if (-4.0..6.0).contains(&magnitude) {
        let places = (digits as f64 - 1.0 - magnitude).max(0.0) as usize;
        let text = format!("{value:.places$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        scientific(value, digits)
    };
    text.replace('-', "−")
}

/// `kg*m^2` as `kg·m²`.
pub(crate) fn unit(unit: &str) -> String {
    unit.replace('*', "·").replace("^2", "²").replace("^3", "³")
}

/// `1.2e-7` as `1.2·10⁻⁷`.
fn scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    let raised = exponent.chars().filter_map(|c| match c {
        '-' => Some('⁻'),
        digit => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10)? as usize),
    });
    format!("{mantissa}·10{}", raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(0.05, 4), "0.05");
        assert_eq!(number(70.3, 4), "70.3");
        assert_eq!(number(-100.0, 3), "−100");
        assert_eq!(number(0.000_024, 3), "2.4·10⁻⁵");
        assert_eq!(number(1_000_000.0, 3), "1·10⁶");
        assert_eq!(number(99_999.9, 3), "100000");
        assert_eq!(number(f64::INFINITY, 3), "∞");
        assert_eq!(number(-0.0, 3), "0");
    }

    #[test]
    fn markup_is_escaped() {
        assert_eq!(escape("<a b=\"c\">'&"), "&lt;a b=&quot;c&quot;&gt;&#39;&amp;");
    }
}
