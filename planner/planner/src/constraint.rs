//! Shape sets that follow trajectories of their own (Sec. IV-C).

use crate::Error;
use crate::motion::DesiredMotion;
use core::fmt;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// The constrained part of the shape: zero in every free coordinate.
///
/// The planned shape is the constrained part plus the gain times the *net* acceleration, the desired
/// one minus what the constrained part causes by itself (Eq. 35).
pub trait ShapeConstraint<T: Ordered, const NX: usize, const NS: usize>: Copy {
    /// Whether shape coordinate `index` follows a trajectory of its own.
    fn holds(&self, index: usize) -> bool;

    /// The constrained coordinates with four derivatives at time `t` of the desired motion, seconds.
    fn shape(&self, t: T) -> [SVector<T, NS>; 5];

    /// a_ac = Γ along the constrained coordinates, the free ones at rest, with two derivatives.
    fn acceleration(&self, t: T) -> [SVector<T, NX>; 3];
}

/// No shape set is constrained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unconstrained;

impl<T: Ordered, const NX: usize, const NS: usize> ShapeConstraint<T, NX, NS> for Unconstrained {
    fn holds(&self, _: usize) -> bool {
        false
    }
    #[inline]
    fn shape(&self, _: T) -> [SVector<T, NS>; 5] {
        [SVector::zeros(); 5]
    }
    #[inline]
    fn acceleration(&self, _: T) -> [SVector<T, NX>; 3] {
        [SVector::zeros(); 3]
    }
}

/// A trajectory for one shape set, over the time of the desired motion.
#[derive(Clone, Copy)]
pub struct SetMotion<'a, T: Ordered, const NX: usize> {
    /// Index of the shape set in the robot's description.
    pub set: usize,
    /// Its coordinates, in their own unit.
    pub motion: &'a dyn DesiredMotion<T, NX>,
}

impl<T: Ordered, const NX: usize> fmt::Debug for SetMotion<'_, T, NX> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SetMotion").field("set", &self.set).finish_non_exhaustive()
    }
}

/// Some shape sets follow [`SetMotion`]s; at least one stays free.
pub struct Constrained<'a, R: ?Sized, T: Ordered, const NX: usize, const NS: usize> {
    robot: &'a R,
    sets: &'a [SetMotion<'a, T, NX>],
    held: [bool; NS],
}

// By hand, because the robot is only borrowed: it need not be Clone itself.
impl<R: ?Sized, T: Ordered, const NX: usize, const NS: usize> Clone
    for Constrained<'_, R, T, NX, NS>
{
    fn clone(&self) -> Self {
        *self
    }
}

impl<R: ?Sized, T: Ordered, const NX: usize, const NS: usize> Copy
    for Constrained<'_, R, T, NX, NS>
{
}

impl<R: ?Sized, T: Ordered, const NX: usize, const NS: usize> fmt::Debug
    for Constrained<'_, R, T, NX, NS>
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Constrained").field("sets", &self.sets).finish_non_exhaustive()
    }
}

impl<'a, R, T, const NX: usize, const NS: usize> Constrained<'a, R, T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    T: Ordered,
{
    /// # Errors
    ///
    /// [`Error::Invalid`] for a shape set that the robot does not have or that is named twice,
    /// [`Error::Length`] for one that has not n_x coordinates, [`Error::NoFreeShapeSet`] if none is
    /// left to move the robot.
    pub fn new(robot: &'a R, sets: &'a [SetMotion<'a, T, NX>]) -> Result<Self, Error> {
        let described = robot.shape_description().shape_sets;
        let mut held = [false; NS];
        for &SetMotion { set, .. } in sets {
            let refusal =
                |expected| Error::Invalid { field: "shape set", value: set as f64, expected };
            let described =
                described.get(set).ok_or(refusal("an index into the robot's shape sets"))?;
            let end = described.first.saturating_add(described.len);
            if described.len != NX || end > NS {
                return Err(Error::Length {
                    field: "coordinates of a constrained shape set",
                    found: described.len,
                    expected: NX,
                });
            }
            for entry in &mut held[described.first..end] {
                if core::mem::replace(entry, true) {
                    return Err(refusal("each shape set constrained once"));
                }
            }
        }
        if held.iter().all(|&held| held) {
            return Err(Error::NoFreeShapeSet);
        }
        Ok(Self { robot, sets, held })
    }

    /// dΓ/dt with the shape variables moving by `rate` = [q̇_s, q̈_s, q⃛_s] from `at`.
    fn first_derivative(
        &self,
        at: &[SVector<T, NS>; 3],
        rate: &[SVector<T, NS>; 3],
    ) -> SVector<T, NX> {
        let response = self.robot.response(&at[0], &at[1], &at[2]);
        response.d_qs * rate[0] + response.d_qsd * rate[1] + response.d_qsdd * rate[2]
    }

    /// Second derivative of Γ at `at` along the straight line in direction `rate`.
    ///
    /// The traits give Γ's first derivatives exactly; their derivative in one direction is a fourth-order
    /// difference of these. Γ is quadratic in q̇_s, affine in q̈_s and trigonometric in q_s: with the
    /// step below the error is near 1e-12 of the value in double precision, 1e-4 in single.
    fn second_derivative(
        &self,
        at: &[SVector<T, NS>; 3],
        rate: &[SVector<T, NS>; 3],
    ) -> SVector<T, NX> {
        let speed = rate[0].dot(&rate[0]).sqrt();
        // ε^(1/5) balances truncation against rounding.
        let step = (T::epsilon().ln() * T::from_f64(0.2)).exp() / (T::one() + speed);
        let slope = |factor: f64| {
            let step = step * T::from_f64(factor);
            let shifted = core::array::from_fn(|k| at[k] + rate[k] * step);
            self.first_derivative(&shifted, rate)
        };
        let near = (slope(1.0) - slope(-1.0)) * T::from_f64(8.0);
        (near - (slope(2.0) - slope(-2.0))) / (step * T::from_f64(12.0))
    }
}

impl<R, T, const NX: usize, const NS: usize> ShapeConstraint<T, NX, NS>
    for Constrained<'_, R, T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    T: Ordered,
{
    fn holds(&self, index: usize) -> bool {
        self.held.get(index).copied().unwrap_or(false)
    }

    fn shape(&self, t: T) -> [SVector<T, NS>; 5] {
        let mut shape = [SVector::zeros(); 5];
        let described = self.robot.shape_description().shape_sets;
        for SetMotion { set, motion } in self.sets {
            let Some(first) = described.get(*set).map(|set| set.first) else {
                continue;
            };
            for (order, derivative) in motion.derivatives(t).iter().enumerate() {
                for (k, &value) in derivative.iter().enumerate() {
                    shape[order][first + k] = value;
                }
            }
        }
        shape
    }

    /// ȧ = D Γ·v with v = [q̇, q̈, q⃛], ä = D²Γ·(v, v) + D Γ·v̇.
    fn acceleration(&self, t: T) -> [SVector<T, NX>; 3] {
        let [q, dq, ddq, d3q, d4q] = self.shape(t);
        let (at, rate) = ([q, dq, ddq], [dq, ddq, d3q]);
        let value = self.robot.gamma(&q, &dq, &ddq);
        let first = self.first_derivative(&at, &rate);
        let second =
            self.second_derivative(&at, &rate) + self.first_derivative(&at, &[ddq, d3q, d4q]);
        [value, first, second]
    }
}
