//! Units, dimensions and the names physics has for them.

use crate::model::Dimension;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// Exact `n / d`.
pub(crate) fn ratio(n: i64, d: i64) -> BigRational {
    BigRational::new(BigInt::from(n), BigInt::from(d))
}

impl Dimension {
    /// A pure number or an angle.
    pub const NONE: Self = Self { exponents: [(0, 1), (0, 1), (0, 1)] };
    /// m
    pub const LENGTH: Self = Self::whole(1, 0, 0);
    /// kg
    pub const MASS: Self = Self::whole(0, 1, 0);
    /// s
    pub const TIME: Self = Self::whole(0, 0, 1);
    /// m/s²
    pub const ACCELERATION: Self = Self::whole(1, 0, -2);
    /// kg·m²
    pub const INERTIA: Self = Self::whole(2, 1, 0);
    /// J, and N·m
    pub const ENERGY: Self = Self::whole(2, 1, -2);
    /// W
    pub const POWER: Self = Self::whole(2, 1, -3);

    /// Whole exponents of (m, kg, s).
    #[must_use]
    pub const fn whole(m: i16, kg: i16, s: i16) -> Self {
        Self { exponents: [(m, 1), (kg, 1), (s, 1)] }
    }

    /// Whether it is a pure number or an angle.
    #[must_use]
    pub fn is_none(self) -> bool {
        self.exponents.iter().all(|e| e.0 == 0)
    }

    /// Dimension of a product; `None` if an exponent leaves `i16`.
    #[must_use]
    pub fn times(self, other: Self) -> Option<Self> {
        self.combine(other, |a, b| a + b)
    }

    /// Dimension of a quotient; `None` if an exponent leaves `i16`.
    #[must_use]
    pub fn over(self, other: Self) -> Option<Self> {
        self.combine(other, |a, b| a - b)
    }

    /// Dimension of a power; `None` if an exponent leaves `i16`.
    #[must_use]
    pub fn power(self, exponent: &BigRational) -> Option<Self> {
        let mut out = Self::NONE;
        for (slot, e) in out.exponents.iter_mut().zip(self.exponents) {
            *slot = pack(&(exact(e) * exponent))?;
        }
        Some(out)
    }

    fn combine(
        self,
        other: Self,
        f: impl Fn(BigRational, BigRational) -> BigRational,
    ) -> Option<Self> {
        let mut out = Self::NONE;
        for i in 0..3 {
            out.exponents[i] = pack(&f(exact(self.exponents[i]), exact(other.exponents[i])))?;
        }
        Some(out)
    }

    /// SI base units: `kg·m²/s²`, `1` for a number.
    #[must_use]
    pub fn si(self) -> String {
        let [m, kg, s] = self.exponents;
        let named = [("kg", kg), ("m", m), ("s", s)];
        let part = |positive: bool| {
            let list: Vec<String> = named
                .iter()
                .filter(|(_, e)| if positive { e.0 > 0 } else { e.0 < 0 })
                .map(|(n, e)| format!("{n}{}", superscript((e.0.abs(), e.1))))
                .collect();
            list
        };
        let (over, under) = (part(true), part(false));
        match (over.is_empty(), under.len()) {
            (true, 0) => "1".to_owned(),
            (false, 0) => over.join("·"),
            (true, 1) => format!("1/{}", under[0]),
            (true, _) => format!("1/({})", under.join("·")),
            (false, 1) => format!("{}/{}", over.join("·"), under[0]),
            (false, _) => format!("{}/({})", over.join("·"), under.join("·")),
        }
    }

    /// The physical quantity, where it has a name.
    #[must_use]
    pub fn quantity(self) -> Option<&'static str> {
        let named: &[(Self, &str)] = &[
            (Self::NONE, "number or angle"),
            (Self::LENGTH, "length"),
            (Self::MASS, "mass"),
            (Self::TIME, "time"),
            (Self::whole(2, 0, 0), "area"),
            (Self::whole(3, 0, 0), "volume"),
            (Self::whole(1, 0, -1), "speed"),
            (Self::whole(2, 0, -2), "speed squared"),
            (Self::ACCELERATION, "acceleration"),
            (Self::whole(0, 0, -1), "angular speed or frequency"),
            (Self::whole(0, 0, -2), "angular acceleration"),
            (Self::whole(1, 1, 0), "mass times length"),
            (Self::INERTIA, "moment of inertia"),
            (Self::whole(1, 1, -1), "momentum"),
            (Self::whole(2, 1, -1), "angular momentum"),
            (Self::whole(1, 1, -2), "force"),
            (Self::ENERGY, "energy or torque"),
            (Self::POWER, "power"),
            (Self::whole(0, 1, -2), "stiffness"),
            (Self::whole(0, 1, -1), "damping"),
            (Self::whole(-3, 1, 0), "density"),
            (Self::whole(-1, 1, -2), "pressure"),
        ];
        named.iter().find(|(d, _)| *d == self).map(|(_, n)| *n)
    }

    /// `force: kg·m/s²`, or the base units alone.
    #[must_use]
    pub fn describe(self) -> String {
        match self.quantity() {
            Some(name) if self.is_none() => name.to_owned(),
            Some(name) => format!("{name}: {}", self.si()),
            None => self.si(),
        }
    }

    /// As the language writes it: `kg*m^2/s^2`, with `N`, `N*m` where that is usual for a force.
    #[must_use]
    pub fn unit_text(self) -> String {
        if self == Self::ENERGY {
            return "N*m".to_owned();
        }
        if self == Self::whole(1, 1, -2) {
            return "N".to_owned();
        }
        let [m, kg, s] = self.exponents;
        let mut text = String::new();
        for (name, e) in [("kg", kg), ("m", m), ("s", s)].into_iter().filter(|(_, e)| e.0 != 0) {
            if !text.is_empty() {
                text.push('*');
            }
            text.push_str(name);
            match e {
                (1, 1) => {}
                (n, 1) => text.push_str(&format!("^{n}")),
                (n, d) => text.push_str(&format!("^({n}/{d})")),
            }
        }
        if text.is_empty() { "1".to_owned() } else { text }
    }
}

fn exact((n, d): (i16, i16)) -> BigRational {
    ratio(i64::from(n), i64::from(d.max(1)))
}

fn pack(value: &BigRational) -> Option<(i16, i16)> {
    Some((value.numer().to_i16()?, value.denom().to_i16()?))
}

fn superscript((n, d): (i16, i16)) -> String {
    if (n, d) == (1, 1) {
        return String::new();
    }
    if d != 1 {
        return format!("^({n}/{d})");
    }
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    n.to_string().bytes().filter_map(|b| digits.get(usize::from(b.wrapping_sub(b'0')))).collect()
}

/// A unit of the language.
pub(crate) struct NamedUnit {
    pub(crate) name: &'static str,
    pub(crate) dimension: Dimension,
    /// SI units per unit; for `deg` a factor of pi/180 besides.
    pub(crate) scale: (i64, i64),
}

/// Every unit name.
pub(crate) const UNITS: &[NamedUnit] = &[
    unit("m", Dimension::LENGTH, 1, 1),
    unit("mm", Dimension::LENGTH, 1, 1000),
    unit("cm", Dimension::LENGTH, 1, 100),
    unit("km", Dimension::LENGTH, 1000, 1),
    unit("kg", Dimension::MASS, 1, 1),
    unit("s", Dimension::TIME, 1, 1),
    unit("ms", Dimension::TIME, 1, 1000),
    unit("rad", Dimension::NONE, 1, 1),
    unit("deg", Dimension::NONE, 1, 1),
    unit("N", Dimension::whole(1, 1, -2), 1, 1),
    unit("J", Dimension::ENERGY, 1, 1),
    unit("W", Dimension::POWER, 1, 1),
    unit("Hz", Dimension::whole(0, 0, -1), 1, 1),
    unit("Pa", Dimension::whole(-1, 1, -2), 1, 1),
];

const fn unit(name: &'static str, dimension: Dimension, n: i64, d: i64) -> NamedUnit {
    NamedUnit { name, dimension, scale: (n, d) }
}

/// The unit of this name.
pub(crate) fn find(name: &str) -> Option<&'static NamedUnit> {
    UNITS.iter().find(|u| u.name == name)
}

impl NamedUnit {
    /// SI units per unit, `deg` apart.
    pub(crate) fn factor(&self) -> BigRational {
        ratio(self.scale.0, self.scale.1)
    }
}

/// Whether a number has grown beyond what a model can mean.
pub(crate) fn too_big(value: &BigRational) -> bool {
    value.numer().bits() > 8192 || value.denom().bits() > 8192
}

/// `base^exponent` for a small whole exponent.
pub(crate) fn whole_power(base: &BigRational, exponent: i32) -> Option<BigRational> {
    let bits = base
        .numer()
        .bits()
        .max(base.denom().bits())
        .saturating_mul(u64::from(exponent.unsigned_abs()));
    if bits > 16_384 || (exponent < 0 && base.is_zero()) {
        return None;
    }
    if exponent == 0 {
        return Some(BigRational::one());
    }
    Some(num_traits::Pow::pow(base, exponent))
}

/// A number for a message: decimal where that is short, else as a fraction.
pub(crate) fn decimal(value: &BigRational) -> String {
    match value.to_f64() {
        Some(v) if v.is_finite() => format!("{v}"),
        _ => value.to_string(),
    }
}
