//! Names of symbols, as the model file spells them and as a formula sets them.

/// `phi_x` as `\phi_x`, `l_b` as `\ell_b`, `I_b_xx` as `I_{b,xx}`, `Ixx_b` as `I_{xx,b}`.
pub(super) fn latex_name(name: &str) -> String {
    let (base, subscripts) = split(name);
    format!("{base}{}", subscript(&subscripts))
}

/// The same with an accent on the letter: `\dot{\phi}_x`.
pub(super) fn latex_accented(accent: &str, name: &str) -> String {
    let (base, subscripts) = split(name);
    format!("{accent}{{{base}}}{}", subscript(&subscripts))
}

fn split(name: &str) -> (String, Vec<String>) {
    let mut parts = name.split(['_', '.']).filter(|part| !part.is_empty());
    let base = parts.next().unwrap_or("x");
    let mut subscripts: Vec<String> = Vec::new();
    let letter = if let Some(axes) = inertia_axes(base) {
        subscripts.push(axes.to_owned());
        "I".to_owned()
    } else {
        let digits = base.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        if digits > 0 && digits < base.len() {
            subscripts.push(base[digits..].to_owned());
        }
        letter(if digits > 0 { &base[..digits] } else { base })
    };
    subscripts.extend(parts.map(subscript_part));
    (letter, subscripts)
}

fn inertia_axes(base: &str) -> Option<&str> {
    let axes = base.strip_prefix('I')?;
    (axes.len() == 2 && axes.chars().all(|c| "xyz".contains(c))).then_some(axes)
}

fn subscript(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] if one.chars().count() == 1 => format!("_{one}"),
        _ => format!("_{{{}}}", parts.join(",")),
    }
}

fn subscript_part(part: &str) -> String {
    if is_greek(part) {
        format!("\\{part}")
    } else if part.chars().count() > 2 {
        format!("\\mathrm{{{part}}}")
    } else {
        part.to_owned()
    }
}

fn letter(base: &str) -> String {
    match base {
        "l" => "\\ell".to_owned(),
        _ if is_greek(base) => format!("\\{base}"),
        _ if base.chars().count() == 1 => base.to_owned(),
        _ => format!("\\mathrm{{{base}}}"),
    }
}

fn is_greek(word: &str) -> bool {
    const LETTERS: [&str; 33] = [
        "alpha",
        "beta",
        "gamma",
        "delta",
        "epsilon",
        "varepsilon",
        "zeta",
        "eta",
        "theta",
        "iota",
        "kappa",
        "lambda",
        "mu",
        "nu",
        "xi",
        "pi",
        "rho",
        "sigma",
        "tau",
        "upsilon",
        "phi",
        "varphi",
        "chi",
        "psi",
        "omega",
        "Gamma",
        "Delta",
        "Theta",
        "Lambda",
        "Sigma",
        "Phi",
        "Psi",
        "Omega",
    ];
    LETTERS.contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_set_as_letters_with_subscripts() {
        let cases = [
            ("phi_x", "\\phi_x"),
            ("phi.x", "\\phi_x"),
            ("r_w", "r_w"),
            ("l_b", "\\ell_b"),
            ("I_b_xx", "I_{b,xx}"),
            ("Ixx_b", "I_{xx,b}"),
            ("alpha_l_x", "\\alpha_{l,x}"),
            ("m1", "m_1"),
            ("tau_max", "\\tau_{\\mathrm{max}}"),
            ("mass", "\\mathrm{mass}"),
        ];
        for (name, latex) in cases {
            assert_eq!(latex_name(name), latex);
        }
        assert_eq!(latex_accented("\\dot", "phi_x"), "\\dot{\\phi}_x");
    }
}
