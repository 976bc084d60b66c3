//! Straight-line programs and their execution.

use shapebot_dynamics::Real;
use std::sync::{Mutex, TryLockError};

/// Index into the register file of a tape.
pub(crate) type Register = u32;

/// What an instruction does with its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    /// `target` receives the sine, `right` the cosine of `left`.
    SinCos,
    Sqrt,
    Exp,
    Ln,
    Asin,
    Acos,
    Atan,
    Atan2,
}

/// Registers of one step of a tape. Operations of one operand repeat it in `right`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    pub(crate) target: Register,
    pub(crate) left: Register,
    pub(crate) right: Register,
}

/// Steps that do the same, after each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) operation: Operation,
    pub(crate) count: usize,
}

/// The state that a function is evaluated at. A slice may be empty when the function does not read it.
#[derive(Clone, Copy, Debug)]
pub struct State<'a, T> {
    /// Coordinates q = [q_x, q_s].
    pub q: &'a [T],
    /// Rates q̇.
    pub qd: &'a [T],
    /// Accelerations q̈.
    pub qdd: &'a [T],
    /// Generalised forces, one per coordinate.
    pub force: &'a [T],
}

impl<T> State<'_, T> {
    /// The state of a function of parameters alone.
    pub const EMPTY: Self = Self { q: &[], qd: &[], qdd: &[], force: &[] };
}

/// One of the four vectors of a [`State`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Source {
    Coordinate,
    Rate,
    Acceleration,
    Force,
}

impl<T: Copy> State<'_, T> {
    fn get(&self, source: Source, index: usize) -> Option<T> {
        let vector = match source {
            Source::Coordinate => self.q,
            Source::Rate => self.qd,
            Source::Acceleration => self.qdd,
            Source::Force => self.force,
        };
        vector.get(index).copied()
    }
}

/// An input of a tape: which entry of which vector goes to which register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Input {
    pub(crate) source: Source,
    pub(crate) index: usize,
    pub(crate) register: Register,
}

/// A compiled function: steps over a register file `[constants, inputs, temporaries]`.
///
/// The register file is kept between calls, so that a call neither allocates nor sets constants. A
/// second thread that calls at the same moment works on a copy.
#[derive(Debug)]
pub(crate) struct Tape<T> {
    pub(crate) runs: Vec<Run>,
    pub(crate) steps: Vec<Step>,
    pub(crate) inputs: Vec<Input>,
    pub(crate) outputs: Vec<Register>,
    pub(crate) constants: Vec<T>,
    pub(crate) register_count: usize,
    registers: Mutex<Vec<T>>,
}

impl<T: Real> Tape<T> {
    pub(crate) fn new(
        code: &[(Operation, Step)],
        inputs: Vec<Input>,
        outputs: Vec<Register>,
        constants: Vec<T>,
        register_count: usize,
    ) -> Self {
        let runs = code.chunk_by(|a, b| a.0 == b.0);
        Self {
            runs: runs.map(|run| Run { operation: run[0].0, count: run.len() }).collect(),
            steps: code.iter().map(|&(_, step)| step).collect(),
            registers: Mutex::new(register_file(&constants, register_count)),
            inputs,
            outputs,
            constants,
            register_count,
        }
    }

    /// The first input that a state does not provide.
    pub(crate) fn missing(&self, state: &State<'_, T>) -> Option<Input> {
        self.inputs.iter().copied().find(|x| state.get(x.source, x.index).is_none())
    }

    /// Executes the tape and hands every result with its position to `emit`. Missing inputs count as
    /// not a number.
    pub(crate) fn run(&self, state: &State<'_, T>, emit: impl FnMut(usize, T)) {
        match self.registers.try_lock() {
            Ok(mut registers) => self.run_on(&mut registers, state, emit),
            Err(TryLockError::Poisoned(lock)) => self.run_on(&mut lock.into_inner(), state, emit),
            Err(TryLockError::WouldBlock) => self.run_on(&mut self.fresh_registers(), state, emit),
        }
    }

    fn run_on(&self, registers: &mut [T], state: &State<'_, T>, mut emit: impl FnMut(usize, T)) {
        for input in &self.inputs {
            let value = state.get(input.source, input.index);
            registers[input.register as usize] = value.unwrap_or_else(|| T::from_f64(f64::NAN));
        }
        let mut rest = self.steps.as_slice();
        for run in &self.runs {
            let (steps, after) = rest.split_at(run.count);
            execute(registers, run.operation, steps);
            rest = after;
        }
        for (position, &register) in self.outputs.iter().enumerate() {
            emit(position, registers[register as usize]);
        }
    }

    fn fresh_registers(&self) -> Vec<T> {
        register_file(&self.constants, self.register_count)
    }
}

/// Constants first, the rest not yet set.
fn register_file<T: Real>(constants: &[T], register_count: usize) -> Vec<T> {
    let mut registers = constants.to_vec();
    registers.resize(register_count, T::from_f64(0.0));
    registers
}

fn execute<T: Real>(registers: &mut [T], operation: Operation, steps: &[Step]) {
    match operation {
        Operation::Add => each(registers, steps, |a, b| a + b),
        Operation::Sub => each(registers, steps, |a, b| a - b),
        Operation::Mul => each(registers, steps, |a, b| a * b),
        Operation::Div => each(registers, steps, |a, b| a / b),
        Operation::Neg => each(registers, steps, |a, _| -a),
        Operation::SinCos => {
            for step in steps {
                let (sine, cosine) = registers[step.left as usize].sin_cos();
                registers[step.target as usize] = sine;
                registers[step.right as usize] = cosine;
            }
        }
        Operation::Sqrt => each(registers, steps, |a, _| a.sqrt()),
        Operation::Exp => each(registers, steps, |a, _| a.exp()),
        Operation::Ln => each(registers, steps, |a, _| a.ln()),
        Operation::Asin => each(registers, steps, |a, _| a.asin()),
        Operation::Acos => each(registers, steps, |a, _| a.acos()),
        Operation::Atan => each(registers, steps, |a, _| a.atan()),
        Operation::Atan2 => each(registers, steps, T::atan2),
    }
}

#[inline(always)]
fn each<T: Real>(registers: &mut [T], steps: &[Step], apply: impl Fn(T, T) -> T) {
    for step in steps {
        let value = apply(registers[step.left as usize], registers[step.right as usize]);
        registers[step.target as usize] = value;
    }
}
