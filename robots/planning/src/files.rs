//! A plan as CSV, JSON and bytes.

use crate::error::{Outcome, Refusal};
use crate::motion::PlanFiles;
use nalgebra::SVector;
use shapebot_dynamics::Description;
use shapebot_planner::Row;
use shapebot_planner::value::{FileError, RobotId, encode, encoded_len, write_csv, write_json};

/// Writes the rows with their forces, one per coordinate.
pub(crate) fn files<const N: usize, const NX: usize, const NS: usize>(
    robot: &Description,
    id: &RobotId<'_>,
    rows: &[Row<f64, NX, NS>],
    force: &dyn Fn(&Row<f64, NX, NS>) -> SVector<f64, N>,
) -> Outcome<PlanFiles> {
    let names: Vec<String> =
        robot.coordinates.iter().map(|coordinate| format!("force_{}", coordinate.name)).collect();
    let names: [&str; N] = std::array::from_fn(|i| names.get(i).map_or("", String::as_str));
    let mut files = PlanFiles::default();
    let rows = || rows.iter().copied();
    write_csv(&mut files.csv, id, robot, names, rows(), force).map_err(Refusal::plan)?;
    write_json(&mut files.json, id, robot, names, rows(), force).map_err(Refusal::plan)?;
    files.binary = vec![0; encoded_len::<f64, NX, NS, N>(rows().len())];
    encode::<f64, f64, NX, NS, N>(id, rows(), 1, force, &mut files.binary)
        .map_err(|error: FileError| Refusal::plan(error))?;
    Ok(files)
}
