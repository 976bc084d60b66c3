//! Scenarios drawn at random. Draw `index` of `seed` is the same by itself as among others.

use crate::scale::Scale;
use crate::{Floor, Friction, Push, Scenario, Sensors};
use nalgebra::{SVector, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use shapebot_dynamics::{Description, Parameter};

/// Half widths of what is drawn, most of them relative to the robot's [`Scale`]. Angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranges {
    /// Relative change of parameters that are masses or moments of inertia, each by itself.
    pub inertia: f64,
    /// Largest dry friction, drive and contact together, of the scale's force.
    pub coulomb: f64,
    /// Largest viscous friction, of force times time per coordinate's length.
    pub viscous: f64,
    /// Largest delay, of the scale's time; drawn for actuation and sensing together.
    pub delay: f64,
    /// Largest noise of the lean.
    pub lean_noise: f64,
    /// Largest noise of the lean rate, in radians per unit of the scale's time.
    pub lean_rate_noise: f64,
    /// Largest bias of the lean.
    pub bias: f64,
    /// Counts of the encoders per unit of the scale's length; 0 for none.
    pub counts: f64,
    /// Largest slope.
    pub slope: f64,
    /// Largest distance from the start of the plan, of the scale's length.
    pub start_position: f64,
    /// Largest lean beside the plan's at the start.
    pub start_lean: f64,
    /// Largest push: change of the output's speed if it were free, of length per time.
    pub push: f64,
}

impl Default for Ranges {
    /// What the 70 kg ballbot of the literature is tried with, in its own units: ±20 %, 2 N·m + 0.3
    /// N·m·s, 6 ms, 0.05° and 0.3°/s, 0.5°, 4096 counts, 2° of slope, 10 cm and 2°, no pushes.
    fn default() -> Self {
        Self {
            inertia: 0.2,
            coulomb: 0.028,
            viscous: 0.14,
            delay: 0.0173,
            lean_noise: 0.05_f64.to_radians(),
            lean_rate_noise: 0.1_f64.to_radians(),
            bias: 0.5_f64.to_radians(),
            counts: 6600.0,
            slope: 2.0_f64.to_radians(),
            start_position: 0.093,
            start_lean: 2.0_f64.to_radians(),
            push: 0.0,
        }
    }
}

/// A run to make.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw<const NX: usize, const NS: usize> {
    /// What happens.
    pub scenario: Scenario<NX, NS>,
    /// Parameters of the plant that differ from the model's, in their declared ranges.
    pub parameters: Vec<(&'static str, f64)>,
}

/// Units of parameters that [`Ranges::inertia`] changes.
const INERTIAS: [&str; 2] = ["kg", "kg*m^2"];

/// Draw `index` of the sequence that `seed` begins, for a motion of `duration` seconds.
#[must_use]
pub fn draw<const NX: usize, const NS: usize>(
    description: &Description,
    scale: &Scale,
    ranges: &Ranges,
    duration: f64,
    [seed, index]: [u64; 2],
) -> Draw<NX, NS> {
    let mut source = ChaCha8Rng::seed_from_u64(seed);
    source.set_stream(index);
    let mut numbers = Numbers(source);
    let inertias = description.parameters.iter().filter(|p| INERTIAS.contains(&p.unit));
    let parameters = inertias.map(|p| (p.name, numbers.changed(p, ranges.inertia))).collect();
    let share = numbers.unit();
    let friction = Friction {
        coulomb: ranges.coulomb * scale.force * numbers.unit(),
        viscous: ranges.viscous * scale.force * scale.time / (scale.length / scale.output)
            * numbers.unit(),
    };
    let part = |share: f64| Friction {
        coulomb: friction.coulomb * share,
        viscous: friction.viscous * share,
    };
    let delay = ranges.delay * scale.time * numbers.unit();
    let sensed = numbers.unit();
    let slope = numbers.disc(ranges.slope);
    let mut scenario = Scenario {
        drive: part(share),
        contact: part(1.0 - share),
        floor: Floor { slope, ..Floor::default() },
        actuation_delay: delay * (1.0 - sensed),
        sensors: sensors(&mut numbers, description, scale, ranges),
        start_position: numbers.ball(ranges.start_position * scale.length / scale.output),
        seed: numbers.0.next_u64(),
        ..Scenario::default()
    };
    scenario.sensors.delay = delay * sensed;
    for (index, lean) in leaning(description).into_iter().zip(numbers.list(ranges.start_lean)) {
        scenario.start_shape[index] = lean;
    }
    if ranges.push > 0.0 {
        scenario.pushes.push(push(&mut numbers, description, scale, ranges, duration));
    }
    Draw { scenario, parameters }
}

/// Indices in q_s of what an inertial unit measures; of the whole shape where all is actuated.
fn leaning(description: &Description) -> Vec<usize> {
    let leaning: Vec<usize> = description.unactuated_shape().collect();
    if leaning.is_empty() { (0..description.shape_coordinates().len()).collect() } else { leaning }
}

fn sensors<const NS: usize>(
    numbers: &mut Numbers,
    description: &Description,
    scale: &Scale,
    ranges: &Ranges,
) -> Sensors<NS> {
    let mut sensors = Sensors {
        lean_noise: ranges.lean_noise * numbers.unit(),
        lean_rate_noise: ranges.lean_rate_noise / scale.time * numbers.unit(),
        position_step: match ranges.counts {
            counts if counts > 0.0 => scale.length / scale.output / counts,
            _ => 0.0,
        },
        ..Sensors::default()
    };
    for (index, bias) in leaning(description).into_iter().zip(numbers.list(ranges.bias)) {
        sensors.lean_bias[index] = bias;
    }
    sensors
}

/// A tenth of the scale's time long, somewhere in the motion, horizontal, at any point.
fn push(
    numbers: &mut Numbers,
    description: &Description,
    scale: &Scale,
    ranges: &Ranges,
    duration: f64,
) -> Push {
    let long = 0.1 * scale.time;
    let [x, y] = numbers.disc(ranges.push * scale.inertia * scale.length / scale.time / long);
    Push {
        point: numbers.0.random_range(0..description.points.len().max(1)),
        force: Vector3::new(x, y, 0.0),
        start: numbers.unit() * duration,
        duration: long,
    }
}

struct Numbers(ChaCha8Rng);

impl Numbers {
    /// From 0 to 1.
    fn unit(&mut self) -> f64 {
        self.0.random()
    }

    /// From −1 to 1.
    fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Endless numbers of at most this magnitude.
    fn list(&mut self, reach: f64) -> [f64; 16] {
        std::array::from_fn(|_| reach * self.signed())
    }

    /// Even over a disc.
    fn disc(&mut self, radius: f64) -> [f64; 2] {
        let (r, angle) = (radius * self.unit().sqrt(), std::f64::consts::TAU * self.unit());
        [r * angle.cos(), r * angle.sin()]
    }

    /// In a ball: a direction of the cube, a length of its own.
    fn ball<const L: usize>(&mut self, radius: f64) -> SVector<f64, L> {
        let direction = SVector::<f64, L>::from_fn(|_, _| self.signed());
        direction / direction.norm().max(1e-9) * (radius * self.unit())
    }

    /// A parameter in its declared range.
    fn changed(&mut self, parameter: &Parameter, part: f64) -> f64 {
        let value = parameter.value * (1.0 + part * self.signed());
        value.clamp(parameter.lower, parameter.upper)
    }
}
