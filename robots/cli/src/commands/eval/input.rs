//! Reading one state from one line, into memory that is used again.

use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_derive::Deserialize;
use std::fmt;

/// A state as given.
#[derive(Debug, Default)]
pub(crate) struct Input {
    /// q.
    pub(crate) q: Given,
    /// q̇.
    pub(crate) qd: Given,
    /// q̈.
    pub(crate) qdd: Given,
    /// Forces of the actuators.
    pub(crate) tau: Given,
}

/// A vector of the line, if it is there.
#[derive(Debug, Default)]
pub(crate) struct Given {
    /// Entries.
    pub(crate) values: Vec<f64>,
    /// Whether the line had it.
    pub(crate) present: bool,
}

impl Input {
    /// Reads a line. The error says what is wrong with it and, where it helps, at which column.
    pub(crate) fn read(&mut self, line: &str) -> Result<(), String> {
        for given in [&mut self.q, &mut self.qd, &mut self.qdd, &mut self.tau] {
            given.values.clear();
            given.present = false;
        }
        let mut deserializer = serde_json::Deserializer::from_str(line);
        (&mut *self).deserialize(&mut deserializer).map_err(|e| explain(&e))?;
        deserializer.end().map_err(|e| explain(&e))
    }

    fn vector(&mut self, key: Key) -> Option<&mut Given> {
        match key {
            Key::Q => Some(&mut self.q),
            Key::Qd => Some(&mut self.qd),
            Key::Qdd => Some(&mut self.qdd),
            Key::Tau => Some(&mut self.tau),
            Key::Other => None,
        }
    }
}

/// A key of the object, without a copy of its text.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(field_identifier, rename_all = "lowercase")]
enum Key {
    Q,
    Qd,
    Qdd,
    Tau,
    #[serde(other)]
    Other,
}

impl Key {
    const fn name(self) -> &'static str {
        match self {
            Self::Q => "q",
            Self::Qd => "qd",
            Self::Qdd => "qdd",
            Self::Tau => "tau",
            Self::Other => "",
        }
    }
}

/// serde_json's text, with its line (always the first) left out.
fn explain(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let message = text.strip_suffix(&place).unwrap_or(&text);
    format!("column {}: {message}", error.column())
}

impl<'de> DeserializeSeed<'de> for &mut Input {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for &mut Input {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with the vectors `q`, `qd`, `qdd` and `tau`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<Key>()? {
            let Some(given) = self.vector(key) else {
                map.next_value::<IgnoredAny>()?;
                continue;
            };
            if given.present {
                return Err(serde::de::Error::custom(format_args!(
                    "`{}` is given twice",
                    key.name()
                )));
            }
            map.next_value_seed(given)?;
        }
        Ok(())
    }
}

impl<'de> DeserializeSeed<'de> for &mut Given {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.present = true;
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for &mut Given {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<(), A::Error> {
        while let Some(value) = sequence.next_element::<f64>()? {
            self.values.push(value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Input;

    #[test]
    fn a_line_fills_the_vectors_it_mentions() {
        let mut input = Input::default();
        input.read(r#"{"q":[1,2.5],"note":{"a":[]},"qd":[-1e-3,0]}"#).unwrap();
        assert_eq!(input.q.values, [1.0, 2.5]);
        assert_eq!(input.qd.values, [-1e-3, 0.0]);
        assert!(!input.qdd.present && !input.tau.present);
        input.read(r#"{"q":[]}"#).unwrap();
        assert!(input.q.present && input.q.values.is_empty() && !input.qd.present);
    }

    #[test]
    fn what_is_no_state_is_refused() {
        let mut input = Input::default();
        for line in [
            "",
            "[]",
            "{",
            r#"{"q":[1e999]}"#,
            r#"{"q":[NaN]}"#,
            r#"{"q":[null]}"#,
            r#"{"q":1}"#,
            r#"{"q":[1],"q":[1]}"#,
            r#"{"q":[1]} x"#,
        ] {
            assert!(input.read(line).is_err(), "{line}");
        }
    }

    #[test]
    fn decimal_numbers_are_read_to_the_nearest_double() {
        let mut input = Input::default();
        input.read(r#"{"q":[0.17999999999999999334,5e-324,1.7976931348623157e308]}"#).unwrap();
        assert_eq!(input.q.values, [0.18, 5e-324, f64::MAX]);
    }
}
