//! What goes into a controller and what comes out.

use nalgebra::SVector;
use shapebot_dynamics::{Ordered, Robot};

/// Coordinates and rates of a robot, q = [q_x, q_s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T, const N: usize> {
    /// Coordinates, SI units.
    pub q: SVector<T, N>,
    /// Their rates.
    pub qd: SVector<T, N>,
}

/// What is to happen now, from a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<T, const N: usize, const NX: usize, const NS: usize> {
    /// q_x, q̇_x, q̈_x of the plan.
    pub position: [SVector<T, NX>; 3],
    /// q_s, q̇_s, q̈_s of the plan.
    pub shape: [SVector<T, NS>; 3],
    /// Generalised forces of the plan, fed forward on the position variables; zero for none.
    pub force: SVector<T, N>,
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> Target<T, N, NX, NS> {
    /// Standing still at a position, with the shape at the origin.
    pub fn stand(position: SVector<T, NX>) -> Self {
        let still = SVector::from_element(T::zero());
        let (at, shape) = ([position, still, still], SVector::from_element(T::zero()));
        Self { position: at, shape: [shape; 3], force: SVector::from_element(T::zero()) }
    }

    /// The same with the forces that the robot's dynamics need for this motion,
    /// M q̈ + C q̇ + G + ∂D/∂q̇.
    #[must_use]
    pub fn with_feedforward<R: Robot<T, N, NX, NS>>(self, robot: &R) -> Self {
        let [q, qd, qdd] =
            [0, 1, 2].map(|order: usize| R::join(&self.position[order], &self.shape[order]));
        let drag = robot.dissipative_force(&q, &qd);
        Self { force: robot.inverse_dynamics(&q, &qd, &qdd) - drag, ..self }
    }
}

/// What the motors are to do until the next step, and what the controller thinks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<T, const N: usize, const NX: usize, const NS: usize> {
    /// Generalised forces after all clamps; zero where there is no actuator.
    pub force: SVector<T, N>,
    /// The same per actuator, in its unit; entries beyond their number are zero.
    pub actuator: SVector<T, N>,
    /// Compensation shape q_s^c (Eq. 36), after its limits.
    pub compensation: SVector<T, NS>,
    /// Shape that makes up for a constant offset of the measured shape, after its limits.
    pub trim: SVector<T, NS>,
    /// Disturbing force on the position variables as the momentum observer sees it; zero if it is off.
    pub disturbance: SVector<T, NX>,
    /// Error of the output against the plan, in units of the position variables.
    pub position_error: SVector<T, NX>,
    /// A force or the compensation met a limit.
    pub saturated: bool,
    /// Something was not finite: all forces are zero, and the step counts as not taken.
    pub fault: bool,
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> Command<T, N, NX, NS> {
    /// No force.
    pub(crate) fn fault() -> Self {
        Self {
            force: SVector::from_element(T::zero()),
            actuator: SVector::from_element(T::zero()),
            compensation: SVector::from_element(T::zero()),
            trim: SVector::from_element(T::zero()),
            disturbance: SVector::from_element(T::zero()),
            position_error: SVector::from_element(T::zero()),
            saturated: false,
            fault: true,
        }
    }
}

/// Adds up values that are all to be finite: one that is not leaves no finite sum. Nor do values near
/// the largest of their type, which mean nothing either.
///
/// A conjunction of comparisons would do as well, but some compilers (LLVM 22 in `VectorCombine`) do not
/// come to an end over those of fifteen coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Finite<T>(T);

impl<T: Ordered> Finite<T> {
    /// Of nothing.
    pub(crate) fn new() -> Self {
        Self(T::zero())
    }

    /// And all entries of a vector.
    #[must_use]
    pub(crate) fn and<const L: usize>(self, vector: &SVector<T, L>) -> Self {
        Self(vector.iter().fold(self.0, |sum, &x| sum + x))
    }

    /// Whether all were finite.
    pub(crate) fn holds(self) -> bool {
        self.0.is_finite()
    }
}
