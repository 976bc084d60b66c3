//! The controller along a motion near the origin.

use super::random::Random;
use super::text::{array, list};
use crate::Error;
use nalgebra::SVector;
use shapebot_control::{Controller, Gains, State, Target};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{Real, Robot};

/// Steps.
const STEPS: u32 = 200;

/// Steps after which another place is wanted.
const MOVED: u32 = 100;

/// Amplitudes of position and shape: small enough that forces stay away from their limits.
const AMPLITUDES: [f64; 2] = [0.05, 0.005];

const KIND: &str =
    "/// A step of the controller: measured state, wanted position, forces of the actuators.
#[derive(Debug)]
pub struct Step {
    pub q: &'static [f64],
    pub qd: &'static [f64],
    pub wanted: &'static [f64],
    pub actuator: &'static [f64],
    pub compensation: &'static [f64],
}

";

/// The items of the vectors' module.
pub(crate) fn record<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    period_us: u32,
) -> Result<String, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let period = f64::from(period_us) * 1e-6;
    let mut gains = Gains::from_design(robot, design)?;
    gains.period = period;
    let mut controller = Controller::new(robot, &gains)?;
    let mut random = Random::new();
    // Each coordinate swings: amplitude, rate, phase.
    let swings: [[f64; 3]; N] = core::array::from_fn(|i| {
        let amplitude = AMPLITUDES[usize::from(i >= NX)];
        [random.between(-amplitude, amplitude), random.between(1.0, 4.0), random.between(0.0, 3.0)]
    });
    let mut entries = Vec::new();
    for step in 0..STEPS {
        let time = f64::from(step) * period;
        let at = swings.map(|[amplitude, rate, phase]| {
            let (sin, cos) = Real::sin_cos(rate * time + phase);
            [amplitude * sin, amplitude * rate * cos]
        });
        let state: State<f64, N> =
            State { q: SVector::from(at.map(|[q, _]| q)), qd: SVector::from(at.map(|[_, qd]| qd)) };
        let wanted = if step < MOVED { 0.0 } else { 0.02 };
        let wanted = SVector::<f64, NX>::from_element(wanted);
        let command = controller.step(&state, &Target::stand(wanted));
        entries.push(format!(
            "Step {{ q: &{}, qd: &{}, wanted: &{}, actuator: &{}, compensation: &{} }},",
            array(&state.q),
            array(&state.qd),
            array(&wanted),
            array(&command.actuator),
            array(&command.compensation)
        ));
    }
    let docs = "The controller on the interpreted robot, one step after the other.";
    Ok(KIND.to_owned() + &list(docs, "STEPS", "Step", &entries))
}
