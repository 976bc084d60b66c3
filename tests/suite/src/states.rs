//! States to test at: fixed pseudo-random points within the declared ranges.

use shapebot_dynamics::nalgebra::SVector;
use shapebot_dynamics::{Coordinate, Description};

/// A state of motion, with a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize> {
    /// q
    pub q: SVector<f64, N>,
    /// q̇
    pub qd: SVector<f64, N>,
    /// q̈
    pub qdd: SVector<f64, N>,
    /// f
    pub force: SVector<f64, N>,
}

/// The same sequence of numbers in every run (splitmix64).
#[derive(Clone, Debug)]
pub struct Numbers(u64);

impl Numbers {
    /// A sequence of its own per seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A number between two others.
    pub fn between(&mut self, lower: f64, upper: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        let fraction = (z >> 11) as f64 / (1_u64 << 53) as f64;
        lower + (upper - lower) * fraction
    }

    /// A vector of such numbers.
    pub fn vector<const N: usize>(&mut self, lower: f64, upper: f64) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.between(lower, upper))
    }
}

/// The part of a coordinate's range to test in: not to its very ends, and not far out.
#[must_use]
pub fn interval(coordinate: &Coordinate) -> (f64, f64) {
    let (lower, upper) = (coordinate.lower.max(-2.0), coordinate.upper.min(2.0));
    let (middle, half) = (0.5 * (lower + upper), 0.45 * (upper - lower));
    (middle - half, middle + half)
}

/// `count` states of a robot.
///
/// # Panics
///
/// If the description is not that of a robot with N coordinates.
#[must_use]
pub fn states<const N: usize>(description: &Description, count: usize) -> Vec<State<N>> {
    assert_eq!(description.coordinates.len(), N, "{}", description.name);
    let mut numbers = Numbers::new(20_130_101);
    let mut state = |_| {
        let intervals = description.coordinates.iter().map(interval);
        let q: Vec<f64> = intervals.map(|(a, b)| numbers.between(a, b)).collect();
        State {
            q: SVector::from_column_slice(&q),
            qd: numbers.vector(-2.0, 2.0),
            qdd: numbers.vector(-3.0, 3.0),
            force: numbers.vector(-10.0, 10.0),
        }
    };
    (0..count).map(&mut state).collect()
}
