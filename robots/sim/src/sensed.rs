//! What sensors say of shape coordinates, without memory: for simulations with clocks of their own.

use crate::Plant;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use shapebot_control::State;
use shapebot_dynamics::Role;

impl<const N: usize, const NX: usize, const NS: usize> Plant<'_, N, NX, NS> {
    /// The state with the errors that the scenario gives to sensors of shape coordinates: bias, what a
    /// floor that is not level adds to a lean, and noise that depends on seed and time alone. Counts and
    /// delay are those of the sensors' nodes.
    #[must_use]
    pub fn sensed(&self, time: f64, state: &State<f64, N>) -> State<f64, N> {
        let (sensors, mut sensed) = (&self.scenario().sensors, *state);
        let seed = self.scenario().seed.wrapping_add(time.to_bits());
        let mut noise = ChaCha8Rng::seed_from_u64(seed);
        let offset = self.lean_offset(&state.q);
        for (i, coordinate) in self.system().description().coordinates.iter().enumerate() {
            let Some(shape) = i.checked_sub(NX).filter(|shape| *shape < NS) else { continue };
            sensed.q[i] += sensors.lean_bias[shape];
            sensed.qd[i] += sensors.lean_rate_bias[shape];
            if coordinate.role == Role::Shape && !coordinate.actuated {
                let [angle, rate]: [f64; 2] =
                    std::array::from_fn(|_| StandardNormal.sample(&mut noise));
                sensed.q[i] += offset[i] + sensors.lean_noise * angle;
                sensed.qd[i] += sensors.lean_rate_noise * rate;
            }
        }
        sensed
    }
}
