//! Bundled drives, robots and tasks.
#![allow(dead_code, reason = "each test uses its part")]

pub(crate) mod wire;

use nalgebra::{SMatrix, SVector};
use shapebot_control::Gains;
use shapebot_drive_build::{DriveDescription, Source};
use shapebot_dynamics::{Description, Robot};
use shapebot_planner::value::{PlanView, RobotId};
use shapebot_planning::PlannedMotion;
use shapebot_rig::{Outcome, Script, network, run};
use shapebot_runtime::{Runtime, Settings};
use shapebot_sim::{Plant, Scenario};
use std::fmt;
use std::io::Write as _;
use std::ops::Range;

/// A bundled drive for a model.
pub(crate) fn drive(name: &str, model: &Description) -> DriveDescription {
    let source = Source::parse(name, shapebot_drives::text(name).unwrap()).unwrap();
    source.check(model).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A line of figures, past the test harness.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// The plan of a task's text.
pub(crate) fn motion<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    text: &str,
) -> PlannedMotion
where
    R: Robot<f64, N, NX, NS>,
{
    let task = shapebot_tasks::parse("task.toml", text).unwrap();
    let id = RobotId::of(robot.description());
    shapebot_planning::plan(robot, &task, &id).unwrap_or_else(|e| panic!("{e:?}"))
}

/// K⁰_qx of a plan of one phase.
pub(crate) fn plan_gain<const NX: usize, const NS: usize>(
    motion: &PlannedMotion,
) -> SMatrix<f64, NS, NX> {
    let gain = &motion.phases.first().unwrap().gain;
    SMatrix::from_fn(|i, j| gain[i][j])
}

/// The paper's straight line along the first axis, refined.
pub(crate) fn line(robot: &str, goal: &str, duration: &str) -> String {
    format!(
        "robot = \"{robot}\"\nsamples = 501\nmethod = \"refined\"\n[motion]\nkind = \"line\"\n\
         goal = \"{goal} m\"\nduration = \"{duration} s\"\n"
    )
}

/// How a plan was followed.
pub(crate) struct Followed {
    outcome: Outcome,
    /// Largest compensation of each shape coordinate along the plan, degrees.
    compensation: Vec<f64>,
    /// Root of the mean squared distance of the output from the origin along the plan, m.
    distance: f64,
}

impl Followed {
    /// The largest compensation of some shape coordinates, degrees.
    pub(crate) fn compensation(&self, coordinates: Range<usize>) -> f64 {
        self.compensation[coordinates].iter().fold(0.0, |most, x| f64::max(most, *x))
    }

    /// Root of the mean squared distance of the output from the origin along the plan, m.
    pub(crate) const fn distance(&self) -> f64 {
        self.distance
    }

    /// What came of it.
    pub(crate) const fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// The error against the plan is the robot's own and below a bound in metres; no frame was lost and no
    /// torque cut.
    pub(crate) fn assert_within(&self, bound: f64) {
        let counters = self.outcome.counters;
        assert!(self.outcome.is_truth);
        assert!(self.outcome.plan_rmse <= bound, "{self}");
        assert_eq!([counters.malformed, counters.missed, counters.limited], [0; 3], "{self}");
    }
}

impl fmt::Display for Followed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Outcome { plan_rmse, plan_max, end_error, lean_max, force_max, cycles, .. } =
            self.outcome;
        write!(
            f,
            "RMSE {:.3} mm, most {:.3} mm, at the end {:.3} mm, lean {:.2}°, {force_max:.1} N·m, \
             compensation {:.3?}°, {cycles} cycles, {} missed, {} limited",
            plan_rmse * 1e3,
            plan_max * 1e3,
            end_error * 1e3,
            lean_max.to_degrees(),
            self.compensation,
            self.outcome.counters.missed,
            self.outcome.counters.limited,
        )
    }
}

/// Follows a plan through the frames of a bundled drive.
pub(crate) fn follow<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    gains: &Gains<f64, NX, NS>,
    drive_name: &str,
    motion: &PlannedMotion,
    scenario: &Scenario<NX, NS>,
) -> Followed
where
    R: Robot<f64, N, NX, NS>,
{
    let plant = Plant::new(robot, robot, scenario, 0.0005).unwrap();
    follow_on(robot, &plant, gains, drive_name, motion, &Script::default())
}

/// The same on any plant, with times of its own.
pub(crate) fn follow_on<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    plant: &Plant<'_, N, NX, NS>,
    gains: &Gains<f64, NX, NS>,
    drive_name: &str,
    motion: &PlannedMotion,
    script: &Script,
) -> Followed
where
    R: Robot<f64, N, NX, NS>,
{
    let description = drive(drive_name, robot.description());
    let tables = description.tables();
    let table = tables.table();
    let plan = PlanView::<f64, NX, NS, N>::open_any(&motion.files.binary).unwrap();
    let mut world = network(&description, robot, plant, 1).unwrap();
    let period = f64::from(table.timing.period_us) * 1e-6;
    let gains = Gains { period, ..*gains };
    let mut runtime = Runtime::new(robot, &table, &gains, &Settings::default()).unwrap();
    runtime.load(plan).unwrap();
    let mut compensation = SVector::<f64, NS>::zeros();
    let (mut squares, mut cycles) = (0.0, 0.0);
    let outcome = run(&mut runtime, (robot, &plan), &mut world, script, &mut |cycle| {
        let snapshot = cycle.snapshot;
        if let (Some(_), Some(command)) = (snapshot.plan_time, snapshot.command) {
            compensation = compensation.sup(&command.compensation.abs());
            let (qx, qs) = R::split(&cycle.truth.unwrap().q);
            squares += robot.output(&qx, &qs).norm_squared();
            cycles += 1.0;
        }
    });
    let outcome = outcome.unwrap_or_else(|error| panic!("{drive_name}: {error}"));
    let compensation = compensation.iter().map(|x| x.to_degrees()).collect();
    Followed { outcome, compensation, distance: f64::sqrt(squares / cycles) }
}
