//! Numbers of a model at its own parameter values and at the origin: limits of motors, sizes of
//! solids, levels and weights of dry friction.

use shapebot_model_dsl::model::{
    Axis, CoordinateId, Expr, ExprId, FrameId, Function, Model, ParameterId, Vector, VectorId,
};
use shapebot_symbolic::nearest;

/// Reads numbers of one model.
pub(crate) struct Constants<'m> {
    model: &'m Model,
}

impl<'m> Constants<'m> {
    pub(crate) const fn of(model: &'m Model) -> Self {
        Self { model }
    }

    /// The value of an expression at rest at the origin.
    pub(crate) fn value(&self, id: ExprId) -> f64 {
        Origin::new(self.model, None).run(id).value
    }

    /// Its partial derivatives by the coordinates there.
    pub(crate) fn slopes(&self, id: ExprId) -> Vec<f64> {
        let along = |i| Origin::new(self.model, Some(i)).run(id).slope;
        (0..self.model.coordinates.len()).map(along).collect()
    }
}

/// A value with its derivative along one coordinate.
#[derive(Clone, Copy)]
struct Pair {
    value: f64,
    slope: f64,
}

impl Pair {
    const ZERO: Self = Self::fixed(0.0);
    const NONE: Self = Self::fixed(f64::NAN);

    const fn fixed(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }

    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }

    fn mul(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        Self { value: self.value * other.value, slope }
    }

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }

    /// A function's value and, where the argument moves at all, its derivative.
    fn apply(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: if self.slope == 0.0 { 0.0 } else { derivative * self.slope } }
    }
}

/// Expressions are remembered: `let` bindings are shared.
struct Origin<'m> {
    model: &'m Model,
    direction: Option<usize>,
    scalars: Vec<Option<Pair>>,
    vectors: Vec<Option<[Pair; 3]>>,
}

impl<'m> Origin<'m> {
    fn new(model: &'m Model, direction: Option<usize>) -> Self {
        let scalars = vec![None; model.expressions.len()];
        Self { model, direction, scalars, vectors: vec![None; model.vectors.len()] }
    }

    /// Goes through the arena in order, operands first, so that no recursion goes deep.
    fn run(mut self, id: ExprId) -> Pair {
        for i in 0..=id.0 {
            self.scalar(ExprId(i));
        }
        self.scalar(id)
    }

    fn scalar(&mut self, id: ExprId) -> Pair {
        if let Some(known) = self.scalars[id.0 as usize] {
            return known;
        }
        let value = self.expression(id);
        self.scalars[id.0 as usize] = Some(value);
        value
    }

    fn expression(&mut self, id: ExprId) -> Pair {
        let model = self.model;
        match *model.expr(id) {
            Expr::Number(ref number) => Pair::fixed(nearest(number)),
            Expr::Pi => Pair::fixed(std::f64::consts::PI),
            Expr::Parameter(ParameterId(i)) => {
                model.parameters.get(i as usize).map_or(Pair::NONE, |p| Pair::fixed(p.value_f64))
            }
            Expr::Coordinate(CoordinateId(i)) => {
                let slope = if self.direction == Some(i as usize) { 1.0 } else { 0.0 };
                Pair { value: 0.0, slope }
            }
            Expr::Add(a, b) => self.scalar(a).add(self.scalar(b)),
            Expr::Sub(a, b) => self.scalar(a).add(self.scalar(b).neg()),
            Expr::Mul(a, b) => self.scalar(a).mul(self.scalar(b)),
            Expr::Div(a, b) => self.scalar(a).div(self.scalar(b)),
            Expr::Neg(a) => self.scalar(a).neg(),
            Expr::Power(a, ref exponent) => {
                let (a, r) = (self.scalar(a), nearest(exponent));
                a.apply(a.value.powf(r), r * a.value.powf(r - 1.0))
            }
            Expr::Call(function, ref arguments) => {
                let mut arguments = arguments.iter().map(|&a| self.scalar(a));
                let first = arguments.next().unwrap_or(Pair::NONE);
                call(function, first, arguments.next().unwrap_or(Pair::NONE))
            }
            // At rest nothing changes.
            Expr::TimeDerivative(_) => Pair::ZERO,
            Expr::Dot(a, b) => {
                let (a, b) = (self.vector(a), self.vector(b));
                (0..3).fold(Pair::ZERO, |sum, k| sum.add(a[k].mul(b[k])))
            }
            Expr::Component(v, axis) => self.vector(v)[usize::from(axis).min(2)],
        }
    }

    /// World components.
    fn vector(&mut self, id: VectorId) -> [Pair; 3] {
        if let Some(known) = self.vectors[id.0 as usize] {
            return known;
        }
        let model = self.model;
        let value = match *model.vector(id) {
            Vector::InFrame(ref v) => {
                let entries = v.entries.map(|e| self.scalar(e));
                self.in_world(v.frame, entries)
            }
            Vector::Sum(ref terms) => terms.iter().fold([Pair::ZERO; 3], |sum, &term| {
                let term = self.vector(term);
                std::array::from_fn(|k| sum[k].add(term[k]))
            }),
            Vector::Scaled(factor, v) => {
                let factor = self.scalar(factor);
                self.vector(v).map(|x| factor.mul(x))
            }
            Vector::Cross(a, b) => {
                let (a, b) = (self.vector(a), self.vector(b));
                [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].mul(b[j]).add(a[j].mul(b[i]).neg()))
            }
            Vector::TimeDerivative(_) | Vector::AngularVelocity(_) => [Pair::ZERO; 3],
        };
        self.vectors[id.0 as usize] = Some(value);
        value
    }

    fn in_world(&mut self, FrameId(frame): FrameId, mut v: [Pair; 3]) -> [Pair; 3] {
        let model = self.model;
        let mut at = model.frames.get(frame as usize);
        while let Some(frame) = at {
            for &(axis, angle) in frame.rotations.iter().rev() {
                v = turn(axis, self.scalar(angle), v);
            }
            at = frame.parent.and_then(|FrameId(parent)| model.frames.get(parent as usize));
        }
        v
    }
}

fn turn(axis: Axis, angle: Pair, v: [Pair; 3]) -> [Pair; 3] {
    let (sin, cos) = angle.value.sin_cos();
    let (s, c) = (angle.apply(sin, cos), angle.apply(cos, -sin));
    let (i, j) = match axis {
        Axis::X => (1, 2),
        Axis::Y => (2, 0),
        Axis::Z => (0, 1),
    };
    let mut turned = v;
    turned[i] = c.mul(v[i]).add(s.mul(v[j]).neg());
    turned[j] = s.mul(v[i]).add(c.mul(v[j]));
    turned
}

fn call(function: Function, x: Pair, other: Pair) -> Pair {
    let v = x.value;
    match function {
        Function::Sin => x.apply(v.sin(), v.cos()),
        Function::Cos => x.apply(v.cos(), -v.sin()),
        Function::Tan => x.apply(v.tan(), 1.0 + v.tan() * v.tan()),
        Function::Asin => x.apply(v.asin(), 1.0 / (1.0 - v * v).sqrt()),
        Function::Acos => x.apply(v.acos(), -1.0 / (1.0 - v * v).sqrt()),
        Function::Atan => x.apply(v.atan(), 1.0 / (1.0 + v * v)),
        Function::Sinh => x.apply(v.sinh(), v.cosh()),
        Function::Cosh => x.apply(v.cosh(), v.sinh()),
        Function::Tanh => x.apply(v.tanh(), 1.0 - v.tanh() * v.tanh()),
        Function::Sqrt => x.apply(v.sqrt(), 0.5 / v.sqrt()),
        Function::Exp => x.apply(v.exp(), v.exp()),
        Function::Ln => x.apply(v.ln(), 1.0 / v),
        Function::Atan2 => {
            let square = v * v + other.value * other.value;
            let slope = (other.value * x.slope - v * other.slope) / square;
            Pair { value: v.atan2(other.value), slope }
        }
    }
}
