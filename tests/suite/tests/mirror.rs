//! Robots that are required to be symmetric are, in the code that runs.

use shapebot_dynamics::nalgebra::{SMatrix, SVector, Vector3};
use shapebot_dynamics::{LagrangianSystem, Robot};
use shapebot_model_dsl::model::{Model, Requirement};
use shapebot_tests::compare::{Numbers, assert_close, compare_on_scale};
use shapebot_tests::states::{State, states};

/// Pairs of coordinates that the reflection exchanges, if the model requires one.
fn exchanged(model: &Model) -> Option<Vec<(usize, usize)>> {
    model.requirements.iter().find_map(|required| match &required.requirement {
        Requirement::Mirror { exchanged, .. } => {
            Some(exchanged.iter().map(|(a, b)| (a.0 as usize, b.0 as usize)).collect())
        }
        _ => None,
    })
}

/// The reflection in the x-z plane in generalised coordinates: an exchange of coordinates, then signs.
type Reflection<const N: usize> = SMatrix<f64, N, N>;

fn reflection<const N: usize>(pairs: &[(usize, usize)], signs: usize) -> Reflection<N> {
    let partner = |i: usize| {
        let pair = pairs.iter().find(|(a, b)| *a == i || *b == i);
        pair.map_or(i, |&(a, b)| if a == i { b } else { a })
    };
    let sign = |i: usize| if signs >> i & 1 == 1 { -1.0 } else { 1.0 };
    SMatrix::from_fn(|i, j| if j == partner(i) { sign(i.min(j)) } else { 0.0 })
}

/// Signs that reflect the centre of mass and leave the energies alone: found by trying all of them, so
/// that the test knows nothing about the robot.
fn find_reflection<const N: usize>(
    robot: &impl LagrangianSystem<f64, N>,
    pairs: &[(usize, usize)],
) -> Option<Reflection<N>> {
    let flip = Vector3::new(1.0, -1.0, 1.0);
    let samples = states::<N>(robot.description(), 3);
    let fits = |s: &Reflection<N>, State { q, qd, .. }: &State<N>| {
        let center = robot.center_of_mass(&(s * q)) - robot.center_of_mass(q).component_mul(&flip);
        let energy = robot.kinetic_energy(&(s * q), &(s * qd)) - robot.kinetic_energy(q, qd);
        center.abs().max() < 1e-12 && energy.abs() < 1e-10 * robot.kinetic_energy(q, qd)
    };
    (0..1 << N).map(|signs| reflection(pairs, signs)).find(|s| samples.iter().all(|q| fits(s, q)))
}

fn check<const N: usize, const NX: usize, const NS: usize, R>(name: &str, robot: &R, model: &Model)
where
    R: Robot<f64, N, NX, NS>,
{
    let Some(pairs) = exchanged(model) else { return };
    assert!(!pairs.is_empty(), "{name}: nothing is exchanged");
    let s = find_reflection(robot, &pairs).unwrap_or_else(|| panic!("{name}: no reflection"));
    assert_eq!(s * s, Reflection::<N>::identity(), "{name}: reflecting twice");
    let position = SMatrix::<f64, NX, NX>::from_fn(|i, j| s[(i, j)]);
    let shape = SMatrix::<f64, NS, NS>::from_fn(|i, j| s[(NX + i, NX + j)]);
    for (index, State { q, qd, qdd, force }) in
        states::<N>(robot.description(), 10).iter().enumerate()
    {
        let name = format!("{name}, state {index}");
        let mass = s * robot.mass_matrix(q) * s;
        assert_close(format!("{name}: M"), &robot.mass_matrix(&(s * q)), &mass, 1e-12);
        let bias = s * robot.coriolis_vector(q, qd);
        assert_close(
            format!("{name}: Cqd"),
            &robot.coriolis_vector(&(s * q), &(s * qd)),
            &bias,
            1e-12,
        );
        assert_close(
            format!("{name}: G"),
            &robot.gravity(&(s * q)),
            &(s * robot.gravity(q)),
            1e-12,
        );
        let moved = s * robot.forward_dynamics(q, qd, force);
        let found = robot.forward_dynamics(&(s * q), &(s * qd), &(s * force));
        assert_close(format!("{name}: forward dynamics"), &found, &moved, 1e-10);
        let [qs, qsd, qsdd] = [q, qd, qdd].map(|v| R::split(v).1);
        let gamma = position * robot.gamma(&qs, &qsd, &qsdd);
        let found = robot.gamma(&(shape * qs), &(shape * qsd), &(shape * qsdd));
        assert_close(format!("{name}: Gamma"), &found, &gamma, 1e-12);
    }
    let gain = position * robot.shape_gain() * shape;
    assert_close(format!("{name}: K0_qs"), &robot.shape_gain(), &gain, 1e-13);
}

macro_rules! tests {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        /// Names of the robots whose models require a symmetry.
        fn check_all() -> Vec<&'static str> {
            let mut symmetric = Vec::new();
            $({
                let model = shapebot_tests::models::model($name);
                if exchanged(&model).is_some() {
                    symmetric.push($name);
                }
                let robot = shapebot_generated::$module::$robot::<f64>::from_model();
                check::<$n, $nx, $ns, _>($name, &robot, &model);
            })*
            symmetric
        }
    };
}

shapebot_generated::for_each_robot!(tests);

#[test]
fn reflecting_the_state_reflects_the_motion() {
    let symmetric = check_all();
    assert!(symmetric.contains(&"ballbot3d_arms"), "{symmetric:?}");
}

/// Exchanging the arms without reflecting is no symmetry: the test above can fail.
#[test]
fn exchanging_the_arms_alone_changes_the_motion() {
    let robot = shapebot_generated::ballbot3d_arms::Ballbot3dArms::<f64>::from_model();
    let pairs = exchanged(&shapebot_tests::models::model("ballbot3d_arms")).expect("a symmetry");
    let exchange: Reflection<8> = reflection(&pairs, 0);
    let state = &states::<8>(LagrangianSystem::<f64, 8>::description(&robot), 1)[0];
    let q: SVector<f64, 8> = exchange * state.q;
    let mass = exchange * robot.mass_matrix(&state.q) * exchange;
    assert!(compare_on_scale(&robot.mass_matrix(&q).array(), &mass.array(), 1e-6, 1.0).is_err());
}
