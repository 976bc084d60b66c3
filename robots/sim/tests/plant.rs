//! The plant against physics: energy, momentum, forces computed by hand, another integrator.

use nalgebra::{SVector, Vector2, Vector3};
use rkf78::{IntegrationConfig, OdeSystem, Rkf78, Tolerances};
use shapebot_control::State;
use shapebot_dynamics::{LagrangianSystem, Robot};
use shapebot_generated::ballbot_planar::BallbotPlanar;
use shapebot_generated::ballbot3d::Ballbot3d;
use shapebot_generated::cartpole_planar::{CartpolePlanar, Params as CartpoleParams};
use shapebot_generated::cartpole3d::Cartpole3d;
use shapebot_generated::marble_maze::MarbleMaze;
use shapebot_generated::marble_maze_full::MarbleMazeFull;
use shapebot_sim::{Error, Floor, Friction, Plant, Push, Scale, Scenario, Weights};

/// A state off the origin, well within the ranges.
fn somewhere<const N: usize>(system: &dyn LagrangianSystem<f64, N>) -> State<f64, N> {
    let coordinates = system.description().coordinates;
    let part = |i: usize| (1.0 + 0.8 * i as f64).cos();
    State {
        q: SVector::from_fn(|i, _| 0.3 * part(i) * coordinates[i].upper.min(1.0)),
        qd: SVector::from_fn(|i, _| 0.4 * part(i + 3) * coordinates[i].upper.min(1.0)),
    }
}

fn energy<const N: usize>(system: &dyn LagrangianSystem<f64, N>, state: &State<f64, N>) -> f64 {
    system.kinetic_energy(&state.q, &state.qd) + system.potential_energy(&state.q)
}

/// Largest change of energy over its kinetic part in 0.4 s.
fn drift<R, const N: usize, const NX: usize, const NS: usize>(robot: &R, step: f64) -> f64
where
    R: Robot<f64, N, NX, NS>,
{
    let scenario = Scenario::<NX, NS>::default();
    let plant = Plant::new(robot, robot, &scenario, step).expect("a plant");
    let mut state = somewhere(robot);
    let (start, mut kinetic, mut worst) = (energy(robot, &state), 0.0_f64, 0.0_f64);
    for k in 0..(0.4 / step).round() as usize {
        state = plant.advance(k as f64 * step, &state, &SVector::zeros());
        kinetic = kinetic.max(robot.kinetic_energy(&state.q, &state.qd));
        worst = worst.max((energy(robot, &state) - start).abs());
    }
    worst / kinetic
}

/// Friction that fits the robot's size.
fn friction<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    viscous: f64,
    coulomb: f64,
) -> Friction
where
    R: Robot<f64, N, NX, NS>,
{
    let scale = Scale::of(robot).expect("a scale");
    let rate = scale.length / scale.time / scale.output;
    Friction { viscous: viscous * scale.force / rate, coulomb: coulomb * scale.force }
}

/// Energy lost equals what dissipation and friction took.
fn balance<R, const N: usize, const NX: usize, const NS: usize>(name: &str, robot: &R)
where
    R: Robot<f64, N, NX, NS>,
{
    const STEP: f64 = 2e-5;
    let scenario = Scenario::<NX, NS> {
        drive: friction(robot, 0.05, 0.05),
        contact: friction(robot, 0.03, 0.03),
        ..Scenario::default()
    };
    let plant = Plant::new(robot, robot, &scenario, STEP).expect("a plant");
    let mut state = somewhere(robot);
    let start = energy(robot, &state);
    let power = |state: &State<f64, N>| plant.disturbance(0.0, state).dot(&state.qd);
    let mut work = 0.0;
    for k in 0..2000 {
        let before = power(&state);
        let half = Plant::new(robot, robot, &scenario, STEP / 2.0).expect("a plant");
        let middle = power(&half.advance(k as f64 * STEP, &state, &SVector::zeros()));
        state = plant.advance(k as f64 * STEP, &state, &SVector::zeros());
        work += STEP / 6.0 * (before + 4.0 * middle + power(&state));
    }
    let lost = energy(robot, &state) - start;
    assert!(work < 0.0, "{name}: friction gave {work} J");
    assert!((lost - work).abs() < 1e-4 * work.abs(), "{name}: lost {lost}, work {work}");
}

struct Smooth<'a, R, const N: usize, const NX: usize, const NS: usize> {
    plant: &'a Plant<'a, N, NX, NS>,
    robot: &'a R,
}

/// Forces that swing, to have something to integrate.
fn drive<const N: usize>(system: &dyn LagrangianSystem<f64, N>, time: f64) -> SVector<f64, N> {
    let mut force = SVector::zeros();
    for (index, actuator) in system.description().actuators.iter().enumerate() {
        let swing = 0.02 * actuator.limit * (7.0 * time + index as f64).sin();
        force += system.input_column(&SVector::zeros(), index) * swing;
    }
    force
}

/// y is q, then q̇; `N2` is twice `N`.
impl<R, const N: usize, const NX: usize, const NS: usize, const N2: usize> OdeSystem<f64, N2>
    for Smooth<'_, R, N, NX, NS>
where
    R: LagrangianSystem<f64, N>,
{
    fn rhs(&self, time: f64, y: &[f64; N2], dy: &mut [f64; N2]) {
        let (q, qd) = y.split_at(N);
        let state = State { q: SVector::from_column_slice(q), qd: SVector::from_column_slice(qd) };
        let acceleration = self.plant.acceleration(time, &state, &drive(self.robot, time));
        dy[..N].copy_from_slice(qd);
        dy[N..].copy_from_slice(acceleration.as_slice());
    }
}

/// The adaptive method of order eight takes the forces as they swing; ours holds them over short steps,
/// and comes closer with the square of the step.
fn agrees_with_an_adaptive_method<
    R,
    const N: usize,
    const NX: usize,
    const NS: usize,
    const N2: usize,
>(
    name: &str,
    robot: &R,
) where
    R: Robot<f64, N, NX, NS>,
{
    const STEP: f64 = 0.0005;
    let drag = friction(robot, 0.1, 0.0);
    let scenario = Scenario::<NX, NS> { drive: drag, contact: drag, ..Scenario::default() };
    let plant = Plant::new(robot, robot, &scenario, STEP).expect("a plant");
    let start = somewhere(robot);
    let joined: Vec<f64> = start.q.iter().chain(&start.qd).copied().collect();
    let joined: [f64; N2] = joined.try_into().expect("positions and rates");
    let smooth = Smooth { plant: &plant, robot };
    let mut adaptive = Rkf78::new(Tolerances::new(1e-13, 1e-11));
    let (_, end) = adaptive
        .integrate(&smooth, &IntegrationConfig::new(0.0, 0.2, STEP), &joined)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    // Ours with the drive's force taken at the middle of ever shorter steps: second order in them.
    let ours = |step: f64| {
        let plant = Plant::new(robot, robot, &scenario, step).expect("a plant");
        let mut state = start;
        for k in 0..(0.2 / step).round() as usize {
            let time = k as f64 * step;
            state = plant.advance(time, &state, &drive(robot, time + 0.5 * step));
        }
        SVector::<f64, N>::from_fn(|i, _| state.q[i] - end[i]).norm()
    };
    let (coarse, fine) = (ours(STEP), ours(STEP / 4.0));
    let size = 1.0 + (0..N).map(|i| end[i].abs()).sum::<f64>();
    assert!(coarse < 1e-5 * size, "{name}: {coarse:e}");
    assert!(fine < coarse / 12.0 || fine < 1e-10 * size, "{name}: {coarse:e}, then {fine:e}");
}

macro_rules! every_robot {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        #[test]
        fn without_friction_energy_stays() {
            $({
                use shapebot_generated::$module as module;
                let mut parameters = module::Params::<f64>::model();
                for parameter in module::DESCRIPTION.parameters {
                    if ["N*m*s", "N*s/m"].contains(&parameter.unit) {
                        parameters.set(parameter.name, 0.0);
                    }
                }
                let robot = module::$robot::try_new(parameters).expect("no friction");
                let (coarse, fine) = (drift(&robot, 0.001), drift(&robot, 0.0005));
                assert!(fine < 1e-7, "{}: {fine:e}", $name);
                assert!(fine < coarse / 12.0 || fine < 1e-12, "{}: {coarse:e}, {fine:e}", $name);
            })*
        }

        #[test]
        fn energy_lost_is_the_work_of_friction() {
            $(balance($name, &shapebot_generated::$module::$robot::<f64>::from_model());)*
        }

        #[test]
        fn the_fixed_step_agrees_with_an_adaptive_integrator() {
            $(agrees_with_an_adaptive_method::<_, $n, $nx, $ns, { 2 * $n }>(
                $name,
                &shapebot_generated::$module::$robot::<f64>::from_model(),
            );)*
        }
    };
}

shapebot_generated::for_each_robot!(every_robot);

#[test]
fn a_ball_that_does_not_roll_feels_no_floor() {
    let robot = BallbotPlanar::<f64>::from_model();
    let contact = Friction { viscous: 0.3, coulomb: 2.0 };
    let scenario = Scenario { contact, ..Scenario::default() };
    let plant = Plant::<2, 1, 1>::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let own = |qd: Vector2<f64>| {
        let state = State { q: Vector2::new(0.0, 0.1), qd };
        plant.disturbance(0.0, &state) - robot.dissipative_force(&state.q, &qd)
    };
    // The ball turns with theta + phi.
    assert!(own(Vector2::new(2.0, -2.0)).norm() < 1e-12);
    let rolling = own(Vector2::new(3.0, 1.0));
    assert!((rolling - Vector2::new(-3.2, -3.2)).norm() < 1e-5, "{rolling}");
}

#[test]
fn dry_friction_holds_a_cart_up_to_its_level() {
    let mut parameters = CartpoleParams::<f64>::model();
    parameters.set("b_x", 0.0);
    let robot = CartpolePlanar::try_new(parameters).expect("a cart");
    let drive = Friction { viscous: 0.0, coulomb: 2.0 };
    let scenario = Scenario { drive, ..Scenario::default() };
    let plant = Plant::<2, 1, 1>::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let moved = |force: f64| {
        let mut state = State { q: Vector2::zeros(), qd: Vector2::zeros() };
        for k in 0..100 {
            state = plant.advance(k as f64 * 0.0005, &state, &Vector2::new(force, 0.0));
        }
        state.q[0]
    };
    assert!(moved(1.9).abs() < 2e-4, "{} m", moved(1.9));
    // What is above the level moves the cart: 1 kg, and the pole hardly resists at first.
    let free = 0.5 * (3.0 - 2.0) * 0.05_f64.powi(2);
    assert!((moved(3.0) - free).abs() < 0.1 * free, "{} m, {free} m", moved(3.0));
}

#[test]
fn a_push_gives_its_impulse() {
    let mut parameters = shapebot_generated::cartpole3d::Params::<f64>::model();
    parameters.set("b_x", 0.0);
    let robot = Cartpole3d::try_new(parameters).expect("a cart");
    let points = robot.description().points;
    let point = points.iter().position(|name| *name == "head").expect("a head");
    let force = Vector3::new(3.0, -2.0, 0.0);
    let push = Push { point, force, start: 0.1, duration: 0.2 };
    let scenario = Scenario { pushes: vec![push], ..Scenario::default() };
    let plant = Plant::<4, 2, 2>::new(&robot, &robot, &scenario, 0.001).expect("a plant");
    let mut state = State { q: SVector::zeros(), qd: SVector::zeros() };
    for k in 0..400 {
        // Half a step off, so that beginning and end do not hang on rounding.
        state = plant.advance((k as f64 + 0.5) * 0.001, &state, &SVector::zeros());
    }
    // Positions are cyclic and nothing else acts along them: their momenta are the impulse.
    let momentum = robot.mass_matrix(&state.q) * state.qd;
    let impulse = force * 0.2;
    assert!((momentum[0] - impulse.x).abs() < 1e-2 * impulse.norm(), "{momentum}");
    assert!((momentum[1] - impulse.y).abs() < 1e-2 * impulse.norm(), "{momentum}");
}

#[test]
fn a_slope_pulls_down_with_the_weight() {
    let robot = Ballbot3d::<f64>::from_model();
    let points = robot.description().points;
    let center = points.iter().position(|name| *name == "center").expect("a center");
    let (angle, ball) = (2.0_f64.to_radians(), 2.44 * 9.81);
    let scenario = Scenario {
        floor: Floor::rising(angle),
        weights: vec![(center, ball)],
        ..Scenario::default()
    };
    let plant = Plant::<4, 2, 2>::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let weights = Weights::of(&robot, &scenario.weights).expect("weights");
    assert!((weights.rigid - 70.3 * 9.81).abs() < 1e-4, "{weights:?}");
    let rest = State { q: SVector::zeros(), qd: SVector::zeros() };
    let force = plant.disturbance(0.0, &rest);
    let along = -(70.3 * 9.81 + ball) * angle.sin();
    // Upright, theta.x and phi.y both roll the ball along x; phi.y also tips the body.
    let tipping = -70.3 * 9.81 * angle.sin() * 0.87;
    let expected = SVector::from([along * 0.1058, 0.0, 0.0, along * 0.1058 + tipping]);
    assert!((force - expected).norm() < 1e-6, "{force} {expected}");
    // Leaning by the angle of the slope it stands upright in gravity: nothing tips it.
    let upright = State { q: SVector::from([0.0, 0.0, 0.0, angle]), qd: SVector::zeros() };
    let tip = plant.disturbance(0.0, &upright) - robot.gravity(&upright.q);
    assert!((tip[3] - along * 0.1058).abs() < 1e-6, "{tip}");
}

#[test]
fn slopes_are_refused_where_the_weight_is_not_known() {
    let scenario = Scenario { floor: Floor::rising(0.01), ..Scenario::default() };
    let textbook = MarbleMaze::<f64>::from_model();
    let refused = Plant::<4, 2, 2>::new(&textbook, &textbook, &scenario, 0.001);
    assert!(matches!(refused.map(|_| ()), Err(Error::NotWeight { .. })));
    let full = MarbleMazeFull::<f64>::from_model();
    let weights = Weights::of(&full, &[]).expect("weights");
    assert!((weights.rigid - 0.5084 * 9.81).abs() < 1e-6, "{weights:?}");
    assert!(Plant::<4, 2, 2>::new(&full, &textbook, &scenario, 0.001).is_ok());
}

#[test]
fn the_full_maze_is_the_textbook_for_slow_tilting() {
    let (textbook, full) = (MarbleMaze::<f64>::from_model(), MarbleMazeFull::<f64>::from_model());
    // Plates that stand still: the marble runs with 5/7 g sin(beta) in both.
    let q = SVector::from([0.02, -0.03, 0.0, 0.1]);
    let hold = |system: &dyn LagrangianSystem<f64, 4>| {
        let mut acceleration = SVector::<f64, 4>::zeros();
        // The force on the plate that leaves it at rest.
        let mass = system.mass_matrix(&q);
        let free = mass.fixed_view::<2, 2>(0, 0).try_inverse().expect("masses")
            * -system.gravity(&q).fixed_rows::<2>(0);
        acceleration.fixed_rows_mut::<2>(0).copy_from(&free);
        acceleration
    };
    let (a, b): (SVector<f64, 4>, SVector<f64, 4>) = (hold(&textbook), hold(&full));
    assert!((a[0] - 5.0 / 7.0 * 9.81 * 0.1_f64.sin()).abs() < 1e-9, "{a}");
    assert!((a - b).norm() < 1e-9, "{a} {b}");
    // While it turns the marble is thrown outward: + x beta'^2, which the textbook drops.
    let (qd, held) = (SVector::from([0.0, 0.0, 0.0, 2.0]), SVector::from([0.0; 4]));
    let thrown = full.inverse_dynamics(&q, &qd, &held)[0] - full.gravity(&q)[0];
    assert!((thrown + 0.0084 * 0.02 * 4.0).abs() < 1e-9, "{thrown}");
}

#[test]
fn actuators_give_no_more_than_their_limit() {
    let robot = BallbotPlanar::<f64>::from_model();
    let scenario = Scenario { strength: 0.5, ..Scenario::default() };
    let plant = Plant::<2, 1, 1>::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let q = Vector2::zeros();
    let asked = Vector2::new(-80.0, 0.0);
    assert_eq!(plant.actuate(&q, &Vector2::zeros(), &asked), Vector2::new(-30.0, 0.0));
}

#[test]
fn what_is_not_possible_is_refused() {
    let robot = BallbotPlanar::<f64>::from_model();
    let refused = |scenario: Scenario<1, 1>| {
        Plant::<2, 1, 1>::new(&robot, &robot, &scenario, 0.0005).map(|_| ()).unwrap_err()
    };
    let push = Push { point: 99, force: Vector3::zeros(), start: 0.0, duration: 1.0 };
    let far = refused(Scenario { pushes: vec![push], ..Scenario::default() });
    assert!(matches!(far, Error::Point { index: 99, .. }), "{far}");
    let drive = Friction { viscous: -1.0, coulomb: 0.0 };
    let negative = refused(Scenario { drive, ..Scenario::default() });
    assert!(matches!(negative, Error::Invalid { .. }), "{negative}");
}
