//! From what was sampled at a SYNC to the controller's state.

use nalgebra::{SMatrix, SVector};
use shapebot_control::{State, Target};
use shapebot_drive::Measurement;
use shapebot_dynamics::{Ordered, Robot};

/// Cycles over which a value that did not come is carried on.
const CARRIED: u8 = 8;

/// Position variables come as counts, shape variables with their rates.
///
/// What drives a balancing robot shakes its position and its shape against each other. With
/// N = ∂Γ/∂q̈_s, y = q_x − N q_s feels none of it, and its acceleration is the target's plus K⁰_qs times
/// the deviation of the shape. A tracking filter on y that expects this may be slow without lagging
/// behind, and q̇_x = ẏ + N q̇_s takes the fast part from the shape's rates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sensing<T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    period: T,
    /// α and β/T.
    gains: [T; 2],
    /// N.
    response: SMatrix<T, NX, NS>,
    /// K⁰_qs.
    shape_gain: SMatrix<T, NX, NS>,
    /// y and ẏ.
    estimate: Option<[SVector<T, NX>; 2]>,
    /// Measured position variables where the model's are zero, counts.
    origin: [i64; NX],
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> Sensing<T, N, NX, NS> {
    pub(crate) fn new<R: Robot<T, N, NX, NS>>(robot: &R, period: T, bandwidth: T) -> Self {
        let rest = SVector::from_element(T::zero());
        let one = T::one();
        let pole = (-(bandwidth * period)).exp();
        Self {
            period,
            gains: [one - pole * pole, (one - pole) * (one - pole) / period],
            response: robot.response(&rest, &rest, &rest).d_qsdd,
            shape_gain: robot.shape_gain(),
            estimate: None,
            origin: [0; NX],
        }
    }

    /// Position variables are zero where they were measured now.
    pub(crate) fn home(&mut self, measurement: &Measurement) {
        for (at, origin) in self.origin.iter_mut().enumerate() {
            *origin = measurement.counts(at);
        }
        self.estimate = None;
    }

    /// One for each position variable whose value is from `least` to `most` cycles old.
    fn mask(measurement: &Measurement, least: u8, most: u8) -> SVector<T, NX> {
        let is_in = |i: usize| (least..=most).contains(&measurement.age(i));
        SVector::from_fn(|i, _| if is_in(i) { T::one() } else { T::zero() })
    }

    /// The state at the SYNC of the measurement. `target` is what was wanted a cycle ago, `free`
    /// whether nothing but the ball touches the floor.
    pub(crate) fn step<R: Robot<T, N, NX, NS>>(
        &mut self,
        measurement: &Measurement,
        target: &Target<T, N, NX, NS>,
        free: bool,
    ) -> State<T, N> {
        let c = T::from_f64;
        let rates: SVector<T, NS> =
            SVector::from_fn(|i, _| T::from_f32(measurement.velocity(NX + i)));
        let shape = rates.map_with_location(|i, _, rate| {
            let sampled = measurement.way(NX + i, 0);
            match measurement.age(NX + i).min(CARRIED) {
                0 => sampled,
                late => sampled + rate * T::from_f32(late.into()) * self.period,
            }
        });
        let mut position = SVector::<T, NX>::from_element(T::zero());
        for (i, (entry, origin)) in position.iter_mut().zip(&self.origin).enumerate() {
            *entry = measurement.way(i, *origin);
        }
        let acceleration = if free {
            target.position[2] - self.response * target.shape[2]
                + self.shape_gain * (shape - target.shape[0])
        } else {
            SVector::from_element(T::zero())
        };
        let measured = position - self.response * shape;
        let [y, rate] = self.estimate.unwrap_or([measured, -(self.response * rates)]);
        let half = c(0.5) * self.period * self.period;
        let mut ahead = y + rate * self.period + acceleration * half;
        let mut rate = rate + acceleration * self.period;
        let [alpha, beta] = self.gains;
        // What did not come is carried on.
        let (fresh, carried) = (Self::mask(measurement, 0, 0), Self::mask(measurement, 1, CARRIED));
        let residual = (measured - ahead).component_mul(&fresh);
        rate += residual * beta;
        ahead += residual * alpha;
        let expected = ahead + self.response * shape;
        position += (expected - position).component_mul(&carried);
        self.estimate = Some([ahead, rate]);
        State {
            q: R::join(&position, &shape),
            qd: R::join(&(rate + self.response * rates), &rates),
        }
    }
}
