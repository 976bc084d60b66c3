//! JᵀJ of the fixed linearisation: assembled and factored once per plan.

use super::banded::{Banded, Block, Diagonal};
use super::basis::{Basis, DEGREE, ORDER, SpanBasis};
use super::problem::Linearised;
use super::spans::{INTERVALS, sigmas};
use super::window::Window;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// The normal equations over the samples of the early sweeps, factored.
#[derive(Clone, Debug)]
pub(crate) enum Normal<T: Ordered, const NX: usize, const POINTS: usize> {
    /// The axes do not touch each other.
    Apart(Banded<Diagonal<T, NX>, POINTS>),
    Coupled(Banded<SMatrix<T, NX, NX>, POINTS>),
}

impl<T: Ordered, const NX: usize, const POINTS: usize> Normal<T, NX, POINTS> {
    pub(crate) fn empty() -> Self {
        Self::Coupled(Banded::zeros())
    }

    /// Assembles and factors; `free` are the first control point that is solved for and the first after
    /// those. `None` if the matrix is singular to working precision.
    pub(crate) fn prepare(
        &mut self,
        basis: &Basis<T>,
        window: &Window<T>,
        linear: &Linearised<T, NX>,
        free: (usize, usize),
    ) -> Option<()> {
        let metric = linear.jacobian.transpose() * linear.jacobian;
        let apart = diagonal(&linear.output).is_some() && diagonal(&metric).is_some();
        match self {
            Self::Coupled(_) if apart => *self = Self::Apart(Banded::zeros()),
            Self::Apart(_) if !apart => *self = Self::Coupled(Banded::zeros()),
            _ => {}
        }
        match self {
            Self::Apart(matrix) => {
                assemble(basis, window, linear, matrix);
                matrix.factor(free.0, free.1)
            }
            Self::Coupled(matrix) => {
                assemble(basis, window, linear, matrix);
                matrix.factor(free.0, free.1)
            }
        }
    }

    /// The same for a curve that is fitted itself, to the samples of any window.
    pub(crate) fn prepare_samples(
        &mut self,
        basis: &Basis<T>,
        window: &Window<T>,
        free: (usize, usize),
    ) -> Option<()> {
        let mut matrix = Banded::<Diagonal<T, NX>, POINTS>::zeros();
        assemble_samples(basis, window, &mut matrix);
        matrix.factor(free.0, free.1)?;
        *self = Self::Apart(matrix);
        Some(())
    }

    /// The control points that are solved for.
    pub(crate) fn free(&self) -> core::ops::Range<usize> {
        match self {
            Self::Apart(matrix) => matrix.free(),
            Self::Coupled(matrix) => matrix.free(),
        }
    }

    /// Solves for the free control points, in place; the given ones stay.
    pub(crate) fn solve_free(&self, right: &mut [SVector<T, NX>; POINTS]) {
        match self {
            Self::Apart(matrix) => matrix.solve(right),
            Self::Coupled(matrix) => matrix.solve(right),
        }
    }

    /// Solves for the free control points, in place, where `steps` has those that are given.
    pub(crate) fn solve(
        &self,
        count: usize,
        steps: &[SVector<T, NX>; POINTS],
        right: &mut [SVector<T, NX>; POINTS],
    ) {
        match self {
            Self::Apart(matrix) => matrix.shift_given(count, steps, right),
            Self::Coupled(matrix) => matrix.shift_given(count, steps, right),
        }
        self.solve_free(right);
    }
}

/// One number, or matrix, for every pair of eight.
type Square<B> = [[B; ORDER]; ORDER];

/// Adds the samples of all spans to the normal equations: they lie alike in all spans, and mirrored. Those
/// at the window's ends, which no free control point moves, count one half like any end of a span.
fn assemble<T: Ordered, B: Block<T, NX>, const NX: usize, const POINTS: usize>(
    basis: &Basis<T>,
    window: &Window<T>,
    linear: &Linearised<T, NX>,
    normal: &mut Banded<B, POINTS>,
) {
    normal.clear(window.spans + DEGREE);
    let powers = products(&node_powers(), window.span_length(), linear);
    let mut blocks = [[B::zero(); ORDER]; ORDER];
    for span in 0..window.spans.div_ceil(2) {
        // From here to the middle all spans are alike.
        if span <= DEGREE {
            blocks = span_blocks(basis.span(span), &powers);
        }
        let mirrored = window.spans - 1 - span;
        for i in 0..ORDER {
            for j in 0..=i {
                normal.add(span + i, i - j, &blocks[i][j]);
                if mirrored != span {
                    let other = blocks[DEGREE - j][DEGREE - i].transposed();
                    normal.add(mirrored + i, i - j, &other);
                }
            }
        }
    }
}

/// Sums over the samples of a span of (σᵏ − τ²(σᵏ)̈)ᵀ JᵀJ (σˡ − τ²(σˡ)̈).
fn products<T: Ordered, B: Block<T, NX>, const NX: usize>(
    sums: &Powers<T>,
    length: T,
    linear: &Linearised<T, NX>,
) -> Square<B> {
    let metric = linear.jacobian.transpose() * linear.jacobian;
    let once = metric * linear.output;
    let twice = B::of(&(linear.output.transpose() * once));
    let (metric, once) = (B::of(&metric), B::of(&once));
    let bend = |k: usize| T::from_f64((k * k.saturating_sub(1)) as f64) / (length * length);
    core::array::from_fn(|k| {
        core::array::from_fn(|l| {
            let sum = |less: usize| (k + l).checked_sub(less).map_or_else(T::zero, |n| sums[n]);
            B::zero()
                .plus(&metric, sum(0))
                .plus(&once, -bend(l) * sum(2))
                .plus(&once.transposed(), -bend(k) * sum(2))
                .plus(&twice, bend(k) * bend(l) * sum(4))
        })
    })
}

/// Σ σᵏ over the samples of a span.
type Powers<T> = [T; 2 * ORDER - 1];

fn add_powers<T: Ordered>(sums: &mut Powers<T>, sigma: T) {
    let mut power = T::one();
    for sum in sums {
        *sum += power;
        power *= sigma;
    }
}

/// The same over a span of the early sweeps, its samples weighted so that they sum up to one.
fn node_powers<T: Ordered>() -> Powers<T> {
    // One half at both ends of the span.
    let mut sums = [T::from_f64(0.5); 2 * ORDER - 1];
    sums[0] = T::one();
    for sigma in sigmas().into_iter().skip(1) {
        add_powers(&mut sums, sigma);
    }
    sums.map(|sum| sum / T::from_f64(INTERVALS as f64))
}

/// [`assemble`] for the curve itself and samples that lie in the spans as they do.
fn assemble_samples<T: Ordered, const NX: usize, const POINTS: usize>(
    basis: &Basis<T>,
    window: &Window<T>,
    normal: &mut Banded<Diagonal<T, NX>, POINTS>,
) {
    let mut add_span = |span: usize, sums: &Powers<T>| {
        let one = Diagonal::of(&SMatrix::identity());
        let powers = core::array::from_fn(|k| {
            core::array::from_fn(|l| Diagonal::zero().plus(&one, sums[k + l]))
        });
        let blocks = span_blocks(basis.span(span), &powers);
        for i in 0..ORDER {
            for j in 0..=i {
                normal.add(span + i, i - j, &blocks[i][j]);
            }
        }
    };
    let mut current = 0;
    let mut sums = [T::zero(); 2 * ORDER - 1];
    for (span, sigma) in window.places().take(window.count) {
        if span != current {
            add_span(current, &sums);
            sums = [T::zero(); 2 * ORDER - 1];
            current = span;
        }
        add_powers(&mut sums, sigma);
    }
    add_span(current, &sums);
}

/// The lower triangle of the blocks of one span.
fn span_blocks<T: Ordered, B: Block<T, NX>, const NX: usize>(
    functions: &SpanBasis<T>,
    powers: &Square<B>,
) -> Square<B> {
    let mut result = [[B::zero(); ORDER]; ORDER];
    for (i, function) in functions.iter().enumerate() {
        let mut left = [B::zero(); ORDER];
        for (row, &coefficient) in powers.iter().zip(function) {
            for (sum, block) in left.iter_mut().zip(row) {
                *sum = sum.plus(block, coefficient);
            }
        }
        for (j, other) in functions.iter().enumerate().take(i + 1) {
            for (block, &coefficient) in left.iter().zip(other) {
                result[i][j] = result[i][j].plus(block, coefficient);
            }
        }
    }
    result
}

/// What a 1 × 1 or diagonal matrix has on its diagonal; `None` for another.
pub(crate) fn diagonal<T: Ordered, const NX: usize>(
    matrix: &SMatrix<T, NX, NX>,
) -> Option<[T; NX]> {
    let largest = crate::linear_algebra::largest(matrix.iter().copied());
    for i in 0..NX {
        for j in 0..NX {
            if i != j && matrix[(i, j)].abs() > largest * T::epsilon().sqrt() {
                return None;
            }
        }
    }
    Some(core::array::from_fn(|i| matrix[(i, i)]))
}
