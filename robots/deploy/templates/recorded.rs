//! The robot of this crate against vectors that were recorded when the crate was made.
//!
//! None of them was computed by the code that is tested here. The equations of motion come from an
//! interpreter of the symbolic derivation, while this crate has emitted code with the parameters folded
//! in; the controller's steps come from the controller on that interpreted robot; the plan's points are
//! those of the polynomials that its nodes were taken from.

use robot::{CONTROL, DESCRIPTION, DRIVE, N, NS, NX, ROBOT, Robot};
use shapebot_control::{Controller, Gains, State, Target};
use shapebot_dynamics::nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{LagrangianSystem, ShapeAccelerated};
use shapebot_planner::value::{PlanBytes, PlanView, RobotId};

mod vectors;

use vectors::{DYNAMICS, PLAN, POINTS, STEPS};

/// Largest difference, relative to the largest of the expected numbers or one.
#[track_caller]
fn assert_close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1.0_f64, |most, number| most.max(number.abs()));
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        let apart = (a - b).abs() / scale;
        // Written so that not a number fails.
        assert!(apart <= tolerance, "{what}, entry {index}: {a:e}, recorded {b:e}");
    }
}

fn vector<const L: usize>(numbers: &[f64]) -> SVector<f64, L> {
    SVector::from_iterator(numbers.iter().copied())
}

fn rows<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Vec<f64> {
    matrix.transpose().iter().copied().collect()
}

#[test]
fn emitted_dynamics_are_those_of_the_symbolic_derivation() {
    assert_eq!(DYNAMICS.len(), 16);
    for v in DYNAMICS {
        let [q, qd, qdd, force] = [v.q, v.qd, v.qdd, v.force].map(vector::<N>);
        assert_close("M", &rows(&ROBOT.mass_matrix(&q)), v.mass_matrix, 1e-12);
        let coriolis = ROBOT.coriolis_vector(&q, &qd);
        assert_close("C q'", coriolis.as_slice(), v.coriolis_vector, 1e-12);
        assert_close("G", ROBOT.gravity(&q).as_slice(), v.gravity, 1e-12);
        let forward = ROBOT.forward_dynamics(&q, &qd, &force);
        assert_close("q''", forward.as_slice(), v.forward_dynamics, 1e-9);
        let shape = |q: &SVector<f64, N>| <Robot as shapebot_dynamics::Robot<f64, N, NX, NS>>::split(q).1;
        let gamma = ROBOT.gamma(&shape(&q), &shape(&qd), &shape(&qdd));
        assert_close("Gamma", gamma.as_slice(), v.gamma, 1e-11);
    }
}

#[test]
fn single_precision_is_close() {
    for v in DYNAMICS {
        let q: SVector<f32, N> = vector::<N>(v.q).map(|x| x as f32);
        let mass: SMatrix<f32, N, N> = ROBOT.mass_matrix(&q);
        assert_close("M", &rows(&mass.map(f64::from)), v.mass_matrix, 1e-5);
    }
}

#[test]
fn controller_steps_are_those_recorded() {
    assert_eq!(STEPS.len(), 200);
    let mut gains = Gains::<f64, NX, NS>::from_design(&ROBOT, &CONTROL).expect("gains");
    gains.period = f64::from(DRIVE.timing.period_us) * 1e-6;
    let mut controller = Controller::new(&ROBOT, &gains).expect("a controller");
    let mut largest = 0.0_f64;
    for (index, step) in STEPS.iter().enumerate() {
        let state = State { q: vector(step.q), qd: vector(step.qd) };
        let command = controller.step(&state, &Target::stand(vector(step.wanted)));
        assert!(!command.fault, "step {index}");
        assert_close("forces", command.actuator.as_slice(), step.actuator, 1e-8);
        assert_close("compensation", command.compensation.as_slice(), step.compensation, 1e-9);
        largest = step.actuator.iter().fold(largest, |most, force| most.max(force.abs()));
    }
    // Else nothing was compared.
    assert!(largest > 1e-3);
}

#[test]
fn plan_is_evaluated_in_place_as_recorded() {
    if let Some(own) = robot::PLAN {
        let own = PlanBytes::open(own).expect("the plan of the program");
        RobotId::of(&DESCRIPTION).check(own.robot()).expect("a plan for this robot");
    }
    let id = RobotId::of(&DESCRIPTION);
    let plan = PlanView::<f64, NX, NS, N>::open(PLAN, &id).expect("the plan of this robot");
    for point in POINTS {
        let at = plan.at(point.time);
        let mut values = Vec::new();
        at.position.iter().for_each(|v| values.extend_from_slice(v.as_slice()));
        at.shape.iter().for_each(|v| values.extend_from_slice(v.as_slice()));
        values.extend_from_slice(at.force.as_slice());
        assert_close("plan", &values, point.values, 1e-11);
    }
    let mut altered = PLAN.to_vec();
    altered[100] ^= 1;
    assert!(PlanView::<f64, NX, NS, N>::open(&altered, &id).is_err());
}

#[test]
fn drive_and_robot_fit() {
    assert_eq!(usize::from(DRIVE.coordinates), N);
    assert_eq!(N, NX + NS);
    assert_eq!(DESCRIPTION.coordinates.len(), N);
    let q = SVector::<f64, N>::from_element(0.0);
    assert!(ROBOT.mass_matrix(&q).iter().all(|entry| entry.is_finite()));
    let joined = <Robot as shapebot_dynamics::Robot<f64, N, NX, NS>>::join(
        &SVector::from_element(1.0),
        &SVector::from_element(2.0),
    );
    assert_eq!(joined.iter().filter(|entry| **entry == 1.0).count(), NX);
}
