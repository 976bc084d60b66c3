//! Gains that an operator may set.

use nalgebra::SVector;
use shapebot_control::Gains;
use shapebot_dynamics::Ordered;

/// A gain that an operator may set while the robot is in use, as a factor of the designed one, the same
/// for all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tunable {
    /// Its name.
    pub name: &'static str,
    /// Smallest factor.
    pub low: f32,
    /// Largest factor.
    pub high: f32,
}

/// What an operator may set, by number. At every corner of these bounds bundled
/// ballbots keep to a plan under a push.
pub const TUNABLE: [Tunable; 4] = [
    // k_x of the outer loop.
    Tunable { name: "position", low: 0.6, high: 1.25 },
    // k_v of the outer loop.
    Tunable { name: "velocity", low: 0.85, high: 1.25 },
    // k_p, k_d and k_i of the balancing loop.
    Tunable { name: "balance", low: 0.9, high: 1.25 },
    // ω of the actuated shape variables, with their integral gain.
    Tunable { name: "servo", low: 0.5, high: 1.25 },
];

/// Designed gains and an operator's factors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tuning<T, const NX: usize, const NS: usize> {
    design: Gains<T, NX, NS>,
    factors: [T; TUNABLE.len()],
}

impl<T: Ordered, const NX: usize, const NS: usize> Tuning<T, NX, NS> {
    pub(crate) fn new(design: &Gains<T, NX, NS>) -> Self {
        Self { design: *design, factors: [T::one(); TUNABLE.len()] }
    }

    /// The same with another factor. `None` if there is no such gain, or if it is out of its bounds.
    pub(crate) fn with(mut self, index: u8, factor: f32) -> Option<Self> {
        let tunable = TUNABLE.get(usize::from(index))?;
        // Not a number is within no bounds.
        if !(factor >= tunable.low && factor <= tunable.high) {
            return None;
        }
        *self.factors.get_mut(usize::from(index))? = T::from_f32(factor);
        Some(self)
    }

    /// The factors, by their numbers.
    pub(crate) fn factors(&self) -> [f32; TUNABLE.len()] {
        self.factors.map(Ordered::to_f32)
    }

    pub(crate) fn gains(&self) -> Gains<T, NX, NS> {
        let [position, velocity, balance, servo] = self.factors;
        let scaled = |gains: &SVector<T, NX>, factor| gains * factor;
        let design = &self.design;
        Gains {
            position: scaled(&design.position, position),
            velocity: scaled(&design.velocity, velocity),
            lean: scaled(&design.lean, balance),
            lean_rate: scaled(&design.lean_rate, balance),
            lean_integral: scaled(&design.lean_integral, balance),
            servo_rate: design.servo_rate * servo,
            servo_integral: design.servo_integral * servo * servo * servo,
            ..*design
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{TUNABLE, Tuning};
    use shapebot_control::Gains;
    use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL};

    #[test]
    fn factors_are_of_the_design_and_within_bounds() {
        let robot = Ballbot3dArms::<f64>::default();
        let design = Gains::from_design(&robot, &CONTROL).unwrap();
        let tuning = Tuning::new(&design);
        assert_eq!(tuning.gains(), design);
        for (index, tunable) in (0..).zip(&TUNABLE) {
            for wrong in [tunable.low * 0.999, tunable.high * 1.001, f32::NAN, f32::INFINITY] {
                assert!(tuning.with(index, wrong).is_none(), "{} {wrong}", tunable.name);
            }
        }
        assert!(tuning.with(TUNABLE.len() as u8, 1.0).is_none());
        // A second factor is not one of the first.
        let tuned = tuning.with(3, 0.75).and_then(|tuning| tuning.with(3, 0.5)).unwrap().gains();
        assert_eq!(tuned.servo_rate, 0.5 * design.servo_rate);
        assert_eq!(tuned.servo_integral, 0.125 * design.servo_integral);
        assert_eq!((tuned.lean, tuned.position), (design.lean, design.position));
        let tuned = tuning.with(2, 1.25).and_then(|tuning| tuning.with(0, 0.75)).unwrap().gains();
        assert_eq!(tuned.lean[0], 1.25 * design.lean[0]);
        assert_eq!(tuned.lean_rate[1], 1.25 * design.lean_rate[1]);
        assert_eq!((tuned.position, tuned.velocity), (design.position * 0.75, design.velocity));
    }
}
