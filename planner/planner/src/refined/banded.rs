//! Normal equations of a spline: block-banded, factored once, solved in every sweep.

use super::basis::ORDER;
use crate::linear_algebra::{exceeds, inverse};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// A symmetric matrix of n_x × n_x blocks; control points more than seven apart share no span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Banded<T: Ordered, const NX: usize, const POINTS: usize> {
    /// `[i][d]` is block (i, i − d). Rows and columns in `free` hold L and D of L D Lᵀ once factored.
    blocks: [[SMatrix<T, NX, NX>; ORDER]; POINTS],
    inverses: [SMatrix<T, NX, NX>; POINTS],
    free: (usize, usize),
}

impl<T: Ordered, const NX: usize, const POINTS: usize> Banded<T, NX, POINTS> {
    pub(crate) fn zeros() -> Self {
        Self {
            blocks: [[SMatrix::zeros(); ORDER]; POINTS],
            inverses: [SMatrix::zeros(); POINTS],
            free: (0, 0),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.blocks = [[SMatrix::zeros(); ORDER]; POINTS];
    }

    /// Adds to block (row, row − below).
    pub(crate) fn add(&mut self, row: usize, below: usize, block: &SMatrix<T, NX, NX>) {
        if let Some(entry) = self.blocks.get_mut(row).and_then(|row| row.get_mut(below)) {
            *entry += block;
        }
    }

    /// Factors the rows from `first` up to `end`; the others belong to control points that are given.
    /// `None` if the matrix is singular to working precision.
    pub(crate) fn factor(&mut self, first: usize, end: usize) -> Option<()> {
        self.free = (first, end);
        self.damp();
        for i in first..end {
            let lowest = first.max(i.saturating_sub(ORDER - 1));
            for j in lowest..i {
                // Y_ij = L_ij D_j, kept until D_i is known.
                let mut block = self.blocks[i][i - j];
                for k in lowest.max(j.saturating_sub(ORDER - 1))..j {
                    block -= self.blocks[i][i - k] * self.blocks[j][j - k].transpose();
                }
                self.blocks[i][i - j] = block;
            }
            let mut diagonal = self.blocks[i][0];
            for j in lowest..i {
                let scaled = self.blocks[i][i - j];
                let lower = scaled * self.inverses[j];
                diagonal -= lower * scaled.transpose();
                self.blocks[i][i - j] = lower;
            }
            if (0..NX).any(|k| !exceeds(diagonal[(k, k)], T::zero())) {
                return None;
            }
            self.blocks[i][0] = diagonal;
            self.inverses[i] = inverse(diagonal)?;
        }
        Some(())
    }

    /// A shift of the diagonal far below what the sweeps would notice: they correct for it.
    fn damp(&mut self) {
        let (first, end) = self.free;
        let mut largest = T::zero();
        for row in &self.blocks[first..end] {
            for k in 0..NX {
                if row[0][(k, k)] > largest {
                    largest = row[0][(k, k)];
                }
            }
        }
        let shift = largest * T::epsilon() * T::from_f64(16.0);
        for row in &mut self.blocks[first..end] {
            for k in 0..NX {
                row[0][(k, k)] += shift;
            }
        }
    }

    /// The control points that are solved for.
    pub(crate) fn free(&self) -> core::ops::Range<usize> {
        self.free.0..self.free.1
    }

    /// Subtracts from the right-hand side what the steps of the given control points contribute.
    pub(crate) fn shift_given(
        &self,
        count: usize,
        steps: &[SVector<T, NX>; POINTS],
        right: &mut [SVector<T, NX>; POINTS],
    ) {
        let (first, end) = self.free;
        for i in first..end {
            for j in i.saturating_sub(ORDER - 1)..first {
                right[i] -= self.blocks[i][i - j] * steps[j];
            }
            for j in end..count.min(i + ORDER) {
                right[i] -= self.blocks[j][j - i].transpose() * steps[j];
            }
        }
    }

    /// Solves for the free control points, in place.
    pub(crate) fn solve(&self, x: &mut [SVector<T, NX>; POINTS]) {
        let (first, end) = self.free;
        for i in first..end {
            for j in first.max(i.saturating_sub(ORDER - 1))..i {
                let known = self.blocks[i][i - j] * x[j];
                x[i] -= known;
            }
        }
        for i in first..end {
            x[i] = self.inverses[i] * x[i];
        }
        for i in (first..end).rev() {
            for j in i + 1..end.min(i + ORDER) {
                let known = self.blocks[j][j - i].transpose() * x[j];
                x[i] -= known;
            }
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
        let mut matrix = Banded::<f64, 2, POINTS>::zeros();
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
