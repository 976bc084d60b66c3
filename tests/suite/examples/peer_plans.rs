//! Table II's task planned by both of our methods, at the samples of `tests/peers/planning` and at the
//! paper's: plans as CSV and a table of times, in the folder that is given.

use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::SVector;
use shapebot_generated::ballbot_planar::BallbotPlanar;
use shapebot_generated::ballbot3d::Ballbot3d;
use shapebot_generated::ballbot3d_arms::Ballbot3dArms;
use shapebot_generated::cartpole_planar::CartpolePlanar;
use shapebot_planner::motion::Line;
use shapebot_planner::value::{RobotId, write_csv};
use shapebot_planner::{Refinement, Row, Task, Weighting, Workspace, actuator_force, plan, refine};
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const SAMPLES: [usize; 2] = [101, 501];
const CALLS: usize = 301;

/// The median over calls that follow one another, seconds.
fn median(mut plan: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..CALLS)
        .map(|_| {
            let begin = Instant::now();
            plan();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[CALLS / 2]
}

/// Where plans and times go.
struct Output<'a> {
    folder: &'a Path,
    system: &'static str,
    times: String,
}

impl Output<'_> {
    /// A plan's samples, and a line of the table: system, method, samples, seconds, RMSE in metres.
    fn add<R, const N: usize, const NX: usize, const NS: usize>(
        &mut self,
        robot: &R,
        (method, samples): (&str, usize),
        (seconds, rmse): (f64, f64),
        rows: impl Iterator<Item = Row<f64, NX, NS>>,
    ) -> Result<(), Box<dyn Error>>
    where
        R: Robot<f64, N, NX, NS>,
    {
        let system = self.system;
        writeln!(self.times, "{system},{method},{samples},{seconds},{rmse}")?;
        let names: [String; N] = std::array::from_fn(|row| format!("force_{row}"));
        let names: [&str; N] = std::array::from_fn(|row| names[row].as_str());
        let mut text = String::new();
        let force = |row: &_| actuator_force::<_, _, N, NX, NS>(robot, row);
        let description = robot.description();
        write_csv(&mut text, &RobotId::of(description), description, names, rows, force)?;
        fs::write(self.folder.join(format!("{system}_{method}_{samples}.csv")), text)?;
        Ok(())
    }
}

/// Two metres in five seconds, leaning with the unactuated shape set alone.
fn plans<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    output: &mut Output<'_>,
) -> Result<(), Box<dyn Error>>
where
    R: Robot<f64, N, NX, NS>,
{
    let goal = SVector::<f64, NX>::from_fn(|axis, _| if axis == 0 { 2.0 } else { 0.0 });
    let line = Line::new(SVector::zeros(), goal, 5.0, 9)?;
    let sets = robot.description().shape_sets.iter();
    let ratios: Vec<f64> = sets.map(|set| f64::from(u8::from(!set.actuated))).collect();
    for samples in SAMPLES {
        let task = Task::new(&line, samples).weighting(Weighting::Contributions(&ratios));
        let seconds = median(|| {
            let _ = black_box(plan(robot, &task));
        });
        let planned = plan(robot, &task)?;
        let found = (seconds, planned.report().output_rmse);
        output.add(robot, ("gain", samples), found, planned.rows(robot))?;
        let mut workspace = Workspace::<f64, NX, 64>::new();
        let refinement = Refinement::default();
        let seconds = median(|| {
            let _ = black_box(refine(robot, &task, &refinement, &mut workspace));
        });
        let planned = refine(robot, &task, &refinement, &mut workspace)?;
        let found = (seconds, planned.report().output_rmse);
        output.add(robot, ("refined", samples), found, planned.rows(robot, 1)?)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("expected a folder")?;
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    let times = "system,method,samples,seconds,rmse\n".to_owned();
    let mut output = Output { folder, system: "", times };
    // What `tests/peers/planning` calls the models that it knows.
    output.system = "ballbot3d";
    plans(&Ballbot3d::from_model(), &mut output)?;
    output.system = "ballbot3d_arms";
    plans(&Ballbot3dArms::from_model(), &mut output)?;
    output.system = "ballbot_planar";
    plans(&BallbotPlanar::from_model(), &mut output)?;
    output.system = "cartpole";
    plans(&CartpolePlanar::from_model(), &mut output)?;
    fs::write(folder.join("times.csv"), output.times)?;
    Ok(())
}
