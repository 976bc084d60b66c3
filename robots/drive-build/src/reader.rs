//! Reading a TOML table key by key; complaints are collected, so that one run shows them all.

use crate::error::{Complaints, Said, Spot, suggestion};
use crate::unit;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// The text that is read, and where complaints go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Context<'s> {
    pub(crate) text: &'s str,
    pub(crate) complaints: &'s Complaints,
}

impl Context<'_> {
    pub(crate) fn spot(&self, at: usize, key: &str) -> Spot {
        let mut end = at.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        Spot { line, column, key: key.to_owned() }
    }
}

/// A value with its key's path.
#[derive(Clone, Debug)]
pub(crate) struct Value<'s> {
    context: Context<'s>,
    path: String,
    value: &'s DeValue<'s>,
    at: usize,
}

impl<'s> Value<'s> {
    pub(crate) fn spot(&self) -> Spot {
        self.context.spot(self.at, &self.path)
    }

    pub(crate) fn said<T>(&self, value: T) -> Said<T> {
        Said { value, spot: self.spot() }
    }

    /// Complains about this value.
    pub(crate) fn refuse<T>(&self, message: impl Into<String>) -> Option<T> {
        self.context.complaints.add(&self.spot(), message);
        None
    }

    fn expected<T>(&self, what: &str) -> Option<T> {
        self.refuse(format!("expected {what}, found a {}", self.value.type_str()))
    }

    pub(crate) fn string(&self) -> Option<&'s str> {
        self.value.as_str().or_else(|| self.expected("a string"))
    }

    pub(crate) fn name(&self) -> Option<Said<String>> {
        self.string().map(|text| self.said(text.to_owned()))
    }

    /// One of some words.
    pub(crate) fn word<T: Copy>(&self, words: &[(&str, T)]) -> Option<T> {
        let found = self.string()?;
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == found) {
            return Some(*value);
        }
        let known = words.iter().map(|(word, _)| *word);
        self.refuse(format!("no such choice: `{found}`{}", suggestion(found, known)))
    }

    pub(crate) fn is_string(&self) -> bool {
        self.value.is_str()
    }

    pub(crate) fn is_table(&self) -> bool {
        self.value.as_table().is_some()
    }

    pub(crate) fn boolean(&self) -> Option<bool> {
        self.value.as_bool().or_else(|| self.expected("true or false"))
    }

    /// A number without a unit.
    pub(crate) fn number(&self) -> Option<f64> {
        let text = match self.value {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => return self.expected("a number"),
        };
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.or_else(|| self.refuse("expected a finite number"))
    }

    /// A whole number within bounds.
    pub(crate) fn integer<T: TryFrom<i64>>(&self, low: i64, high: i64) -> Option<T> {
        let DeValue::Integer(number) = self.value else {
            return self.expected("a whole number");
        };
        let value = i64::from_str_radix(number.as_str(), number.radix());
        let inside = value.ok().filter(|value| (low..=high).contains(value));
        let fitting = inside.and_then(|value| T::try_from(value).ok());
        fitting.or_else(|| self.refuse(format!("expected a whole number from {low} to {high}")))
    }

    /// A number with a unit of the dimension of `like`.
    pub(crate) fn quantity(&self, like: &str) -> Option<Said<f64>> {
        let Some(text) = self.value.as_str() else {
            return self.expected(&format!("a string with a number and a unit like {like}"));
        };
        match unit::quantity(text, like) {
            Ok(value) => Some(self.said(value)),
            Err(message) => self.refuse(message),
        }
    }

    /// A quantity above zero.
    pub(crate) fn positive(&self, like: &str) -> Option<Said<f64>> {
        let quantity = self.quantity(like)?;
        if quantity.value > 0.0 { Some(quantity) } else { self.refuse("must be above zero") }
    }

    pub(crate) fn list(&self) -> Option<Vec<Value<'s>>> {
        let array: &'s DeArray<'s> = self.value.as_array().or_else(|| self.expected("an array"))?;
        let entry = |(index, value): (usize, &'s Spanned<DeValue<'s>>)| Value {
            context: self.context,
            path: format!("{}[{index}]", self.path),
            value: value.get_ref(),
            at: value.span().start,
        };
        Some(array.iter().enumerate().map(entry).collect())
    }

    /// Names in an array.
    pub(crate) fn names(&self) -> Option<Vec<Said<String>>> {
        Some(self.list()?.iter().filter_map(Value::name).collect())
    }

    pub(crate) fn table(&self) -> Option<Table<'s>> {
        let table = self.value.as_table().or_else(|| self.expected("a table"))?;
        Some(Table { context: self.context, path: self.path.clone(), table, at: self.at })
    }
}

/// A table with its path.
#[derive(Clone, Debug)]
pub(crate) struct Table<'s> {
    context: Context<'s>,
    path: String,
    table: &'s DeTable<'s>,
    at: usize,
}

impl<'s> Table<'s> {
    pub(crate) fn root(context: Context<'s>, table: &'s Spanned<DeTable<'s>>) -> Self {
        Self { context, path: String::new(), table: table.get_ref(), at: 0 }
    }

    pub(crate) fn spot(&self) -> Spot {
        self.context.spot(self.at, &self.path)
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    fn refuse_key(&self, key: &str, at: usize, message: String) {
        self.context.complaints.add(&self.context.spot(at, &self.path_of(key)), message);
    }

    /// Refuses keys that are not known.
    pub(crate) fn only(&self, known: &[&str]) {
        for (key, _) in self.table.iter() {
            let name = key.get_ref().as_ref();
            if !known.contains(&name) {
                let message = format!("unknown key{}", suggestion(name, known.iter().copied()));
                self.refuse_key(name, key.span().start, message);
            }
        }
    }

    pub(crate) fn get(&self, key: &str) -> Option<Value<'s>> {
        self.entries().into_iter().find(|(name, _)| name.value == key).map(|(_, value)| value)
    }

    pub(crate) fn require(&self, key: &str) -> Option<Value<'s>> {
        let found = self.get(key);
        if found.is_none() {
            self.refuse_key(key, self.at, "this key is missing".into());
        }
        found
    }

    /// A sub-table by its key; empty if the key is missing.
    pub(crate) fn tables(&self, key: &str) -> Vec<(Said<String>, Table<'s>)> {
        let Some(table) = self.get(key).and_then(|value| value.table()) else {
            return Vec::new();
        };
        let entry = |(name, value): (Said<&str>, Value<'s>)| {
            let name = Said { value: name.value.to_owned(), spot: name.spot };
            Some((name, value.table()?))
        };
        table.entries().into_iter().filter_map(entry).collect()
    }

    /// All keys with their values, in the file's order.
    pub(crate) fn entries(&self) -> Vec<(Said<&'s str>, Value<'s>)> {
        let entry =
            |(key, value): (&'s Spanned<toml::de::DeString<'s>>, &'s Spanned<DeValue<'s>>)| {
                let (name, at) = (key.get_ref().as_ref(), key.span().start);
                let path = self.path_of(name);
                let spot = self.context.spot(at, &path);
                let value = Value {
                    context: self.context,
                    path,
                    value: value.get_ref(),
                    at: value.span().start,
                };
                (at, (Said { value: name, spot }, value))
            };
        let mut entries: Vec<_> = self.table.iter().map(entry).collect();
        entries.sort_by_key(|(at, _)| *at);
        entries.into_iter().map(|(_, entry)| entry).collect()
    }
}
