//! The drive unit turns against the body.

use core::f32::consts::{PI, TAU};
use shapebot_dynamics::Real;

/// A rotation in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    cos: f32,
    sin: f32,
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Self = Self { cos: 1.0, sin: 0.0 };

    /// By the angle of the drive unit against the body, rad.
    #[must_use]
    pub fn of(yaw: f32) -> Self {
        let (sin, cos) = Real::sin_cos(yaw);
        Self { cos, sin }
    }

    /// From the body's frame into the drive unit's: forces.
    #[must_use]
    pub fn into_drive(self, [x, y]: [f32; 2]) -> [f32; 2] {
        [self.cos * x + self.sin * y, self.cos * y - self.sin * x]
    }

    /// From the drive unit's frame into the body's: rates and displacements of one cycle.
    #[must_use]
    pub fn into_body(self, [x, y]: [f32; 2]) -> [f32; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }
}

/// The angle brought into −π to π.
#[must_use]
pub fn wrapped(angle: f32) -> f32 {
    if (-PI..=PI).contains(&angle) {
        return angle;
    }
    angle - TAU * libm::floorf((angle + PI) / TAU)
}

/// Holds a heading by a torque between body and drive unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingHold {
    /// Heading that is held, rad.
    reference: f32,
    /// Heading that is gone to, rad.
    target: f32,
}

impl HeadingHold {
    /// Holds a heading.
    #[must_use]
    pub const fn at(heading: f32) -> Self {
        Self { reference: heading, target: heading }
    }

    /// A new heading to go to; one that is not finite is ignored.
    pub fn aim(&mut self, heading: f32) {
        if heading.is_finite() {
            self.target = wrapped(heading);
        }
    }

    /// Whether this heading is gone to.
    #[must_use]
    pub fn aims_at(&self, heading: f32) -> bool {
        !heading.is_finite() || self.target == wrapped(heading)
    }

    /// Whether the reference is at the target and the body within 0.02 rad of it.
    #[must_use]
    pub fn has_arrived(&self, heading: f32) -> bool {
        self.reference == self.target && libm::fabsf(wrapped(heading - self.target)) < 0.02
    }

    /// Moves the reference by at most `step` radians and gives the torque on the body, N·m.
    pub fn torque(
        &mut self,
        heading: f32,
        rate: f32,
        [stiffness, damping]: [f32; 2],
        step: f32,
    ) -> f32 {
        let rest = wrapped(self.target - self.reference);
        self.reference = if libm::fabsf(rest) <= step {
            self.target
        } else {
            wrapped(self.reference + libm::copysignf(step, rest))
        };
        stiffness * wrapped(self.reference - heading) - damping * rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_into_the_drive_and_rates_out_of_it_are_inverse() {
        // The drive unit is turned by a quarter to the left: its x axis is the body's y axis.
        let quarter = Rotation::of(PI / 2.0);
        let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-6;
        assert!(near(quarter.into_drive([0.0, 1.0]), [1.0, 0.0]));
        assert!(near(quarter.into_drive([1.0, 0.0]), [0.0, -1.0]));
        assert!(near(quarter.into_body([1.0, 0.0]), [0.0, 1.0]));
        let turn = Rotation::of(0.7);
        assert!(near(turn.into_body(turn.into_drive([2.0, -3.0])), [2.0, -3.0]));
        // Power is the same in both frames.
        let (force, rate) = ([1.5, -0.5], [0.2, 0.9]);
        let power = |f: [f32; 2], v: [f32; 2]| f[0] * v[0] + f[1] * v[1];
        let drive = power(turn.into_drive(force), turn.into_drive(rate));
        assert!((drive - power(force, rate)).abs() < 1e-6);
    }

    #[test]
    fn headings_go_the_short_way_round() {
        assert!((wrapped(3.0 * PI / 2.0) + PI / 2.0).abs() < 1e-6);
        let mut hold = HeadingHold::at(3.0);
        hold.aim(-3.0);
        let torque = hold.torque(3.0, 0.0, [10.0, 1.0], 0.1);
        assert!((torque - 1.0).abs() < 1e-5, "{torque}");
        hold.aim(f32::NAN);
        for _ in 0..3 {
            hold.torque(-3.0, 0.0, [10.0, 1.0], 0.1);
        }
        assert!(hold.has_arrived(-3.0) && !hold.has_arrived(3.0));
    }
}
