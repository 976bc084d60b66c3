//! The table of all diagnostic codes. A code exists if and only if it stands here; its page is
//! `diagnostics/CODE.md`.

use crate::diagnostic::Code;

/// A row of the table.
pub(crate) struct Entry {
    pub(crate) code: Code,
    pub(crate) title: &'static str,
    pub(crate) page: &'static str,
}

macro_rules! table {
    ($($name:ident $title:literal;)*) => {
        $(#[doc = $title] pub const $name: Code = Code::new(stringify!($name));)*

        pub(crate) const TABLE: &[Entry] = &[$(Entry {
            code: $name,
            title: $title,
            page: include_str!(concat!("../diagnostics/", stringify!($name), ".md")),
        }),*];
    };
}

table! {
    E0001 "the file is not UTF-8";
    E0002 "the file is too large";
    E0003 "the file holds no robot";
    E0004 "a character that is not part of the language";
    E0005 "brackets are nested too deeply";
    E0006 "a bracket without its partner";
    E0007 "a number that cannot be read";
    E0008 "a name without an ASCII spelling";
    E0009 "a literal that is not part of the language";
    E0010 "an error of shapebot itself";
    E0101 "something else was expected";
    E0102 "the file does not begin with a robot";
    E0103 "an unknown statement";
    E0104 "a missing operator";
    E0105 "a number's unit is also a name";
    E0106 "gravity needs an axis of the world";
    E0107 "out of place at the top level";
    E0108 "a malformed time derivative";
    E0109 "a statement not allowed here";
    E0110 "wrong fields of a rigid body";
    E0201 "an unknown name";
    E0202 "a name declared twice";
    E0203 "two names that become one in the generated code";
    E0204 "an unknown member";
    E0205 "a name that cannot be used";
    E0206 "a name used before its declaration";
    E0207 "an unknown unit";
    E0208 "an unknown function, component or solid";
    E0209 "a function that is not smooth";
    E0301 "unlike quantities in a sum";
    E0302 "a function of something that is no number or angle";
    E0303 "an exponent that is no constant number";
    E0304 "a quantity of the wrong dimension";
    E0305 "division by zero";
    E0306 "an exponent out of range";
    E0307 "an energy that is not in joules";
    E0308 "a dissipation that is not in watts";
    E0309 "unlike quantities compared";
    E0310 "degrees as a declared unit";
    E0401 "a scalar or another simple value is needed";
    E0402 "kinds that do not go together";
    E0403 "a vector is needed";
    E0404 "a frame is needed";
    E0405 "a position that is no sum of components in frames";
    E0406 "arrays of different lengths";
    E0407 "a wrong number of arguments";
    E0408 "a motor or a brake must work on a rate";
    E0409 "an inertia of the wrong kind";
    E0501 "a robot without kinetic energy";
    E0502 "a robot without coordinates";
    E0503 "an output of the wrong size";
    E0504 "a value outside its own range";
    E0505 "an empty range";
    E0506 "declared twice where once is meant";
    E0507 "something that must be constant is not";
    E0508 "a rate where only positions make sense";
    E0509 "the model is too large";
    E0510 "a component that contains itself";
    E0511 "mirror of things that are not alike";
    E0512 "an index that is no whole number";
    E0513 "a requirement that the model's own values break";
    E0514 "a negative quantity that cannot be negative";
    W0501 "a parameter that is never used";
    W0502 "an inertia without effect";
    P0601 "the number of unactuated equations does not fit";
    P0602 "an unactuated equation depends on a position variable";
    P0603 "an unactuated equation depends on a position rate";
    P0604 "the coupling to the position acceleration is singular at the origin";
    P0605 "the origin is no equilibrium";
    P0606 "the constraint's linearisation is rank deficient";
    P0607 "input coupling";
    P0608 "the mirror requirement does not hold";
    P0609 "the output's Jacobian is not constant or is singular";
    P0610 "the kinetic energy is no quadratic form in the rates";
    P0611 "the mass matrix is not positive definite";
    P0612 "a shape set that cannot accelerate the robot in every direction";
    P0613 "the coupling becomes singular within the declared ranges";
    P0614 "a potential that depends on rates";
    P0615 "a construct that the derivation does not support";
}

pub(crate) fn entry(code: &str) -> Option<&'static Entry> {
    TABLE.iter().find(|e| e.code.as_str().eq_ignore_ascii_case(code))
}
