mod common;
use common::*;
use nalgebra::SVector;
use shapebot_control::{Gains, State};
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;

fn look<R, const N: usize, const NX: usize, const NS: usize>(
    name: &str,
    robot: &R,
    design: &ControlDesign,
) where
    R: Robot<f64, N, NX, NS>,
{
    let f = &design.figures;
    println!(
        "== {name} kp {:?} kd {:?} ki {:?} kx {:?} kv {:?} obs {} off {}",
        design.lean,
        design.lean_rate,
        design.lean_integral,
        design.position,
        design.velocity,
        design.observer_rate,
        design.offset_rate
    );
    println!(
        "   decay {} damping {} delay {} | worst {} {} {} | {:?} together {} samples {}",
        f.decay,
        f.damping,
        f.delay_margin,
        f.worst_decay,
        f.worst_damping,
        f.worst_delay_margin,
        f.ranges.first(),
        f.together,
        f.samples
    );
    let base = Gains::from_design(robot, design).unwrap();
    let c = robot.description().coordinates;
    let reach = (c[0].upper * 0.5 * robot.output_jacobian_position()[(0, 0)]).min(2.0);
    let plan = travel(robot, reach, 5.0, 8.0);
    let still = State { q: SVector::zeros(), qd: SVector::zeros() };
    let nominal = World::default();
    let deg = 1f64.to_radians();
    let show = |what: &str, r: Run<NX>| {
        println!(
            "{what:10} rmse {:.2e} end {:.2e} max {:.2e} comp {:.3}deg force {:.3} lean {:.2}deg",
            r.rmse,
            r.end,
            r.largest,
            r.compensation / deg,
            r.force,
            r.lean / deg
        )
    };
    let r = run(robot, robot, &base, &plan, still, &nominal);
    show("nominal", r);
    let limit = robot.description().actuators[0].limit;
    let r = run(
        robot,
        robot,
        &base,
        &plan,
        still,
        &World { drive: [0.3 / 60.0 * limit, 2.0 / 60.0 * limit], ..nominal },
    );
    show("friction", r);
    let mut g = base;
    g.observer = false;
    let r = run(
        robot,
        robot,
        &g,
        &plan,
        still,
        &World { drive: [0.3 / 60.0 * limit, 2.0 / 60.0 * limit], ..nominal },
    );
    show("no obs", r);
    let r = run(robot, robot, &base, &plan, still, &World { delay: 3, ..nominal });
    show("delay", r);
    let mut bias = SVector::zeros();
    for i in 0..NX {
        bias[N - NX + i] = 0.5 * deg;
    }
    let r = run(robot, robot, &base, &plan, still, &World { bias, ..nominal });
    show("bias", r);
    let mut start = still;
    for i in 0..NX {
        start.q[N - NX + i] = 2.0 * deg;
    }
    start.q[0] = reach / 20.0 / robot.output_jacobian_position()[(0, 0)];
    let r = run(robot, robot, &base, &plan[..3500], start, &nominal);
    show("start", r);
}

macro_rules! all {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(look::<_, $n, $nx, $ns>($name, &shapebot_generated::$module::$robot::<f64>::from_model(), &shapebot_generated::$module::CONTROL);)*
    };
}

#[test]
fn look_at_all() {
    shapebot_generated::for_each_robot!(all);
}
