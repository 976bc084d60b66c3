//! A plan file as a table, whatever its form.

use crate::failure::{Failure, Outcome};
use shapebot_dynamics::Description;
use shapebot_planner::value::{
    FileError, PlanBytes, PlanText, RobotId, Sizes, TextForm, TextWriter, encode_values,
    encoded_values_len, state_columns,
};

/// What the columns of forces begin with.
pub(super) const FORCE: &str = "force_";

/// Forms of a plan file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Csv,
    Json,
    Binary,
}

impl Form {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Csv => "CSV",
            Self::Json => "JSON",
            Self::Binary => "binary",
        }
    }
}

/// A plan that was read and found whole and unaltered.
#[derive(Clone, Debug)]
pub(super) struct PlanTable<'a> {
    pub(super) form: Form,
    pub(super) robot: String,
    pub(super) fingerprint: u32,
    /// Names of the columns; none of a binary plan until its robot is known.
    pub(super) columns: Vec<String>,
    /// One number per column, time first.
    pub(super) rows: Vec<Vec<f64>>,
    id: RobotId<'a>,
    /// Of a binary plan.
    sizes: Option<Sizes>,
}

impl<'a> PlanTable<'a> {
    pub(super) fn read(content: &'a [u8]) -> Result<Self, FileError> {
        if content.starts_with(b"SBPL") {
            return Self::of_bytes(&PlanBytes::open(content)?);
        }
        match std::str::from_utf8(content) {
            Ok(text) => PlanText::open(text).map(|text| Self::of_text(&text)),
            // A plan's text is UTF-8 when it is written.
            Err(_) if content.starts_with(b"# shapebot-plan") || content.starts_with(b"{") => {
                Err(FileError::Checksum)
            }
            Err(_) => Err(FileError::NotAPlan),
        }
    }

    fn of_text(text: &PlanText<'a>) -> Self {
        Self {
            form: match text.form() {
                TextForm::Csv => Form::Csv,
                TextForm::Json => Form::Json,
            },
            robot: text.robot().name().to_owned(),
            fingerprint: text.robot().fingerprint(),
            columns: text.columns().map(str::to_owned).collect(),
            rows: text.rows().map(|row| row.flatten().collect()).collect(),
            id: *text.robot(),
            sizes: None,
        }
    }

    fn of_bytes(plan: &PlanBytes<'a>) -> Result<Self, FileError> {
        let values = plan.sizes().values();
        let row = |node| -> Vec<f64> {
            let values = (0..values).map(|index| plan.value(node, index));
            std::iter::once(plan.time(node)).chain(values).collect()
        };
        let rows: Vec<Vec<f64>> = (0..plan.nodes()).map(row).collect();
        if rows.iter().flatten().any(|value| !value.is_finite()) {
            return Err(FileError::NonFinite);
        }
        Ok(Self {
            form: Form::Binary,
            robot: plan.robot().name().to_owned(),
            fingerprint: plan.robot().fingerprint(),
            columns: Vec::new(),
            rows,
            id: *plan.robot(),
            sizes: Some(plan.sizes()),
        })
    }

    pub(super) fn id(&self) -> RobotId<'a> {
        self.id
    }

    /// Names the columns of a binary plan as its robot does.
    pub(super) fn name_columns(&mut self, robot: &Description) {
        let Some(sizes) = self.sizes.filter(|_| self.columns.is_empty()) else {
            return;
        };
        let names = state_columns(robot).map(|name| name.to_string());
        let mut columns: Vec<String> = std::iter::once("t".to_owned()).chain(names).collect();
        let coordinates = robot.coordinates.iter().map(|coordinate| coordinate.name);
        columns.extend(coordinates.take(sizes.forces).map(|name| format!("{FORCE}{name}")));
        self.columns = columns;
    }

    pub(super) fn time(&self, row: usize) -> f64 {
        self.rows.get(row).and_then(|row| row.first()).copied().unwrap_or_default()
    }

    /// The values of a column.
    pub(super) fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|column| column == name)?;
        self.rows.iter().map(|row| row.get(index).copied()).collect()
    }

    /// The plan in another form; `content` is the file that it was read from.
    pub(super) fn convert(
        &self,
        content: &[u8],
        form: Form,
        robot: Option<&Description>,
    ) -> Outcome<Vec<u8>> {
        if form == self.form {
            return Ok(content.to_vec());
        }
        match form {
            Form::Csv => self.text(TextForm::Csv),
            Form::Json => self.text(TextForm::Json),
            Form::Binary => self.binary(robot.ok_or_else(unnamed)?),
        }
    }

    fn text(&self, form: TextForm) -> Outcome<Vec<u8>> {
        let width = self.rows.first().map_or(0, Vec::len);
        if self.columns.len() != width {
            return Err(unnamed());
        }
        let mut text = String::new();
        let mut write = || -> std::fmt::Result {
            let mut writer = TextWriter::new(&mut text, form, &self.id, self.columns.iter())?;
            self.rows.iter().try_for_each(|row| writer.row(row.iter().copied()))?;
            writer.finish()
        };
        write().map_err(Failure::refused)?;
        Ok(text.into_bytes())
    }

    /// The columns that the binary form has, at equal distances in time.
    fn binary(&self, robot: &Description) -> Outcome<Vec<u8>> {
        let forces = self.columns.iter().filter(|name| name.starts_with(FORCE)).cloned();
        let forces: Vec<String> = forces.collect();
        let sizes = Sizes {
            positions: robot.position_coordinates().len(),
            shapes: robot.shape_coordinates().len(),
            forces: forces.len(),
        };
        let names = state_columns(robot).map(|name| name.to_string()).chain(forces);
        let index = |name: String| {
            let index = self.columns.iter().position(|column| *column == name);
            index.ok_or_else(|| Failure::refused(format!("the plan has no column `{name}`")))
        };
        let order = names.map(index).collect::<Outcome<Vec<usize>>>()?;
        self.check_times()?;
        let value = |row: usize, k: usize| {
            let column = order.get(k).copied().unwrap_or_default();
            self.rows.get(row).and_then(|row| row.get(column)).copied().unwrap_or(f64::NAN)
        };
        let mut bytes = vec![0; encoded_values_len::<f64>(&sizes, self.rows.len())];
        let time = |row| self.time(row);
        encode_values::<f64>(&self.id, &sizes, self.rows.len(), time, value, &mut bytes)
            .map_err(Failure::refused)?;
        Ok(bytes)
    }

    /// Refuses times that are not at equal distances: the binary form has only the first and the step.
    fn check_times(&self) -> Outcome {
        let last = self.rows.len().saturating_sub(1);
        let (first, end) = (self.time(0), self.time(last));
        let step = (end - first) / last as f64;
        for row in 0..=last {
            if (self.time(row) - first - step * row as f64).abs() > 1e-6 * step {
                return Err(Failure::refused(format!(
                    "sample {row} is at {} s: the binary form needs equal distances in time",
                    self.time(row)
                )));
            }
        }
        Ok(())
    }
}

fn unnamed() -> Failure {
    Failure::usage("the plan's robot is not bundled: --robot FILE says what its columns are")
}
