//! Interpreted models against exactly computed states (`tests/reference/dynamics`).

use nalgebra::SVector;
use serde_json::Value;
use shapebot_codegen::derive::{Derivation, Parameters, Quantity, derive};
use shapebot_dynamics::{LagrangianSystem, Robot, ShapeAccelerated};
use shapebot_interpreter::{
    Error, Interpreted, State, Tapes, check_parameters, sizes, with_interpreted,
};
use std::io::Write;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Stems for which there are a model and reference data.
fn stems() -> Vec<String> {
    let entries = std::fs::read_dir(root().join("tests/reference/dynamics")).into_iter().flatten();
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let stems: Vec<String> = entries.flatten().filter_map(|entry| stem(&entry.path())).collect();
    if stems.is_empty() {
        let _ = writeln!(std::io::stderr(), "skipped: no reference data beside this crate");
    }
    stems
}

fn derivation(text: &str) -> Derivation {
    let parsed = shapebot_model_dsl::parse("model.robot", text);
    let model = parsed.model.unwrap_or_else(|| panic!("{:?}", parsed.diagnostics));
    derive(&model, Parameters::Symbolic).unwrap_or_else(|diagnostics| panic!("{diagnostics:?}"))
}

fn bundled(stem: &str) -> Option<Derivation> {
    let path = root().join(format!("robots/models/{stem}.robot"));
    std::fs::read_to_string(path).ok().map(|text| derivation(&text))
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

fn assert_close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance * largest.max(1e-3), "{what}: {a} instead of {b}");
    }
}

const FIELDS: [(&str, Quantity); 15] = [
    ("M", Quantity::MassMatrix),
    ("C", Quantity::CoriolisMatrix),
    ("Cqd", Quantity::CoriolisVector),
    ("G", Quantity::Gravity),
    ("Gamma", Quantity::Gamma),
    ("GammaP", Quantity::GammaPrime),
    ("dM_dq", Quantity::MassMatrixJacobian),
    ("dCqd_dq", Quantity::CoriolisVectorJacobianQ),
    ("dCqd_dqd", Quantity::CoriolisVectorJacobianQd),
    ("dG_dq", Quantity::GravityJacobian),
    ("dGammaP_dqs", Quantity::GammaPrimeJacobian),
    ("kinetic", Quantity::KineticEnergy),
    ("potential", Quantity::PotentialEnergy),
    ("qdd_fd", Quantity::ForwardDynamics),
    ("Gamma dGamma_dqs dGamma_dqsd dGamma_dqsdd", Quantity::Response),
];

#[test]
fn functions_agree_with_exact_states() {
    for stem in stems() {
        let Some(derivation) = bundled(&stem) else { continue };
        let tapes = Tapes::<f64>::with_model_parameters(&derivation);
        let file = root().join(format!("tests/reference/dynamics/{stem}.json"));
        let data: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        for state in data["states"].as_array().unwrap() {
            check_state(&stem, &tapes, state);
        }
        let mut gain = vec![0.0; tapes.result_count(Quantity::ShapeGain).unwrap()];
        tapes.evaluate(Quantity::ShapeGain, &State::EMPTY, &mut gain).unwrap();
        assert_close(&stem, &gain, &numbers(&data["K0_qs"]), 1e-13);
    }
}

fn check_state(stem: &str, tapes: &Tapes, state: &Value) {
    let [q, qd, qdd, mut force] = ["q", "qd", "qdd", "tau"].map(|key| numbers(&state[key]));
    // The reference's coordinates have no input coupling: forces act on the first coordinates.
    force.resize(q.len(), 0.0);
    let at = State { q: &q, qd: &qd, qdd: &qdd, force: &force };
    for (fields, quantity) in FIELDS {
        let mut results = vec![0.0; tapes.result_count(quantity).unwrap()];
        tapes.evaluate(quantity, &at, &mut results).unwrap();
        let mut rest = results.as_slice();
        for field in fields.split(' ') {
            let expected = numbers(&state[field]);
            let (found, after) = rest.split_at(expected.len());
            assert_close(&format!("{stem} {field}"), found, &expected, 1e-12);
            rest = after;
        }
        assert!(rest.is_empty());
    }
}

#[test]
fn the_traits_are_a_thin_layer_over_the_tapes() {
    let Some(derivation) = bundled("ballbot3d") else { return };
    let tapes = Tapes::<f64>::with_model_parameters(&derivation);
    let result = with_interpreted!(tapes.clone(), |robot| checks(&robot));
    assert!(result.is_ok());
    let wrong = Interpreted::<5, 2, 3>::from_tapes(tapes);
    assert!(matches!(wrong, Err(Error::Length { .. })));
}

fn checks<const N: usize, const NX: usize, const NS: usize>(robot: &Interpreted<N, NX, NS>) {
    let pattern = |offset: f64| SVector::<f64, N>::from_fn(|i, _| 0.1 * (i as f64 - 1.3) + offset);
    let (q, qd, qdd) = (pattern(0.01), pattern(0.2), pattern(-0.1));
    let force = robot.inverse_dynamics(&q, &qd, &qdd);
    let back = robot.forward_dynamics(&q, &qd, &force);
    assert_close("forward after inverse", back.as_slice(), qdd.as_slice(), 1e-11);
    let motion = robot.motion(&q, &qd);
    let sum = motion.mass_matrix * qdd + motion.coriolis_vector + motion.gravity;
    assert_close("motion", sum.as_slice(), force.as_slice(), 1e-12);
    let coriolis = robot.coriolis_matrix(&q, &qd) * qd;
    assert_close("C qd", coriolis.as_slice(), motion.coriolis_vector.as_slice(), 1e-12);
    let kinetic = 0.5 * qd.dot(&(robot.mass_matrix(&q) * qd));
    assert_close("energy", &[robot.kinetic_energy(&q, &qd)], &[kinetic], 1e-12);

    let [(_, qs), (_, qsd), (_, qsdd)] = [q, qd, qdd].map(|v| Interpreted::<N, NX, NS>::split(&v));
    let response = robot.response(&qs, &qsd, &qsdd);
    assert_close(
        "gamma",
        robot.gamma(&qs, &qsd, &qsdd).as_slice(),
        response.gamma.as_slice(),
        1e-12,
    );
    let still = SVector::<f64, NS>::zeros();
    let constant = robot.gamma(&qs, &still, &still);
    assert_close("gamma prime", robot.gamma_prime(&qs).as_slice(), constant.as_slice(), 1e-12);
    assert_close(
        "K0",
        robot.gamma_prime_jacobian(&still).as_slice(),
        robot.shape_gain().as_slice(),
        1e-13,
    );
    let rotation = robot.frame_rotation(&q, 1);
    assert_close(
        "rotation",
        (rotation.transpose() * rotation).as_slice(),
        nalgebra::Matrix3::<f64>::identity().as_slice(),
        1e-14,
    );
    assert_eq!(robot.frame_rotation(&q, 99), nalgebra::Matrix3::identity());
    assert_eq!(robot.point_position(&q, 99), nalgebra::Vector3::zeros());
    assert_eq!(robot.input_column(&q, 99), SVector::<f64, N>::zeros());
}

#[test]
fn parameters_are_bound_and_checked() {
    let Some(derivation) = bundled("ballbot3d") else { return };
    let mut values: Vec<f64> = derivation.model.parameters.iter().map(|p| p.value_f64).collect();
    assert_eq!(check_parameters(&derivation, &values), Ok(()));
    let mass = derivation.model.parameters.iter().position(|p| p.name == "m_b").unwrap();
    values[mass] = 80.0;
    let (light, heavy) = (
        Tapes::<f64>::with_model_parameters(&derivation),
        Tapes::new(&derivation, &values).unwrap(),
    );
    let q = vec![0.1; 4];
    let energy = |tapes: &Tapes| {
        let mut result = [0.0];
        tapes
            .evaluate(Quantity::PotentialEnergy, &State { q: &q, ..State::EMPTY }, &mut result)
            .unwrap();
        result[0]
    };
    assert_close("energy", &[energy(&heavy)], &[energy(&light) * 80.0 / 70.3], 1e-12);
    values[mass] = 1e9;
    assert!(matches!(check_parameters(&derivation, &values), Err(Error::OutOfRange { .. })));
    assert!(matches!(Tapes::new(&derivation, &values[1..]), Err(Error::Length { .. })));
}

#[test]
fn a_state_that_is_too_short_is_refused() {
    let Some(derivation) = bundled("ballbot_planar") else { return };
    let tapes = Tapes::<f64>::with_model_parameters(&derivation);
    let mut results = [0.0; 4];
    let state = State { q: &[0.1], ..State::EMPTY };
    assert!(matches!(
        tapes.evaluate(Quantity::MassMatrix, &state, &mut results),
        Err(Error::Length { what: "coordinates", found: 1, expected: 2 })
    ));
    let point = Quantity::PointPosition(99);
    assert_eq!(tapes.evaluate(point, &state, &mut results), Err(Error::Absent(point)));
}

/// Two free links: no position variable is accelerated by a shape.
const PENDULUM: &str = "
robot Pendulum {
    params { m: kg = 1; l: m = 0.5; I: kg*m^2 = 0.01; g: m/s^2 = 9.81; }
    position a: rad;
    shape b: rad;
    frame upper = world * rot_y(a);
    frame lower = upper * rot_y(b);
    rigid first { mass: m, inertia: diag(I, I, I), frame: upper, com: upper*[0, 0, -l] }
    rigid second { mass: m, inertia: diag(I, I, I), frame: lower, com: upper*[0, 0, -2*l] + lower*[0, 0, -l] }
    gravity g along -world.z;
}";

#[test]
fn a_model_outside_the_class_still_has_its_lagrangian() {
    let tapes = Tapes::<f64>::with_model_parameters(&derivation(PENDULUM));
    assert!(tapes.has(Quantity::MassMatrix) && !tapes.has(Quantity::Gamma));
    assert!(matches!(sizes(&tapes), Err(Error::NotShapeAccelerated { .. })));
    let result = with_interpreted!(tapes, |robot| robot.shape_gain().len());
    assert!(matches!(result, Err(Error::NotShapeAccelerated { .. })));
}
