//! Units: `kg*m^2`, `m/s^2`, `N*m/rad`, `1/s`.

use super::{Parse, Parser};
use crate::ast::WrittenUnit;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::lex::Kind;
use crate::model::{Dimension, Unit};
use crate::suggest::closest;
use crate::units::{self, ratio};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

impl Parser<'_> {
    /// A unit; a refused one is reported and poisoned.
    pub(super) fn unit(&mut self) -> Parse<WrittenUnit> {
        let start = self.span();
        let mut state = UnitState {
            dimension: Some(Dimension::NONE),
            scale: Some(BigRational::one()),
            degrees: false,
        };
        let mut text = String::new();
        let mut divide = false;
        loop {
            let (factor, factor_text) = self.unit_factor()?;
            state.apply(&factor, divide);
            text.push_str(&factor_text);
            divide = match self.peek() {
                Kind::Punct('*') => false,
                Kind::Punct('/') => true,
                _ => break,
            };
            text.push(if divide { '/' } else { '*' });
            self.advance();
        }
        let unit = match (state.dimension, state.scale) {
            (Some(dimension), Some(scale)) => Some(Unit { dimension, text, scale }),
            _ => None,
        };
        Ok(WrittenUnit { unit, degrees: state.degrees, span: self.since(start) })
    }

    fn unit_factor(&mut self) -> Parse<(UnitState, String)> {
        let (base, text) = self.unit_atom()?;
        if !self.eat_punct('^') {
            return Ok((base, text));
        }
        let start = self.span();
        let exponent = self.unit_exponent()?;
        let span = self.since(start);
        let raised = base.raise(&exponent);
        if raised.dimension.is_none() && base.dimension.is_some() {
            self.sink.push(Diagnostic::error(
                codes::E0306,
                span,
                "this exponent of a unit is out of range",
            ));
        }
        let shown =
            if exponent.is_integer() { exponent.to_string() } else { format!("({exponent})") };
        Ok((raised, format!("{text}^{shown}")))
    }

    fn unit_atom(&mut self) -> Parse<(UnitState, String)> {
        let span = self.span();
        match self.peek().clone() {
            Kind::Number(literal) if literal.value.is_one() && literal.suffix.is_none() => {
                self.advance();
                Ok((UnitState::one(), "1".to_owned()))
            }
            Kind::Open('(') => {
                self.advance();
                let inner = self.unit()?;
                self.close(')', "after the unit in parentheses")?;
                let state = UnitState {
                    dimension: inner.unit.as_ref().map(|u| u.dimension),
                    scale: inner.unit.as_ref().map(|u| u.scale.clone()),
                    degrees: inner.degrees,
                };
                let text = inner.unit.map_or(String::new(), |u| u.text);
                Ok((state, format!("({text})")))
            }
            Kind::Ident(name) => {
                self.advance();
                let Some(unit) = units::find(&name) else {
                    self.unknown_unit(&name, span);
                    return Ok((UnitState::poison(), name));
                };
                let state = UnitState {
                    dimension: Some(unit.dimension),
                    scale: Some(unit.factor()),
                    degrees: name == "deg",
                };
                Ok((state, name))
            }
            _ => Err(self.expected("a unit such as `kg*m^2`, or `1` for a number")),
        }
    }

    fn unknown_unit(&mut self, name: &str, span: crate::Span) {
        let help = match name {
            "g" | "gram" => Some("write masses in `kg`".to_owned()),
            "kgm" => Some("write `kg*m`".to_owned()),
            "Nm" => Some("write `N*m`".to_owned()),
            "meter" | "metre" | "meters" | "metres" => Some("write `m`".to_owned()),
            "kilogram" | "kilograms" => Some("write `kg`".to_owned()),
            "second" | "seconds" | "sec" => Some("write `s`".to_owned()),
            "radian" | "radians" => Some("write `rad`".to_owned()),
            "newton" | "newtons" => Some("write `N`".to_owned()),
            "joule" | "joules" => Some("write `J`".to_owned()),
            "watt" | "watts" => Some("write `W`".to_owned()),
            "degree" | "degrees" => Some("write `rad` and give values as `30deg`".to_owned()),
            _ => closest(name, units::UNITS.iter().map(|u| u.name))
                .map(|n| format!("did you mean `{n}`?")),
        };
        let known: Vec<&str> = units::UNITS.iter().map(|u| u.name).collect();
        self.sink.push(
            Diagnostic::error(codes::E0207, span, format!("there is no unit `{name}`"))
                .label("unknown unit")
                .note(format!("the units are {}", known.join(", ")))
                .maybe_help(help),
        );
    }

    fn unit_exponent(&mut self) -> Parse<BigRational> {
        let parenthesised = self.eat(&Kind::Open('('));
        let sign = if self.eat_punct('-') { -1 } else { 1 };
        let n = self.small_whole()?;
        if !parenthesised {
            return Ok(ratio(sign * n, 1));
        }
        let d = if self.eat_punct('/') { self.small_whole()? } else { 1 };
        self.close(')', "after the exponent")?;
        if d == 0 {
            return Err(self.expected("a divisor other than zero"));
        }
        Ok(ratio(sign * n, d))
    }

    fn small_whole(&mut self) -> Parse<i64> {
        let number = match self.peek() {
            Kind::Number(literal) if literal.value.is_integer() && literal.suffix.is_none() => {
                literal.value.to_i64()
            }
            _ => None,
        };
        match number.filter(|n| n.abs() <= 1000) {
            Some(n) => {
                self.advance();
                Ok(n)
            }
            None => Err(self.expected("a whole number as exponent of a unit")),
        }
    }
}

struct UnitState {
    dimension: Option<Dimension>,
    scale: Option<BigRational>,
    degrees: bool,
}

impl UnitState {
    fn one() -> Self {
        Self { dimension: Some(Dimension::NONE), scale: Some(BigRational::one()), degrees: false }
    }

    fn poison() -> Self {
        Self { dimension: None, scale: None, degrees: false }
    }

    fn raise(&self, exponent: &BigRational) -> Self {
        let scale = match (&self.scale, exponent.is_integer().then(|| exponent.to_i32()).flatten())
        {
            (Some(s), _) if s.is_one() => Some(BigRational::one()),
            (Some(s), Some(e)) => units::whole_power(s, e),
            _ => None,
        };
        Self {
            dimension: self.dimension.and_then(|d| d.power(exponent)),
            scale,
            degrees: self.degrees,
        }
    }

    fn apply(&mut self, factor: &Self, divide: bool) {
        let (d, s) = (self.dimension.take(), self.scale.take());
        self.dimension = match (d, factor.dimension) {
            (Some(a), Some(b)) => {
                if divide {
                    a.over(b)
                } else {
                    a.times(b)
                }
            }
            _ => None,
        };
        self.scale = match (s, &factor.scale) {
            (Some(a), Some(b)) => {
                Some(if divide { a / b } else { a * b }).filter(|v| !units::too_big(v))
            }
            _ => None,
        };
        self.degrees |= factor.degrees;
    }
}
