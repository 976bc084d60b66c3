//! Arms against the reference: shares, constraints (Sec. IV-C) and refined plans along a line.

use crate::common::arms::PlanarArms;
use crate::common::robots::{Robot, TABLE_I};
use nalgebra::{Vector1, Vector3};
use serde_json::Value;
use shapebot_planner::motion::{DesiredMotion, Legs, Line, Rest};
use shapebot_planner::{
    Constrained, Error, Objective, Refinement, SetMotion, ShapeConstraint, Task, Weighting,
    Workspace, plan, refine,
};
use std::io::Write;

const ARMS: Robot<PlanarArms> =
    Robot(PlanarArms { ballbot: TABLE_I, m_a: 1.0, l_a: 0.55, i_a: 0.0016, d_z: 1.3 });

fn load(name: &str) -> Option<Value> {
    let path = format!("{}/../../tests/reference/planning/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let Ok(text) = std::fs::read_to_string(&path) else {
        let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
        assert!(!required.split(',').any(|word| word == "reference"), "{path} is missing");
        let _ = writeln!(std::io::stderr(), "skipped: no reference data at {path}");
        return None;
    };
    Some(serde_json::from_str(&text).expect("reference data is JSON"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The pitch coordinates of the file's q_s.
fn pitch(value: &Value) -> Vector3<f64> {
    Vector3::from([1, 3, 5].map(|i| number(&value[i])))
}

#[track_caller]
fn close(what: &str, found: f64, expected: f64, tolerance: f64) {
    let difference = (found - expected).abs();
    assert!(difference <= tolerance, "{what}: {found} for {expected}, off by {difference:e}");
}

fn goal(distance: f64, duration: f64) -> Line<f64, 1> {
    Line::new(Vector1::new(0.0), Vector1::new(distance), duration, 9).expect("a line")
}

/// Gain and refined plan of one case.
fn check<M, C>(data: &Value, motion: &M, constraint: C, spans: usize)
where
    M: DesiredMotion<f64, 1>,
    C: ShapeConstraint<f64, 1, 3>,
{
    let samples = number(&data["n_samples"]) as usize;
    let ratios = ["c_alpha_l", "c_alpha_r", "c_phi"].map(|c| number(&data["weights"][c]));
    let task = Task::new(motion, samples)
        .weighting(Weighting::Contributions(&ratios))
        .constraint(constraint);
    for expected in data["optimised"].as_array().expect("a list") {
        let objective = match expected["objective"].as_str() {
            Some("pos_xw") => Objective::Output,
            Some("pos_theta") => Objective::Position,
            _ => Objective::Acceleration,
        };
        let plan = plan(&ARMS, &task.objective(objective)).expect("a plan");
        let (report, cost) = (plan.report(), number(&expected["cost"]));
        let name = format!("{objective:?}");
        assert!(report.termination.converged(), "{name}");
        close(&name, report.cost, cost, 1e-6 * cost);
        close(&name, report.output_rmse, number(&expected["rmse_xw_m"]), 1e-7);
        let peaks = report.peak_shape - pitch(&expected["peak_shape_rad"]);
        assert!(peaks.abs().max() < 1e-6, "{name}: {peaks}");
        for row in expected["samples"].as_array().into_iter().flatten() {
            let difference = plan.at(number(&row["t"])).shape - pitch(&row["qs"]);
            assert!(difference.abs().max() < 1e-6, "{name}: {difference}");
        }
    }
    let mut workspace = Workspace::<f64, 1, 96>::new();
    let refinement = Refinement { spans: Some(spans), ..Default::default() };
    let plan = refine(&ARMS, &task, &refinement, &mut workspace).expect("a plan");
    let report = plan.report();
    let reference = number(&data["beyond_paper_bspline"]["rmse_xw_m"]);
    let _ =
        writeln!(std::io::stderr(), "RMSE {reference:.3e}, floor {:?}: {report:?}", plan.floor());
    assert!(report.converged);
    assert!(report.output_rmse <= reference.max(2e-5) * 1.01);
    assert!(report.output_end_error < 1e-4 && report.output_end_velocity_error < 1e-4);
}

#[test]
fn equal_thirds() {
    if let Some(data) = load("arms_equal_thirds_0.25m_5s") {
        check(&data, &goal(0.25, 5.0), shapebot_planner::Unconstrained, 25);
    }
}

#[test]
fn arms_alone() {
    if let Some(data) = load("paper_arm_forward_2m") {
        check(&data, &goal(2.0, 15.2), shapebot_planner::Unconstrained, 76);
    }
}

#[test]
fn half_arms_half_body() {
    if let Some(data) = load("paper_arm_body_5050_2m") {
        check(&data, &goal(2.0, 10.8), shapebot_planner::Unconstrained, 54);
    }
}

/// Arms go up, the robot moves, arms come down.
struct ArmsUp {
    up: Line<f64, 1>,
    hold: Rest<f64, 1>,
    down: Line<f64, 1>,
}

impl ArmsUp {
    fn new() -> Self {
        let (rest, raised) = (Vector1::new(0.0), Vector1::new(-core::f64::consts::FRAC_PI_2));
        Self {
            up: Line::new(rest, raised, 4.0, 9).expect("a line"),
            hold: Rest::new(raised, 6.0).expect("a rest"),
            down: Line::new(raised, rest, 4.0, 9).expect("a line"),
        }
    }
    fn legs(&self) -> [&dyn DesiredMotion<f64, 1>; 3] {
        [&self.up, &self.hold, &self.down]
    }
}

#[test]
fn arms_held_horizontal() {
    let Some(data) = load("paper_arms_horizontal_2m") else {
        return;
    };
    let arms = ArmsUp::new();
    let legs = arms.legs();
    let arm = Legs::new(&legs).expect("legs");
    let sets = [SetMotion { set: 0, motion: &arm }, SetMotion { set: 1, motion: &arm }];
    let constraint = Constrained::new(&ARMS, &sets).expect("a constraint");
    for sample in data["a_ac_samples"].as_array().expect("a list") {
        let [a, da, dda] = constraint.acceleration(number(&sample["t"]));
        close("a_ac", a[0], number(&sample["a_ac"][0]), 1e-10);
        close("a_ac_d", da[0], number(&sample["a_ac_d"][0]), 1e-10);
        close("a_ac_dd", dda[0], number(&sample["a_ac_dd"][0]), 1e-9);
    }
    let before = Rest::new(Vector1::new(0.0), 4.5).expect("a rest");
    let after = Rest::new(Vector1::new(2.0), 4.5).expect("a rest");
    let line = goal(2.0, 5.0);
    let parts: [&dyn DesiredMotion<f64, 1>; 3] = [&before, &line, &after];
    check(&data, &Legs::new(&parts).expect("legs"), constraint, 70);
}

#[test]
fn senseless_constraints_are_refused_by_name() {
    let line = goal(0.3, 4.0);
    let motion = |set| SetMotion { set, motion: &line };
    let refusal =
        |sets: &[SetMotion<'_, f64, 1>]| Constrained::new(&ARMS, sets).map(|_| ()).unwrap_err();
    assert_eq!(refusal(&[motion(0), motion(1), motion(2)]), Error::NoFreeShapeSet);
    assert!(refusal(&[motion(3)]).to_string().starts_with("shape set is 3"));
    assert!(refusal(&[motion(1), motion(1)]).to_string().starts_with("shape set is 1"));
    // A constraint that leaves its range, and a constrained set that is to contribute.
    let far = goal(2.0, 4.0);
    let sets = [SetMotion { set: 0, motion: &far }];
    let constraint = Constrained::new(&ARMS, &sets).expect("a constraint");
    let task = Task::new(&line, 401).constraint(constraint);
    let error = plan(&ARMS, &task).expect_err("refused");
    assert!(matches!(error, Error::OutOfRange { coordinate: "alpha_l", .. }), "{error}");
    let mut workspace = Workspace::<f64, 1, 64>::new();
    let error = refine(&ARMS, &task, &Refinement::default(), &mut workspace).expect_err("refused");
    assert!(matches!(error, Error::LimitExceeded { coordinate: "alpha_l", .. }), "{error}");
    let task = task.weighting(Weighting::Contributions(&[0.5, 0.0, 0.5]));
    let error = plan(&ARMS, &task).expect_err("refused");
    assert_eq!(
        error.to_string(),
        "entry 0 of the contributions is 0.5, expected 0 for a constrained shape set"
    );
}

/// The free sets cancel what the constrained ones do: the robot stays where it is.
#[test]
fn one_arm_waves_while_the_robot_stands() {
    let up = goal(-1.2, 3.0);
    let down = Line::new(Vector1::new(-1.2), Vector1::new(0.0), 3.0, 9).expect("a line");
    let wave = [up, down];
    let wave = Legs::new(&wave).expect("legs");
    let sets = [SetMotion { set: 0, motion: &wave }];
    let constraint = Constrained::new(&ARMS, &sets).expect("a constraint");
    let rest = Rest::new(Vector1::new(0.0), 6.0).expect("a rest");
    let task = Task::new(&rest, 601)
        .weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]))
        .constraint(constraint);
    let gained = plan(&ARMS, &task).expect("a plan");
    let mut workspace = Workspace::<f64, 1, 64>::new();
    let refined = refine(&ARMS, &task, &Refinement::default(), &mut workspace).expect("a plan");
    let (gained, refined) = (gained.report(), refined.report());
    let _ = writeln!(std::io::stderr(), "{} {}", gained.output_rmse, refined.output_rmse);
    assert!(refined.converged && refined.output_rmse < 1e-4, "{refined:?}");
    assert!(gained.output_max_error < 0.1, "{gained:?}");
}
