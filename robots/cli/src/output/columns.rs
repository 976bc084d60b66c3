//! Text in aligned columns.

use std::io::{self, Write};

/// Where a column's text stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    /// At the left.
    Left,
    /// At the right.
    Right,
}

/// Rows of text under a head.
#[derive(Debug)]
pub(crate) struct Columns {
    head: Vec<(&'static str, Align)>,
    rows: Vec<Vec<String>>,
}

impl Columns {
    /// An empty table.
    pub(crate) fn new(head: &[(&'static str, Align)]) -> Self {
        Self { head: head.to_vec(), rows: Vec::new() }
    }

    /// Adds a row; cells beyond the head are not shown.
    pub(crate) fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// Writes the table; the head in bold where the reader shows it.
    pub(crate) fn write(&self, to: &mut impl Write) -> io::Result<()> {
        let bold = anstyle::Style::new().bold();
        let widths = self.widths();
        let head = self.head.iter().map(|(title, _)| *title);
        writeln!(to, "{bold}{}{bold:#}", self.line(head, &widths))?;
        for row in &self.rows {
            writeln!(to, "{}", self.line(row.iter().map(String::as_str), &widths))?;
        }
        Ok(())
    }

    fn widths(&self) -> Vec<usize> {
        let width = |i: usize, title: &str| {
            let cells =
                self.rows.iter().filter_map(|row| row.get(i)).map(|cell| cell.chars().count());
            cells.chain([title.chars().count()]).max().unwrap_or(0)
        };
        self.head.iter().enumerate().map(|(i, (title, _))| width(i, title)).collect()
    }

    fn line<'a>(&self, cells: impl Iterator<Item = &'a str>, widths: &[usize]) -> String {
        let cells =
            cells.zip(&self.head).zip(widths).map(|((cell, (_, align)), &width)| match align {
                Align::Left => format!("{cell:<width$}"),
                Align::Right => format!("{cell:>width$}"),
            });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::{Align, Columns};

    #[test]
    fn cells_stand_below_each_other() {
        let mut columns = Columns::new(&[("name", Align::Left), ("n", Align::Right)]);
        columns.push(vec!["ballbot".into(), "2".into()]);
        columns.push(vec!["x".into(), "16".into()]);
        let mut text = Vec::new();
        columns.write(&mut anstream::StripStream::new(&mut text)).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "name      n\nballbot   2\nx        16\n");
    }
}
