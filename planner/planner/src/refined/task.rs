//! Settings of the refined planner.

use crate::Error;
use crate::linear_algebra::is_finite;
use crate::motion::Derivatives;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// Where a robot is when its plan begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<T: Ordered, const NX: usize, const NS: usize> {
    /// q_x.
    pub position: SVector<T, NX>,
    /// q̇_x.
    pub velocity: SVector<T, NX>,
    /// q_s: lean, arms.
    pub shape: SVector<T, NS>,
    /// q̇_s.
    pub shape_velocity: SVector<T, NS>,
    /// q̈_s, if it is to be continuous as well, and with it the torque: that of the plan under way.
    pub shape_acceleration: Option<SVector<T, NS>>,
}

impl<T: Ordered, const NX: usize, const NS: usize> Start<T, NX, NS> {
    /// The output's position and velocity, and the acceleration and jerk that the shape and its rate
    /// are about to cause: where a [`Transfer`](crate::motion::Transfer) for a moving robot begins.
    pub fn output<R>(&self, robot: &R) -> Derivatives<T, NX>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        let jacobian = robot.output_jacobian_position();
        let by_shape = robot.output_jacobian_shape(&self.position, &self.shape);
        let caused = jacobian * robot.shape_gain();
        [
            robot.output(&self.position, &self.shape),
            jacobian * self.velocity + by_shape * self.shape_velocity,
            caused * self.shape,
            caused * self.shape_velocity,
            SVector::zeros(),
        ]
    }
}

/// How a plan is refined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement<T: Ordered, const NX: usize, const NS: usize> {
    /// Seconds of standing before the motion, in which the robot may lean already.
    pub standing_before: T,
    /// Seconds of standing after the motion.
    pub standing_after: T,
    /// The state that the plan begins in. Without one: on the desired motion, at its velocity, free
    /// shape coordinates and their rates zero.
    pub start: Option<Start<T, NX, NS>>,
    /// Seconds in which a start off the desired motion catches up with it; the whole window without a
    /// number.
    pub catch_up: Option<T>,
    /// Spans of the spline, from 4. Without a number: four per second, at least twenty, as far as
    /// workspace and samples allow.
    pub spans: Option<usize>,
    /// Most evaluations of Γ along the whole plan.
    pub max_sweeps: usize,
    /// Ends when the next sweep would move the output by less than this (root mean square, metres)
    /// and its end error is below this in metres and metres per second.
    pub tolerance: T,
    /// Largest magnitude of each shape coordinate, in its unit; the declared ranges hold as well.
    pub limits: Option<SVector<T, NS>>,
}

impl<T: Ordered, const NX: usize, const NS: usize> Default for Refinement<T, NX, NS> {
    fn default() -> Self {
        Self {
            standing_before: T::zero(),
            standing_after: T::zero(),
            start: None,
            catch_up: None,
            spans: None,
            max_sweeps: 10,
            tolerance: T::from_f64(8e-5),
            limits: None,
        }
    }
}

impl<T: Ordered, const NX: usize, const NS: usize> Refinement<T, NX, NS> {
    /// The refinement with `seconds` of standing before and after the motion.
    #[must_use]
    pub fn standing(self, seconds: T) -> Self {
        Self { standing_before: seconds, standing_after: seconds, ..self }
    }

    /// The refinement from a given state.
    #[must_use]
    pub fn start(self, start: Start<T, NX, NS>) -> Self {
        Self { start: Some(start), ..self }
    }

    /// The refinement with bounds on the magnitude of the shape coordinates.
    #[must_use]
    pub fn limits(self, limits: SVector<T, NS>) -> Self {
        Self { limits: Some(limits), ..self }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let expected = "a finite number that is not negative";
        for (field, value) in [
            ("standing time before the motion", self.standing_before),
            ("standing time after the motion", self.standing_after),
            ("tolerance", self.tolerance),
        ] {
            if !value.is_finite() || value < T::zero() {
                return Err(Error::Invalid { field, value: value.to_f64(), expected });
            }
        }
        if let Some(catch_up) = self.catch_up {
            crate::motion::check_duration(catch_up)?;
        }
        if self.max_sweeps == 0 {
            let expected = "at least 1";
            return Err(Error::Invalid { field: "number of sweeps", value: 0.0, expected });
        }
        if let Some(start) = &self.start {
            let finite = is_finite(&start.position)
                && is_finite(&start.velocity)
                && is_finite(&start.shape)
                && is_finite(&start.shape_velocity)
                && start.shape_acceleration.as_ref().is_none_or(is_finite);
            if !finite {
                return Err(Error::NonFiniteMatrix { matrix: "start state" });
            }
        }
        let limits = self.limits.iter().flat_map(|limits| limits.iter()).enumerate();
        for (index, &limit) in limits {
            if !limit.is_finite() || limit < T::zero() {
                let (field, value) = ("limits", limit.to_f64());
                return Err(Error::InvalidEntry { field, index, value, expected });
            }
        }
        Ok(())
    }
}
