//! Every fault in every state, over the bundled tasks of ballbots.
//!
//! By default a part of all injections; all of them:
//!
//! ```text
//! cargo test --release -p shapebot-rig --test campaign -- --ignored --nocapture
//! ```

mod common;

use common::say;
use rayon::prelude::*;
use shapebot_control::Gains;
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_generated::{ballbot_planar, ballbot3d, ballbot3d_arms};
use shapebot_planner::value::PlanView;
use shapebot_rig::campaign::{Extent, Subject, Summary, campaign};
use shapebot_sim::{Plant, Scenario};
use std::time::Instant;

/// Bundled tasks of a robot; each with the bundled drives of the same robot.
fn tasks(robot: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let line = format!("robot = \"{robot}\"");
    let own = move |text: &str| text.lines().any(|other| other == line);
    shapebot_tasks::TASKS.iter().copied().filter(move |(_, text)| own(text))
}

fn subject<R, const N: usize, const NX: usize, const NS: usize>(
    (robot, design): (&R, &ControlDesign),
    drive: &str,
    (task, text): (&str, &str),
    extent: Extent,
) -> Summary
where
    R: Robot<f64, N, NX, NS>,
{
    let motion = common::motion(robot, text);
    let description = common::drive(drive, robot.description());
    let tables = description.tables();
    let table = tables.table();
    let plan = PlanView::<f64, NX, NS, N>::open_any(&motion.files.binary).unwrap();
    let scenario = Scenario::default();
    let plant = Plant::new(robot, robot, &scenario, 0.0005).unwrap();
    let mut gains = Gains::from_design(robot, design).unwrap();
    gains.period = f64::from(table.timing.period_us) * 1e-6;
    let task = format!("{task} on {drive}");
    let subject = Subject {
        task: &task,
        robot,
        plant: &plant,
        description: &description,
        table: &table,
        gains,
        plan,
    };
    let begun = Instant::now();
    let summary = campaign(&subject, extent, &mut |_| {});
    let summary = summary.unwrap_or_else(|error| panic!("{task}: {error}"));
    say(&format!("{task}: {} injections in {:.0?}", summary.injections, begun.elapsed()));
    summary
}

/// One in `stride` of all injections.
fn all(stride: usize) -> Summary {
    let planar = ballbot_planar::BallbotPlanar::from_model();
    let spatial = ballbot3d::Ballbot3d::from_model();
    let arms = ballbot3d_arms::Ballbot3dArms::from_model();
    let mut jobs: Vec<Box<dyn Fn(Extent) -> Summary + Send + Sync>> = Vec::new();
    for task in tasks("ballbot3d_arms") {
        let robot = (&arms, &ballbot3d_arms::CONTROL);
        jobs.push(Box::new(move |extent| subject(robot, "ballbot3d_arms", task, extent)));
    }
    for drive in ["ballbot3d", "ballbot3d_1khz"] {
        for task in tasks("ballbot3d") {
            let robot = (&spatial, &ballbot3d::CONTROL);
            jobs.push(Box::new(move |extent| subject(robot, drive, task, extent)));
        }
    }
    for task in tasks("ballbot_planar") {
        let robot = (&planar, &ballbot_planar::CONTROL);
        jobs.push(Box::new(move |extent| subject(robot, "ballbot_planar", task, extent)));
    }
    let extent = |job: usize| Extent { stride, first: job * 7 % stride };
    let parts = jobs.par_iter().enumerate().map(|(index, job)| job(extent(index)));
    let summary = parts.reduce(Summary::default, |mut all, part| {
        all.join(part);
        all
    });
    say(&format!("{summary}"));
    for violation in &summary.violations {
        say(violation);
    }
    summary
}

#[test]
fn a_part_of_all_faults_does_no_harm() {
    let summary = all(97);
    assert!(summary.injections > 100, "{summary}");
    assert!(summary.violations.is_empty(), "{summary}");
}

#[test]
#[ignore = "takes long: see above"]
fn no_fault_does_harm() {
    let stride = std::env::var("SHAPEBOT_STRIDE").map_or(1, |text| text.parse().unwrap());
    let begun = Instant::now();
    let summary = all(stride);
    say(&format!("{:.0?}", begun.elapsed()));
    assert!(summary.injections * stride >= 10_000, "{summary}");
    assert!(summary.violations.is_empty(), "{summary}");
}
