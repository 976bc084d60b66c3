//! The parts of a step.

use crate::Controller;
use crate::Target;
use crate::clamp::{clamp, clamp_all};
use crate::controller::Memory;
use crate::plant::Dynamics;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Motion, Ordered, Robot};

/// Deviation of a state from its target.
pub(crate) struct Deviation<T: Ordered, const NX: usize, const NS: usize> {
    pub(crate) position: SVector<T, NX>,
    pub(crate) velocity: SVector<T, NX>,
    pub(crate) shape: SVector<T, NS>,
    pub(crate) rate: SVector<T, NS>,
}

/// What the outer loop asks for.
pub(crate) struct Outer<T: Ordered, const NX: usize, const NS: usize> {
    /// q_s^c, Eq. 36.
    pub(crate) compensation: SVector<T, NS>,
    /// Shape against the offset of the measured shape.
    pub(crate) trim: SVector<T, NS>,
    /// Error of the output in units of q_x.
    pub(crate) position_error: SVector<T, NX>,
    /// The compensation met a limit.
    pub(crate) limited: bool,
}

/// Shape errors: q_s less plan, compensation and trim.
pub(crate) struct Errors<T: Ordered, const NX: usize, const NS: usize> {
    pub(crate) shape: SVector<T, NS>,
    /// e = K⁰_u times that of the unactuated shape.
    pub(crate) lean: SVector<T, NX>,
}

impl<R, T, const N: usize, const NX: usize, const NS: usize> Controller<'_, R, T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    /// u_c = −k_x δx − k_v δẋ and the shape q_s^c = K⁰_qx u_c (Eq. 36) within its limits.
    pub(crate) fn outer(
        &self,
        memory: &Memory<T, N, NX, NS>,
        deviation: &Deviation<T, NX, NS>,
        target: &Target<T, N, NX, NS>,
    ) -> Outer<T, NX, NS> {
        let gains = &self.gains;
        let along = &self.plant.output_shape;
        let position_error = deviation.position + along * deviation.shape;
        let velocity_error = deviation.velocity + along * deviation.rate;
        let acceleration = -(gains.position.component_mul(&position_error)
            + gains.velocity.component_mul(&velocity_error));
        let wanted = self.compensation_gain * acceleration;
        let (planned, zero) = (&target.shape[0], T::zero());
        // In this order, so that what is within its limits stays the same to the bit.
        let compensation = SVector::from_fn(|i, _| {
            let (last, step) = (memory.compensation[i], self.compensation_step[i]);
            if wanted[i] == zero && last == zero {
                return zero;
            }
            let slewed = clamp(wanted[i], last - step, last + step);
            let limit = gains.compensation_limit[i];
            self.within_range(i, clamp(slewed, -limit, limit), planned[i])
        });
        let trim =
            clamp_all(&-(self.plant.body_gain * memory.offset.offset), &gains.compensation_limit);
        Outer { compensation, trim, position_error, limited: compensation != wanted }
    }

    /// Compensation that leaves the shape in its range, or does not lead it further out.
    fn within_range(&self, i: usize, compensation: T, planned: T) -> T {
        let (zero, lower) = (T::zero(), self.plant.lower[i] - planned);
        let upper = self.plant.upper[i] - planned;
        let lower = if lower < zero { lower } else { zero };
        let upper = if upper > zero { upper } else { zero };
        clamp(compensation, lower, upper)
    }

    /// Errors of the shape against what the outer loop made of the plan.
    pub(crate) fn errors(
        &self,
        deviation: &Deviation<T, NX, NS>,
        outer: &Outer<T, NX, NS>,
    ) -> Errors<T, NX, NS> {
        let shape = deviation.shape - outer.compensation - outer.trim;
        Errors { shape, lean: self.plant.lean_gain * shape }
    }

    /// Forces on the position variables after their limits:
    /// M_xx (k_p e + k_d ė + k_i ∫e + K⁰_qs q_s^c) − d̂ + feedforward.
    pub(crate) fn balance(
        &self,
        memory: &Memory<T, N, NX, NS>,
        deviation: &Deviation<T, NX, NS>,
        outer: &Outer<T, NX, NS>,
        error: &Errors<T, NX, NS>,
        motion: &Motion<T, N>,
        target: &Target<T, N, NX, NS>,
    ) -> SVector<T, N> {
        let gains = &self.gains;
        let rate = self.plant.lean_gain * deviation.rate;
        let acceleration = gains.lean.component_mul(&error.lean)
            + gains.lean_rate.component_mul(&rate)
            + gains.lean_integral.component_mul(&memory.lean_integral)
            + self.plant.shape_gain * outer.compensation;
        let inertia: SMatrix<T, NX, NX> = motion.mass_matrix.fixed_view::<NX, NX>(0, 0).into();
        let (planned, _) = R::split(&target.force);
        let force = inertia * acceleration + planned - memory.momentum.disturbance;
        let driven = |i: usize| i < NX && self.plant.actuator[i] < N;
        SVector::from_fn(|i, _| if driven(i) { force[i] } else { T::zero() })
    }

    /// Adds the forces on servoed shape variables by computed torque: with the forces on the position
    /// variables given, exactly those that produce the wanted accelerations.
    pub(crate) fn servo(
        &self,
        memory: &Memory<T, N, NX, NS>,
        deviation: &Deviation<T, NX, NS>,
        error: &Errors<T, NX, NS>,
        dynamics: &Dynamics<'_, T, N>,
        target: &Target<T, N, NX, NS>,
        balance: &SVector<T, N>,
    ) -> SVector<T, N> {
        if !self.plant.has_servo {
            return *balance;
        }
        let gains = &self.gains;
        let (rate, two) = (gains.servo_rate, T::from_f64(2.0));
        let wanted = target.shape[2]
            - error.shape * (rate * rate)
            - deviation.rate * (two * gains.servo_damping * rate)
            - memory.servo_integral * gains.servo_integral;
        let mut acceleration: SVector<T, N> = SVector::from_fn(|i, _| {
            if i < NX { T::zero() } else { self.plant.servoed[i - NX] * wanted[i - NX] }
        });
        let acting = SVector::<T, NX>::from_fn(|i, _| {
            self.limited_entry(i, balance[i], memory.force[i]) + memory.momentum.disturbance[i]
        });
        self.plant.accelerate(dynamics, &acting, &mut acceleration);
        SVector::from_fn(|i, _| {
            let servoed = i >= NX && self.plant.servoed[i - NX] > T::zero();
            if servoed { balance[i] + dynamics.needed(i, &acceleration) } else { balance[i] }
        })
    }

    /// Forces that the actuators can give, and change that fast.
    pub(crate) fn limited(&self, wanted: &SVector<T, N>, last: &SVector<T, N>) -> SVector<T, N> {
        SVector::from_fn(|i, _| self.limited_entry(i, wanted[i], last[i]))
    }

    fn limited_entry(&self, i: usize, wanted: T, last: T) -> T {
        let (step, limit) = (self.force_step[i], self.plant.limit[i]);
        clamp(clamp(wanted, last - step, last + step), -limit, limit)
    }

    /// Integrates the errors, but not further into a limit.
    pub(crate) fn integrate(
        &self,
        memory: &mut Memory<T, N, NX, NS>,
        error: &Errors<T, NX, NS>,
        wanted: &SVector<T, N>,
        force: &SVector<T, N>,
    ) {
        let (period, zero) = (self.gains.period, T::zero());
        let excess = wanted - force;
        for i in 0..NX {
            let held = excess[i] * error.lean[i] > zero;
            memory.lean_integral[i] += if held { zero } else { error.lean[i] * period };
        }
        for i in 0..NS {
            // The force falls as the error grows.
            let held = excess[NX + i] * error.shape[i] < zero;
            let part = self.plant.servoed[i] * error.shape[i] * period;
            memory.servo_integral[i] += if held { zero } else { part };
        }
    }
}
