//! Identifiers: NFC, then ASCII. `θ` and `theta` are one name.

use unicode_normalization::UnicodeNormalization;

/// ASCII spelling of an identifier; `Err` with the first character that has none.
pub(crate) fn ascii(text: &str) -> Result<String, char> {
    if text.is_ascii() {
        return Ok(text.to_owned());
    }
    let mut out = String::new();
    for c in text.nfc() {
        if c.is_ascii() {
            out.push(c);
        } else {
            out.push_str(greek(c).ok_or(c)?);
        }
    }
    Ok(out)
}

fn greek(c: char) -> Option<&'static str> {
    Some(match c {
        'α' => "alpha",
        'β' | 'ϐ' => "beta",
        'γ' => "gamma",
        'δ' => "delta",
        'ε' | 'ϵ' => "epsilon",
        'ζ' => "zeta",
        'η' => "eta",
        'θ' | 'ϑ' => "theta",
        'ι' => "iota",
        'κ' | 'ϰ' => "kappa",
        'λ' => "lambda",
        'μ' | 'µ' => "mu",
        'ν' => "nu",
        'ξ' => "xi",
        'ο' => "omicron",
        'π' => "pi",
        'ρ' | 'ϱ' => "rho",
        'σ' | 'ς' => "sigma",
        'τ' => "tau",
        'υ' => "upsilon",
        'φ' | 'ϕ' => "phi",
        'χ' => "chi",
        'ψ' => "psi",
        'ω' => "omega",
        'Γ' => "Gamma",
        'Δ' => "Delta",
        'Θ' => "Theta",
        'Λ' => "Lambda",
        'Ξ' => "Xi",
        'Π' => "Pi",
        'Σ' => "Sigma",
        'Φ' => "Phi",
        'Ψ' => "Psi",
        'Ω' => "Omega",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::ascii;

    #[test]
    fn greek_becomes_ascii() {
        assert_eq!(ascii("θ_x").as_deref(), Ok("theta_x"));
        assert_eq!(ascii("ℓ_b"), Err('ℓ'));
    }
}
