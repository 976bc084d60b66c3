//! What the traits promise to whoever implements them by hand.

use nalgebra::{Matrix1, Matrix2, Matrix3, SMatrix, SVector, Vector1, Vector2, Vector3};
use shapebot_dynamics::{
    Actuator, Coordinate, Description, LagrangianSystem, Ordered, Real, Response, Robot, Role,
    ShapeAccelerated, ShapeSet,
};

const fn angle(name: &'static str, role: Role, actuated: bool) -> Coordinate {
    Coordinate { name, unit: "rad", role, actuated, lower: -1.0, upper: f64::INFINITY }
}

static DESCRIPTION: Description = Description {
    name: "double_integrator",
    summary: "Unit masses under unit gravity: x'' = s.",
    coordinates: &[angle("x", Role::Position, true), angle("s", Role::Shape, false)],
    position_count: 1,
    shape_sets: &[ShapeSet { name: "s", first: 0, len: 1, actuated: false }],
    actuators: &[Actuator { name: "force", unit: "N", limit: f64::INFINITY }],
    parameters: &[],
    outputs: &["x"],
    output_unit: "m",
    frames: &["world"],
    points: &[],
    geometry: &[],
    friction: &[],
};

/// M = 1, C = 0, V = −s²/2: small enough to see every default body at work.
struct DoubleIntegrator;

impl<T: Real> LagrangianSystem<T, 2> for DoubleIntegrator {
    fn mass_matrix(&self, _q: &Vector2<T>) -> Matrix2<T> {
        Matrix2::identity()
    }
    fn coriolis_matrix(&self, _q: &Vector2<T>, _qd: &Vector2<T>) -> Matrix2<T> {
        Matrix2::zeros()
    }
    fn coriolis_vector(&self, _q: &Vector2<T>, _qd: &Vector2<T>) -> Vector2<T> {
        Vector2::zeros()
    }
    fn gravity(&self, q: &Vector2<T>) -> Vector2<T> {
        Vector2::new(T::zero(), -q[1])
    }
    fn kinetic_energy(&self, _q: &Vector2<T>, qd: &Vector2<T>) -> T {
        qd.dot(qd) * T::from_f64(0.5)
    }
    fn potential_energy(&self, q: &Vector2<T>) -> T {
        q[1] * q[1] * T::from_f64(-0.5)
    }
    fn mass_matrix_jacobian(&self, _q: &Vector2<T>) -> [Matrix2<T>; 2] {
        [Matrix2::zeros(); 2]
    }
    fn coriolis_vector_jacobian_q(&self, _q: &Vector2<T>, _qd: &Vector2<T>) -> Matrix2<T> {
        Matrix2::zeros()
    }
    fn coriolis_vector_jacobian_qd(&self, _q: &Vector2<T>, _qd: &Vector2<T>) -> Matrix2<T> {
        Matrix2::zeros()
    }
    fn gravity_jacobian(&self, _q: &Vector2<T>) -> Matrix2<T> {
        Matrix2::new(T::zero(), T::zero(), T::zero(), -T::one())
    }
    fn inverse_dynamics(&self, q: &Vector2<T>, _qd: &Vector2<T>, qdd: &Vector2<T>) -> Vector2<T> {
        qdd + self.gravity(q)
    }
    fn forward_dynamics(&self, q: &Vector2<T>, _qd: &Vector2<T>, force: &Vector2<T>) -> Vector2<T> {
        force - self.gravity(q)
    }
    fn description(&self) -> &Description {
        &DESCRIPTION
    }
    fn input_column(&self, _q: &Vector2<T>, _actuator: usize) -> Vector2<T> {
        Vector2::new(T::one(), T::zero())
    }
    fn center_of_mass(&self, _q: &Vector2<T>) -> Vector3<T> {
        Vector3::zeros()
    }
    fn frame_rotation(&self, _q: &Vector2<T>, _frame: usize) -> Matrix3<T> {
        Matrix3::identity()
    }
    fn point_position(&self, _q: &Vector2<T>, _point: usize) -> Vector3<T> {
        Vector3::zeros()
    }
    fn point_jacobian(&self, _q: &Vector2<T>, _point: usize) -> SMatrix<T, 3, 2> {
        SMatrix::zeros()
    }
}

impl<T: Real> ShapeAccelerated<T, 1, 1> for DoubleIntegrator {
    fn gamma(&self, qs: &Vector1<T>, _qsd: &Vector1<T>, _qsdd: &Vector1<T>) -> Vector1<T> {
        *qs
    }
    fn gamma_prime(&self, qs: &Vector1<T>) -> Vector1<T> {
        *qs
    }
    fn gamma_prime_jacobian(&self, _qs: &Vector1<T>) -> Matrix1<T> {
        Matrix1::identity()
    }
    fn shape_gain(&self) -> Matrix1<T> {
        Matrix1::identity()
    }
    fn response(&self, qs: &Vector1<T>, qsd: &Vector1<T>, qsdd: &Vector1<T>) -> Response<T, 1, 1> {
        Response {
            gamma: self.gamma(qs, qsd, qsdd),
            d_qs: Matrix1::identity(),
            d_qsd: Matrix1::zeros(),
            d_qsdd: Matrix1::zeros(),
        }
    }
    fn output(&self, qx: &Vector1<T>, _qs: &Vector1<T>) -> Vector1<T> {
        *qx
    }
    fn output_jacobian_position(&self) -> Matrix1<T> {
        Matrix1::identity()
    }
    fn output_jacobian_shape(&self, _qx: &Vector1<T>, _qs: &Vector1<T>) -> Matrix1<T> {
        Matrix1::zeros()
    }
    fn shape_description(&self) -> &Description {
        &DESCRIPTION
    }
}

impl<T: Real> Robot<T, 2, 1, 1> for DoubleIntegrator {}

#[test]
fn the_bundled_motion_is_its_parts() {
    let (q, qd) = (Vector2::new(0.3, -0.2), Vector2::new(1.0, 2.0));
    let motion = DoubleIntegrator.motion(&q, &qd);
    assert_eq!(motion.mass_matrix, DoubleIntegrator.mass_matrix(&q));
    assert_eq!(motion.coriolis_vector, DoubleIntegrator.coriolis_vector(&q, &qd));
    assert_eq!(motion.gravity, DoubleIntegrator.gravity(&q));
    assert_eq!(DoubleIntegrator.dissipative_force(&q, &qd), Vector2::zeros());
}

#[test]
fn split_undoes_join() {
    let (position, shape) = (Vector1::new(1.5), Vector1::new(-0.25));
    let q = <DoubleIntegrator as Robot<f64, 2, 1, 1>>::join(&position, &shape);
    assert_eq!(q, Vector2::new(1.5, -0.25));
    assert_eq!(<DoubleIntegrator as Robot<f64, 2, 1, 1>>::split(&q), (position, shape));
}

#[test]
fn both_traits_can_be_trait_objects() {
    let shape: &dyn ShapeAccelerated<f64, 1, 1> = &DoubleIntegrator;
    let lagrangian: &dyn LagrangianSystem<f32, 2> = &DoubleIntegrator;
    assert_eq!(shape.gamma_prime(&Vector1::new(0.5)), Vector1::new(0.5));
    assert_eq!(lagrangian.description().name, "double_integrator");
}

#[test]
fn a_description_splits_its_coordinates_by_role() {
    let names = |coordinates: &[Coordinate]| coordinates.iter().map(|c| c.name).collect::<Vec<_>>();
    assert_eq!(names(DESCRIPTION.position_coordinates()), ["x"]);
    assert_eq!(names(DESCRIPTION.shape_coordinates()), ["s"]);
    assert_eq!(DESCRIPTION.unactuated_shape().collect::<Vec<_>>(), [0]);
    let broken = Description { position_count: 7, ..DESCRIPTION };
    assert_eq!(broken.shape_coordinates(), []);
    assert_eq!(broken.unactuated_shape().count(), 0);
}

/// A scalar that takes every provided method of `Ordered`.
#[test]
fn provided_methods_of_a_scalar_agree_with_the_floats() {
    #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
    struct Plain(f32);
    macro_rules! operator {
        ($($trait:ident $method:ident $op:tt),*) => {$(
            impl core::ops::$trait for Plain {
                type Output = Self;
                fn $method(self, other: Self) -> Self { Plain(self.0 $op other.0) }
            }
        )*};
    }
    macro_rules! assignment {
        ($($trait:ident $method:ident $op:tt),*) => {$(
            impl core::ops::$trait for Plain {
                fn $method(&mut self, other: Self) { self.0 $op other.0; }
            }
        )*};
    }
    operator!(Add add +, Sub sub -, Mul mul *, Div div /);
    assignment!(AddAssign add_assign +=, SubAssign sub_assign -=, MulAssign mul_assign *=, DivAssign div_assign /=);
    impl core::ops::Neg for Plain {
        type Output = Self;
        fn neg(self) -> Self {
            Plain(-self.0)
        }
    }
    impl num_traits::Zero for Plain {
        fn zero() -> Self {
            Plain(0.0)
        }
        fn is_zero(&self) -> bool {
            self.0 == 0.0
        }
    }
    impl num_traits::One for Plain {
        fn one() -> Self {
            Plain(1.0)
        }
    }
    macro_rules! delegate {
        ($($function:ident),*) => {$(
            fn $function(self) -> Self { Plain(Real::$function(self.0)) }
        )*};
    }
    impl Real for Plain {
        fn from_f64(value: f64) -> Self {
            Plain(Real::from_f64(value))
        }
        fn sin_cos(self) -> (Self, Self) {
            let (s, c) = Real::sin_cos(self.0);
            (Plain(s), Plain(c))
        }
        fn atan2(self, x: Self) -> Self {
            Plain(Real::atan2(self.0, x.0))
        }
        delegate!(sqrt, exp, ln, asin, acos, atan);
    }
    impl Ordered for Plain {
        fn to_f64(self) -> f64 {
            f64::from(self.0)
        }
    }
    assert_eq!(Plain::epsilon().0, f32::EPSILON);
    assert_eq!(Plain(-2.0).abs(), Plain(2.0));
    assert!(!Plain(f32::NAN).is_finite() && !Plain(f32::INFINITY).is_finite());
    assert!(Plain(1e30).is_finite() && Plain(f32::NAN).abs() != Plain(0.0));
}

#[test]
fn functions_of_the_floats_are_those_of_libm() {
    for step in -20..=20 {
        let x = f64::from(step) * 0.37;
        assert_eq!(Real::sin_cos(x), libm::sincos(x));
        assert_eq!(Real::atan2(x, 0.5), libm::atan2(x, 0.5));
        #[allow(clippy::cast_possible_truncation)]
        let single = x as f32;
        // Of single precision, and to it.
        let (sin, cos) = Real::sin_cos(single);
        let (exact_sin, exact_cos) = libm::sincos(f64::from(single));
        for (found, exact) in [(sin, exact_sin), (cos, exact_cos)] {
            assert!((f64::from(found) - exact).abs() <= 0.5 * f64::from(f32::EPSILON), "{single}");
        }
    }
    let vector = SVector::<f64, 3>::new(1.0, 2.0, 2.0);
    assert_eq!(Real::sqrt(vector.dot(&vector)), 3.0);
}
