//! Why there is no plan.

use std::fmt;

/// Why there is no plan, in the user's words; messages begin with the place of the task that is to
/// blame, if there is one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The task makes no sense for the robot.
    Task {
        /// What is wrong with it.
        message: String,
        /// What may have been meant.
        help: Option<String>,
    },
    /// The task makes sense, but its plan does not work out.
    Plan {
        /// Why.
        message: String,
    },
}

/// What planning returns.
pub(crate) type Outcome<T = ()> = Result<T, Refusal>;

impl Refusal {
    /// A task that makes no sense.
    pub fn task(message: impl fmt::Display) -> Self {
        Self::Task { message: message.to_string(), help: None }
    }

    /// A plan that does not work out.
    pub fn plan(message: impl fmt::Display) -> Self {
        Self::Plan { message: message.to_string() }
    }

    /// An unknown name, with the closest of the known ones.
    pub fn unknown<'a>(what: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        Self::Task { message: format!("no {what} `{name}`"), help: suggestion(name, &known) }
    }

    /// The same with the place of what it is about ahead of it, unless it has one.
    #[must_use]
    pub fn at(self, place: &str) -> Self {
        let placed = |message: String| {
            if place.is_empty() || message.starts_with(place) {
                return message;
            }
            format!("{place}: {message}")
        };
        match self {
            Self::Task { message, help } => Self::Task { message: placed(message), help },
            Self::Plan { message } => Self::Plan { message: placed(message) },
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Task { message, help: Some(help) } => write!(f, "{message}; {help}"),
            Self::Task { message, help: None } | Self::Plan { message } => f.write_str(message),
        }
    }
}

impl std::error::Error for Refusal {}

/// A suggestion for an unknown name: the closest of the known ones, or all of them.
#[must_use]
pub fn suggestion(name: &str, known: &[&str]) -> Option<String> {
    match closest(name, known) {
        Some(close) => Some(format!("did you mean `{close}`?")),
        None if known.is_empty() => None,
        None => Some(format!("known: {}", known.join(", "))),
    }
}

/// The known name that is closest, if one is close.
fn closest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    if name.len() > 64 {
        return None;
    }
    let allowed = 1 + name.chars().count() / 3;
    let distance =
        |other: &str| strsim::damerau_levenshtein(&name.to_lowercase(), &other.to_lowercase());
    let candidates = known.iter().map(|&other| (distance(other), other));
    candidates.filter(|(d, _)| *d <= allowed).min().map(|(_, other)| other)
}

#[cfg(test)]
mod tests {
    use super::closest;

    #[test]
    fn the_closest_name_is_close() {
        let known = ["hopper", "hopper_arms", "cart_planar"];
        assert_eq!(closest("hoper", &known), Some("hopper"));
        assert_eq!(closest("glider", &known), None);
    }
}
