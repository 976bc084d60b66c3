//! Friction that a model does not have.

use nalgebra::SVector;

/// Viscous and dry friction, alike along all position variables, in their units of force (N·m of a
/// wheel's angle, N of a cart's way).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// Force per rate.
    pub viscous: f64,
    /// Force of dry (Coulomb) friction, whatever the rate.
    pub coulomb: f64,
}

impl Friction {
    /// No force at any rate.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.viscous == 0.0 && self.coulomb == 0.0
    }

    /// Rate below which dry friction is replaced by a steep viscous one, so that a Runge-Kutta step of
    /// `step` seconds stays stable and does not chatter: c/ε times mobility times step is one.
    ///
    /// `mobility` is the acceleration per unit of force at a standstill. What should stick creeps at most
    /// with ε.
    #[must_use]
    pub fn regularisation(&self, mobility: f64, step: f64) -> f64 {
        (self.coulomb * mobility * step).max(f64::MIN_POSITIVE.sqrt())
    }

    /// Force on each axis by itself, as of a drive per axis.
    #[must_use]
    pub fn per_axis<const NX: usize>(
        &self,
        rate: &SVector<f64, NX>,
        regularisation: f64,
    ) -> SVector<f64, NX> {
        rate.map(|v| -self.viscous * v - self.coulomb * smooth_sign(v, v.abs(), regularisation))
    }

    /// Force against the direction of the rate, as of a contact that slides alike in all directions.
    #[must_use]
    pub fn isotropic<const NX: usize>(
        &self,
        rate: &SVector<f64, NX>,
        regularisation: f64,
    ) -> SVector<f64, NX> {
        let speed = rate.norm();
        rate.map(|v| -self.viscous * v - self.coulomb * smooth_sign(v, speed, regularisation))
    }
}

/// v/|v|, with slope 1/ε through zero.
pub(crate) fn smooth_sign(v: f64, speed: f64, regularisation: f64) -> f64 {
    v / speed.hypot(regularisation)
}

#[cfg(test)]
mod tests {
    use super::Friction;
    use nalgebra::{Vector1, Vector2};

    #[test]
    fn at_speed_it_is_the_textbook_law() {
        let friction = Friction { viscous: 0.3, coulomb: 2.0 };
        let force = friction.per_axis(&Vector1::new(-4.0), 1e-6);
        assert!((force[0] - 3.2).abs() < 1e-9, "{force}");
    }

    #[test]
    fn a_contact_resists_along_its_velocity_with_its_level() {
        let friction = Friction { viscous: 0.0, coulomb: 2.0 };
        let force = friction.isotropic(&Vector2::new(3.0, 4.0), 1e-6);
        assert!((force - Vector2::new(-1.2, -1.6)).norm() < 1e-9, "{force}");
        let force = friction.per_axis(&Vector2::new(3.0, 4.0), 1e-6);
        assert!((force - Vector2::new(-2.0, -2.0)).norm() < 1e-9, "{force}");
    }

    #[test]
    fn standing_still_takes_no_force() {
        let friction = Friction { viscous: 0.3, coulomb: 2.0 };
        assert_eq!(friction.per_axis(&Vector1::new(0.0), 0.01)[0], 0.0);
        assert_eq!(friction.isotropic(&Vector2::new(0.0, 0.0), 0.01).norm(), 0.0);
        assert_eq!(Friction::default().per_axis(&Vector1::new(3.0), 1e-9)[0], 0.0);
    }
}
