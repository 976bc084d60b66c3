//! Going to rest, and staying.

use crate::Settings;
use crate::polynomial::ToRest;
use nalgebra::{SMatrix, SVector};
use shapebot_control::Target;
use shapebot_dynamics::{Ordered, Robot};

/// Largest acceleration of a polynomial of fifth degree from a speed to rest, in speeds per duration.
const BRAKING: f64 = 1.5;

/// What a stand needs to know of a robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance<T: Ordered, const NX: usize, const NS: usize> {
    /// Shape through which the body accelerates: K⁰_qs times it is one.
    pub(crate) body_gain: SMatrix<T, NS, NX>,
    /// Accelerations that the controller can make up for.
    pub(crate) authority: SVector<T, NX>,
    /// One for actuated shape coordinates.
    pub(crate) servoed: SVector<T, NS>,
    /// Control period, s.
    pub(crate) period: T,
}

/// A motion to rest: position and actuated shape by polynomials; the rest of the shape follows, so that
/// Γ′ of it is the position's acceleration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stand<T: Ordered, const NX: usize, const NS: usize> {
    began_us: u64,
    position: ToRest<T, NX>,
    joints: ToRest<T, NS>,
    /// Wanted shape.
    shape: SVector<T, NS>,
}

impl<T: Ordered, const NX: usize, const NS: usize> Stand<T, NX, NS> {
    pub(crate) fn still(position: SVector<T, NX>, shape: SVector<T, NS>, now: u64) -> Self {
        let (position, joints) = (ToRest::still(position), ToRest::still(shape));
        Self { began_us: now, position, joints, shape }
    }

    /// From a motion of position and shape; to `goal`, or to where braking ends.
    pub(crate) fn from_motion(
        position: [SVector<T, NX>; 3],
        shape: [SVector<T, NS>; 3],
        goal: Option<SVector<T, NX>>,
        balance: &Balance<T, NX, NS>,
        settings: &Settings<T>,
        now: u64,
    ) -> Self {
        let c = T::from_f64;
        let mut duration = settings.stop_time;
        for (speed, authority) in position[1].iter().zip(&balance.authority) {
            let needed = c(BRAKING) * speed.abs() / *authority;
            if *authority > T::zero() && needed > duration {
                duration = needed;
            }
        }
        let way = c(0.5) * duration;
        let goal = goal.unwrap_or(position[0] + position[1] * way);
        let joint_goal = shape[0] + (shape[1] * way).component_mul(&balance.servoed);
        Self {
            began_us: now,
            position: ToRest::new(position, goal, duration),
            joints: ToRest::new(shape, joint_goal, duration),
            shape: shape[0],
        }
    }

    fn time(&self, now: u64) -> T {
        seconds(now.saturating_sub(self.began_us))
    }

    pub(crate) fn goal(&self) -> &SVector<T, NX> {
        self.position.goal()
    }

    /// Whether the motion is over.
    pub(crate) fn is_over(&self, now: u64) -> bool {
        self.position.is_over(self.time(now))
    }

    /// What is wanted now; once a cycle.
    pub(crate) fn step<R, const N: usize>(
        &mut self,
        robot: &R,
        balance: &Balance<T, NX, NS>,
        settings: &Settings<T>,
        now: u64,
    ) -> Target<T, N, NX, NS>
    where
        R: Robot<T, N, NX, NS>,
    {
        let time = self.time(now);
        let position = self.position.at(time);
        let joints = self.joints.at(time);
        // One step of Newton's method per cycle towards the lean that accelerates so, slowed down.
        let missing = position[2] - robot.gamma_prime(&self.shape);
        let lean_rate = balance.body_gain * missing / settings.lean_time;
        let free = balance.servoed.map(|servoed| T::one() - servoed);
        let follow = |joint: &SVector<T, NS>, lean: SVector<T, NS>| {
            joint.component_mul(&balance.servoed) + lean.component_mul(&free)
        };
        self.shape = follow(&joints[0], self.shape + lean_rate * balance.period);
        let still = SVector::from_element(T::zero());
        let shape = [self.shape, follow(&joints[1], lean_rate), follow(&joints[2], still)];
        Target { position, shape, force: SVector::from_element(T::zero()) }
    }
}

/// Microseconds as seconds.
pub(crate) fn seconds<T: Ordered>(micros: u64) -> T {
    T::from_i64(micros.min(i64::MAX as u64) as i64) * T::from_f64(1e-6)
}
