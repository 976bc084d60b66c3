//! `shapebot eval`: dynamics of given states, JSON lines in, JSON lines out.
//!
//! Memory does not grow with the input: one line, one state and one set of results are alive at a
//! time. Output is flushed whenever the input has nothing more at hand, so that a program at the other
//! end of two pipes gets its answer.

mod fields;
mod input;

pub(crate) use fields::{Field, Results, Selection, Sizes};

use crate::args::EvalArgs;
use crate::failure::{Failure, Outcome};
use crate::output::Json;
use crate::robot::{self, Dynamics};
use input::{Given, Input};
use shapebot_dynamics::Description;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};

/// Bytes read and written at a time.
const BUFFER: usize = 1 << 20;

/// A longer line is no state, and is refused before it fills the memory.
const LONGEST_LINE: u64 = 1 << 20;

/// A state with a value for everything.
#[derive(Debug, Default)]
pub(crate) struct State {
    /// q.
    pub(crate) q: Vec<f64>,
    /// q̇.
    pub(crate) qd: Vec<f64>,
    /// q̈.
    pub(crate) qdd: Vec<f64>,
    /// Forces of the actuators.
    pub(crate) tau: Vec<f64>,
}

pub(crate) fn run(args: &EvalArgs) -> Outcome {
    let robot = robot::open(&args.robot)?.dynamics(&args.parameters.values)?;
    let selection = Selection::parse(&args.fields, robot.is_shape_accelerated())?;
    let stdin = BufReader::with_capacity(BUFFER, std::io::stdin().lock());
    let stdout = BufWriter::with_capacity(BUFFER, std::io::stdout().lock());
    stream(&*robot, &selection, stdin, stdout)
}

/// Answers every line of `input` in `output`.
fn stream<R: Read>(
    robot: &dyn Dynamics,
    selection: &Selection,
    mut input: BufReader<R>,
    mut output: impl Write,
) -> Outcome {
    let mut evaluation = Evaluation::new(robot, selection);
    let mut line = Vec::new();
    for number in 1_u64.. {
        if input.buffer().is_empty() {
            output.flush()?;
        }
        line.clear();
        if input.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut line)? == 0 {
            break;
        }
        match evaluation.answer(&line) {
            Ok(Some(answer)) => output.write_all(answer)?,
            Ok(None) => {}
            Err(message) => {
                output.flush()?;
                return Err(Failure::usage(format!("line {number}: {message}")));
            }
        }
    }
    output.flush()?;
    Ok(())
}

/// What is used again from line to line.
struct Evaluation<'a> {
    robot: &'a dyn Dynamics,
    selection: &'a Selection,
    /// Fields with the text before their values and their layouts.
    layout: Vec<(Field, String, Vec<usize>)>,
    reads_rates: bool,
    reads_accelerations: bool,
    input: Input,
    state: State,
    results: Results,
    answer: Json,
}

impl<'a> Evaluation<'a> {
    fn new(robot: &'a dyn Dynamics, selection: &'a Selection) -> Self {
        let sizes = robot.sizes();
        let layout = selection.iter().enumerate().map(|(i, field)| {
            let opening = if i == 0 { '{' } else { ',' };
            (field, format!("{opening}\"{}\":", field.name()), field.extents(sizes))
        });
        Self {
            robot,
            selection,
            layout: layout.collect(),
            reads_rates: selection.iter().any(Field::reads_rates),
            reads_accelerations: selection.iter().any(Field::reads_accelerations),
            input: Input::default(),
            state: State::default(),
            results: Results::default(),
            answer: Json::default(),
        }
    }

    /// The line that answers a line, nothing for a blank one, or what is wrong with it.
    fn answer(&mut self, line: &[u8]) -> Result<Option<&[u8]>, String> {
        if line.len() as u64 > LONGEST_LINE {
            return Err(format!("longer than {LONGEST_LINE} bytes"));
        }
        let line = std::str::from_utf8(line).map_err(|_| "not UTF-8".to_owned())?;
        let line = line.trim_ascii();
        if line.is_empty() {
            return Ok(None);
        }
        self.input.read(line)?;
        self.take_state()?;
        self.robot.evaluate(self.selection, &self.state, &mut self.results);
        self.write();
        Ok(Some(self.answer.as_bytes()))
    }

    fn take_state(&mut self) -> Result<(), String> {
        let Description { coordinates, actuators, .. } = self.robot.description();
        let of_coordinates = (coordinates.len(), "coordinate");
        let Self { input, state, .. } = self;
        take("q", true, of_coordinates, &mut input.q, &mut state.q)?;
        take("qd", self.reads_rates, of_coordinates, &mut input.qd, &mut state.qd)?;
        take("qdd", self.reads_accelerations, of_coordinates, &mut input.qdd, &mut state.qdd)?;
        take("tau", false, (actuators.len(), "actuator"), &mut input.tau, &mut state.tau)
    }

    fn write(&mut self) {
        self.answer.clear();
        for (field, opening, extents) in &self.layout {
            self.answer.raw(opening);
            self.answer.array(extents, self.results.get(*field));
        }
        self.answer.raw("}\n");
    }
}

/// Moves a vector from the line to the state; zeros if it may be left out.
fn take(
    key: &str,
    required: bool,
    (count, noun): (usize, &str),
    given: &mut Given,
    state: &mut Vec<f64>,
) -> Result<(), String> {
    if !given.present && required {
        return Err(format!("`{key}` is missing"));
    }
    if !given.present {
        state.clear();
        state.resize(count, 0.0);
        return Ok(());
    }
    let found = given.values.len();
    if found != count {
        let entries = if found == 1 { "entry" } else { "entries" };
        let plural = if count == 1 { "" } else { "s" };
        return Err(format!("`{key}` has {found} {entries}, the robot has {count} {noun}{plural}"));
    }
    std::mem::swap(&mut given.values, state);
    Ok(())
}
