//! From an expression graph to a tape: parameters bound, parameter-only values folded, registers of
//! dead values used again.

use crate::order::batched;
use crate::tape::{Input, Operation, Register, Source, Step, Tape};
use shapebot_dynamics::Real;
use shapebot_symbolic::{Graph, Id, Node, Symbol, Unary, nearest, needed};
use std::collections::BTreeMap;

/// Compiles the values `results` of a graph, where parameter i has the value `parameters[i]`. A
/// parameter or auxiliary symbol without a value counts as not a number.
pub(crate) fn compile<T: Real>(graph: &Graph, results: &[Id], parameters: &[T]) -> Tape<T> {
    let order = needed(graph, results, |_| false);
    let size = order.last().map_or(0, |id| id.index() + 1);
    let mut compiler = Compiler {
        graph,
        parameters,
        fixed: vec![None; size],
        register: vec![None; size],
        constants: Vec::new(),
        inputs: Vec::new(),
        code: Vec::new(),
        allocator: Allocator::default(),
        pairs: BTreeMap::new(),
    };
    compiler.fold(&order);
    compiler.place_constants(&order, results);
    compiler.place_inputs(&order);
    let order = batched(graph, &order, |id| compiler.is_fixed(id));
    compiler.translate(&order, &last_uses(graph, &order, results, size));
    compiler.finish(results)
}

/// Position in `order` after which a value is not read again; `usize::MAX` for results.
fn last_uses(graph: &Graph, order: &[Id], results: &[Id], size: usize) -> Vec<usize> {
    let mut last = vec![0; size];
    for (position, &id) in order.iter().enumerate() {
        for operand in graph.node(id).operands().into_iter().flatten() {
            last[operand.index()] = position;
        }
    }
    for id in results {
        last[id.index()] = usize::MAX;
    }
    last
}

/// Sine and cosine of one angle, as far as they are needed.
#[derive(Clone, Copy, Default)]
struct Pair {
    sine: Option<Id>,
    cosine: Option<Id>,
}

struct Compiler<'a, T> {
    graph: &'a Graph,
    parameters: &'a [T],
    /// Values that depend on parameters alone.
    fixed: Vec<Option<T>>,
    /// Where a value lives.
    register: Vec<Option<Register>>,
    constants: Vec<T>,
    inputs: Vec<Input>,
    code: Vec<(Operation, Step)>,
    allocator: Allocator,
    pairs: BTreeMap<Id, Pair>,
}

impl<T: Real> Compiler<'_, T> {
    fn fold(&mut self, order: &[Id]) {
        for &id in order {
            self.fixed[id.index()] = self.fold_one(id);
            match *self.graph.node(id) {
                Node::Unary(Unary::Sin, x) => self.pairs.entry(x).or_default().sine = Some(id),
                Node::Unary(Unary::Cos, x) => self.pairs.entry(x).or_default().cosine = Some(id),
                _ => {}
            }
        }
    }

    fn fold_one(&self, id: Id) -> Option<T> {
        let v = |x: Id| self.fixed[x.index()];
        Some(match *self.graph.node(id) {
            Node::Constant(ref value) => T::from_f64(nearest(value)),
            Node::Pi => T::from_f64(std::f64::consts::PI),
            Node::Symbol(Symbol::Parameter(i)) => self.parameter(i),
            Node::Symbol(Symbol::Auxiliary(_)) => T::from_f64(f64::NAN),
            Node::Symbol(_) => return None,
            Node::Add(a, b) => v(a)? + v(b)?,
            Node::Sub(a, b) => v(a)? - v(b)?,
            Node::Mul(a, b) => v(a)? * v(b)?,
            Node::Div(a, b) => v(a)? / v(b)?,
            Node::Neg(a) => -v(a)?,
            Node::Unary(function, a) => apply(function, v(a)?),
            Node::Atan2(y, x) => v(y)?.atan2(v(x)?),
        })
    }

    fn parameter(&self, index: u32) -> T {
        self.parameters.get(index as usize).copied().unwrap_or_else(|| T::from_f64(f64::NAN))
    }

    fn is_fixed(&self, id: Id) -> bool {
        self.fixed[id.index()].is_some()
    }

    /// Registers for the folded values that an instruction or a result reads.
    fn place_constants(&mut self, order: &[Id], results: &[Id]) {
        let graph = self.graph;
        let live = order.iter().filter(|id| !self.is_fixed(**id));
        let read = live.flat_map(|&id| graph.node(id).operands().into_iter().flatten());
        let read: Vec<Id> = read.chain(results.iter().copied()).collect();
        for id in read {
            if let (Some(value), None) = (self.fixed[id.index()], self.register[id.index()]) {
                self.register[id.index()] = Some(self.allocator.take());
                self.constants.push(value);
            }
        }
    }

    fn place_inputs(&mut self, order: &[Id]) {
        for &id in order {
            let Node::Symbol(symbol) = *self.graph.node(id) else { continue };
            let Some((source, index)) = source(symbol) else { continue };
            let register = self.allocator.take();
            self.register[id.index()] = Some(register);
            self.inputs.push(Input { source, index, register });
        }
    }

    fn translate(&mut self, order: &[Id], last_use: &[usize]) {
        for (position, &id) in order.iter().enumerate() {
            let operands = self.graph.node(id).operands();
            let [a, b] = operands.map(|x| x.map_or(0, |x| self.register_of(x)));
            self.release(operands, position, last_use);
            if self.register[id.index()].is_none() {
                self.emit(id, a, b);
            }
        }
    }

    fn register_of(&self, id: Id) -> Register {
        self.register[id.index()].unwrap_or_default()
    }

    /// Gives back the registers of operands that are read here for the last time.
    fn release(&mut self, operands: [Option<Id>; 2], position: usize, last_use: &[usize]) {
        let [a, b] = operands;
        let distinct = [a, if a == b { None } else { b }];
        for operand in distinct.into_iter().flatten() {
            let temporary = !self.is_fixed(operand);
            if temporary && last_use[operand.index()] == position {
                self.allocator.give_back(self.register_of(operand));
            }
        }
    }

    fn emit(&mut self, id: Id, a: Register, b: Register) {
        let (operation, right) = match *self.graph.node(id) {
            Node::Add(..) => (Operation::Add, b),
            Node::Sub(..) => (Operation::Sub, b),
            Node::Mul(..) => (Operation::Mul, b),
            Node::Div(..) => (Operation::Div, b),
            Node::Neg(_) => (Operation::Neg, a),
            Node::Atan2(..) => (Operation::Atan2, b),
            Node::Unary(Unary::Sin | Unary::Cos, angle) => return self.emit_pair(angle, a),
            Node::Unary(function, _) => (operation(function), a),
            // Inputs and constants have their registers already.
            Node::Constant(_) | Node::Pi | Node::Symbol(_) => return,
        };
        let target = self.allocator.take();
        self.register[id.index()] = Some(target);
        self.code.push((operation, Step { target, left: a, right }));
    }

    /// Sine and cosine together, as compiled code computes them.
    fn emit_pair(&mut self, angle: Id, left: Register) {
        let Pair { sine, cosine } = self.pairs.get(&angle).copied().unwrap_or_default();
        let [target, right] = [self.allocator.take(), self.allocator.take()];
        for (id, register) in [(sine, target), (cosine, right)] {
            match id {
                Some(id) => self.register[id.index()] = Some(register),
                None => self.allocator.give_back(register),
            }
        }
        self.code.push((Operation::SinCos, Step { target, left, right }));
    }

    fn finish(self, results: &[Id]) -> Tape<T> {
        let outputs = results.iter().map(|&id| self.register_of(id)).collect();
        Tape::new(&self.code, self.inputs, outputs, self.constants, self.allocator.size())
    }
}

/// Hands out registers, the most recently freed first.
#[derive(Default)]
struct Allocator {
    free: Vec<Register>,
    next: Register,
}

impl Allocator {
    fn take(&mut self) -> Register {
        self.free.pop().unwrap_or_else(|| {
            self.next += 1;
            self.next - 1
        })
    }

    fn give_back(&mut self, register: Register) {
        self.free.push(register);
    }

    const fn size(&self) -> usize {
        self.next as usize
    }
}

const fn source(symbol: Symbol) -> Option<(Source, usize)> {
    Some(match symbol {
        Symbol::Coordinate(i) => (Source::Coordinate, i as usize),
        Symbol::Rate(i) => (Source::Rate, i as usize),
        Symbol::Acceleration(i) => (Source::Acceleration, i as usize),
        Symbol::Force(i) => (Source::Force, i as usize),
        Symbol::Parameter(_) | Symbol::Auxiliary(_) => return None,
    })
}

const fn operation(function: Unary) -> Operation {
    match function {
        Unary::Sqrt => Operation::Sqrt,
        Unary::Exp => Operation::Exp,
        Unary::Ln => Operation::Ln,
        Unary::Asin => Operation::Asin,
        Unary::Acos => Operation::Acos,
        Unary::Atan => Operation::Atan,
        Unary::Sin | Unary::Cos => Operation::SinCos,
    }
}

fn apply<T: Real>(function: Unary, x: T) -> T {
    match function {
        Unary::Sqrt => x.sqrt(),
        Unary::Sin => x.sin_cos().0,
        Unary::Cos => x.sin_cos().1,
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
    }
}
