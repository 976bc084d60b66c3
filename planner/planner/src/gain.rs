//! K⁰_qx, the gain that maps accelerations of the position variables to constant shapes.

use crate::Error;
use crate::linear_algebra::{first_indefinite_row, inverse, is_finite, largest, pseudo_inverse};
use nalgebra::SMatrix;
use shapebot_dynamics::{Ordered, ShapeAccelerated, ShapeSet};

/// How far the contributions may sum from one; they are divided by their sum.
const SUM_TOLERANCE: f64 = 1e-5;

/// How the shape variables share the work of accelerating the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weighting<'a, T: Ordered, const NS: usize> {
    /// The smallest shape ‖q_s‖ that does it: W = 1 in Eq. 24. With as many shape as position
    /// variables this is Eq. 19, the inverse of K⁰_qs, as every other weighting then is.
    #[default]
    MinimumNorm,
    /// One contribution ratio c_j ≥ 0 per shape set, in the order of the robot's description,
    /// together 1. Set j then provides the fraction c_j of the acceleration: its block of K⁰_qx is
    /// c_j (K⁰_j)⁻¹ with K⁰_j its block of K⁰_qs.
    ///
    /// That is Eq. 24 with W_j = √c_j (K⁰_jᵀ K⁰_j)^(−½), of which Eqs. 28-30 are the ballbot's instance.
    /// Where Eq. 24 has no value, at c_j = 0, this is its limit: the set stays at rest.
    Contributions(&'a [T]),
    /// Any symmetric positive definite weight matrix W, Eqs. 24 and 25: the shape that minimises
    /// ‖W⁻¹ q_s‖.
    Matrix(SMatrix<T, NS, NS>),
}

impl<T: Ordered, const NS: usize> Weighting<'_, T, NS> {
    /// K⁰_qx = W (K⁰_qs W)^# (Eq. 24): rad (or m) of shape per unit acceleration of the position
    /// variables. K⁰_qs K⁰_qx = 1.
    ///
    /// # Errors
    ///
    /// Contributions that are negative, not finite, not one per shape set or not 1 in sum; a weight
    /// matrix that is not symmetric positive definite; a robot whose shape cannot accelerate all
    /// position variables; a contributing shape set that cannot do so on its own.
    pub fn gain<const NX: usize, R>(&self, robot: &R) -> Result<SMatrix<T, NS, NX>, Error>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        self.free_gain(robot, |_| false)
    }

    /// The same with the rows of constrained coordinates zero: the free ones do all the work.
    pub(crate) fn free_gain<const NX: usize, R>(
        &self,
        robot: &R,
        held: impl Fn(usize) -> bool,
    ) -> Result<SMatrix<T, NS, NX>, Error>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        let mut shape_gain = robot.shape_gain();
        if !is_finite(&shape_gain) {
            return Err(Error::NonFiniteMatrix { matrix: "shape gain" });
        }
        for index in (0..NS).filter(|&index| held(index)) {
            shape_gain.column_mut(index).fill(T::zero());
        }
        let singular = Error::Singular { matrix: "weighted shape gain" };
        match self {
            Self::MinimumNorm => pseudo_inverse(&shape_gain).ok_or(singular),
            Self::Contributions(ratios) => {
                let sets = robot.shape_description().shape_sets;
                check_held(ratios, sets, held)?;
                by_contributions(&shape_gain, ratios, sets)
            }
            Self::Matrix(weight) => {
                check_weight(weight)?;
                let weight = SMatrix::<T, NS, NS>::from_fn(|i, j| {
                    if held(i) || held(j) { T::zero() } else { weight[(i, j)] }
                });
                pseudo_inverse(&(shape_gain * weight)).map(|p| weight * p).ok_or(singular)
            }
        }
    }
}

fn by_contributions<T: Ordered, const NX: usize, const NS: usize>(
    shape_gain: &SMatrix<T, NX, NS>,
    ratios: &[T],
    sets: &[ShapeSet],
) -> Result<SMatrix<T, NS, NX>, Error> {
    let sum = check_ratios(ratios, sets.len())?;
    let mut gain = SMatrix::zeros();
    for (set, &ratio) in sets.iter().zip(ratios) {
        check_set(set, NX, NS)?;
        if ratio == T::zero() {
            continue;
        }
        let block = SMatrix::<T, NX, NX>::from_fn(|i, j| shape_gain[(i, set.first + j)]);
        let inverse = inverse(block).ok_or(Error::UselessShapeSet { set: set.name })?;
        for (i, row) in inverse.row_iter().enumerate() {
            for (j, &entry) in row.iter().enumerate() {
                gain[(set.first + i, j)] = entry * ratio / sum;
            }
        }
    }
    Ok(gain)
}

/// A constrained set cannot contribute.
fn check_held<T: Ordered>(
    ratios: &[T],
    sets: &[ShapeSet],
    held: impl Fn(usize) -> bool,
) -> Result<(), Error> {
    for (index, (set, ratio)) in sets.iter().zip(ratios).enumerate() {
        if held(set.first) && *ratio != T::zero() {
            return Err(Error::InvalidEntry {
                field: "contributions",
                index,
                value: ratio.to_f64(),
                expected: "0 for a constrained shape set",
            });
        }
    }
    Ok(())
}

/// A set that contributes has n_x coordinates, all of them in q_s.
fn check_set(set: &ShapeSet, expected: usize, shape_count: usize) -> Result<(), Error> {
    let end = set.first.saturating_add(set.len);
    let (field, found, expected) = if set.len != expected {
        ("coordinates of a shape set", set.len, expected)
    } else if end > shape_count {
        ("shape coordinates described", end, shape_count)
    } else {
        return Ok(());
    };
    Err(Error::Length { field, found, expected })
}

/// Checks the contributions and returns their sum.
fn check_ratios<T: Ordered>(ratios: &[T], sets: usize) -> Result<T, Error> {
    if ratios.len() != sets {
        return Err(Error::Length { field: "contributions", found: ratios.len(), expected: sets });
    }
    let mut sum = T::zero();
    for (index, &ratio) in ratios.iter().enumerate() {
        if !ratio.is_finite() || ratio < T::zero() {
            return Err(Error::InvalidEntry {
                field: "contributions",
                index,
                value: ratio.to_f64(),
                expected: "a finite number that is not negative",
            });
        }
        sum += ratio;
    }
    if (sum.to_f64() - 1.0).abs() <= SUM_TOLERANCE {
        return Ok(sum);
    }
    Err(Error::Invalid { field: "sum of the contributions", value: sum.to_f64(), expected: "1" })
}

fn check_weight<T: Ordered, const NS: usize>(weight: &SMatrix<T, NS, NS>) -> Result<(), Error> {
    if !is_finite(weight) {
        return Err(Error::NonFiniteMatrix { matrix: "weight matrix" });
    }
    let tolerance = largest(weight.iter().copied()) * T::epsilon() * T::from_f64(8.0);
    for row in 0..NS {
        for column in 0..row {
            if (weight[(row, column)] - weight[(column, row)]).abs() > tolerance {
                return Err(Error::WeightMatrix { row, expected: "symmetric" });
            }
        }
    }
    match first_indefinite_row(*weight) {
        None => Ok(()),
        Some(row) => Err(Error::WeightMatrix { row, expected: "positive definite" }),
    }
}
