//! What must hold of a report before it is shown.

use crate::data::{Animation, Report, RunPage};
use crate::error::Error;

pub(super) fn report(report: &Report) -> Result<(), Error> {
    for table in &report.tables {
        for row in &table.rows {
            length(&table.title, "cells of a row", table.columns.len(), row.cells.len())?;
            if let Some(run) = row.run.filter(|&run| run >= report.runs.len()) {
                return Err(Error::UnknownRun { table: table.title.clone(), run });
            }
        }
    }
    for robot in &report.robots {
        let poles = robot.control.iter().flat_map(|c| c.open_loop.iter().chain(&c.closed_loop));
        finite(&robot.name, "poles", poles.flatten().copied())?;
    }
    report.runs.iter().try_for_each(|run| check_run(report, run))
}

fn check_run(report: &Report, run: &RunPage) -> Result<(), Error> {
    let robot = report.robots.iter().find(|robot| robot.name == run.robot);
    let robot = robot
        .ok_or_else(|| Error::UnknownRobot { run: run.title.clone(), robot: run.robot.clone() })?;
    let increasing = run.time.windows(2).all(|pair| pair[0] < pair[1]);
    if run.time.is_empty() || !increasing || !run.time.iter().all(|t| t.is_finite()) {
        return Err(Error::Time { run: run.title.clone() });
    }
    for panel in &run.panels {
        for series in &panel.series {
            let what = format!("{}, {}", panel.title, series.label);
            length(&run.title, &what, run.time.len(), series.values.len())?;
        }
    }
    let figures = run.figures.iter().flat_map(|f| [Some(f.ours), f.paper].into_iter().flatten());
    finite(&run.title, "figures", figures)?;
    match &run.animation {
        Some(animation) => check_animation(run, animation, robot.bodies.len()),
        None => Ok(()),
    }
}

fn check_animation(run: &RunPage, animation: &Animation, bodies: usize) -> Result<(), Error> {
    length(&run.title, "frames", run.time.len(), animation.frames.len())?;
    for frame in &animation.frames {
        length(&run.title, "poses of a frame", bodies, frame.len())?;
        let numbers = frame.iter().flat_map(|pose| pose.position.iter().chain(&pose.rotation));
        finite(&run.title, "poses", numbers.copied())?;
    }
    if let Some(carrier) = animation.carrier {
        // A body that is not there has no poses.
        length(&run.title, "bodies up to the carrier", (carrier + 1).max(bodies), bodies)?;
    }
    finite(&run.title, "floor", [animation.floor])?;
    for path in &animation.paths {
        length(&run.title, "points of a path", run.time.len(), path.points.len())?;
        finite(&run.title, "paths", path.points.iter().flatten().copied())?;
    }
    Ok(())
}

fn length(place: &str, what: &str, expected: usize, found: usize) -> Result<(), Error> {
    if expected == found {
        return Ok(());
    }
    Err(Error::Length { place: format!("{place}: {what}"), expected, found })
}

fn finite(place: &str, what: &str, values: impl IntoIterator<Item = f64>) -> Result<(), Error> {
    match values.into_iter().all(f64::is_finite) {
        true => Ok(()),
        false => Err(Error::NotFinite { place: format!("{place}: {what}") }),
    }
}
