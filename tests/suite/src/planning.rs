//! The reference planning tasks, planned with a robot of the traits.

use crate::compare::{assert_close, assert_close_on_scale};
use crate::reference::Data;
use shapebot_dynamics::nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Robot, ShapeAccelerated};
use shapebot_planner::motion::{Bezier, Derivatives, DesiredMotion, Line};
use shapebot_planner::{LevenbergMarquardt, Objective, Plan, Row, Task, Weighting, plan};

/// The reference integrates a spline through the accelerations, the planner local cubics: at 100 Hz
/// that is all they differ by.
const RELATIVE: f64 = 1e-6;
/// The same for positions.
const METRES: f64 = 1e-8;

/// What the reference calls the models.
#[must_use]
pub fn model_of(system: &str) -> &str {
    match system {
        "cartpole" => "cartpole_planar",
        "planar_ballbot" => "ballbot_planar",
        other => other,
    }
}

/// The desired motion of a reference task.
enum Motion<const NX: usize> {
    Line(Line<f64, NX>),
    Bezier(Vec<SVector<f64, NX>>, f64),
}

/// A field under either of the two names that the files use.
fn either(task: &Data, names: [&str; 2]) -> Data {
    let found = names.iter().find_map(|name| task.optional(name));
    found.unwrap_or_else(|| panic!("reference task has neither of {names:?}"))
}

impl<const NX: usize> Motion<NX> {
    fn of(task: &Data) -> Self {
        let duration = either(task, ["duration_s", "T"]).number();
        if task.get("kind").text() == "bezier" {
            let points = task.get("pts").list();
            return Self::Bezier(points.iter().map(Data::vector).collect(), duration);
        }
        let distance = either(task, ["distance_m", "D"]).number();
        let goal = direction::<NX>(task) * distance;
        Self::Line(Line::new(SVector::zeros(), goal, duration, 9).expect("a line"))
    }
}

fn direction<const NX: usize>(task: &Data) -> SVector<f64, NX> {
    either(task, ["direction", "dir"]).vector()
}

impl<const NX: usize> DesiredMotion<f64, NX> for Motion<NX> {
    fn duration(&self) -> f64 {
        match self {
            Self::Line(line) => line.duration(),
            Self::Bezier(_, duration) => *duration,
        }
    }
    fn derivatives(&self, t: f64) -> Derivatives<f64, NX> {
        match self {
            Self::Line(line) => line.derivatives(t),
            Self::Bezier(points, duration) => {
                Bezier::new(points, *duration).expect("a curve").derivatives(t)
            }
        }
    }
}

/// A reference task for a robot.
struct Case<'a, R, const NX: usize, const NS: usize> {
    name: &'a str,
    robot: &'a R,
    data: &'a Data,
    motion: Motion<NX>,
    weights: Option<Vec<f64>>,
}

/// Plans a reference task under all its objectives and compares gain, costs, errors and samples.
///
/// # Panics
///
/// If the plan is another.
pub fn reference_task<const N: usize, const NX: usize, const NS: usize>(
    name: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    data: &Data,
) {
    let weights = data.optional("weights").map(|weights| {
        ["c_alpha_l", "c_alpha_r", "c_phi"].map(|c| weights.get(c).number()).to_vec()
    });
    let case: Case<'_, _, NX, NS> =
        Case { name, robot, data, motion: Motion::of(&data.get("task")), weights };
    case.check();
}

type Planned<'p, const NX: usize, const NS: usize> = Plan<'p, Motion<NX>, f64, NX, NS>;

impl<R: ShapeAccelerated<f64, NX, NS>, const NX: usize, const NS: usize> Case<'_, R, NX, NS> {
    fn plan(&self, objective: Objective, iterations: usize) -> Planned<'_, NX, NS> {
        let samples = self.data.get("n_samples").number() as usize;
        let weighting = match &self.weights {
            Some(ratios) => Weighting::Contributions(ratios),
            None => Weighting::MinimumNorm,
        };
        let optimiser = LevenbergMarquardt { max_iterations: iterations, ..Default::default() };
        let task = Task::new(&self.motion, samples).objective(objective);
        let task = task.weighting(weighting).optimiser(optimiser);
        plan(self.robot, &task).unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    fn check(&self) {
        let name = self.name;
        assert_close(
            format!("{name}: K0_qs"),
            &self.robot.shape_gain(),
            &self.data.get("Kqs0"),
            1e-12,
        );
        let initial = self.plan(Objective::Output, 0);
        assert_close(format!("{name}: K0"), initial.initial_gain(), &self.data.get("K0"), 1e-12);
        self.check_report("K0", &initial, &self.data.get("K0_only"));
        let optima = self.data.get("optimised").list();
        assert!(!optima.is_empty(), "{name}: nothing to compare with");
        for expected in &optima {
            let label = expected.get("objective").text().to_owned();
            let objective = match label.as_str() {
                "pos_xw" => Objective::Output,
                "pos_theta" => Objective::Position,
                "acc" => Objective::Acceleration,
                other => panic!("{name}: objective {other}"),
            };
            self.check_optimum(&label, &self.plan(objective, 50), expected);
        }
    }

    fn check_optimum(&self, label: &str, plan: &Planned<'_, NX, NS>, expected: &Data) {
        let name = format!("{}, {label}", self.name);
        let report = plan.report();
        assert!(report.termination.converged(), "{name}: {:?}", report.termination);
        assert!(report.iterations <= 8, "{name}: {} iterations", report.iterations);
        for (found, field) in [(report.cost, "cost"), (report.initial_cost, "cost_at_K0")] {
            assert_close(format!("{name}: {field}"), &found, &expected.get(field), RELATIVE);
        }
        match expected.optional("K_dot_dir") {
            Some(along) => {
                let found = plan.gain() * direction::<NX>(&self.data.get("task"));
                assert_close(format!("{name}: K times direction"), &found, &along, RELATIVE);
            }
            // A curve determines all of K.
            None => {
                assert_close(format!("{name}: S"), plan.factor(), &expected.get("S"), RELATIVE);
                assert_close(format!("{name}: K"), plan.gain(), &expected.get("K"), RELATIVE);
            }
        }
        self.check_report(label, plan, expected);
    }

    fn check_report(&self, label: &str, plan: &Planned<'_, NX, NS>, expected: &Data) {
        let name = format!("{}, {label}", self.name);
        let report = plan.report();
        let cost = report.acceleration_cost;
        assert_close(format!("{name}: J_acc"), &cost, &expected.get("J_acc"), RELATIVE);
        let scale = self.data.get("len_scale_m_per_qx").number();
        for (found, field) in [
            (report.output_rmse, "rmse_xw_m"),
            (report.output_end_error, "end_err_xw_m"),
            (report.output_max_error, "max_err_xw_m"),
            (report.position_rmse * scale, "rmse_theta_m"),
        ] {
            let what = format!("{name}: {field}");
            assert_close_on_scale(what, &found, &expected.get(field), METRES, 1.0);
        }
        let peaks = expected.get("peak_shape_rad");
        assert_close_on_scale(format!("{name}: peaks"), &report.peak_shape, &peaks, 1e-6, 1.0);
        let rows: Vec<_> = plan.rows(self.robot).collect();
        let rate = self.data.get("sample_rate_hz").number();
        for sample in expected.optional("samples").map(|s| s.list()).unwrap_or_default() {
            let index = (sample.get("t").number() * rate).round() as usize;
            check_row(&name, &rows[index], &sample, scale);
        }
    }
}

/// One sample; positions in metres.
fn check_row<const NX: usize, const NS: usize>(
    name: &str,
    row: &Row<f64, NX, NS>,
    expected: &Data,
    scale: f64,
) {
    let name = format!("{name}, t = {}", row.plan.time);
    let position = |field: &str| expected.get(field).vector::<NX>();
    let metres =
        |what: &str, found: SVector<f64, NX>, expected: SVector<f64, NX>, tolerance: f64| {
            assert_close_on_scale(format!("{name}: {what}"), &found, &expected, tolerance, 1.0);
        };
    assert_close_on_scale(format!("{name}: t"), &row.plan.time, &expected.get("t"), 1e-12, 1.0);
    let desired = &row.plan.desired.position;
    metres("qx_des", desired[0] * scale, position("qx_des") * scale, METRES);
    metres("a_des", desired[2], position("a_des"), 1e-10);
    for (found, field, tolerance) in [
        (row.plan.shape, "qs", 1e-7),
        (row.plan.shape_velocity, "qs_d", 1e-6),
        (row.plan.shape_acceleration, "qs_dd", 1e-6),
    ] {
        let what = format!("{name}: {field}");
        assert_close_on_scale(what, &found, &expected.get(field), tolerance, 1.0);
    }
    metres("acc", row.acceleration * scale, position("acc") * scale, 1e-5);
    metres("qx", row.position * scale, position("qx") * scale, 2.0 * METRES);
    metres("xw", row.output, position("xw"), 2.0 * METRES);
}

/// Γ, its Jacobians, M, C q̇ and G at one of the reference's random points.
///
/// # Panics
///
/// If one of them is off.
pub fn reference_point<const N: usize, const NX: usize, const NS: usize, R>(
    name: &str,
    robot: &R,
    point: &Data,
) where
    R: Robot<f64, N, NX, NS>,
{
    const TOLERANCE: f64 = 1e-10;
    let [qs, qsd, qsdd] = ["qs", "qs_d", "qs_dd"].map(|field| point.get(field).vector::<NS>());
    let response = robot.response(&qs, &qsd, &qsdd);
    let gamma = robot.gamma(&qs, &qsd, &qsdd);
    assert_close(format!("{name}: gamma"), &gamma, &point.get("gamma"), TOLERANCE);
    let jacobians: [(&str, SMatrix<f64, NX, NS>); 3] = [
        ("dgamma_dqs", response.d_qs),
        ("dgamma_dqsd", response.d_qsd),
        ("dgamma_dqsdd", response.d_qsdd),
    ];
    for (field, found) in jacobians {
        assert_close(format!("{name}: {field}"), &found, &point.get(field), TOLERANCE);
    }
    // M, C q̇ and G of these robots do not depend on q_x.
    let q = R::join(&SVector::zeros(), &qs);
    let qd = R::join(&point.get("qx_d").vector(), &qsd);
    assert_close(format!("{name}: M"), &robot.mass_matrix(&q), &point.get("M"), TOLERANCE);
    assert_close(
        format!("{name}: Cqd"),
        &robot.coriolis_vector(&q, &qd),
        &point.get("Cqd"),
        TOLERANCE,
    );
    assert_close(format!("{name}: G"), &robot.gravity(&q), &point.get("G"), TOLERANCE);
}
