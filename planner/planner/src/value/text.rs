//! CSV and JSON.

use super::FileError;
use super::binary::VERSION;
use super::crc::{Crc32, crc32};
use crate::plan::Row;
use core::fmt::{self, Write};
use nalgebra::SVector;
use shapebot_dynamics::{Description, Ordered};

/// What precedes the checksum in a file, for both formats.
const CSV_MARK: &str = "# crc32 ";
const JSON_MARK: &str = ",\n\"crc32\": \"";

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

/// Writes one row of numbers per sample as CSV: time, desired output, output, coordinates with rates
/// and accelerations, forces. Lines that begin with `#` carry version and checksum; numbers are the
/// shortest that read back to the same value.
///
/// # Errors
///
/// Those of `out`.
pub fn write_csv<W, T, const NX: usize, const NS: usize, const F: usize>(
    out: &mut W,
    description: &Description,
    forces: [&str; F],
    rows: impl Iterator<Item = Row<T, NX, NS>>,
    force: impl Fn(&Row<T, NX, NS>) -> SVector<T, F>,
) -> fmt::Result
where
    W: Write,
    T: Ordered + fmt::Display,
{
    let mut out = Checked { out, crc: Crc32::new() };
    writeln!(out, "# shapebot-plan {VERSION} {}", description.name)?;
    columns(&mut out, description, &forces, |out, name| write!(out, "{name}"), ",")?;
    writeln!(out)?;
    for row in rows {
        numbers(&mut out, &row, &force(&row), ",")?;
        writeln!(out)?;
    }
    let crc = out.crc.value();
    writeln!(out.out, "{CSV_MARK}{crc:08x}")
}

/// The same as JSON: an object with format, version, robot, columns, rows and checksum.
///
/// # Errors
///
/// Those of `out`.
pub fn write_json<W, T, const NX: usize, const NS: usize, const F: usize>(
    out: &mut W,
    description: &Description,
    forces: [&str; F],
    rows: impl Iterator<Item = Row<T, NX, NS>>,
    force: impl Fn(&Row<T, NX, NS>) -> SVector<T, F>,
) -> fmt::Result
where
    W: Write,
    T: Ordered + fmt::Display,
{
    let mut out = Checked { out, crc: Crc32::new() };
    write!(out, "{{\n\"format\": \"shapebot-plan\",\n\"version\": {VERSION},\n")?;
    write!(out, "\"robot\": \"{}\",\n\"columns\": [", description.name)?;
    columns(&mut out, description, &forces, |out, name| write!(out, "\"{name}\""), ", ")?;
    write!(out, "],\n\"rows\": [")?;
    let mut separator = "\n";
    for row in rows {
        write!(out, "{separator}[")?;
        numbers(&mut out, &row, &force(&row), ", ")?;
        write!(out, "]")?;
        separator = ",\n";
    }
    write!(out, "\n]")?;
    let crc = out.crc.value();
    write!(out.out, "{JSON_MARK}{crc:08x}\"\n}}\n")
}

/// A column's name: prefix, coordinate, suffix.
struct Name<'a>(&'a str, &'a str, &'a str);

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}{}", self.0, self.1, self.2)
    }
}

fn columns<W: Write>(
    out: &mut W,
    description: &Description,
    forces: &[&str],
    write: impl Fn(&mut W, &Name<'_>) -> fmt::Result,
    separator: &str,
) -> fmt::Result {
    write(out, &Name("", "t", ""))?;
    let mut add = |name: Name<'_>| {
        out.write_str(separator)?;
        write(out, &name)
    };
    for (prefix, suffix) in [("", "_desired"), ("", "")] {
        for output in description.outputs {
            add(Name(prefix, output, suffix))?;
        }
    }
    for suffix in ["", "_d", "_dd"] {
        for coordinate in description.position_coordinates() {
            add(Name("", coordinate.name, suffix))?;
        }
    }
    for suffix in ["", "_d", "_dd"] {
        for coordinate in description.shape_coordinates() {
            add(Name("", coordinate.name, suffix))?;
        }
    }
    forces.iter().try_for_each(|force| add(Name("", force, "")))
}

fn numbers<W: Write, T, const NX: usize, const NS: usize, const F: usize>(
    out: &mut W,
    row: &Row<T, NX, NS>,
    force: &SVector<T, F>,
    separator: &str,
) -> fmt::Result
where
    T: Ordered + fmt::Display,
{
    let plan = &row.plan;
    write!(out, "{}", plan.time)?;
    let positions =
        [plan.desired.output[0], row.output, row.position, row.velocity, row.acceleration];
    let shapes = [plan.shape, plan.shape_velocity, plan.shape_acceleration];
    let positions = positions.iter().flat_map(|v| v.iter());
    let shapes = shapes.iter().flat_map(|v| v.iter());
    for value in positions.chain(shapes).chain(force.iter()) {
        if value.is_finite() {
            write!(out, "{separator}{value}")?;
        } else {
            write!(out, "{separator}null")?;
        }
    }
    Ok(())
}

/// Checks version and checksum of a plan as CSV or JSON.
///
/// # Errors
///
/// [`FileError::NotAPlan`], [`FileError::Version`]; [`FileError::Truncated`] without a checksum,
/// [`FileError::Checksum`] with a wrong one.
pub fn verify_text(text: &str) -> Result<(), FileError> {
    let (version, mark, tail) = if let Some(rest) = text.strip_prefix("# shapebot-plan ") {
        (rest, CSV_MARK, "\n")
    } else if let Some(rest) = text.strip_prefix("{\n\"format\": \"shapebot-plan\",\n\"version\": ")
    {
        (rest, JSON_MARK, "\"\n}\n")
    } else {
        return Err(FileError::NotAPlan);
    };
    let digits = version.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default();
    let found = digits.parse().map_err(|_| FileError::NotAPlan)?;
    if found != VERSION {
        return Err(FileError::Version { found });
    }
    let Some(at) = text.rfind(mark) else {
        return Err(FileError::Truncated { found: text.len(), expected: text.len() + mark.len() });
    };
    let (content, rest) = text.split_at(at);
    let expected = at + mark.len() + 8 + tail.len();
    let checksum = rest[mark.len()..]
        .strip_suffix(tail)
        .filter(|digits| digits.len() == 8)
        .ok_or(FileError::Truncated { found: text.len(), expected })?;
    match u32::from_str_radix(checksum, 16) {
        Ok(checksum) if checksum == crc32(content.as_bytes()) => Ok(()),
        _ => Err(FileError::Checksum),
    }
}
