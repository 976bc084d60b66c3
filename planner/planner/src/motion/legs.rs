//! Motions in a row.

use super::{Derivatives, DesiredMotion, check_duration};
use crate::Error;
use crate::linear_algebra::{largest, norm};
use core::marker::PhantomData;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Several motions, one after the other. Mixed kinds go in as `&dyn DesiredMotion`.
///
/// Each begins where the one before ends. How smoothly they meet is for [`first_jump`](super::first_jump)
/// to say.
#[derive(Clone, Copy, Debug)]
pub struct Legs<'a, M, T, const NX: usize> {
    legs: &'a [M],
    duration: T,
    dimension: PhantomData<[T; NX]>,
}

impl<'a, M: DesiredMotion<T, NX>, T: Ordered, const NX: usize> Legs<'a, M, T, NX> {
    /// # Errors
    ///
    /// No legs, a leg without a duration, a leg that begins somewhere else than the one before ends.
    pub fn new(legs: &'a [M]) -> Result<Self, Error> {
        let mut duration = T::zero();
        let mut end: Option<SVector<T, NX>> = None;
        for (index, leg) in legs.iter().enumerate() {
            check_duration(leg.duration())?;
            let start = leg.position(T::zero());
            if let Some(end) = end {
                let size = T::one() + largest(start.iter().copied());
                let gap = norm(&(start - end));
                if !gap.is_finite() || gap > size * T::epsilon() * T::from_f64(1024.0) {
                    return Err(Error::InvalidEntry {
                        field: "gaps ahead of the legs",
                        index,
                        value: gap.to_f64(),
                        expected: "0",
                    });
                }
            }
            end = Some(leg.position(leg.duration()));
            duration += leg.duration();
        }
        check_duration(duration)?;
        Ok(Self { legs, duration, dimension: PhantomData })
    }

    /// The leg at a time, and the time in it. At a joint it is the later leg.
    fn at(&self, t: T) -> Option<(&'a M, T)> {
        let mut begin = T::zero();
        let mut found = None;
        for leg in self.legs {
            if found.is_some() && t < begin {
                break;
            }
            found = Some((leg, t - begin));
            begin += leg.duration();
        }
        found
    }
}

impl<M: DesiredMotion<T, NX>, T: Ordered, const NX: usize> DesiredMotion<T, NX>
    for Legs<'_, M, T, NX>
{
    fn duration(&self) -> T {
        self.duration
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        self.at(t).map_or([SVector::zeros(); 5], |(leg, t)| leg.derivatives(t))
    }

    fn position(&self, t: T) -> SVector<T, NX> {
        self.at(t).map_or_else(SVector::zeros, |(leg, t)| leg.position(t))
    }
}
