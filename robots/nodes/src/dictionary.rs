//! The object dictionary of a simulated node.

use std::collections::BTreeMap;

use shapebot_drive::{DataType, Object};

use crate::Abort;

/// What may be done with an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Never changes.
    Constant,
    /// Read by others, written by the node.
    Read,
    /// Read and written by others.
    ReadWrite,
    /// Only written by others.
    Write,
}

/// PDOs that an object may be part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mappable {
    /// None.
    No,
    /// Transmit PDOs.
    Transmit,
    /// Receive PDOs.
    Receive,
    /// Both.
    Both,
}

impl Mappable {
    const fn allows(self, direction: Self) -> bool {
        matches!(
            (self, direction),
            (Self::Both, _) | (Self::Transmit, Self::Transmit) | (Self::Receive, Self::Receive)
        )
    }
}

/// What an object holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// A number and its type.
    Number(DataType, i64),
    /// A name.
    Text(String),
}

impl Value {
    /// The bytes that an SDO upload sends.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Number(kind, value) => {
                kind.encode(*value).into_iter().take(kind.bytes()).collect()
            }
            Self::Text(text) => text.as_bytes().to_vec(),
        }
    }
}

/// An object with its access and range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// What it holds.
    pub value: Value,
    /// What may be done with it.
    pub access: Access,
    /// PDOs that it may be part of.
    pub mappable: Mappable,
    /// Smallest and largest value that may be written.
    pub range: (i64, i64),
}

/// All objects of a node.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dictionary {
    variables: BTreeMap<Object, Variable>,
}

impl Dictionary {
    /// Adds or replaces a number.
    pub fn number(
        &mut self,
        object: Object,
        kind: DataType,
        value: i64,
        access: Access,
        mappable: Mappable,
    ) {
        let value = Value::Number(kind, value);
        let variable = Variable { value, access, mappable, range: kind.range() };
        self.variables.insert(object, variable);
    }

    /// Adds a name, which is only read.
    pub fn text(&mut self, object: Object, text: &str) {
        let value = Value::Text(text.to_owned());
        let (access, mappable) = (Access::Constant, Mappable::No);
        self.variables.insert(object, Variable { value, access, mappable, range: (0, 0) });
    }

    /// Narrows what may be written to an object.
    pub fn limit(&mut self, object: Object, range: (i64, i64)) {
        if let Some(variable) = self.variables.get_mut(&object) {
            variable.range = range;
        }
    }

    /// Takes an object away.
    pub fn remove(&mut self, object: Object) {
        self.variables.remove(&object);
    }

    /// Whether an object is there.
    #[must_use]
    pub fn contains(&self, object: Object) -> bool {
        self.variables.contains_key(&object)
    }

    /// The variable of an object.
    ///
    /// # Errors
    ///
    /// [`Abort::NoObject`] or [`Abort::NoSubIndex`].
    pub fn find(&self, object: Object) -> Result<&Variable, Abort> {
        self.variables.get(&object).ok_or_else(|| self.missing(object))
    }

    fn missing(&self, object: Object) -> Abort {
        let first = Object { index: object.index, sub: 0 };
        let last = Object { index: object.index, sub: u8::MAX };
        let has_index = self.variables.range(first..=last).next().is_some();
        if has_index { Abort::NoSubIndex } else { Abort::NoObject }
    }

    /// The number in an object, zero if there is none.
    #[must_use]
    pub fn get(&self, object: Object) -> i64 {
        match self.variables.get(&object) {
            Some(Variable { value: Value::Number(_, number), .. }) => *number,
            _ => 0,
        }
    }

    /// Sets the number in an object from within the node, brought into the type's range. Nothing
    /// happens if there is no such number.
    pub fn set(&mut self, object: Object, number: i64) {
        if let Some(Variable { value: Value::Number(kind, old), .. }) =
            self.variables.get_mut(&object)
        {
            let (low, high) = kind.range();
            *old = number.clamp(low, high);
        }
    }

    /// Whether another node may write `bytes` to an object, and the number that they are.
    ///
    /// # Errors
    ///
    /// The reason against.
    pub fn check_write(&self, object: Object, bytes: &[u8]) -> Result<i64, Abort> {
        let variable = self.find(object)?;
        if matches!(variable.access, Access::Constant | Access::Read) {
            return Err(Abort::ReadOnly);
        }
        let Value::Number(kind, _) = variable.value else { return Err(Abort::ReadOnly) };
        match bytes.len() {
            length if length > kind.bytes() => return Err(Abort::TooLong),
            length if length < kind.bytes() => return Err(Abort::TooShort),
            _ => {}
        }
        let number = kind.decode(bytes);
        let (low, high) = variable.range;
        if number > high {
            Err(Abort::TooHigh)
        } else if number < low {
            Err(Abort::TooLow)
        } else {
            Ok(number)
        }
    }

    /// The bytes of an object for another node.
    ///
    /// # Errors
    ///
    /// The reason against.
    pub fn read(&self, object: Object) -> Result<Vec<u8>, Abort> {
        let variable = self.find(object)?;
        if variable.access == Access::Write {
            return Err(Abort::WriteOnly);
        }
        Ok(variable.value.bytes())
    }

    /// Type of an object that a mapping entry names, if it may be mapped and has the entry's length.
    ///
    /// # Errors
    ///
    /// [`Abort::NotMappable`], [`Abort::NoObject`] or [`Abort::NoSubIndex`].
    pub fn mapped(&self, entry: u32, direction: Mappable) -> Result<(Object, DataType), Abort> {
        let [bits, sub, low, high] = entry.to_le_bytes();
        let object = Object { index: u16::from_le_bytes([low, high]), sub };
        let kind = match dummy(object) {
            Some(kind) if direction == Mappable::Receive => kind,
            Some(_) => return Err(Abort::NotMappable),
            None => {
                let variable = self.find(object)?;
                match &variable.value {
                    Value::Number(kind, _) if variable.mappable.allows(direction) => *kind,
                    _ => return Err(Abort::NotMappable),
                }
            }
        };
        let fits = usize::from(bits) == 8 * kind.bytes();
        if fits { Ok((object, kind)) } else { Err(Abort::NotMappable) }
    }

    /// Takes over from `other` all objects whose index is in a range.
    pub fn restore(&mut self, other: &Self, indices: std::ops::RangeInclusive<u16>) {
        for (object, variable) in &other.variables {
            if indices.contains(&object.index) && self.contains(*object) {
                self.variables.insert(*object, variable.clone());
            }
        }
    }
}

/// The type that a mapping entry names instead of an object: a gap.
fn dummy(object: Object) -> Option<DataType> {
    let kinds =
        [DataType::I8, DataType::I16, DataType::I32, DataType::U8, DataType::U16, DataType::U32];
    kinds.into_iter().find(|kind| kind.dummy() == object)
}
