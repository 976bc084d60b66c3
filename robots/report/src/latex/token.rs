//! LaTeX as tokens.

/// A token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    /// `\name`, or `\` and one sign.
    Command(String),
    /// A letter.
    Letter(char),
    /// Digits with at most one point.
    Number(String),
    /// Any other sign.
    Sign(char),
    /// `{`.
    Open,
    /// `}`.
    Close,
    /// `_`.
    Sub,
    /// `^`.
    Sup,
    /// `&`.
    NewCell,
    /// `\\`.
    NewRow,
}

/// Splits a text.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let token = match c {
            c if c.is_whitespace() => continue,
            '{' => Token::Open,
            '}' => Token::Close,
            '_' => Token::Sub,
            '^' => Token::Sup,
            '&' => Token::NewCell,
            '\\' => {
                let mut name = String::new();
                while let Some(letter) = rest.next_if(char::is_ascii_alphabetic) {
                    name.push(letter);
                }
                if name.is_empty() {
                    name.extend(rest.next());
                }
                if name == "\\" { Token::NewRow } else { Token::Command(name) }
            }
            c if c.is_ascii_digit() => {
                let mut number = String::from(c);
                while let Some(digit) = rest.next_if(|c| c.is_ascii_digit() || *c == '.') {
                    number.push(digit);
                }
                Token::Number(number)
            }
            c if c.is_alphabetic() => Token::Letter(c),
            c => Token::Sign(c),
        };
        tokens.push(token);
    }
    tokens
}

/// The letter that a command stands for.
pub(super) fn letter(command: &str) -> Option<&'static str> {
    const LETTERS: [(&str, &str); 34] = [
        ("alpha", "α"),
        ("beta", "β"),
        ("gamma", "γ"),
        ("delta", "δ"),
        ("epsilon", "ε"),
        ("varepsilon", "ε"),
        ("zeta", "ζ"),
        ("eta", "η"),
        ("theta", "θ"),
        ("iota", "ι"),
        ("kappa", "κ"),
        ("lambda", "λ"),
        ("mu", "μ"),
        ("nu", "ν"),
        ("xi", "ξ"),
        ("pi", "π"),
        ("rho", "ρ"),
        ("sigma", "σ"),
        ("tau", "τ"),
        ("upsilon", "υ"),
        ("phi", "φ"),
        ("chi", "χ"),
        ("psi", "ψ"),
        ("omega", "ω"),
        ("Gamma", "Γ"),
        ("Delta", "Δ"),
        ("Theta", "Θ"),
        ("Lambda", "Λ"),
        ("Sigma", "Σ"),
        ("Phi", "Φ"),
        ("Psi", "Ψ"),
        ("Omega", "Ω"),
        ("ell", "ℓ"),
        ("partial", "∂"),
    ];
    LETTERS.iter().find(|(name, _)| *name == command).map(|(_, letter)| *letter)
}
