//! The linear-quadratic regulator that the paper compares with: state feedback on the linearised robot,
//! tracking the desired motion upright, without a plan.

mod linearise;
mod riccati;

use crate::Error;
use crate::reference::Moment;
use crate::simulate::Tracker;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use shapebot_control::{Command, State};
use shapebot_dynamics::{LagrangianSystem, Robot};

pub use linearise::{Linear, linearise};
pub use riccati::{discretise, solve_riccati};

/// Diagonals of Q and R.
#[derive(Clone, Debug, PartialEq)]
pub struct LqrWeights {
    /// Of Q: squared coordinates, then squared rates; 2 N entries in SI units.
    pub state: Vec<f64>,
    /// Of R: squared forces of the actuators.
    pub actuator: Vec<f64>,
}

/// u = −K (x − x^d) at every control period, x^d the desired motion with the shape at zero.
pub struct Lqr<'a, const N: usize, const NX: usize, const NS: usize> {
    robot: &'a dyn LagrangianSystem<f64, N>,
    gain: DMatrix<f64>,
    /// Position coordinates per output.
    inverse: SMatrix<f64, NX, NX>,
    /// h at the origin.
    origin: SVector<f64, NX>,
}

impl<'a, const N: usize, const NX: usize, const NS: usize> Lqr<'a, N, NX, NS> {
    /// The regulator of the robot linearised at the origin and sampled with `period`.
    ///
    /// # Errors
    ///
    /// Weights of another size or sign; a robot that no such regulator stabilises.
    pub fn new<R>(robot: &'a R, weights: &LqrWeights, period: f64) -> Result<Self, Error>
    where
        R: Robot<f64, N, NX, NS>,
    {
        let system = linearise(robot)?;
        for (what, found, expected) in [
            ("number of weights of the state", weights.state.len(), 2 * N),
            ("number of weights of the actuators", weights.actuator.len(), system.input.ncols()),
        ] {
            if found != expected {
                let expected = "one per entry";
                return Err(Error::Invalid { what, value: found as f64, expected });
            }
        }
        let (a, b) = discretise(&system, period);
        let q = DMatrix::from_diagonal(&DVector::from_column_slice(&weights.state));
        let r = DMatrix::from_diagonal(&DVector::from_column_slice(&weights.actuator));
        let equation = "inverse of the output's Jacobian";
        Ok(Self {
            gain: solve_riccati(&a, &b, &q, &r)?,
            inverse: robot
                .output_jacobian_position()
                .try_inverse()
                .ok_or(Error::NoSolution { equation })?,
            origin: robot.output(&SVector::zeros(), &SVector::zeros()),
            robot,
        })
    }

    /// K, actuators × 2 N.
    #[must_use]
    pub const fn gain(&self) -> &DMatrix<f64> {
        &self.gain
    }
}

impl<const N: usize, const NX: usize, const NS: usize> Tracker<N, NX, NS> for Lqr<'_, N, NX, NS> {
    fn step(
        &mut self,
        state: &State<f64, N>,
        moment: &Moment<N, NX, NS>,
    ) -> Command<f64, N, NX, NS> {
        let position = self.inverse * (moment.desired[0] - self.origin);
        let velocity = self.inverse * moment.desired[1];
        let wanted = |part: &SVector<f64, NX>, i: usize| if i < NX { part[i] } else { 0.0 };
        let error = DVector::from_fn(2 * N, |i, _| match i.checked_sub(N) {
            None => state.q[i] - wanted(&position, i),
            Some(i) => state.qd[i] - wanted(&velocity, i),
        });
        let asked = -(&self.gain * error);
        let (mut force, mut actuator, mut saturated) = (SVector::zeros(), SVector::zeros(), false);
        for (index, declared) in self.robot.description().actuators.iter().enumerate() {
            actuator[index] = asked[index].clamp(-declared.limit, declared.limit);
            saturated |= actuator[index] != asked[index];
            force += self.robot.input_column(&state.q, index) * actuator[index];
        }
        Command {
            force,
            actuator,
            saturated,
            compensation: SVector::zeros(),
            trim: SVector::zeros(),
            disturbance: SVector::zeros(),
            position_error: SVector::zeros(),
            fault: false,
        }
    }
}
