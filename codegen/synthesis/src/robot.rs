//! The scales of a robot's linearisation, and the parameter values at which a design is judged.

use crate::linear_algebra::Matrix;
use crate::linearisation::Linearisation;
use crate::search::SERVO_RATE;
use shapebot_codegen::derive::Derivation;

/// Largest off-diagonal part of a matrix of scales that counts as none.
const COUPLING: f64 = 1e-9;

/// A robot at the model's own parameter values.
#[derive(Debug)]
pub(crate) struct Robot<'a> {
    pub(crate) derivation: &'a Derivation,
    pub(crate) model: Linearisation,
    /// Whether an actuator works on a coordinate.
    pub(crate) actuated: Vec<bool>,
    /// The position variables are actuated and balance the unactuated shape.
    pub(crate) balancing: bool,
    /// The momentum observer's conditions are proved.
    pub(crate) observable: bool,
    /// Per axis.
    pub(crate) scales: Vec<Scale>,
    /// Axes do not act on each other.
    pub(crate) decoupled: bool,
    /// Shape coordinates in which K⁰ is one: columns of s = T s'.
    unit: Matrix,
    /// Shape variables that the balancing loop, or the outer loop, acts through.
    through: Vec<usize>,
}

/// Natural scales of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// p² of v̈ = p²(v − w), the lean v as acceleration and the force w as acceleration, 1/s²: p is the
    /// pole without torque. Zero without a balancing loop.
    pub(crate) pole_squared: f64,
    /// Time that the outer loop is measured in, s.
    pub(crate) time: f64,
}

impl<'a> Robot<'a> {
    /// Why there is no such robot, if there is none.
    pub(crate) fn new(derivation: &'a Derivation) -> Result<Self, String> {
        let singular = || String::from("its linearisation at the origin is singular");
        let values: Vec<f64> = derivation.model.parameters.iter().map(|p| p.value_f64).collect();
        let model = Linearisation::new(derivation, &values).ok_or_else(singular)?;
        let n_x = model.position_count();
        let free = derivation.equations.unactuated();
        let actuated: Vec<bool> = (0..model.len()).map(|i| !free.contains(&i)).collect();
        let balancing = free.iter().all(|&i| i >= n_x);
        if !balancing && free.iter().any(|&i| i >= n_x) {
            return Err("some position variables are actuated and some are not".into());
        }
        let facts = &derivation.certificate.positions;
        let observable = balancing && facts.iter().all(|fact| fact.momentum_observer);
        let through: Vec<usize> =
            (0..model.len() - n_x).filter(|&j| !balancing || !actuated[n_x + j]).collect();
        let axes: Vec<usize> = (0..n_x).collect();
        let gain = model.shape_gain.pick(&axes, &through);
        let transposed = gain.transpose();
        let square = gain.times(&transposed).inverse();
        let unit = transposed.times(
            &square
                .ok_or("the shape that its loop acts through does not reach every acceleration")?,
        );
        let mut robot = Self {
            derivation,
            model,
            actuated,
            balancing,
            observable,
            scales: Vec::new(),
            decoupled: false,
            unit,
            through,
        };
        robot.measure().ok_or_else(singular)?;
        Ok(robot)
    }

    /// The robot with servoed shape locked, in units in which K⁰ is one: what is balanced.
    pub(crate) fn core(&self, model: &Linearisation) -> Linearisation {
        let axes: Vec<usize> = (0..model.position_count()).collect();
        model.restricted(&axes, &self.through).in_shape_coordinates(&self.unit)
    }

    fn measure(&mut self) -> Option<()> {
        let core = self.core(&self.model);
        let n_x = core.position_count();
        let (axes, lean): (Vec<usize>, Vec<usize>) = ((0..n_x).collect(), (n_x..2 * n_x).collect());
        let output = core.response.plus(&core.output_shape).scaled(-1.0);
        let inertia = core.mass.pick(&axes, &axes);
        let reaction = inertia.solve(&core.mass.pick(&axes, &lean))?;
        let pole = if self.balancing {
            core.response.plus(&reaction).scaled(-1.0).inverse()?
        } else {
            Matrix::zeros(n_x, n_x)
        };
        let scale = |i: usize| Scale {
            pole_squared: pole[(i, i)],
            time: time(pole[(i, i)], output[(i, i)]),
        };
        self.scales = (0..n_x).map(scale).collect();
        let parts =
            [&core.mass, &core.stiffness, &core.damping, &core.output_shape, &core.response];
        self.decoupled = parts.iter().all(|part| is_decoupled(part, n_x));
        Some(())
    }

    /// Linearisations at other parameter values within `share` of the model's own, clipped to the declared
    /// ranges: `corners` corners of that box, and the middles of its faces if `faces` are wanted. Values
    /// at which nothing can be computed are left out.
    pub(crate) fn samples(&self, share: f64, corners: usize, faces: bool) -> Vec<Linearisation> {
        let box_of = self.ranges(share);
        let own: Vec<f64> = box_of.iter().map(|b| b.1).collect();
        let mut points = Vec::new();
        if faces {
            for (i, &(lower, _, upper)) in box_of.iter().enumerate() {
                for value in [lower, upper] {
                    let mut point = own.clone();
                    point[i] = value;
                    points.push(point);
                }
            }
        }
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..corners {
            let mut point = own.clone();
            for (value, &(lower, _, upper)) in point.iter_mut().zip(&box_of) {
                // xorshift64: fixed, so that every run decides alike.
                bits ^= bits << 13;
                bits ^= bits >> 7;
                bits ^= bits << 17;
                *value = if bits & (1 << 40) == 0 { lower } else { upper };
            }
            points.push(point);
        }
        points.iter().filter_map(|point| Linearisation::new(self.derivation, point)).collect()
    }

    /// (lower, own, upper) of each parameter.
    pub(crate) fn ranges(&self, share: f64) -> Vec<(f64, f64, f64)> {
        let range = |p: &shapebot_model_dsl::model::Parameter| {
            let own = p.value_f64;
            let ends = [own * (1.0 - share), own * (1.0 + share)];
            let (mut lower, mut upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            if let Some(declared) = p.range {
                lower = lower.max(declared.lower).min(own);
                upper = upper.min(declared.upper).max(own);
            }
            (lower, own, upper)
        };
        self.derivation.model.parameters.iter().map(range).collect()
    }
}

/// τ where the output is delayed by it, else 1/p, else four times that of the servo.
fn time(pole_squared: f64, output: f64) -> f64 {
    let lag = output.abs().sqrt();
    let fall = if pole_squared == 0.0 { 4.0 / SERVO_RATE } else { 1.0 / pole_squared.abs().sqrt() };
    if lag > 0.1 * fall { lag } else { fall }
}

/// Whether every block of a matrix by axes is diagonal.
fn is_decoupled(matrix: &Matrix, axes: usize) -> bool {
    let scale = matrix.largest();
    let across = (0..matrix.rows)
        .flat_map(|i| (0..matrix.columns).map(move |j| (i, j)))
        .filter(|(i, j)| i % axes != j % axes);
    across.fold(0.0, |m: f64, at| m.max(matrix[at].abs())) <= COUPLING * scale
}
