//! Identifiers of the emitted code.

use shapebot_symbolic::Symbol;
use std::collections::BTreeSet;

/// Names that emitted bodies use themselves.
const RESERVED: &[&str] = &[
    "c", "q", "qd", "qdd", "qx", "qs", "qsd", "qsdd", "force", "params", "columns", "vector",
    "entries", "frame", "point", "actuator",
];

/// Types that an emitted module names without a path.
const RESERVED_TYPES: &[&str] = &[
    "ArrayStorage",
    "Clone",
    "Copy",
    "Debug",
    "Default",
    "Eq",
    "Err",
    "Ok",
    "Params",
    "PartialEq",
    "Real",
    "Result",
    "SMatrix",
    "SVector",
    "Self",
    "T",
];

/// An identifier of emitted code from a name of the model: `left.arm` becomes `left_arm`.
pub(super) fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut text: String = name.chars().map(plain).collect();
    if text.starts_with(|c: char| c.is_ascii_digit()) {
        text.insert(0, '_');
    }
    if text.bytes().all(|b| b == b'_') {
        text.push('x');
    }
    if syn::parse_str::<syn::Ident>(&text).is_err() {
        text.push('_');
    }
    text
}

/// A type name: `ballbot_2d` becomes `Ballbot2d`, `BallbotWithArms` stays.
pub(super) fn type_name(name: &str) -> String {
    let text = identifier(name);
    let parts = text.split('_').filter(|part| !part.is_empty());
    let camel: String = parts
        .map(|part| {
            part.chars().next().map_or('X', |c| c.to_ascii_uppercase()).to_string() + &part[1..]
        })
        .collect();
    if RESERVED_TYPES.contains(&camel.as_str()) { camel + "Robot" } else { camel }
}

/// Hands out each name once.
#[derive(Clone, Debug)]
pub(super) struct Names {
    taken: BTreeSet<String>,
}

impl Names {
    /// With the names that bodies use themselves taken.
    pub(super) fn new() -> Self {
        Self { taken: RESERVED.iter().map(|&name| name.to_owned()).collect() }
    }

    /// No name is taken.
    pub(super) fn empty() -> Self {
        Self { taken: BTreeSet::new() }
    }

    /// The name, or `name_`, `name_2`, … if it is taken.
    pub(super) fn take(&mut self, name: &str) -> String {
        let base = identifier(name);
        let mut candidate = base.clone();
        let mut number = 1;
        while !self.taken.insert(candidate.clone()) {
            candidate = if number == 1 && RESERVED.contains(&base.as_str()) {
                format!("{base}_")
            } else {
                format!("{base}_{}", number + 1)
            };
            number += 1;
        }
        candidate
    }

    /// `prefix_1`, `prefix_2`, …: the first that is free, counting on from `last`.
    pub(super) fn number(&mut self, prefix: &str, last: &mut usize) -> String {
        loop {
            *last += 1;
            let candidate = identifier(&format!("{prefix}_{last}"));
            if self.taken.insert(candidate.clone()) {
                return candidate;
            }
        }
    }
}

/// Names of a model's symbols in emitted bodies.
#[derive(Clone, Debug)]
pub(super) struct SymbolNames {
    /// `r_w`
    pub(super) parameters: Vec<String>,
    /// Fields of `Params`.
    pub(super) fields: Vec<String>,
    /// `phi_x`
    pub(super) coordinates: Vec<String>,
    /// `phi_x_d`
    pub(super) rates: Vec<String>,
    /// `phi_x_dd`
    pub(super) accelerations: Vec<String>,
    /// `force_phi_x`
    pub(super) forces: Vec<String>,
    /// All of the above taken.
    pub(super) taken: Names,
}

impl SymbolNames {
    /// Names in the order of the model; coordinates have the first choice.
    pub(super) fn new(coordinates: &[&str], parameters: &[&str]) -> Self {
        let mut names = Names::new();
        let coordinates: Vec<String> = coordinates.iter().map(|name| names.take(name)).collect();
        let parameters_local = parameters.iter().map(|name| names.take(name)).collect();
        let mut fields = Names::empty();
        let mut derived = |suffix: &str, prefix: &str| -> Vec<String> {
            coordinates.iter().map(|name| names.take(&format!("{prefix}{name}{suffix}"))).collect()
        };
        let (rates, accelerations) = (derived("_d", ""), derived("_dd", ""));
        let forces = derived("", "force_");
        Self {
            parameters: parameters_local,
            fields: parameters.iter().map(|name| fields.take(name)).collect(),
            coordinates,
            rates,
            accelerations,
            forces,
            taken: names,
        }
    }

    /// Local name of a symbol.
    pub(super) fn of(&self, symbol: Symbol) -> &str {
        let (list, i) = match symbol {
            Symbol::Parameter(i) => (&self.parameters, i),
            Symbol::Coordinate(i) => (&self.coordinates, i),
            Symbol::Rate(i) => (&self.rates, i),
            Symbol::Acceleration(i) => (&self.accelerations, i),
            Symbol::Force(i) => (&self.forces, i),
            Symbol::Auxiliary(_) => return "undefined",
        };
        list.get(i as usize).map_or("undefined", String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_keywords_and_foreign_letters_become_identifiers() {
        assert_eq!(identifier("left.arm"), "left_arm");
        assert_eq!(identifier("type"), "type_");
        assert_eq!(identifier("self"), "self_");
        assert_eq!(identifier("2d"), "_2d");
        assert_eq!(identifier("φ"), "_x");
    }

    #[test]
    fn type_names_are_camel_case_and_avoid_our_own() {
        assert_eq!(type_name("BallbotWithArms"), "BallbotWithArms");
        assert_eq!(type_name("cart_pole"), "CartPole");
        assert_eq!(type_name("params"), "ParamsRobot");
        assert_eq!(type_name("Result"), "ResultRobot");
    }

    #[test]
    fn a_name_is_given_once() {
        let mut names = Names::new();
        assert_eq!(names.take("a"), "a");
        assert_eq!(names.take("a"), "a_2");
        assert_eq!(names.take("c"), "c_");
        let mut last = 0;
        assert_eq!(names.number("a", &mut last), "a_1");
        assert_eq!(names.number("a", &mut last), "a_3");
    }
}
