//! Plans against an independent implementation of the paper's planner (Python and CasADi).

use crate::common::robots::{Ballbot, CartPole, Equations, Planar, Robot, Spatial, TABLE_I};
use nalgebra::{SMatrix, SVector};
use serde_json::Value;
use shapebot_dynamics::ShapeAccelerated;
use shapebot_planner::motion::{Bezier, DesiredMotion, Line};
use shapebot_planner::{LevenbergMarquardt, Objective, Plan, Row, Task, plan};
use std::io::Write;

/// The reference integrates a spline through the accelerations, the planner local cubics: at 100 Hz
/// that is all they differ by.
const RELATIVE: f64 = 1e-6;
const METRES: f64 = 1e-8;

fn load(name: &str) -> Option<Value> {
    let path = format!("{}/../../tests/reference/planning/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let Ok(text) = std::fs::read_to_string(&path) else {
        let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
        assert!(!required.split(',').any(|word| word == "reference"), "{path} is missing");
        // A packaged crate has no reference data beside it.
        let _ = writeln!(std::io::stderr(), "skipped: no reference data at {path}");
        return None;
    };
    Some(serde_json::from_str(&text).expect("reference data is JSON"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn field(value: &Value, names: [&str; 2]) -> f64 {
    number(names.iter().map(|name| &value[name]).find(|v| !v.is_null()).expect("a field"))
}

fn vector<const N: usize>(value: &Value, offset: usize) -> SVector<f64, N> {
    SVector::from_fn(|i, _| number(&value[i + offset]))
}

fn matrix<const R: usize, const C: usize>(value: &Value, offset: usize) -> SMatrix<f64, R, C> {
    SMatrix::from_fn(|i, j| number(&value[i + offset][j]))
}

fn largest<const R: usize, const C: usize>(m: SMatrix<f64, R, C>) -> f64 {
    m.iter().fold(0.0, |max, x| x.abs().max(max))
}

#[track_caller]
fn close<const R: usize, const C: usize>(
    what: &str,
    found: SMatrix<f64, R, C>,
    expected: SMatrix<f64, R, C>,
    tolerance: f64,
) {
    let difference = largest(found - expected);
    assert!(difference <= tolerance, "{what}: {found} for {expected}, off by {difference:e}");
}

#[track_caller]
fn close_number(what: &str, found: f64, expected: f64, tolerance: f64) {
    let difference = (found - expected).abs();
    assert!(difference <= tolerance, "{what}: {found} for {expected}, off by {difference:e}");
}

/// The desired motion of a reference case.
enum Motion<const NX: usize> {
    Line(Line<f64, NX>),
    Bezier(Vec<SVector<f64, NX>>, f64),
}

impl<const NX: usize> Motion<NX> {
    fn of(task: &Value) -> Self {
        let duration = field(task, ["duration_s", "T"]);
        if task["kind"] == "bezier" {
            let points = task["pts"].as_array().expect("control points");
            return Self::Bezier(points.iter().map(|p| vector(p, 0)).collect(), duration);
        }
        let direction = if task["direction"].is_null() { &task["dir"] } else { &task["direction"] };
        let goal: SVector<f64, NX> = vector(direction, 0) * field(task, ["distance_m", "D"]);
        Self::Line(Line::new(SVector::zeros(), goal, duration, 9).expect("a line"))
    }
}

impl<const NX: usize> DesiredMotion<f64, NX> for Motion<NX> {
    fn duration(&self) -> f64 {
        match self {
            Self::Line(line) => line.duration(),
            Self::Bezier(_, duration) => *duration,
        }
    }
    fn derivatives(&self, t: f64) -> [SVector<f64, NX>; 5] {
        match self {
            Self::Line(line) => line.derivatives(t),
            Self::Bezier(points, duration) => {
                Bezier::new(points, *duration).expect("a curve").derivatives(t)
            }
        }
    }
}

/// One reference case: a robot whose shape variables are those of the file from `offset` on.
struct Case<E, const NX: usize, const NS: usize> {
    robot: Robot<E>,
    offset: usize,
    data: Value,
    motion: Motion<NX>,
}

impl<E: Equations<NX, NS>, const NX: usize, const NS: usize> Case<E, NX, NS> {
    fn load(name: &str, equations: E, offset: usize) -> Option<Self> {
        let data = load(name)?;
        let motion = Motion::of(&data["task"]);
        Some(Self { robot: Robot(equations), offset, data, motion })
    }

    fn plan(&self, objective: Objective, iterations: usize) -> Plan<'_, Motion<NX>, f64, NX, NS> {
        let samples = self.data["n_samples"].as_u64().expect("a count") as usize;
        let optimiser = LevenbergMarquardt { max_iterations: iterations, ..Default::default() };
        let task = Task::new(&self.motion, samples).objective(objective).optimiser(optimiser);
        plan(&self.robot, &task).expect("a plan")
    }

    fn check(&self) {
        let expected: SMatrix<f64, NX, NS> =
            SMatrix::from_fn(|i, j| number(&self.data["Kqs0"][i][j + self.offset]));
        let shape_gain = self.robot.shape_gain();
        close("shape gain", shape_gain, expected, 1e-12 * largest(expected));
        self.check_report("K0", &self.plan(Objective::Output, 0), &self.data["K0_only"]);
        for expected in self.data["optimised"].as_array().expect("a list") {
            let objective = match expected["objective"].as_str() {
                Some("pos_xw") => Objective::Output,
                Some("pos_theta") => Objective::Position,
                Some("acc") => Objective::Acceleration,
                other => panic!("objective {other:?}"),
            };
            self.check_optimum(&self.plan(objective, 50), expected, &format!("{objective:?}"));
        }
    }

    fn check_optimum(
        &self,
        plan: &Plan<'_, Motion<NX>, f64, NX, NS>,
        expected: &Value,
        name: &str,
    ) {
        let report = plan.report();
        assert!(report.termination.converged(), "{name}: {:?}", report.termination);
        assert!(report.iterations <= 8, "{name}: {} iterations", report.iterations);
        let initial: SMatrix<f64, NS, NX> = matrix(&self.data["K0"], self.offset);
        close("K0", *plan.initial_gain(), initial, 1e-12 * largest(initial));
        let (cost, initial_cost) = (number(&expected["cost"]), number(&expected["cost_at_K0"]));
        close_number(name, report.cost, cost, RELATIVE * cost);
        close_number(name, report.initial_cost, initial_cost, RELATIVE * initial_cost);
        if self.data["direction"].is_null() {
            // A curve determines all of K.
            close(name, *plan.factor(), matrix(&expected["S"], 0), RELATIVE);
        } else {
            let task = &self.data["task"];
            let direction = if task["dir"].is_null() { &task["direction"] } else { &task["dir"] };
            let along = plan.gain() * vector::<NX>(direction, 0);
            let expected: SVector<f64, NS> = vector(&expected["K_dot_dir"], self.offset);
            close(name, along, expected, RELATIVE * largest(expected));
        }
        self.check_report(name, plan, expected);
    }

    fn check_report(&self, name: &str, plan: &Plan<'_, Motion<NX>, f64, NX, NS>, expected: &Value) {
        let report = plan.report();
        let acceleration_cost = number(&expected["J_acc"]);
        close_number(
            name,
            report.acceleration_cost,
            acceleration_cost,
            RELATIVE * acceleration_cost,
        );
        let scale = number(&self.data["len_scale_m_per_qx"]);
        for (found, field) in [
            (report.output_rmse, "rmse_xw_m"),
            (report.output_end_error, "end_err_xw_m"),
            (report.output_max_error, "max_err_xw_m"),
            (report.position_rmse * scale, "rmse_theta_m"),
        ] {
            close_number(&format!("{name} {field}"), found, number(&expected[field]), METRES);
        }
        let peaks: SVector<f64, NS> = vector(&expected["peak_shape_rad"], self.offset);
        close(name, report.peak_shape, peaks, 1e-6);
        let Some(rows) = expected["samples"].as_array() else {
            return;
        };
        let planned: Vec<_> = plan.rows(&self.robot).collect();
        for expected in rows {
            let rate = number(&self.data["sample_rate_hz"]);
            let index = (number(&expected["t"]) * rate).round() as usize;
            self.check_row(&planned[index], expected, scale);
        }
    }

    fn check_row(&self, row: &Row<f64, NX, NS>, expected: &Value, scale: f64) {
        let position = |field: &str| vector::<NX>(&expected[field], 0);
        let shape = |field: &str| vector::<NS>(&expected[field], self.offset);
        close_number("t", row.plan.time, number(&expected["t"]), 1e-12);
        close("qx_des", row.plan.desired.position[0] * scale, position("qx_des") * scale, METRES);
        close("a_des", row.plan.desired.position[2], position("a_des"), 1e-10);
        close("qs", row.plan.shape, shape("qs"), 1e-7);
        close("qs_d", row.plan.shape_velocity, shape("qs_d"), 1e-6);
        close("qs_dd", row.plan.shape_acceleration, shape("qs_dd"), 1e-6);
        close("acc", row.acceleration * scale, position("acc") * scale, 1e-5);
        close("qx", row.position * scale, position("qx") * scale, 2.0 * METRES);
        close("xw", row.output, position("xw"), 2.0 * METRES);
    }
}

/// The ballbot with its arms hanging at rest: with c_φ = 1 they are part of the body.
fn with_resting_arms() -> Ballbot {
    let (mass, arm_length, d_y, d_z, inertia) = (1.0, 0.55, 0.18415, 1.3, [0.0016, 0.0016, 0.001]);
    let Ballbot { m_b, l_b, i_b, .. } = TABLE_I;
    let height: f64 = d_z - arm_length;
    let squares = [d_y * d_y + height * height, height * height, d_y * d_y];
    let total = m_b + 2.0 * mass;
    let center = (m_b * l_b + 2.0 * mass * height) / total;
    let steiner = [1.0, 1.0, 0.0].map(|x| x * (m_b * l_b * l_b - total * center * center));
    let i_b = [0, 1, 2].map(|k| i_b[k] + 2.0 * (inertia[k] + mass * squares[k]) + steiner[k]);
    Ballbot { m_b: total, l_b: center, i_b, ..TABLE_I }
}

macro_rules! case {
    ($test:ident, $name:literal, $equations:expr, $offset:literal) => {
        #[test]
        fn $test() {
            if let Some(case) = Case::load($name, $equations, $offset) {
                case.check();
            }
        }
    };
}

case!(table_2_cart_pole, "table2_cartpole", CartPole { length: 0.5 }, 0);
case!(table_2_planar_ballbot, "table2_planar_ballbot", Planar(TABLE_I), 0);
case!(table_2_ballbot_along_x, "table2_3d_ballbot_x", Spatial(TABLE_I), 0);
case!(table_2_ballbot_along_the_diagonal, "table2_3d_ballbot_diag", Spatial(TABLE_I), 0);
case!(
    table_2_ballbot_with_arms_at_rest,
    "table2_3d_ballbot_arms_cphi1",
    Spatial(with_resting_arms()),
    4
);
case!(figure_6_straight_line, "paper_line_1.414m_4s", Spatial(with_resting_arms()), 4);
case!(figure_10_curve, "paper_bezier43_10s", Spatial(with_resting_arms()), 4);

/// The exact targets for Table II, metres.
#[test]
fn table_2_errors() {
    fn rmse<E: Equations<NX, NS>, const NX: usize, const NS: usize>(equations: E) -> f64 {
        let mut goal = SVector::<f64, NX>::zeros();
        goal[0] = 2.0;
        let line = Line::new(SVector::zeros(), goal, 5.0, 9).expect("a line");
        plan(&Robot(equations), &Task::new(&line, 501)).expect("a plan").report().output_rmse
    }
    for (found, expected) in [
        (rmse(CartPole { length: 0.5 }), 0.0211),
        (rmse(Planar(TABLE_I)), 0.0492),
        (rmse(Spatial(TABLE_I)), 0.0492),
        (rmse(Spatial(with_resting_arms())), 0.0488),
    ] {
        close_number("RMSE", found, expected, 1e-4);
    }
}

/// The handwritten Γ and its Jacobians are those of two rigid-body engines.
#[test]
fn gamma_agrees_with_the_engines() {
    fn check<E: Equations<NX, NS>, const NX: usize, const NS: usize>(points: &Value, equations: E) {
        let robot = Robot(equations);
        for point in points.as_array().expect("points") {
            let arguments = ["qs", "qs_d", "qs_dd"].map(|name| vector::<NS>(&point[name], 0));
            let [qs, qsd, qsdd] = &arguments;
            let response = robot.response(qs, qsd, qsdd);
            let gamma: SVector<f64, NX> = vector(&point["gamma"], 0);
            close("gamma", response.gamma, gamma, 1e-10 * largest(gamma));
            for (found, name) in [
                (response.d_qs, "dgamma_dqs"),
                (response.d_qsd, "dgamma_dqsd"),
                (response.d_qsdd, "dgamma_dqsdd"),
            ] {
                let expected: SMatrix<f64, NX, NS> = matrix(&point[name], 0);
                close(name, found, expected, 1e-10 * largest(expected).max(1.0));
            }
        }
    }
    let Some(data) = load("gamma_points") else {
        return;
    };
    let points = &data["points"];
    check(&points["cartpole"], CartPole { length: 0.5 });
    check(&points["planar_ballbot"], Planar(TABLE_I));
    check(&points["ballbot3d"], Spatial(TABLE_I));
}
