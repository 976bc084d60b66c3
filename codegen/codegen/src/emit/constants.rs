//! Numbers of a model at its own parameter values, with their slopes at the origin: sizes of solids,
//! limits of motors, weights of dry friction.

use shapebot_model_dsl::model::{
    Axis, CoordinateId, Expr, ExprId, FrameId, Function, Model, ParameterId, Vector, VectorId,
};
use shapebot_symbolic::nearest;
use std::cell::RefCell;
use std::collections::HashMap;

/// A value and its partial derivatives by the coordinates, at q = 0 and at rest.
#[derive(Clone, Debug)]
struct Jet {
    value: f64,
    slopes: Vec<f64>,
}

impl Jet {
    fn constant(value: f64, size: usize) -> Self {
        Self { value, slopes: vec![0.0; size] }
    }

    /// A combination of two with the partial derivatives by each.
    fn combine(value: f64, a: &Self, by_a: f64, b: &Self, by_b: f64) -> Self {
        // A slope that is not there must not turn an infinite factor into NaN.
        let times = |x: f64, y: f64| if x == 0.0 { 0.0 } else { x * y };
        let pairs = a.slopes.iter().zip(&b.slopes);
        Self { value, slopes: pairs.map(|(&x, &y)| times(x, by_a) + times(y, by_b)).collect() }
    }

    fn apply(&self, value: f64, slope: f64) -> Self {
        Self::combine(value, self, slope, self, 0.0)
    }
}

/// The value of an expression.
pub(super) fn value(model: &Model, id: ExprId) -> f64 {
    Evaluation::new(model).scalar(id).value
}

/// Its partial derivatives at the origin.
pub(super) fn slopes(model: &Model, id: ExprId) -> Vec<f64> {
    Evaluation::new(model).scalar(id).slopes
}

struct Evaluation<'m> {
    model: &'m Model,
    /// A `let` is one node however often it is used: each is evaluated once, or a chain of doublings
    /// would take exponential time.
    scalars: RefCell<HashMap<ExprId, Jet>>,
    vectors: RefCell<HashMap<VectorId, [Jet; 3]>>,
}

impl<'m> Evaluation<'m> {
    fn new(model: &'m Model) -> Self {
        Self { model, scalars: RefCell::default(), vectors: RefCell::default() }
    }

    fn scalar(&self, id: ExprId) -> Jet {
        if let Some(known) = self.scalars.borrow().get(&id) {
            return known.clone();
        }
        let jet = self.evaluate(id);
        self.scalars.borrow_mut().insert(id, jet.clone());
        jet
    }

    /// World components.
    fn vector(&self, id: VectorId) -> [Jet; 3] {
        if let Some(known) = self.vectors.borrow().get(&id) {
            return known.clone();
        }
        let jets = self.evaluate_vector(id);
        self.vectors.borrow_mut().insert(id, jets.clone());
        jets
    }

    fn constant(&self, value: f64) -> Jet {
        Jet::constant(value, self.model.coordinates.len())
    }

    fn evaluate(&self, id: ExprId) -> Jet {
        match self.model.expr(id) {
            Expr::Number(number) => self.constant(nearest(number)),
            Expr::Pi => self.constant(std::f64::consts::PI),
            Expr::Parameter(ParameterId(i)) => self
                .constant(self.model.parameters.get(*i as usize).map_or(f64::NAN, |p| p.value_f64)),
            Expr::Coordinate(CoordinateId(i)) => {
                let mut jet = self.constant(0.0);
                if let Some(slope) = jet.slopes.get_mut(*i as usize) {
                    *slope = 1.0;
                }
                jet
            }
            &Expr::Add(a, b) => sum(&self.scalar(a), &self.scalar(b)),
            &Expr::Sub(a, b) => sum(&self.scalar(a), &scaled(&self.scalar(b), -1.0)),
            &Expr::Mul(a, b) => product(&self.scalar(a), &self.scalar(b)),
            &Expr::Div(a, b) => {
                let (a, b) = (self.scalar(a), self.scalar(b));
                let value = a.value / b.value;
                Jet::combine(value, &a, 1.0 / b.value, &b, -value / b.value)
            }
            &Expr::Neg(a) => scaled(&self.scalar(a), -1.0),
            Expr::Power(base, exponent) => {
                let (base, r) = (self.scalar(*base), nearest(exponent));
                base.apply(base.value.powf(r), r * base.value.powf(r - 1.0))
            }
            Expr::Call(function, arguments) => self.call(*function, arguments),
            // At rest nothing changes.
            Expr::TimeDerivative(_) => self.constant(0.0),
            &Expr::Dot(a, b) => dot(&self.vector(a), &self.vector(b)),
            &Expr::Component(v, axis) => self.vector(v)[usize::from(axis).min(2)].clone(),
        }
    }

    fn call(&self, function: Function, arguments: &[ExprId]) -> Jet {
        let argument =
            |k: usize| arguments.get(k).map_or(self.constant(f64::NAN), |&id| self.scalar(id));
        let x = argument(0);
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
                let other = argument(1);
                let square = v * v + other.value * other.value;
                Jet::combine(v.atan2(other.value), &x, other.value / square, &other, -v / square)
            }
        }
    }

    fn evaluate_vector(&self, id: VectorId) -> [Jet; 3] {
        match self.model.vector(id) {
            Vector::InFrame(v) => self.to_world(v.frame, v.entries.map(|e| self.scalar(e))),
            Vector::Sum(terms) => {
                let zero = [0, 1, 2].map(|_| self.constant(0.0));
                terms.iter().fold(zero, |at, &term| {
                    let term = self.vector(term);
                    [0, 1, 2].map(|k| sum(&at[k], &term[k]))
                })
            }
            &Vector::Scaled(factor, v) => {
                let (factor, v) = (self.scalar(factor), self.vector(v));
                v.map(|x| product(&factor, &x))
            }
            &Vector::Cross(a, b) => {
                let (a, b) = (self.vector(a), self.vector(b));
                [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
                    sum(&product(&a[i], &b[j]), &scaled(&product(&a[j], &b[i]), -1.0))
                })
            }
            Vector::TimeDerivative(_) | Vector::AngularVelocity(_) => {
                [0, 1, 2].map(|_| self.constant(0.0))
            }
        }
    }

    fn to_world(&self, frame: FrameId, mut v: [Jet; 3]) -> [Jet; 3] {
        let mut at = self.model.frames.get(frame.0 as usize);
        while let Some(frame) = at {
            for &(axis, angle) in frame.rotations.iter().rev() {
                v = turned(axis, &self.scalar(angle), &v);
            }
            at = frame.parent.and_then(|parent| self.model.frames.get(parent.0 as usize));
        }
        v
    }
}

/// A vector after an elementary rotation.
fn turned(axis: Axis, angle: &Jet, v: &[Jet; 3]) -> [Jet; 3] {
    let (sin, cos) = angle.value.sin_cos();
    let (s, c) = (angle.apply(sin, cos), angle.apply(cos, -sin));
    let (i, j) = match axis {
        Axis::X => (1, 2),
        Axis::Y => (2, 0),
        Axis::Z => (0, 1),
    };
    let mut out = v.clone();
    out[i] = sum(&product(&c, &v[i]), &scaled(&product(&s, &v[j]), -1.0));
    out[j] = sum(&product(&s, &v[i]), &product(&c, &v[j]));
    out
}

fn sum(a: &Jet, b: &Jet) -> Jet {
    Jet::combine(a.value + b.value, a, 1.0, b, 1.0)
}

fn scaled(a: &Jet, factor: f64) -> Jet {
    a.apply(a.value * factor, factor)
}

fn product(a: &Jet, b: &Jet) -> Jet {
    Jet::combine(a.value * b.value, a, b.value, b, a.value)
}

fn dot(a: &[Jet; 3], b: &[Jet; 3]) -> Jet {
    let part = |k: usize| product(&a[k], &b[k]);
    sum(&sum(&part(0), &part(1)), &part(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_doublings_is_evaluated_once_per_link() {
        let mut lets = String::from("let a0 = x;\n");
        for i in 1..=60 {
            lets += &format!("let a{i} = a{} + a{};\n", i - 1, i - 1);
        }
        let text = format!(
            "robot Chain {{ params {{ m: kg = 1; }} position x: m; {lets}
             kinetic 1/2*m*d/dt(x)^2; actuator f on d/dt(a60); }}"
        );
        let parsed = shapebot_model_dsl::parse("chain.robot", &text);
        let model = parsed.model.expect("a model");
        let slope = slopes(&model, model.actuators[0].displacement);
        assert_eq!(slope, vec![2_f64.powi(60)]);
    }
}
