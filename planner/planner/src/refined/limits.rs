//! Limits of a plan: declared ranges and those of the task.

use super::problem::Problem;
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::linear_algebra::is_finite;
use crate::motion::DesiredMotion;
use nalgebra::SVector;
use shapebot_dynamics::{Coordinate, Description, Ordered, ShapeAccelerated};

/// Smallest and largest value of every coordinate, each with its time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peaks<T: Ordered, const NX: usize, const NS: usize> {
    position: [Extremes<T>; NX],
    shape: [Extremes<T>; NS],
}

#[derive(Clone, Copy, Debug)]
struct Extremes<T> {
    low: (T, T),
    high: (T, T),
}

impl<T: Ordered> Extremes<T> {
    #[inline]
    fn add(&mut self, time: T, value: T) {
        if value < self.low.0 {
            self.low = (value, time);
        }
        if value > self.high.0 {
            self.high = (value, time);
        }
    }
}

impl<T: Ordered, const NX: usize, const NS: usize> Peaks<T, NX, NS> {
    pub(crate) fn new() -> Self {
        let infinity = T::from_f64(f64::INFINITY);
        let none = Extremes { low: (infinity, T::zero()), high: (-infinity, T::zero()) };
        Self { position: [none; NX], shape: [none; NS] }
    }

    #[inline]
    pub(crate) fn add(&mut self, time: T, shape: &SVector<T, NS>, position: &SVector<T, NX>) {
        for (peak, &value) in self.shape.iter_mut().zip(shape.iter()) {
            peak.add(time, value);
        }
        for (peak, &value) in self.position.iter_mut().zip(position.iter()) {
            peak.add(time, value);
        }
    }

    /// The largest magnitude of each shape coordinate.
    pub(crate) fn magnitude(&self) -> SVector<T, NS> {
        SVector::from_fn(|i, _| {
            let Extremes { low, high } = self.shape[i];
            if low.0.abs() > high.0.abs() { low.0.abs() } else { high.0.abs() }
        })
    }
}

/// What a plan has to keep.
pub(crate) struct Bounds<'a, T: Ordered, const NX: usize, const NS: usize> {
    description: &'a Description,
    limits: Option<&'a SVector<T, NS>>,
}

impl<'a, T: Ordered, const NX: usize, const NS: usize> Bounds<'a, T, NX, NS> {
    pub(crate) fn new<R>(robot: &'a R, limits: Option<&'a SVector<T, NS>>) -> Self
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        Self { description: robot.shape_description(), limits }
    }

    /// Range of shape coordinate `index`.
    fn shape_range(&self, index: usize, coordinate: &Coordinate) -> (f64, f64) {
        let limit = self.limits.and_then(|limits| limits.get(index));
        let limit = limit.map_or(f64::INFINITY, |limit| limit.to_f64());
        (coordinate.lower.max(-limit), coordinate.upper.min(limit))
    }

    /// The breach that comes first in time, if there is one.
    pub(crate) fn first_breach(&self, peaks: &Peaks<T, NX, NS>) -> Option<Error> {
        let mut first: Option<(f64, Error)> = None;
        let mut check =
            |coordinate: &Coordinate, (lower, upper): (f64, f64), peak: &Extremes<T>| {
                for (value, time) in [peak.low, peak.high] {
                    let (value, time) = (value.to_f64(), time.to_f64());
                    // What rounding adds to a value at its bound is no breach.
                    let slack = T::epsilon().to_f64() * 8.0;
                    let inside = value >= lower - slack * lower.abs().min(1e300)
                        && value <= upper + slack * upper.abs().min(1e300);
                    if !inside && first.as_ref().is_none_or(|&(earliest, _)| time < earliest) {
                        first = Some((time, breach(coordinate, time, value, (lower, upper))));
                    }
                }
            };
        for (coordinate, peak) in
            self.description.position_coordinates().iter().zip(&peaks.position)
        {
            check(coordinate, (coordinate.lower, coordinate.upper), peak);
        }
        let shapes = self.description.shape_coordinates().iter().zip(&peaks.shape);
        for (index, (coordinate, peak)) in shapes.enumerate() {
            check(coordinate, self.shape_range(index, coordinate), peak);
        }
        first.map(|(_, error)| error)
    }

    /// Why a sample has no finite error: a shape outside its range, or the first quantity that is no
    /// number.
    pub(crate) fn explain<R, M, C>(
        &self,
        problem: &Problem<'_, R, M, C, T, NX, NS>,
        time: T,
        shape: &SVector<T, NS>,
    ) -> Error
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
        M: DesiredMotion<T, NX> + ?Sized,
        C: ShapeConstraint<T, NX, NS>,
    {
        let seconds = time.to_f64();
        let non_finite = |quantity| Error::NonFinite { quantity, time: seconds };
        if !is_finite(&problem.motion.position(time)) {
            return non_finite("desired motion");
        }
        if !is_finite(&problem.constraint.shape(time)[0]) {
            return non_finite("constrained shape");
        }
        for (index, coordinate) in self.description.shape_coordinates().iter().enumerate() {
            let Some(value) = shape.get(index).map(|value| value.to_f64()) else {
                continue;
            };
            let (lower, upper) = self.shape_range(index, coordinate);
            if value < lower || value > upper {
                return breach(coordinate, seconds, value, (lower, upper));
            }
        }
        non_finite("acceleration response")
    }
}

fn breach(coordinate: &Coordinate, time: f64, value: f64, (lower, upper): (f64, f64)) -> Error {
    Error::LimitExceeded {
        coordinate: coordinate.name,
        unit: coordinate.unit,
        time,
        value,
        lower,
        upper,
        duration: None,
    }
}
