//! Gains of the law, with what a user may override.

use crate::Error;
use crate::plant::Plant;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{Ordered, Robot};

/// Part of a shape coordinate's declared range that compensation may use while the robot balances: 3° of
/// ±30°.
const BALANCING_SHARE: f64 = 0.1;

/// The same where the shape is servoed, which cannot fall.
const SERVOED_SHARE: f64 = 0.5;

/// Compensation limit of a coordinate without a range: 3°, or as many metres.
const UNLIMITED: f64 = 0.052_36;

/// How often per second compensation may cross its limit.
const SLEW: f64 = 20.0;

/// Which part of the shape makes up for position errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compensate {
    /// The shape sets as in the plan, through [`Gains::plan_gain`].
    Plan,
    /// The unactuated shape alone, which has the authority; all of it where the whole shape is actuated.
    #[default]
    Body,
}

/// Gains and limits of a [`Controller`](crate::Controller). Start from [`Gains::from_design`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<T, const NX: usize, const NS: usize> {
    /// Control period, s.
    pub period: T,
    /// k_p of the balancing loop.
    pub lean: SVector<T, NX>,
    /// k_d of the balancing loop, s.
    pub lean_rate: SVector<T, NX>,
    /// k_i of the balancing loop, 1/s.
    pub lean_integral: SVector<T, NX>,
    /// k_x of the outer loop, 1/s².
    pub position: SVector<T, NX>,
    /// k_v of the outer loop, 1/s.
    pub velocity: SVector<T, NX>,
    /// ω of the actuated shape variables, rad/s.
    pub servo_rate: T,
    /// ζ of the actuated shape variables.
    pub servo_damping: T,
    /// Integral gain of the actuated shape variables, 1/s³.
    pub servo_integral: T,
    /// Whether the momentum observer makes up for disturbing forces.
    pub observer: bool,
    /// Its rate, 1/s.
    pub observer_rate: T,
    /// Whether a constant offset of the measured shape is estimated and made up for.
    pub offset: bool,
    /// Rate of that estimate, 1/s.
    pub offset_rate: T,
    /// Which part of the shape makes up for position errors.
    pub compensate: Compensate,
    /// K⁰_qx (Eq. 24) of [`Compensate::Plan`], n_s × n_x: the one that the plan was made with. K⁰_qs
    /// times it must be one.
    pub plan_gain: SMatrix<T, NS, NX>,
    /// Largest magnitude of the compensation of each shape coordinate.
    pub compensation_limit: SVector<T, NS>,
    /// Largest rate of the compensation of each shape coordinate, 1/s.
    pub compensation_slew: SVector<T, NS>,
    /// Largest rate of the forces in full forces per second; infinite for none.
    pub force_slew: T,
}

impl<T: Ordered, const NX: usize, const NS: usize> Gains<T, NX, NS> {
    /// Gains of a design, with default limits for a robot: compensation within a tenth of the declared
    /// ranges (half of them where the whole shape is servoed), made by the body alone.
    ///
    /// # Errors
    ///
    /// A design for a robot of another size or kind; a robot whose roles or gains allow no controller.
    pub fn from_design<R, const N: usize>(robot: &R, design: &ControlDesign) -> Result<Self, Error>
    where
        R: Robot<T, N, NX, NS>,
    {
        let plant = Plant::new(robot)?;
        if plant.balancing != design.balancing {
            return Err(Error::Kind);
        }
        let lean = |gains, what| if plant.balancing { axes(gains, what) } else { Ok(zero()) };
        let limit = compensation_limit(robot.description().shape_coordinates(), plant.balancing);
        let c = T::from_f64;
        Ok(Self {
            period: c(design.period),
            lean: lean(design.lean, "lean")?,
            lean_rate: lean(design.lean_rate, "lean_rate")?,
            lean_integral: lean(design.lean_integral, "lean_integral")?,
            position: axes(design.position, "position")?,
            velocity: axes(design.velocity, "velocity")?,
            servo_rate: c(design.servo.rate),
            servo_damping: c(design.servo.damping),
            servo_integral: c(design.servo.integral),
            observer: design.observer_rate > 0.0,
            observer_rate: c(design.observer_rate),
            offset: design.offset_rate > 0.0,
            offset_rate: c(design.offset_rate),
            compensate: Compensate::Body,
            plan_gain: plant.body_gain,
            compensation_limit: limit,
            compensation_slew: limit * c(SLEW),
            force_slew: c(f64::INFINITY),
        })
    }

    /// Checks what a user may have overridden.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let positive: [(&'static str, T); 2] =
            [("period", self.period), ("force_slew", self.force_slew)];
        for (what, value) in positive {
            if !exceeds(value, T::zero()) {
                return Err(Error::Gain { what });
            }
        }
        let finite: [(&'static str, T); 6] = [
            ("period", self.period),
            ("servo_rate", self.servo_rate),
            ("servo_damping", self.servo_damping),
            ("servo_integral", self.servo_integral),
            ("observer_rate", self.observer_rate),
            ("offset_rate", self.offset_rate),
        ];
        for (what, value) in finite {
            if !(value.is_finite() && value >= T::zero()) {
                return Err(Error::Gain { what });
            }
        }
        let axes = [
            ("lean", &self.lean),
            ("lean_rate", &self.lean_rate),
            ("lean_integral", &self.lean_integral),
            ("position", &self.position),
            ("velocity", &self.velocity),
        ];
        for (what, gains) in axes {
            if !gains.iter().all(|gain| gain.is_finite()) {
                return Err(Error::Gain { what });
            }
        }
        if !self.plan_gain.iter().all(|entry| entry.is_finite()) {
            return Err(Error::Gain { what: "plan_gain" });
        }
        let limits = [
            ("compensation_limit", &self.compensation_limit),
            ("compensation_slew", &self.compensation_slew),
        ];
        for (what, limits) in limits {
            if !limits.iter().all(|&limit| limit >= T::zero()) {
                return Err(Error::Gain { what });
            }
        }
        Ok(())
    }
}

/// Whether `value` is larger than `bound`; NaN is not.
fn exceeds<T: Ordered>(value: T, bound: T) -> bool {
    value > bound
}

fn zero<T: Ordered, const L: usize>() -> SVector<T, L> {
    SVector::from_element(T::zero())
}

fn axes<T: Ordered, const NX: usize>(
    gains: &[f64],
    what: &'static str,
) -> Result<SVector<T, NX>, Error> {
    if gains.len() != NX {
        return Err(Error::Axes { what, found: gains.len(), expected: NX });
    }
    Ok(SVector::from_iterator(gains.iter().map(|&gain| T::from_f64(gain))))
}

fn compensation_limit<T: Ordered, const NS: usize>(
    coordinates: &[shapebot_dynamics::Coordinate],
    balancing: bool,
) -> SVector<T, NS> {
    let share = if balancing { BALANCING_SHARE } else { SERVOED_SHARE };
    let mut limits = SVector::<T, NS>::from_element(T::from_f64(UNLIMITED));
    for (limit, coordinate) in limits.iter_mut().zip(coordinates) {
        let half = (coordinate.upper - coordinate.lower) / 2.0;
        if half.is_finite() {
            *limit = T::from_f64(share * half);
        }
    }
    limits
}
