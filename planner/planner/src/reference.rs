//! The desired motion in a robot's own position coordinates, and its sampling.

use crate::Error;
use crate::integrate::MIN_SAMPLES;
use crate::linear_algebra::{inverse, is_finite};
use crate::motion::{Derivatives, DesiredMotion, check_duration};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// The desired motion at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Desired<T: Ordered, const NX: usize> {
    /// x^d and its time derivatives, in the output's unit (metres).
    pub output: Derivatives<T, NX>,
    /// q_x^d = (∂h/∂q_x)⁻¹ (x^d − h(0, 0)) and its time derivatives, in the unit of the position
    /// coordinates.
    pub position: Derivatives<T, NX>,
}

/// The constant part of the output map h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutputMap<T: Ordered, const NX: usize> {
    /// ∂h/∂q_x.
    pub(crate) jacobian: SMatrix<T, NX, NX>,
    inverse: SMatrix<T, NX, NX>,
    origin: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize> OutputMap<T, NX> {
    pub(crate) fn new<const NS: usize, R>(robot: &R) -> Result<Self, Error>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        let jacobian = robot.output_jacobian_position();
        let origin = robot.output(&SVector::zeros(), &SVector::zeros());
        let inverse = inverse(jacobian).ok_or(Error::Singular { matrix: "output Jacobian" })?;
        if !is_finite(&origin) {
            return Err(Error::NonFiniteMatrix { matrix: "output of the origin" });
        }
        Ok(Self { jacobian, inverse, origin })
    }

    /// (∂h/∂q_x)⁻¹.
    pub(crate) fn inverse(&self) -> &SMatrix<T, NX, NX> {
        &self.inverse
    }

    pub(crate) fn desired(&self, output: Derivatives<T, NX>) -> Desired<T, NX> {
        let mut relative = output;
        relative[0] -= self.origin;
        Desired { output, position: relative.map(|x| self.inverse * x) }
    }
}

/// Equidistant samples of 0 ≤ t ≤ duration, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid<T> {
    pub(crate) count: usize,
    duration: T,
}

impl<T: Ordered> Grid<T> {
    pub(crate) fn new<const NX: usize, M>(motion: &M, count: usize) -> Result<Self, Error>
    where
        M: DesiredMotion<T, NX> + ?Sized,
    {
        Self::of(count, motion.duration())
    }

    pub(crate) fn of(count: usize, duration: T) -> Result<Self, Error> {
        check_duration(duration)?;
        if count < MIN_SAMPLES {
            return Err(Error::Invalid {
                field: "samples",
                value: count as f64,
                expected: "at least 4",
            });
        }
        Ok(Self { count, duration })
    }

    pub(crate) fn step(&self) -> T {
        self.duration / T::from_f64((self.count - 1) as f64)
    }

    pub(crate) fn time(&self, index: usize) -> T {
        if index + 1 == self.count {
            self.duration
        } else {
            T::from_f64(index as f64) * self.step()
        }
    }
}
