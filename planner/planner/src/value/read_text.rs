//! Reading CSV and JSON in place.

use super::FileError;
use super::robot::RobotId;
use super::text::{CSV_HEAD, TextForm, hexadecimal, verified};

/// A plan as CSV or JSON, checked once and read in place.
///
/// Only files as they were written are read: whoever formats one anew breaks its checksum.
#[derive(Clone, Copy, Debug)]
pub struct PlanText<'a> {
    form: TextForm,
    robot: RobotId<'a>,
    columns: &'a str,
    /// Whole lines, one per row.
    rows: &'a str,
}

impl<'a> PlanText<'a> {
    /// # Errors
    ///
    /// Those of [`verify_text`](super::verify_text); [`FileError::Malformed`] where a row is no list of
    /// numbers, one for each column.
    pub fn open(text: &'a str) -> Result<Self, FileError> {
        let (form, content) = verified(text)?;
        let read = match form {
            TextForm::Csv => read_csv(content),
            TextForm::Json => read_json(content),
        };
        let plan = read.ok_or(FileError::NotAPlan)?;
        let columns = plan.columns().count();
        // Rows end the file, but for a bracket in JSON.
        let after = plan.rows.lines().count() + usize::from(form == TextForm::Json);
        let first = content.lines().count() - after;
        for (index, row) in plan.rows().enumerate() {
            let line = first + index + 1;
            let mut found = 0;
            for cell in row {
                match cell {
                    Some(value) if value.is_finite() => found += 1,
                    _ => return Err(FileError::Malformed { line }),
                }
            }
            if found != columns {
                return Err(FileError::Malformed { line });
            }
        }
        Ok(plan)
    }

    /// CSV or JSON.
    pub fn form(&self) -> TextForm {
        self.form
    }

    /// The robot that the plan is for.
    pub fn robot(&self) -> &RobotId<'a> {
        &self.robot
    }

    /// Names of the columns.
    pub fn columns(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.columns.split(',').map(|name| name.trim().trim_matches('"'))
    }

    /// Numbers of the rows, one for each column. `None` for what is no number, which [`open`](Self::open)
    /// refuses.
    pub fn rows(
        &self,
    ) -> impl Iterator<Item = impl Iterator<Item = Option<f64>> + use<'a>> + use<'a> {
        self.rows.lines().map(|line| {
            let line = line.strip_suffix(',').unwrap_or(line);
            let cells = line.trim_start_matches('[').trim_end_matches(']');
            cells.split(',').map(|cell| cell.trim().parse().ok())
        })
    }
}

/// A line and what follows it.
fn line(text: &str) -> Option<(&str, &str)> {
    text.split_once('\n')
}

fn read_csv(content: &str) -> Option<PlanText<'_>> {
    let (head, rest) = line(content)?;
    let (_, head) = head.strip_prefix(CSV_HEAD)?.split_once(' ')?;
    let (fingerprint, name) = head.split_once(' ')?;
    let robot = RobotId::from_file(name, hexadecimal(fingerprint)?);
    let (columns, rows) = line(rest)?;
    Some(PlanText { form: TextForm::Csv, robot, columns, rows })
}

fn read_json(content: &str) -> Option<PlanText<'_>> {
    // Brace, format and version.
    let (_, rest) = line(content)?;
    let (_, rest) = line(rest)?;
    let (_, rest) = line(rest)?;
    let (name, rest) = line(rest)?;
    let name = name.strip_prefix("\"robot\": \"")?.strip_suffix("\",")?;
    let (fingerprint, rest) = line(rest)?;
    let fingerprint = fingerprint.strip_prefix("\"fingerprint\": \"")?.strip_suffix("\",")?;
    let robot = RobotId::from_file(name, hexadecimal(fingerprint)?);
    let (columns, rest) = line(rest)?;
    let columns = columns.strip_prefix("\"columns\": [")?.strip_suffix("],")?;
    let (_, rows) = line(rest.strip_prefix("\"rows\": [")?)?;
    let rows = rows.strip_suffix(']')?;
    Some(PlanText { form: TextForm::Json, robot, columns, rows })
}
