//! A robot that somebody wrote by hand is a robot like any other.

use shapebot_dynamics::nalgebra::{Matrix1, Matrix2, SMatrix, Vector1, Vector2, Vector3};
use shapebot_dynamics::{
    Actuator, Coordinate, Description, LagrangianSystem, Real, Response, Robot, Role,
    ShapeAccelerated, ShapeSet,
};
use shapebot_generated::cartpole_planar::CartpolePlanar;
use shapebot_planner::{Task, motion::Line, plan};
use shapebot_tests::checks;
use shapebot_tests::dual::Dual;

/// Cart of 1 kg, point mass of 0.1 kg on a massless pole of 0.5 m; friction of the track.
struct CartPole;

const CART: f64 = 1.0;
const MASS: f64 = 0.1;
const LENGTH: f64 = 0.5;
const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.1;

const fn coordinate(name: &'static str, unit: &'static str, role: Role, limit: f64) -> Coordinate {
    let actuated = matches!(role, Role::Position);
    Coordinate { name, unit, role, actuated, lower: -limit, upper: limit }
}

static DESCRIPTION: Description = Description {
    name: "cartpole_by_hand",
    summary: "A cart with a pole, written by hand",
    coordinates: &[
        coordinate("x", "m", Role::Position, 10.0),
        coordinate("phi", "rad", Role::Shape, std::f64::consts::FRAC_PI_3),
    ],
    position_count: 1,
    shape_sets: &[ShapeSet { name: "phi", first: 0, len: 1, actuated: false }],
    actuators: &[Actuator { name: "f_x", unit: "N", limit: 20.0 }],
    parameters: &[],
    outputs: &["x"],
    output_unit: "m",
    frames: &["world"],
    points: &["head"],
    geometry: &[],
    friction: &[],
};

fn c<T: Real>(value: f64) -> T {
    T::from_f64(value)
}

impl<T: Real> LagrangianSystem<T, 2> for CartPole {
    fn mass_matrix(&self, q: &Vector2<T>) -> Matrix2<T> {
        let coupling = c::<T>(MASS * LENGTH) * q[1].sin_cos().1;
        Matrix2::new(c(CART + MASS), coupling, coupling, c(MASS * LENGTH * LENGTH))
    }
    fn coriolis_matrix(&self, q: &Vector2<T>, qd: &Vector2<T>) -> Matrix2<T> {
        let entry = -c::<T>(MASS * LENGTH) * q[1].sin_cos().0 * qd[1];
        Matrix2::new(c(0.0), entry, c(0.0), c(0.0))
    }
    fn coriolis_vector(&self, q: &Vector2<T>, qd: &Vector2<T>) -> Vector2<T> {
        self.coriolis_matrix(q, qd) * qd
    }
    fn gravity(&self, q: &Vector2<T>) -> Vector2<T> {
        Vector2::new(c(0.0), -c::<T>(MASS * GRAVITY * LENGTH) * q[1].sin_cos().0)
    }
    fn kinetic_energy(&self, q: &Vector2<T>, qd: &Vector2<T>) -> T {
        let momentum = self.mass_matrix(q) * qd;
        (qd[0] * momentum[0] + qd[1] * momentum[1]) * c(0.5)
    }
    fn potential_energy(&self, q: &Vector2<T>) -> T {
        c::<T>(MASS * GRAVITY * LENGTH) * q[1].sin_cos().1
    }
    fn mass_matrix_jacobian(&self, q: &Vector2<T>) -> [Matrix2<T>; 2] {
        let slope = -c::<T>(MASS * LENGTH) * q[1].sin_cos().0;
        [Matrix2::zeros(), Matrix2::new(c(0.0), slope, slope, c(0.0))]
    }
    fn coriolis_vector_jacobian_q(&self, q: &Vector2<T>, qd: &Vector2<T>) -> Matrix2<T> {
        let slope = -c::<T>(MASS * LENGTH) * q[1].sin_cos().1 * qd[1] * qd[1];
        Matrix2::new(c(0.0), slope, c(0.0), c(0.0))
    }
    fn coriolis_vector_jacobian_qd(&self, q: &Vector2<T>, qd: &Vector2<T>) -> Matrix2<T> {
        self.coriolis_matrix(q, qd) * c::<T>(2.0)
    }
    fn gravity_jacobian(&self, q: &Vector2<T>) -> Matrix2<T> {
        let slope = -c::<T>(MASS * GRAVITY * LENGTH) * q[1].sin_cos().1;
        Matrix2::new(c(0.0), c(0.0), c(0.0), slope)
    }
    fn inverse_dynamics(&self, q: &Vector2<T>, qd: &Vector2<T>, qdd: &Vector2<T>) -> Vector2<T> {
        self.mass_matrix(q) * qdd + self.coriolis_vector(q, qd) + self.gravity(q)
    }
    fn forward_dynamics(&self, q: &Vector2<T>, qd: &Vector2<T>, force: &Vector2<T>) -> Vector2<T> {
        let m = self.mass_matrix(q);
        let rest = force - self.coriolis_vector(q, qd) - self.gravity(q);
        let determinant = m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)];
        Vector2::new(
            (m[(1, 1)] * rest[0] - m[(0, 1)] * rest[1]) / determinant,
            (m[(0, 0)] * rest[1] - m[(1, 0)] * rest[0]) / determinant,
        )
    }
    fn dissipative_force(&self, _: &Vector2<T>, qd: &Vector2<T>) -> Vector2<T> {
        Vector2::new(-c::<T>(FRICTION) * qd[0], c(0.0))
    }
    fn description(&self) -> &Description {
        &DESCRIPTION
    }
    fn input_column(&self, _: &Vector2<T>, actuator: usize) -> Vector2<T> {
        Vector2::new(c(f64::from(u8::from(actuator == 0))), c(0.0))
    }
    fn center_of_mass(&self, q: &Vector2<T>) -> Vector3<T> {
        let (sin, cos) = q[1].sin_cos();
        let share = c::<T>(MASS / (CART + MASS) * LENGTH);
        Vector3::new(q[0] + share * sin, c(0.0), share * cos)
    }
    fn frame_rotation(&self, _: &Vector2<T>, _: usize) -> SMatrix<T, 3, 3> {
        SMatrix::identity()
    }
    fn point_position(&self, q: &Vector2<T>, point: usize) -> Vector3<T> {
        let (sin, cos) = q[1].sin_cos();
        let head = Vector3::new(q[0] + c::<T>(LENGTH) * sin, c(0.0), c::<T>(LENGTH) * cos);
        if point == 0 { head } else { Vector3::zeros() }
    }
    fn point_jacobian(&self, q: &Vector2<T>, point: usize) -> SMatrix<T, 3, 2> {
        let (sin, cos) = q[1].sin_cos();
        let (zero, l) = (c::<T>(0.0), c::<T>(LENGTH));
        let head = SMatrix::from([[c(1.0), zero, zero], [l * cos, zero, -l * sin]]);
        if point == 0 { head } else { SMatrix::zeros() }
    }
}

impl<T: Real> ShapeAccelerated<T, 1, 1> for CartPole {
    fn gamma(&self, q: &Vector1<T>, _: &Vector1<T>, qdd: &Vector1<T>) -> Vector1<T> {
        let (sin, cos) = q[0].sin_cos();
        Vector1::new((c::<T>(GRAVITY) * sin - c::<T>(LENGTH) * qdd[0]) / cos)
    }
    fn gamma_prime(&self, q: &Vector1<T>) -> Vector1<T> {
        let (sin, cos) = q[0].sin_cos();
        Vector1::new(c::<T>(GRAVITY) * sin / cos)
    }
    fn gamma_prime_jacobian(&self, q: &Vector1<T>) -> Matrix1<T> {
        let cos = q[0].sin_cos().1;
        Matrix1::new(c::<T>(GRAVITY) / (cos * cos))
    }
    fn shape_gain(&self) -> Matrix1<T> {
        Matrix1::new(c(GRAVITY))
    }
    fn response(&self, q: &Vector1<T>, qd: &Vector1<T>, qdd: &Vector1<T>) -> Response<T, 1, 1> {
        let (sin, cos) = q[0].sin_cos();
        let gamma: Vector1<T> = self.gamma(q, qd, qdd);
        Response {
            gamma,
            d_qs: Matrix1::new(c::<T>(GRAVITY) + gamma[0] * sin / cos),
            d_qsd: Matrix1::zeros(),
            d_qsdd: Matrix1::new(-c::<T>(LENGTH) / cos),
        }
    }
    fn output(&self, x: &Vector1<T>, _: &Vector1<T>) -> Vector1<T> {
        *x
    }
    fn output_jacobian_position(&self) -> Matrix1<T> {
        Matrix1::new(c(1.0))
    }
    fn output_jacobian_shape(&self, _: &Vector1<T>, _: &Vector1<T>) -> Matrix1<T> {
        Matrix1::zeros()
    }
    fn shape_description(&self) -> &Description {
        &DESCRIPTION
    }
}

impl<T: Real> Robot<T, 2, 1, 1> for CartPole {}

#[test]
fn it_fulfils_all_that_generated_robots_fulfil() {
    let label = "cart-pole by hand";
    checks::mass_matrix::<2, 1, 1>(label, &CartPole);
    checks::coriolis_matrix::<2, 1, 1>(label, &CartPole, &CartPole);
    checks::energies::<2, 1, 1>(label, &CartPole, &CartPole);
    checks::dynamics::<2, 1, 1>(label, &CartPole);
    checks::inputs::<2, 1, 1>(label, &CartPole);
    checks::lagrangian_jacobians::<2, 1, 1>(label, &CartPole, &CartPole);
    checks::shape_jacobians::<2, 1, 1>(label, &CartPole, &CartPole);
    checks::motion_of_the_shape::<2, 1, 1, _>(label, &CartPole);
    checks::shape_map::<2, 1, 1, _>(label, &CartPole);
    checks::energy_is_conserved::<2, 1, 1>(label, &CartPole);
    checks::frames::<2, 1, 1>(label, &CartPole);
    checks::points::<2, 1, 1>(label, &CartPole);
    checks::single_precision::<2, 1, 1>(label, &CartPole, &CartPole);
}

#[test]
fn generated_code_is_what_was_written_by_hand() {
    let generated = CartpolePlanar::<f64>::from_model();
    checks::agrees::<f64, f64, 2, 1, 1>("cart-pole", &generated, &CartPole, 1e-13);
}

#[test]
fn plans_of_both_are_the_same() {
    let line = Line::new([0.0].into(), [2.0].into(), 5.0, 9).expect("a line");
    let by_hand = plan(&CartPole, &Task::new(&line, 501)).expect("a plan");
    let generated = CartpolePlanar::<f64>::from_model();
    let generated = plan(&generated, &Task::new(&line, 501)).expect("a plan");
    let (a, b) = (by_hand.report().output_rmse, generated.report().output_rmse);
    assert!((a - 0.0211).abs() < 5e-5, "Table II: {a}");
    assert!((a - b).abs() < 1e-12, "{a} by hand, {b} generated");
    assert!((by_hand.gain() - generated.gain()).abs().max() < 1e-12);
}

#[test]
fn a_robot_is_usable_behind_a_pointer() {
    let robots: [&dyn ShapeAccelerated<f64, 1, 1>; 2] =
        [&CartPole, &CartpolePlanar::<f64>::from_model()];
    let line = Line::new([0.0].into(), [2.0].into(), 5.0, 9).expect("a line");
    for robot in robots {
        let plan = plan(robot, &Task::new(&line, 501)).expect("a plan");
        assert!(plan.report().termination.converged());
    }
    let _: &dyn Robot<Dual, 2, 1, 1> = &CartPole;
}
