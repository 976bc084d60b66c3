//! All functions of a model, of any dimension, as tapes.

use crate::compile::compile;
use crate::tape::{Source, State, Tape};
use crate::{Error, describe};
use shapebot_codegen::derive::{Derivation, Function, Quantity};
use shapebot_dynamics::{Description, Real};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All functions of a model, compiled to tapes with the parameters' values bound.
///
/// A clone shares the tapes. Sizes are run-time values, so that any model can be evaluated;
/// [`Interpreted`](crate::Interpreted) puts the runtime traits on top for fixed sizes.
#[derive(Clone, Debug)]
pub struct Tapes<T = f64> {
    description: &'static Description,
    functions: Arc<BTreeMap<Quantity, Compiled<T>>>,
}

#[derive(Debug)]
struct Compiled<T> {
    tape: Tape<T>,
    blocks: Vec<Block>,
}

/// One array among the results of a function: it starts at `offset` of the result list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Field name in a bundle.
    pub name: &'static str,
    /// `[]` a scalar, `[n]` a vector, `[rows, columns]`, `[layers, rows, columns]`.
    pub extents: Vec<usize>,
    /// Position of its first entry.
    pub offset: usize,
}

impl<T: Real> Tapes<T> {
    /// Compiles every function of a derivation. `parameters` are values in SI units in the order of the
    /// model; a derivation with folded-in parameters ignores them.
    ///
    /// The names in the description live as long as the program: a few hundred bytes per call are never
    /// given back.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] if there are not as many values as parameters.
    pub fn new(derivation: &Derivation, parameters: &[T]) -> Result<Self, Error> {
        let expected = derivation.model.parameters.len();
        if parameters.len() != expected {
            return Err(Error::Length { what: "parameters", found: parameters.len(), expected });
        }
        Ok(Self::compile(derivation, parameters))
    }

    /// Compiles a derivation with the model's own parameter values.
    #[must_use]
    pub fn with_model_parameters(derivation: &Derivation) -> Self {
        let values = derivation.model.parameters.iter().map(|p| T::from_f64(p.value_f64));
        Self::compile(derivation, &values.collect::<Vec<T>>())
    }

    fn compile(derivation: &Derivation, parameters: &[T]) -> Self {
        let compiled = |(&quantity, function)| (quantity, Compiled::new(function, parameters));
        Self {
            description: describe::leak(derivation),
            functions: Arc::new(derivation.functions.iter().map(compiled).collect()),
        }
    }

    /// Names, units, ranges, actuators and shape sets.
    #[must_use]
    pub const fn description(&self) -> &'static Description {
        self.description
    }

    /// Whether there is such a function.
    #[must_use]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.functions.contains_key(&quantity)
    }

    /// Number of results of a function.
    ///
    /// # Errors
    ///
    /// [`Error::Absent`] if the model has no such function.
    pub fn result_count(&self, quantity: Quantity) -> Result<usize, Error> {
        self.function(quantity).map(|f| f.tape.outputs.len())
    }

    /// Layout of the results of a function.
    ///
    /// # Errors
    ///
    /// [`Error::Absent`] if the model has no such function.
    pub fn blocks(&self, quantity: Quantity) -> Result<&[Block], Error> {
        self.function(quantity).map(|f| f.blocks.as_slice())
    }

    /// Evaluates a function; `results` receives block after block, last index fastest.
    ///
    /// # Errors
    ///
    /// [`Error::Absent`] if the model has no such function, [`Error::Length`] if the state lacks an
    /// entry that the function reads or `results` has the wrong length.
    pub fn evaluate(
        &self,
        quantity: Quantity,
        state: &State<'_, T>,
        results: &mut [T],
    ) -> Result<(), Error> {
        let tape = &self.function(quantity)?.tape;
        if results.len() != tape.outputs.len() {
            let expected = tape.outputs.len();
            return Err(Error::Length { what: "results", found: results.len(), expected });
        }
        if let Some(input) = tape.missing(state) {
            return Err(self.missing(input.source, state));
        }
        tape.run(state, |i, value| results[i] = value);
        Ok(())
    }

    /// Evaluates a function and hands each result with its position to `emit`; without such a function
    /// nothing is emitted. Missing inputs count as not a number.
    pub(crate) fn visit(
        &self,
        quantity: Quantity,
        state: &State<'_, T>,
        emit: impl FnMut(usize, T),
    ) {
        if let Some(function) = self.functions.get(&quantity) {
            function.tape.run(state, emit);
        }
    }

    fn function(&self, quantity: Quantity) -> Result<&Compiled<T>, Error> {
        self.functions.get(&quantity).ok_or(Error::Absent(quantity))
    }

    fn missing(&self, source: Source, state: &State<'_, T>) -> Error {
        let (what, found) = match source {
            Source::Coordinate => ("coordinates", state.q.len()),
            Source::Rate => ("rates", state.qd.len()),
            Source::Acceleration => ("accelerations", state.qdd.len()),
            Source::Force => ("forces", state.force.len()),
        };
        Error::Length { what, found, expected: self.description.coordinates.len() }
    }
}

impl<T: Real> Compiled<T> {
    fn new(function: &Function, parameters: &[T]) -> Self {
        let mut offset = 0;
        let blocks = function.blocks.iter().map(|block| {
            let start = offset;
            offset += block.entries.len();
            Block { name: block.name, extents: block.extents.clone(), offset: start }
        });
        let blocks = blocks.collect();
        Self { tape: compile(&function.graph, &function.results(), parameters), blocks }
    }
}
