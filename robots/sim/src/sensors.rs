//! What the controller is told of the plant's state.

use crate::Sensors;
use nalgebra::SVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use shapebot_control::State;
use shapebot_dynamics::{Description, Role};
use std::collections::VecDeque;

/// The sensors of a run.
pub(crate) struct SensorSuite<const N: usize, const NS: usize> {
    settings: Sensors<NS>,
    kinds: [Kind; N],
    period: f64,
    noise: ChaCha8Rng,
    /// Counts of the encoders one period before.
    counted: Option<SVector<f64, N>>,
    /// Readings on their way, oldest first.
    on_the_way: VecDeque<State<f64, N>>,
    age: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Position,
    Joint,
    Lean,
}

impl<const N: usize, const NS: usize> SensorSuite<N, NS> {
    pub(crate) fn new(
        settings: Sensors<NS>,
        description: &Description,
        period: f64,
        seed: u64,
    ) -> Self {
        let kind = |i: usize| match description.coordinates.get(i) {
            Some(c) if c.role == Role::Shape && !c.actuated => Kind::Lean,
            Some(c) if c.role == Role::Shape => Kind::Joint,
            _ => Kind::Position,
        };
        Self {
            settings,
            kinds: std::array::from_fn(kind),
            period,
            noise: ChaCha8Rng::seed_from_u64(seed),
            counted: None,
            on_the_way: VecDeque::new(),
            age: (settings.delay / period).round() as usize,
        }
    }

    /// A reading of the state; `lean_offset` is what the floor adds to the lean.
    pub(crate) fn read(
        &mut self,
        state: &State<f64, N>,
        lean_offset: &SVector<f64, N>,
    ) -> State<f64, N> {
        let mut read = *state;
        for i in 0..N {
            match self.kinds[i] {
                Kind::Position => read.q[i] = quantised(state.q[i], self.settings.position_step),
                Kind::Joint => {
                    read.q[i] = quantised(state.q[i], self.settings.joint_step);
                    let shape = i - (N - NS);
                    read.q[i] += self.settings.lean_bias[shape];
                    read.qd[i] += self.settings.lean_rate_bias[shape];
                }
                Kind::Lean => self.read_lean(&mut read, lean_offset, i),
            }
        }
        if self.settings.position_step > 0.0 {
            let before = self.counted.replace(read.q).unwrap_or(read.q);
            for i in (0..N).filter(|&i| self.kinds[i] == Kind::Position) {
                read.qd[i] = (read.q[i] - before[i]) / self.period;
            }
        }
        self.delayed(read)
    }

    fn read_lean(&mut self, read: &mut State<f64, N>, lean_offset: &SVector<f64, N>, i: usize) {
        let shape = i - (N - NS);
        let [angle, rate]: [f64; 2] =
            std::array::from_fn(|_| StandardNormal.sample(&mut self.noise));
        read.q[i] +=
            lean_offset[i] + self.settings.lean_bias[shape] + self.settings.lean_noise * angle;
        read.qd[i] += self.settings.lean_rate_bias[shape] + self.settings.lean_rate_noise * rate;
    }

    fn delayed(&mut self, read: State<f64, N>) -> State<f64, N> {
        self.on_the_way.push_back(read);
        if self.on_the_way.len() > self.age + 1 {
            self.on_the_way.pop_front();
        }
        *self.on_the_way.front().unwrap_or(&read)
    }
}

fn quantised(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::{SensorSuite, quantised};
    use crate::Sensors;
    use nalgebra::{SVector, Vector1, Vector2};
    use shapebot_control::State;
    use shapebot_dynamics::{Coordinate, Description, Role};

    const fn coordinate(role: Role, actuated: bool) -> Coordinate {
        Coordinate { name: "c", unit: "rad", role, actuated, lower: -1.0, upper: 1.0 }
    }

    static DESCRIPTION: Description = Description {
        name: "r",
        summary: "",
        coordinates: &[coordinate(Role::Position, true), coordinate(Role::Shape, false)],
        position_count: 1,
        shape_sets: &[],
        actuators: &[],
        parameters: &[],
        outputs: &[],
        output_unit: "m",
        frames: &[],
        points: &[],
        geometry: &[],
        friction: &[],
    };

    fn suite(settings: Sensors<1>, seed: u64) -> SensorSuite<2, 1> {
        SensorSuite::new(settings, &DESCRIPTION, 0.002, seed)
    }

    fn state(x: f64, v: f64) -> State<f64, 2> {
        State { q: Vector2::new(x, 0.0), qd: Vector2::new(v, 0.0) }
    }

    #[test]
    fn without_settings_the_state_is_read_as_it_is() {
        let mut sensors = suite(Sensors::default(), 1);
        let truth = State { q: Vector2::new(0.1, 0.2), qd: Vector2::new(0.3, 0.4) };
        assert_eq!(sensors.read(&truth, &SVector::zeros()), truth);
    }

    #[test]
    fn noise_has_its_deviation_and_follows_the_seed() {
        let settings =
            Sensors { lean_noise: 0.01, lean_bias: Vector1::new(0.5), ..Default::default() };
        let values = |seed| -> Vec<f64> {
            let mut sensors = suite(settings, seed);
            (0..4000).map(|_| sensors.read(&state(0.0, 0.0), &SVector::zeros()).q[1]).collect()
        };
        let first = values(7);
        assert_eq!(first, values(7));
        assert_ne!(first, values(8));
        let mean = first.iter().sum::<f64>() / 4000.0;
        let deviation = (first.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 4000.0).sqrt();
        assert!((mean - 0.5).abs() < 1e-3 && (deviation - 0.01).abs() < 5e-4, "{mean} {deviation}");
    }

    #[test]
    fn delay_hands_out_what_was_read_before() {
        let mut sensors = suite(Sensors { delay: 0.006, ..Default::default() }, 1);
        let read: Vec<f64> = (0..6)
            .map(|k| sensors.read(&state(f64::from(k), 0.0), &SVector::zeros()).q[0])
            .collect();
        assert_eq!(read, [0.0, 0.0, 0.0, 0.0, 1.0, 2.0]);
    }

    #[test]
    fn rates_of_counts_are_their_differences() {
        let mut sensors = suite(Sensors { position_step: 0.01, ..Default::default() }, 1);
        let mut rate = |x: f64| sensors.read(&state(x, 9.0), &SVector::zeros()).qd[0];
        assert_eq!([rate(0.0), rate(0.004), rate(0.012)], [0.0, 0.0, 5.0]);
    }

    #[test]
    fn counts_are_multiples_of_the_step() {
        assert_eq!(quantised(0.37, 0.25), 0.25);
        assert_eq!(quantised(0.38, 0.25), 0.5);
        assert_eq!(quantised(0.37, 0.0), 0.37);
    }
}
