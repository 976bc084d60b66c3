//! The reference planning tasks, planned with a robot of the traits.

mod desired;

use crate::compare::{assert_close, assert_close_on_scale};
use crate::reference::Data;
use desired::{Motion, Prescribed, direction};
use shapebot_dynamics::nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Robot, ShapeAccelerated};
use shapebot_planner::{
    Constrained, LevenbergMarquardt, Objective, Plan, Row, SetMotion, ShapeConstraint, Task,
    Unconstrained, Weighting, plan,
};

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

/// A reference task for a robot.
struct Case<'a, R, C, const NX: usize, const NS: usize> {
    name: &'a str,
    robot: &'a R,
    data: &'a Data,
    motion: Motion<NX>,
    constraint: C,
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
    let task = data.get("task");
    let motion = Motion::of(&task);
    let sets = robot.description().shape_sets.iter().map(|set| set.first).collect::<Vec<_>>();
    let prescribed = Prescribed::<NX>::of(&task, &sets);
    if prescribed.is_empty() {
        let constraint = Unconstrained;
        return Case { name, robot, data, motion, constraint, weights }.check();
    }
    let sets = prescribed.iter().map(|motion| SetMotion { set: motion.set, motion });
    let sets: Vec<_> = sets.collect();
    let constraint = Constrained::new(robot, &sets).expect("a constraint");
    check_constraint(name, &constraint, data);
    Case { name, robot, data, motion, constraint, weights }.check();
}

/// The constrained coordinates, and the acceleration that they cause.
fn check_constraint<const NX: usize, const NS: usize>(
    name: &str,
    constraint: &impl ShapeConstraint<f64, NX, NS>,
    data: &Data,
) {
    let samples = data.get("a_ac_samples").list();
    assert!(!samples.is_empty(), "{name}: nothing to compare the constraint with");
    for sample in samples {
        let t = sample.get("t").number();
        let what = |field: &str| format!("{name}, t = {t}: {field}");
        let shape = constraint.shape(t)[0];
        assert_close_on_scale(what("q_ac"), &shape, &sample.get("q_ac"), 1e-12, 1.0);
        let found = constraint.acceleration(t);
        for (found, field) in found.iter().zip(["a_ac", "a_ac_d", "a_ac_dd"]) {
            assert_close_on_scale(what(field), found, &sample.get(field), 1e-9, 1.0);
        }
    }
}

type Planned<'p, C, const NX: usize, const NS: usize> = Plan<'p, Motion<NX>, f64, NX, NS, C>;

impl<R, C, const NX: usize, const NS: usize> Case<'_, R, C, NX, NS>
where
    R: ShapeAccelerated<f64, NX, NS>,
    C: ShapeConstraint<f64, NX, NS>,
{
    fn plan(&self, objective: Objective, iterations: usize) -> Planned<'_, C, NX, NS> {
        let samples = self.data.get("n_samples").number() as usize;
        let weighting = match &self.weights {
            Some(ratios) => Weighting::Contributions(ratios),
            None => Weighting::MinimumNorm,
        };
        let optimiser = LevenbergMarquardt { max_iterations: iterations, ..Default::default() };
        let task = Task::new(&self.motion, samples).objective(objective);
        let task = task.weighting(weighting).optimiser(optimiser).constraint(self.constraint);
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

    fn check_optimum(&self, label: &str, plan: &Planned<'_, C, NX, NS>, expected: &Data) {
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

    fn check_report(&self, label: &str, plan: &Planned<'_, C, NX, NS>, expected: &Data) {
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
