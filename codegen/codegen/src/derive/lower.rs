//! The model's expressions as values of a graph.

use super::Parameters;
use super::vector::{self, Rotation, Vec3};
use shapebot_model_dsl::model::{
    CoordinateId, Expr, ExprId, FrameId, FrameVector, Function, Model, Position, Vector, VectorId,
};
use shapebot_symbolic::{Graph, Id, Symbol, Tangent, Unary};

/// Lowers expressions of one model into one graph, each once.
#[derive(Clone, Debug)]
pub(crate) struct Lowering<'m> {
    /// The model.
    pub(crate) model: &'m Model,
    /// The graph being filled.
    pub(crate) graph: Graph,
    parameters: Vec<Id>,
    scalars: Vec<Option<Id>>,
    vectors: Vec<Option<Vec3>>,
    rotations: Vec<Vec<Rotation>>,
    time: Tangent,
}

impl<'m> Lowering<'m> {
    /// Starts with the parameters and the frames' rotations.
    pub(crate) fn new(model: &'m Model, mode: Parameters) -> Self {
        let mut lowering = Self {
            model,
            graph: Graph::new(),
            parameters: Vec::new(),
            scalars: vec![None; model.expressions.len()],
            vectors: vec![None; model.vectors.len()],
            rotations: Vec::new(),
            time: Tangent::new([]),
        };
        lowering.time = lowering.time_seeds();
        for (i, parameter) in model.parameters.iter().enumerate() {
            let id = match mode {
                Parameters::Symbolic => lowering.graph.symbol(Symbol::Parameter(number(i))),
                Parameters::Baked => lowering.scalar(parameter.value),
            };
            lowering.parameters.push(id);
        }
        // Operands come first in the arena: in this order no recursion goes deep.
        for i in 0..model.expressions.len() {
            lowering.scalar(ExprId(number(i)));
        }
        for frame in &model.frames {
            let rotations = frame.rotations.iter().map(|&(axis, angle)| {
                let angle = lowering.scalars[angle.0 as usize].unwrap_or(lowering.graph.zero());
                let (sin, cos) = (lowering.graph.sin(angle), lowering.graph.cos(angle));
                Rotation { axis: vector::index(axis), cos, sin }
            });
            let rotations: Vec<Rotation> = rotations.collect();
            lowering.rotations.push(rotations);
        }
        lowering
    }

    /// d/dt: coordinates move at their rates, rates at their accelerations.
    fn time_seeds(&mut self) -> Tangent {
        let graph = &mut self.graph;
        let mut seeds = Vec::new();
        for i in 0..number(self.model.coordinates.len()) {
            seeds.push((Symbol::Coordinate(i), graph.symbol(Symbol::Rate(i))));
            seeds.push((Symbol::Rate(i), graph.symbol(Symbol::Acceleration(i))));
        }
        Tangent::new(seeds)
    }

    /// Total time derivative of a value.
    pub(crate) fn time_derivative(&mut self, id: Id) -> Id {
        self.time.of(&mut self.graph, id)
    }

    /// A scalar expression.
    pub(crate) fn scalar(&mut self, id: ExprId) -> Id {
        if let Some(known) = self.scalars[id.0 as usize] {
            return known;
        }
        let value = self.lower(id);
        self.scalars[id.0 as usize] = Some(value);
        value
    }

    fn lower(&mut self, id: ExprId) -> Id {
        let model = self.model;
        match model.expr(id) {
            Expr::Number(value) => self.graph.constant(value.clone()),
            Expr::Pi => self.graph.pi(),
            Expr::Parameter(p) => match self.parameters.get(p.0 as usize) {
                Some(&id) => id,
                None => self.graph.symbol(Symbol::Parameter(p.0)),
            },
            Expr::Coordinate(CoordinateId(i)) => self.graph.symbol(Symbol::Coordinate(*i)),
            &Expr::Add(a, b) => self.binary(a, b, Graph::add),
            &Expr::Sub(a, b) => self.binary(a, b, Graph::sub),
            &Expr::Mul(a, b) => self.binary(a, b, Graph::mul),
            &Expr::Div(a, b) => self.binary(a, b, Graph::div),
            &Expr::Neg(a) => {
                let a = self.scalar(a);
                self.graph.neg(a)
            }
            Expr::Power(base, exponent) => {
                let base = self.scalar(*base);
                self.graph.pow(base, exponent)
            }
            Expr::Call(function, arguments) => self.call(*function, arguments),
            &Expr::TimeDerivative(e) => {
                let e = self.scalar(e);
                self.time_derivative(e)
            }
            &Expr::Dot(a, b) => self.dot(a, b),
            &Expr::Component(v, axis) => self.world(v)[usize::from(axis).min(2)],
        }
    }

    fn binary(&mut self, a: ExprId, b: ExprId, op: fn(&mut Graph, Id, Id) -> Id) -> Id {
        let (a, b) = (self.scalar(a), self.scalar(b));
        op(&mut self.graph, a, b)
    }

    fn call(&mut self, function: Function, arguments: &[ExprId]) -> Id {
        let x = arguments.first().map_or(self.graph.zero(), |&a| self.scalar(a));
        let y = arguments.get(1).map(|&a| self.scalar(a));
        let graph = &mut self.graph;
        match function {
            Function::Sin => graph.sin(x),
            Function::Cos => graph.cos(x),
            Function::Tan => {
                let (sin, cos) = (graph.sin(x), graph.cos(x));
                graph.div(sin, cos)
            }
            Function::Asin => graph.unary(Unary::Asin, x),
            Function::Acos => graph.unary(Unary::Acos, x),
            Function::Atan => graph.unary(Unary::Atan, x),
            Function::Sqrt => graph.unary(Unary::Sqrt, x),
            Function::Exp => graph.unary(Unary::Exp, x),
            Function::Ln => graph.unary(Unary::Ln, x),
            Function::Atan2 => graph.atan2(x, y.unwrap_or(graph.one())),
            Function::Sinh | Function::Cosh | Function::Tanh => hyperbolic(graph, function, x),
        }
    }

    /// Scalar product; in the common frame where both are written in one.
    fn dot(&mut self, a: VectorId, b: VectorId) -> Id {
        if let (Vector::InFrame(x), Vector::InFrame(y)) =
            (self.model.vector(a), self.model.vector(b))
            && x.frame == y.frame
        {
            let (x, y) = (self.entries(x), self.entries(y));
            return vector::dot(&mut self.graph, &x, &y);
        }
        let (x, y) = (self.world(a), self.world(b));
        vector::dot(&mut self.graph, &x, &y)
    }

    /// Components of a frame vector along its own frame.
    pub(crate) fn entries(&mut self, v: &FrameVector) -> Vec3 {
        v.entries.map(|e| self.scalar(e))
    }

    /// World components of a vector.
    pub(crate) fn world(&mut self, id: VectorId) -> Vec3 {
        if let Some(known) = self.vectors[id.0 as usize] {
            return known;
        }
        let model = self.model;
        let value = match model.vector(id) {
            Vector::InFrame(v) => {
                let entries = self.entries(v);
                self.world_components(v.frame, entries)
            }
            Vector::Sum(terms) => {
                let mut sum = vector::zero(&self.graph);
                for &term in terms {
                    let term = self.world(term);
                    sum = vector::add(&mut self.graph, sum, term);
                }
                sum
            }
            &Vector::Scaled(factor, v) => {
                let (factor, v) = (self.scalar(factor), self.world(v));
                vector::scale(&mut self.graph, factor, v)
            }
            &Vector::Cross(a, b) => {
                let (a, b) = (self.world(a), self.world(b));
                vector::cross(&mut self.graph, a, b)
            }
            &Vector::TimeDerivative(v) => {
                let v = self.world(v);
                v.map(|x| self.time_derivative(x))
            }
            &Vector::AngularVelocity(frame) => self.angular_velocity(frame),
        };
        self.vectors[id.0 as usize] = Some(value);
        value
    }

    /// World components of a vector given along a frame's axes.
    pub(crate) fn world_components(&mut self, frame: FrameId, mut v: Vec3) -> Vec3 {
        let mut at = Some(frame);
        while let Some(FrameId(f)) = at {
            for rotation in self.frame_rotations(FrameId(f)).into_iter().rev() {
                v = rotation.to_parent(&mut self.graph, v);
            }
            at = self.model.frames.get(f as usize).and_then(|frame| frame.parent);
        }
        v
    }

    /// Elementary rotations of a frame relative to its parent.
    pub(crate) fn frame_rotations(&mut self, frame: FrameId) -> Vec<Rotation> {
        if let Some(known) = self.rotations.get(frame.0 as usize) {
            return known.clone();
        }
        let model = self.model;
        let Some(frame) = model.frames.get(frame.0 as usize) else { return Vec::new() };
        let rotations = frame.rotations.iter().map(|&(axis, angle)| {
            let angle = self.scalar(angle);
            let (sin, cos) = (self.graph.sin(angle), self.graph.cos(angle));
            Rotation { axis: vector::index(axis), cos, sin }
        });
        rotations.collect()
    }

    /// Angular velocity of a frame, world components.
    fn angular_velocity(&mut self, frame: FrameId) -> Vec3 {
        let mut sum = vector::zero(&self.graph);
        let mut at = Some(frame);
        while let Some(f) = at {
            let model = self.model;
            let Some(declared) = model.frames.get(f.0 as usize) else { break };
            let rotations = self.frame_rotations(f);
            for (k, &(axis, angle)) in declared.rotations.iter().enumerate() {
                let angle = self.scalar(angle);
                let rate = self.time_derivative(angle);
                let mut v = vector::zero(&self.graph);
                v[vector::index(axis)] = rate;
                for rotation in rotations[..=k].iter().rev() {
                    v = rotation.to_parent(&mut self.graph, v);
                }
                if let Some(parent) = declared.parent {
                    v = self.world_components(parent, v);
                }
                sum = vector::add(&mut self.graph, sum, v);
            }
            at = declared.parent;
        }
        sum
    }

    /// World components of a position.
    pub(crate) fn position(&mut self, position: &Position) -> Vec3 {
        let mut sum = vector::zero(&self.graph);
        for term in &position.terms {
            let entries = self.entries(term);
            let world = self.world_components(term.frame, entries);
            sum = vector::add(&mut self.graph, sum, world);
        }
        sum
    }

    /// Partial derivative of a value.
    pub(crate) fn partial(&mut self, id: Id, symbol: Symbol) -> Id {
        Tangent::partial(&self.graph, symbol).of(&mut self.graph, id)
    }
}

/// sinh, cosh and tanh through the exponential.
fn hyperbolic(graph: &mut Graph, function: Function, x: Id) -> Id {
    let up = graph.unary(Unary::Exp, x);
    let one = graph.one();
    let down = graph.div(one, up);
    let (sum, difference) = (graph.add(up, down), graph.sub(up, down));
    let half = graph.fraction(1, 2);
    match function {
        Function::Sinh => graph.mul(half, difference),
        Function::Cosh => graph.mul(half, sum),
        _ => graph.div(difference, sum),
    }
}

/// An index as the number of a symbol.
pub(crate) fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
