//! Normal equations of a spline: block-banded, factored once, solved in every sweep.

use super::basis::ORDER;
use crate::linear_algebra::{exceeds, inverse, is_finite, largest};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// A block of a [`Banded`] matrix: what couples two control points.
pub(crate) trait Block<T: Ordered, const NX: usize>: Copy {
    fn zero() -> Self;
    /// What this kind of block keeps of a matrix.
    fn of(matrix: &SMatrix<T, NX, NX>) -> Self;
    /// self + other · factor.
    fn plus(&self, other: &Self, factor: T) -> Self;
    fn transposed(&self) -> Self;
    /// A B.
    fn times(&self, other: &Self) -> Self;
    /// A − B Cᵀ.
    fn less(&self, b: &Self, c: &Self) -> Self;
    fn apply(&self, vector: &SVector<T, NX>) -> SVector<T, NX>;
    fn apply_transposed(&self, vector: &SVector<T, NX>) -> SVector<T, NX>;
    fn inverse(&self) -> Option<Self>;
    fn diagonal(&self, axis: usize) -> T;
    fn shift(&mut self, by: T);
}

impl<T: Ordered, const NX: usize> Block<T, NX> for SMatrix<T, NX, NX> {
    fn zero() -> Self {
        Self::zeros()
    }
    fn of(matrix: &SMatrix<T, NX, NX>) -> Self {
        *matrix
    }
    fn plus(&self, other: &Self, factor: T) -> Self {
        self + other * factor
    }
    fn transposed(&self) -> Self {
        self.transpose()
    }
    fn times(&self, other: &Self) -> Self {
        self * other
    }
    fn less(&self, b: &Self, c: &Self) -> Self {
        self - b * c.transpose()
    }
    fn apply(&self, vector: &SVector<T, NX>) -> SVector<T, NX> {
        self * vector
    }
    fn apply_transposed(&self, vector: &SVector<T, NX>) -> SVector<T, NX> {
        self.transpose() * vector
    }
    fn inverse(&self) -> Option<Self> {
        inverse(*self)
    }
    fn diagonal(&self, axis: usize) -> T {
        self[(axis, axis)]
    }
    fn shift(&mut self, by: T) {
        for axis in 0..NX {
            self[(axis, axis)] += by;
        }
    }
}

/// A diagonal block: axes that do not touch each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Diagonal<T: Ordered, const NX: usize>(SVector<T, NX>);

impl<T: Ordered, const NX: usize> Block<T, NX> for Diagonal<T, NX> {
    fn zero() -> Self {
        Self(SVector::zeros())
    }
    fn of(matrix: &SMatrix<T, NX, NX>) -> Self {
        Self(matrix.diagonal())
    }
    fn plus(&self, other: &Self, factor: T) -> Self {
        Self(self.0 + other.0 * factor)
    }
    fn transposed(&self) -> Self {
        *self
    }
    fn times(&self, other: &Self) -> Self {
        Self(self.0.component_mul(&other.0))
    }
    fn less(&self, b: &Self, c: &Self) -> Self {
        Self(self.0 - b.0.component_mul(&c.0))
    }
    fn apply(&self, vector: &SVector<T, NX>) -> SVector<T, NX> {
        self.0.component_mul(vector)
    }
    fn apply_transposed(&self, vector: &SVector<T, NX>) -> SVector<T, NX> {
        self.0.component_mul(vector)
    }
    fn inverse(&self) -> Option<Self> {
        let inverse = Self(self.0.map(|x| T::one() / x));
        is_finite(&inverse.0).then_some(inverse)
    }
    fn diagonal(&self, axis: usize) -> T {
        self.0[axis]
    }
    fn shift(&mut self, by: T) {
        for entry in self.0.iter_mut() {
            *entry += by;
        }
    }
}

/// A symmetric matrix of n_x × n_x blocks; control points more than seven apart share no span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Banded<B, const POINTS: usize> {
    /// `[i][d]` is block (i, i − d). Rows and columns in `free` hold L and D of L D Lᵀ once factored.
    blocks: [[B; ORDER]; POINTS],
    inverses: [B; POINTS],
    free: (usize, usize),
}

impl<B, const POINTS: usize> Banded<B, POINTS> {
    pub(crate) fn zeros<T: Ordered, const NX: usize>() -> Self
    where
        B: Block<T, NX>,
    {
        Self { blocks: [[B::zero(); ORDER]; POINTS], inverses: [B::zero(); POINTS], free: (0, 0) }
    }

    /// Zeros in the first `count` rows.
    pub(crate) fn clear<T: Ordered, const NX: usize>(&mut self, count: usize)
    where
        B: Block<T, NX>,
    {
        for row in self.blocks.iter_mut().take(count) {
            *row = [B::zero(); ORDER];
        }
    }

    /// Adds to block (row, row − below).
    pub(crate) fn add<T: Ordered, const NX: usize>(&mut self, row: usize, below: usize, block: &B)
    where
        B: Block<T, NX>,
    {
        if let Some(entry) = self.blocks.get_mut(row).and_then(|row| row.get_mut(below)) {
            *entry = entry.plus(block, T::one());
        }
    }

    /// Factors the rows from `first` up to `end`; the others belong to control points that are given.
    /// `None` if the matrix is singular to working precision.
    pub(crate) fn factor<T: Ordered, const NX: usize>(
        &mut self,
        first: usize,
        end: usize,
    ) -> Option<()>
    where
        B: Block<T, NX>,
    {
        self.free = (first, end);
        self.damp();
        for i in first..end {
            let lowest = first.max(i.saturating_sub(ORDER - 1));
            for j in lowest..i {
                // Y_ij = L_ij D_j, kept until D_i is known.
                let mut block = self.blocks[i][i - j];
                for k in lowest.max(j.saturating_sub(ORDER - 1))..j {
                    block = block.less(&self.blocks[i][i - k], &self.blocks[j][j - k]);
                }
                self.blocks[i][i - j] = block;
            }
            let mut diagonal = self.blocks[i][0];
            for j in lowest..i {
                let scaled = self.blocks[i][i - j];
                let lower = scaled.times(&self.inverses[j]);
                diagonal = diagonal.less(&lower, &scaled);
                self.blocks[i][i - j] = lower;
            }
            if (0..NX).any(|axis| !exceeds(diagonal.diagonal(axis), T::zero())) {
                return None;
            }
            self.blocks[i][0] = diagonal;
            self.inverses[i] = diagonal.inverse()?;
        }
        Some(())
    }

    /// A shift of the diagonal far below what the sweeps would notice: they correct for it.
    fn damp<T: Ordered, const NX: usize>(&mut self)
    where
        B: Block<T, NX>,
    {
        let (first, end) = self.free;
        let rows = &mut self.blocks[first..end];
        let diagonals = rows.iter().flat_map(|row| (0..NX).map(|axis| row[0].diagonal(axis)));
        let shift = largest(diagonals) * T::epsilon() * T::from_f64(16.0);
        for row in rows {
            row[0].shift(shift);
        }
    }

    /// The control points that are solved for.
    pub(crate) fn free(&self) -> core::ops::Range<usize> {
        self.free.0..self.free.1
    }

    /// Subtracts from the right-hand side what the steps of the given control points contribute.
    pub(crate) fn shift_given<T: Ordered, const NX: usize>(
        &self,
        count: usize,
        steps: &[SVector<T, NX>; POINTS],
        right: &mut [SVector<T, NX>; POINTS],
    ) where
        B: Block<T, NX>,
    {
        let (first, end) = self.free;
        for i in first..end.min(first + ORDER) {
            for j in i.saturating_sub(ORDER - 1)..first {
                right[i] -= self.blocks[i][i - j].apply(&steps[j]);
            }
        }
        for i in first.max(end.saturating_sub(ORDER))..end {
            for j in end..count.min(i + ORDER) {
                right[i] -= self.blocks[j][j - i].apply_transposed(&steps[j]);
            }
        }
    }

    /// Solves for the free control points, in place.
    pub(crate) fn solve<T: Ordered, const NX: usize>(&self, x: &mut [SVector<T, NX>; POINTS])
    where
        B: Block<T, NX>,
    {
        let (first, end) = self.free;
        for i in first..end {
            let mut sum = x[i];
            for j in first.max(i.saturating_sub(ORDER - 1))..i {
                sum -= self.blocks[i][i - j].apply(&x[j]);
            }
            x[i] = sum;
        }
        for i in first..end {
            x[i] = self.inverses[i].apply(&x[i]);
        }
        for i in (first..end).rev() {
            let mut sum = x[i];
            for j in i + 1..end.min(i + ORDER) {
                sum -= self.blocks[j][j - i].apply_transposed(&x[j]);
            }
            x[i] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    #[test]
    fn a_banded_system_with_given_ends_is_solved() {
        const POINTS: usize = 14;
        let mut matrix = Banded::<Matrix2<f64>, POINTS>::zeros();
        let block = |i: usize, d: usize| {
            let x = (i * 7 + d * 3) as f64;
            let off = Matrix2::new(x.sin(), x.cos(), 0.3 * x.cos(), -0.2) * 0.2;
            if d == 0 { Matrix2::new(6.0, 0.1, 0.1, 5.0) } else { off }
        };
        for i in 0..POINTS {
            for d in 0..ORDER.min(i + 1) {
                matrix.add(i, d, &block(i, d));
            }
        }
        let entry = |i: usize, j: usize| match (i.abs_diff(j) < ORDER, i >= j) {
            (false, _) => Matrix2::zeros(),
            (true, true) => block(i, i - j),
            (true, false) => block(j, j - i).transpose(),
        };
        let x: [Vector2<f64>; POINTS] =
            core::array::from_fn(|i| Vector2::new(i as f64, 3.0 - i as f64));
        let mut right: [Vector2<f64>; POINTS] =
            core::array::from_fn(|i| (0..POINTS).map(|j| entry(i, j) * x[j]).sum());
        matrix.factor(3, 11).expect("positive definite");
        matrix.shift_given(POINTS, &x, &mut right);
        matrix.solve(&mut right);
        for i in 3..11 {
            assert!((right[i] - x[i]).abs().max() < 1e-12, "{i}: {} {}", right[i], x[i]);
        }
    }
}
