//! Computations that the host and an emulated Cortex-M4F must agree on to the last bit.
//!
//! A [`Step`] is a computation in single precision on pseudo-random inputs. [`run`] makes many of them
//! and condenses all results into a checksum; the microcontroller's program (`bits`) and the test on
//! the host call it with the same steps. To compare another computation, implement [`Step`] and add a
//! line to [`all`].
#![no_std]
#![forbid(unsafe_code)]

mod digest;
mod full_step;
mod inputs;
mod steps;

pub use digest::Digest;
pub use full_step::FullStep;
pub use inputs::Inputs;
pub use steps::{ArmsMotion, PlanEvaluation, SineCosine, all};

use core::hint::black_box;

/// Evaluations of each step.
pub const COUNT: u32 = 1000;

/// A computation on inputs drawn beforehand.
pub trait Step {
    /// One word, for the report.
    const NAME: &'static str;
    /// Draws the inputs of the next evaluation.
    fn draw(&mut self, inputs: &mut Inputs);
    /// The computation, whose time is taken.
    fn evaluate(&mut self);
    /// Adds all results.
    fn digest(&self, digest: &mut Digest);
}

/// What came out of many evaluations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// [`Step::NAME`].
    pub name: &'static str,
    /// Evaluations.
    pub count: u32,
    /// Checksum of all results.
    pub checksum: u64,
    /// Ticks of the clock, all evaluations together.
    pub ticks: u64,
    /// Ticks of the longest evaluation.
    pub longest: u32,
}

/// Evaluates `step` `count` times. `clock` returns ticks since it was last called.
pub fn run<S: Step>(mut step: S, count: u32, mut clock: impl FnMut() -> u32) -> Outcome {
    let mut inputs = Inputs::new();
    let mut digest = Digest::new();
    let (mut ticks, mut longest) = (0, 0);
    for _ in 0..count {
        step.draw(&mut inputs);
        step = black_box(step);
        clock();
        step.evaluate();
        let spent = clock();
        step = black_box(step);
        ticks += u64::from(spent);
        longest = spent.max(longest);
        step.digest(&mut digest);
    }
    Outcome { name: S::NAME, count, checksum: digest.value(), ticks, longest }
}
