//! How large a robot is, so that disturbances fit every one of them.

use crate::Error;
use nalgebra::{DMatrix, SMatrix, SVector};
use shapebot_dynamics::Robot;

/// Natural units of a robot near its origin.
///
/// With q_s = K⁰u it behaves as ẍ = u − τ²ü: τ is its time, and what a lean of one radian accelerates
/// in τ² its length. Where τ vanishes (a marble on a plate) the length is the half range of its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// s
    pub time: f64,
    /// Acceleration of the output per radian (unit of shape), m/s².
    pub acceleration: f64,
    /// m
    pub length: f64,
    /// Output per unit of the position coordinates: a wheel's radius.
    pub output: f64,
    /// Force on a position coordinate that accelerates it, the shape held, as one radian does.
    pub force: f64,
    /// Inertia of the output, the shape held, kg.
    pub inertia: f64,
}

impl Scale {
    /// Of a robot.
    ///
    /// # Errors
    ///
    /// [`Error::NoSolution`] if K⁰_qs cannot be inverted.
    pub fn of<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> Result<Self, Error>
    where
        R: Robot<f64, N, NX, NS>,
    {
        let zero = SVector::zeros();
        let description = robot.description();
        let gain = robot.shape_gain();
        let mean = |matrix: &SMatrix<f64, NX, NX>| matrix.norm() / (NX as f64).sqrt();
        let output = mean(&robot.output_jacobian_position());
        // The shape that balances, or all of it.
        let mut leaning: Vec<usize> = description.unactuated_shape().collect();
        if leaning.is_empty() {
            leaning = (0..NS).collect();
        }
        let dynamic = DMatrix::from_fn(NX, NS, |i, j| gain[(i, j)]).select_columns(&leaning);
        let equation = "inverse of the shape gain";
        let inverse = dynamic.clone().pseudo_inverse(1e-9);
        let inverse = inverse.map_err(|_| Error::NoSolution { equation })?;
        let response = robot.response(&zero, &zero, &zero).d_qsdd;
        let jerk = DMatrix::from_fn(NX, NS, |i, j| response[(i, j)]).select_columns(&leaning);
        let squared = (jerk * inverse).norm() / (NX as f64).sqrt();
        let acceleration = output * dynamic.norm() / (NX as f64).sqrt();
        let reach = description.position_coordinates().iter().map(|c| c.upper).fold(1e3, f64::min);
        let length = match acceleration * squared {
            length if length > 1e-6 => length,
            _ => reach * output,
        };
        let mass = robot.mass_matrix(&SVector::zeros()).fixed_view::<NX, NX>(0, 0).into_owned();
        let coordinate_mass = mean(&mass);
        Ok(Self {
            time: (length / acceleration).sqrt(),
            acceleration,
            length,
            output,
            force: coordinate_mass * acceleration / output,
            inertia: coordinate_mass / (output * output),
        })
    }
}
