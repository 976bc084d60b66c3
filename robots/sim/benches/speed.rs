//! Simulated seconds per second: controller, sensors, and a plant of four steps per period.
//!
//! `cargo bench -p shapebot-sim`

use shapebot_control::{Controller, Gains, Target};
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_sim::{Friction, Moment, Scale, Scenario, Sensors, Table, Timing, World, simulate};
use std::io::Write;
use std::time::Instant;

/// Length of a run, s.
const SECONDS: f64 = 20.0;

fn speed<R, const N: usize, const NX: usize, const NS: usize>(
    name: &str,
    robot: &R,
    design: &ControlDesign,
) where
    R: Robot<f64, N, NX, NS>,
{
    let stand = Moment {
        target: Target::stand([0.0; NX].into()),
        planned: [0.0; NX].into(),
        desired: [[0.0; NX].into(); 2],
    };
    let reference = Table::new(SECONDS, vec![stand; 2]).expect("a table");
    let scale = Scale::of(robot).expect("a scale");
    let friction = Friction { viscous: 0.0, coulomb: 0.01 * scale.force };
    let sensors = Sensors { lean_noise: 1e-4, lean_rate_noise: 1e-3, ..Sensors::default() };
    let scenario =
        Scenario { drive: friction, contact: friction, sensors, ..Scenario::<NX, NS>::default() };
    let gains = Gains::from_design(robot, design).expect("gains");
    let timing = Timing { period: gains.period, after: 0.0, ..Timing::default() };
    let world = World { system: robot, map: robot, scenario: &scenario, timing };
    let mut controller = Controller::new(robot, &gains).expect("a controller");
    let mut fastest = f64::INFINITY;
    for _ in 0..5 {
        controller.reset();
        let begin = Instant::now();
        let run = simulate(&world, &reference, &mut controller).expect("a run");
        fastest = fastest.min(begin.elapsed().as_secs_f64());
        assert!(run.fell.is_none(), "{name} fell: {:?}", run.fell);
    }
    let _ = writeln!(std::io::stdout(), "{name:20} {:8.0} s per s", SECONDS / fastest);
}

macro_rules! speeds {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $({
            use shapebot_generated::$module as module;
            speed($name, &module::$robot::<f64>::from_model(), &module::CONTROL);
        })*
    };
}

fn main() {
    shapebot_generated::for_each_robot!(speeds);
}
