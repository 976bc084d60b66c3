//! Reading a TOML table key by key, with a place for every complaint.

use crate::error::{Error, suggestion};
use crate::quantity::{Dimension, Quantities};
use crate::task::Said;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

type Outcome<T> = Result<T, Error>;

/// The file that is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'s> {
    pub(crate) name: &'s str,
    pub(crate) text: &'s str,
}

impl Source<'_> {
    /// `file:line:column`.
    pub(crate) fn place(&self, at: usize) -> String {
        let mut end = at.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        format!("{}:{line}:{column}", self.name)
    }
}

/// A value with its key's path.
#[derive(Clone, Debug)]
pub(crate) struct Value<'s> {
    source: Source<'s>,
    path: String,
    value: &'s DeValue<'s>,
    span: Range<usize>,
}

impl<'s> Value<'s> {
    pub(crate) fn place(&self) -> String {
        format!("{}: `{}`", self.source.place(self.span.start), self.path)
    }

    pub(crate) fn error(&self, message: impl Into<String>) -> Error {
        Error { place: self.place(), message: message.into() }
    }

    pub(crate) fn said<T>(&self, value: T) -> Said<T> {
        Said { value, place: self.place() }
    }

    fn expected(&self, what: &str) -> Error {
        self.error(format!("expected {what}, found a {}", self.value.type_str()))
    }

    pub(crate) fn string(&self) -> Outcome<&'s str> {
        self.value.as_str().ok_or_else(|| self.expected("a string"))
    }

    /// One of some words.
    pub(crate) fn word<T: Copy>(&self, words: &[(&str, T)]) -> Outcome<T> {
        let found = self.string()?;
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == found) {
            return Ok(*value);
        }
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        Err(self.error(format!("no such choice: `{found}`{}", suggestion(found, &known))))
    }

    /// True or false.
    pub(crate) fn switch(&self) -> Outcome<bool> {
        self.value.as_bool().ok_or_else(|| self.expected("true or false"))
    }

    pub(crate) fn is_list(&self) -> bool {
        self.value.is_array()
    }

    pub(crate) fn is_string(&self) -> bool {
        self.value.is_str()
    }

    /// A number without a unit.
    pub(crate) fn number(&self) -> Outcome<f64> {
        let text = match self.value {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => return Err(self.expected("a number")),
        };
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| self.error("expected a finite number"))
    }

    pub(crate) fn count(&self) -> Outcome<usize> {
        let DeValue::Integer(number) = self.value else {
            return Err(self.expected("a whole number"));
        };
        let count = usize::from_str_radix(number.as_str(), number.radix());
        count.map_err(|_| self.error("expected a number from 0 up"))
    }

    /// Numbers with a unit.
    pub(crate) fn quantities(&self) -> Outcome<Quantities> {
        let Some(text) = self.value.as_str() else {
            return Err(self.expected("a string of numbers and a unit such as \"2, 0 m\""));
        };
        Quantities::parse(text).map_err(|message| self.error(message))
    }

    /// Seconds.
    pub(crate) fn time(&self) -> Outcome<f64> {
        let quantities = self.quantities()?;
        match (quantities.dimension, &*quantities.values) {
            (Dimension::Time, &[seconds]) => Ok(seconds),
            _ => Err(self.error("expected one time such as \"5 s\"")),
        }
    }

    /// Seconds from zero up, of a time in which nothing has to happen.
    pub(crate) fn pause(&self) -> Outcome<f64> {
        match self.time()? {
            seconds if seconds >= 0.0 => Ok(seconds),
            seconds => Err(self.error(format!("a time cannot be negative, found {seconds} s"))),
        }
    }

    /// Seconds above zero.
    pub(crate) fn duration(&self) -> Outcome<f64> {
        match self.time()? {
            seconds if seconds > 0.0 => Ok(seconds),
            seconds => {
                Err(self.error(format!("a duration is longer than zero, found {seconds} s")))
            }
        }
    }

    pub(crate) fn list(&self) -> Outcome<Vec<Value<'s>>> {
        let array: &'s DeArray<'s> =
            self.value.as_array().ok_or_else(|| self.expected("an array"))?;
        let entry = |(index, value): (usize, &'s Spanned<DeValue<'s>>)| Value {
            source: self.source,
            path: format!("{}[{index}]", self.path),
            value: value.get_ref(),
            span: value.span(),
        };
        Ok(array.iter().enumerate().map(entry).collect())
    }

    pub(crate) fn table(&self) -> Outcome<Table<'s>> {
        let table = self.value.as_table().ok_or_else(|| self.expected("a table"))?;
        Ok(Table { source: self.source, path: self.path.clone(), table, span: self.span.clone() })
    }
}

/// A table with its path.
#[derive(Clone, Debug)]
pub(crate) struct Table<'s> {
    source: Source<'s>,
    path: String,
    table: &'s DeTable<'s>,
    span: Range<usize>,
}

impl<'s> Table<'s> {
    pub(crate) fn root(source: Source<'s>, table: &'s Spanned<DeTable<'s>>) -> Self {
        Self { source, path: String::new(), table: table.get_ref(), span: 0..0 }
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    fn error_at(&self, key: &str, at: usize, message: String) -> Error {
        Error { place: format!("{}: `{}`", self.source.place(at), self.path_of(key)), message }
    }

    /// Refuses keys that are not known.
    pub(crate) fn only(&self, known: &[&str]) -> Outcome<()> {
        let unknown = self.table.iter().find(|(key, _)| !known.contains(&key.get_ref().as_ref()));
        let Some((key, _)) = unknown else {
            return Ok(());
        };
        let name = key.get_ref().as_ref();
        let message = format!("unknown key{}", suggestion(name, known));
        Err(self.error_at(name, key.span().start, message))
    }

    pub(crate) fn get(&self, key: &str) -> Option<Value<'s>> {
        self.entries().into_iter().find(|(name, _)| name.value == key).map(|(_, value)| value)
    }

    pub(crate) fn require(&self, key: &str) -> Outcome<Value<'s>> {
        let missing = || self.error_at(key, self.span.start, "this key is missing".into());
        self.get(key).ok_or_else(missing)
    }

    /// All keys with their values, in the file's order.
    pub(crate) fn entries(&self) -> Vec<(Said<&'s str>, Value<'s>)> {
        let entry =
            |(key, value): (&'s Spanned<toml::de::DeString<'s>>, &'s Spanned<DeValue<'s>>)| {
                let (name, at) = (key.get_ref().as_ref(), key.span().start);
                let path = self.path_of(name);
                let place = format!("{}: `{path}`", self.source.place(at));
                let value =
                    Value { source: self.source, path, value: value.get_ref(), span: value.span() };
                (at, (Said { value: name, place }, value))
            };
        let mut entries: Vec<_> = self.table.iter().map(entry).collect();
        entries.sort_by_key(|(at, _)| *at);
        entries.into_iter().map(|(_, entry)| entry).collect()
    }
}
