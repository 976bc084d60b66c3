//! CSV and JSON.

use super::FileError;
use super::binary::VERSION;
use super::crc::{Crc32, crc32};
use super::robot::RobotId;
use crate::plan::Row;
use core::fmt::{self, Write};
use nalgebra::SVector;
use shapebot_dynamics::{Description, Ordered};

/// What precedes the checksum in a file, for both formats.
const CSV_MARK: &str = "# crc32 ";
const JSON_MARK: &str = ",\n\"crc32\": \"";

/// What a file begins with.
pub(super) const CSV_HEAD: &str = "# shapebot-plan ";
pub(super) const JSON_HEAD: &str = "{\n\"format\": \"shapebot-plan\",\n\"version\": ";

/// Forms of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextForm {
    /// Comma-separated values.
    Csv,
    /// JSON.
    Json,
}

/// Text on its way to `out`, with its checksum.
struct Checked<'w, W> {
    out: &'w mut W,
    crc: Crc32,
}

impl<W: Write> Write for Checked<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.crc.add(text.as_bytes());
        self.out.write_str(text)
    }
}

/// A plan as text, cell by cell: columns, then rows.
///
/// Lines that begin with `#`, or members of the object, carry version, robot, its fingerprint and the
/// checksum.
pub struct TextWriter<'w, W> {
    out: Checked<'w, W>,
    form: TextForm,
    /// Rows so far.
    rows: usize,
}

impl<'w, W: Write> TextWriter<'w, W> {
    /// Begins a file with the names of its columns.
    ///
    /// # Errors
    ///
    /// Those of `out`, here and below.
    pub fn new<N: fmt::Display>(
        out: &'w mut W,
        form: TextForm,
        robot: &RobotId<'_>,
        columns: impl Iterator<Item = N>,
    ) -> Result<Self, fmt::Error> {
        let mut out = Checked { out, crc: Crc32::new() };
        let (name, fingerprint) = (Plain(robot.name()), robot.fingerprint());
        match form {
            TextForm::Csv => writeln!(out, "{CSV_HEAD}{VERSION} {fingerprint:08x} {name}")?,
            TextForm::Json => write!(
                out,
                "{JSON_HEAD}{VERSION},\n\"robot\": \"{name}\",\n\
                 \"fingerprint\": \"{fingerprint:08x}\",\n\"columns\": ["
            )?,
        }
        for (index, column) in columns.enumerate() {
            match (form, index) {
                (TextForm::Csv, 0) => write!(out, "{column}")?,
                (TextForm::Csv, _) => write!(out, ",{column}")?,
                (TextForm::Json, 0) => write!(out, "\"{column}\"")?,
                (TextForm::Json, _) => write!(out, ", \"{column}\"")?,
            }
        }
        out.write_str(match form {
            TextForm::Csv => "\n",
            TextForm::Json => "],\n\"rows\": [",
        })?;
        Ok(Self { out, form, rows: 0 })
    }

    /// Adds a row. Numbers are the shortest that read back to the same value, `null` if not finite.
    ///
    /// # Errors
    ///
    /// Those of `out`.
    pub fn row<T: Ordered + fmt::Display>(
        &mut self,
        cells: impl Iterator<Item = T>,
    ) -> fmt::Result {
        let (begin, between, end) = match (self.form, self.rows) {
            (TextForm::Csv, _) => ("", ",", "\n"),
            (TextForm::Json, 0) => ("\n[", ", ", "]"),
            (TextForm::Json, _) => (",\n[", ", ", "]"),
        };
        self.rows += 1;
        self.out.write_str(begin)?;
        for (index, cell) in cells.enumerate() {
            if index > 0 {
                self.out.write_str(between)?;
            }
            if cell.is_finite() {
                write!(self.out, "{cell}")?;
            } else {
                self.out.write_str("null")?;
            }
        }
        self.out.write_str(end)
    }

    /// Ends the file with its checksum.
    ///
    /// # Errors
    ///
    /// Those of `out`.
    pub fn finish(mut self) -> fmt::Result {
        match self.form {
            TextForm::Csv => {
                let crc = self.out.crc.value();
                writeln!(self.out.out, "{CSV_MARK}{crc:08x}")
            }
            TextForm::Json => {
                write!(self.out, "\n]")?;
                let crc = self.out.crc.value();
                write!(self.out.out, "{JSON_MARK}{crc:08x}\"\n}}\n")
            }
        }
    }
}

/// A name without what would end a line or a string.
struct Plain<'a>(&'a str);

impl fmt::Display for Plain<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = |c: char| !c.is_control() && c != '"' && c != '\\';
        self.0.chars().try_for_each(|c| f.write_char(if plain(c) { c } else { '_' }))
    }
}

/// Writes one row of numbers per sample as CSV: time, desired output, output, coordinates with rates
/// and accelerations, forces.
///
/// # Errors
///
/// Those of `out`.
pub fn write_csv<W, T, const NX: usize, const NS: usize, const F: usize>(
    out: &mut W,
    robot: &RobotId<'_>,
    description: &Description,
    forces: [&str; F],
    rows: impl Iterator<Item = Row<T, NX, NS>>,
    force: impl Fn(&Row<T, NX, NS>) -> SVector<T, F>,
) -> fmt::Result
where
    W: Write,
    T: Ordered + fmt::Display,
{
    let columns = columns(description, &forces);
    write_rows(TextWriter::new(out, TextForm::Csv, robot, columns)?, rows, force)
}

/// The same as JSON: an object with format, version, robot, columns, rows and checksum.
///
/// # Errors
///
/// Those of `out`.
pub fn write_json<W, T, const NX: usize, const NS: usize, const F: usize>(
    out: &mut W,
    robot: &RobotId<'_>,
    description: &Description,
    forces: [&str; F],
    rows: impl Iterator<Item = Row<T, NX, NS>>,
    force: impl Fn(&Row<T, NX, NS>) -> SVector<T, F>,
) -> fmt::Result
where
    W: Write,
    T: Ordered + fmt::Display,
{
    let columns = columns(description, &forces);
    write_rows(TextWriter::new(out, TextForm::Json, robot, columns)?, rows, force)
}

fn write_rows<W: Write, T, const NX: usize, const NS: usize, const F: usize>(
    mut writer: TextWriter<'_, W>,
    rows: impl Iterator<Item = Row<T, NX, NS>>,
    force: impl Fn(&Row<T, NX, NS>) -> SVector<T, F>,
) -> fmt::Result
where
    T: Ordered + fmt::Display,
{
    for row in rows {
        let (plan, force) = (&row.plan, force(&row));
        let positions =
            [plan.desired.output[0], row.output, row.position, row.velocity, row.acceleration];
        let shapes = [plan.shape, plan.shape_velocity, plan.shape_acceleration];
        let positions = positions.iter().flat_map(|v| v.iter());
        let shapes = shapes.iter().flat_map(|v| v.iter());
        let values = positions.chain(shapes).chain(force.iter()).copied();
        writer.row(core::iter::once(plan.time).chain(values))?;
    }
    writer.finish()
}

/// A column's name: coordinate, suffix.
#[derive(Clone, Copy, Debug)]
pub struct ColumnName<'a>(&'a str, &'static str);

impl fmt::Display for ColumnName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.0, self.1)
    }
}

/// Suffixes of a coordinate's value, rate and acceleration.
const DERIVATIVES: [&str; 3] = ["", "_d", "_dd"];

/// The columns of a plan: `t`, the desired output (`x_desired`), the output, position coordinates,
/// their rates (`_d`) and accelerations (`_dd`), the same of the shape, forces.
fn columns<'a>(
    description: &'a Description,
    forces: &'a [&'a str],
) -> impl Iterator<Item = ColumnName<'a>> + 'a {
    let outputs = |suffix| description.outputs.iter().map(move |name| ColumnName(name, suffix));
    core::iter::once(ColumnName("t", ""))
        .chain(outputs("_desired"))
        .chain(outputs(""))
        .chain(state_columns(description))
        .chain(forces.iter().map(|name| ColumnName(name, "")))
}

/// Those columns that the binary form has as well, but for time and forces, in its order.
pub fn state_columns(description: &Description) -> impl Iterator<Item = ColumnName<'_>> + '_ {
    let coordinates = [description.position_coordinates(), description.shape_coordinates()];
    coordinates.into_iter().flat_map(|coordinates| {
        let names = move |suffix| coordinates.iter().map(move |c| ColumnName(c.name, suffix));
        DERIVATIVES.into_iter().flat_map(names)
    })
}

/// Checks version and checksum of a plan as CSV or JSON.
///
/// # Errors
///
/// [`FileError::NotAPlan`], [`FileError::Version`]; [`FileError::Truncated`] without a checksum,
/// [`FileError::Checksum`] with a wrong one.
pub fn verify_text(text: &str) -> Result<(), FileError> {
    verified(text).map(|_| ())
}

/// The form of a text, and what its checksum is of.
pub(super) fn verified(text: &str) -> Result<(TextForm, &str), FileError> {
    let (form, version, mark, tail) = if let Some(rest) = text.strip_prefix(CSV_HEAD) {
        (TextForm::Csv, rest, CSV_MARK, "\n")
    } else if let Some(rest) = text.strip_prefix(JSON_HEAD) {
        (TextForm::Json, rest, JSON_MARK, "\"\n}\n")
    } else {
        return Err(FileError::NotAPlan);
    };
    let digits = version.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default();
    let found = digits.parse().map_err(|_| FileError::NotAPlan)?;
    if found != VERSION {
        return Err(FileError::Version { found });
    }
    let Some((content, rest)) = text.rfind(mark).and_then(|at| text.split_at_checked(at)) else {
        return Err(FileError::Truncated { found: text.len(), expected: text.len() + mark.len() });
    };
    let expected = content.len() + mark.len() + 8 + tail.len();
    let checksum = rest.get(mark.len()..).and_then(|rest| rest.strip_suffix(tail));
    let checksum = checksum
        .filter(|digits| digits.len() == 8)
        .ok_or(FileError::Truncated { found: text.len(), expected })?;
    match hexadecimal(checksum) {
        Some(checksum) if checksum == crc32(content.as_bytes()) => Ok((form, content)),
        _ => Err(FileError::Checksum),
    }
}

/// Eight digits as they are written: in lower case.
pub(super) fn hexadecimal(digits: &str) -> Option<u32> {
    let written =
        digits.len() == 8 && digits.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'));
    u32::from_str_radix(digits, 16).ok().filter(|_| written)
}
