//! The page and its file.

use crate::data::{DesignFigure, Parameter, Report, RobotPage, RunPage, Table};
use crate::error::Error;
use crate::pack::Data;
use crate::{certificate, latex, text};
use serde_derive::Serialize;
use std::io::Write as _;
use std::path::{Path, PathBuf};

mod check;

/// Largest length of a page in bytes.
pub const LIMIT: usize = 10_000_000;

const TEMPLATE: &str = include_str!("../assets/page.html.tera");
const STYLE: &str =
    concat!(include_str!("../assets/page.css"), include_str!("../assets/parts.css"));
/// In this order: each uses the ones before.
const SCRIPT: &str = concat!(
    include_str!("../assets/data.js"),
    include_str!("../assets/algebra.js"),
    include_str!("../assets/mesh.js"),
    include_str!("../assets/camera.js"),
    include_str!("../assets/shaders.js"),
    include_str!("../assets/webgl.js"),
    include_str!("../assets/painter.js"),
    include_str!("../assets/scene.js"),
    include_str!("../assets/plot.js"),
    include_str!("../assets/diagrams.js"),
    include_str!("../assets/player.js"),
    include_str!("../assets/main.js"),
);

impl Report {
    /// The page: HTML that needs nothing else. The same report gives the same bytes.
    ///
    /// # Errors
    ///
    /// If lengths, names or times do not fit together, if a pose or figure is not finite, or if the
    /// page is longer than [`LIMIT`].
    pub fn html(&self) -> Result<String, Error> {
        check::report(self)?;
        let mut tera = tera::Tera::new();
        // The name's ending turns escaping on.
        tera.add_raw_template("page.html", TEMPLATE)?;
        let mut context = tera::Context::from_serialize(&View::of(self))?;
        context.insert("style", STYLE);
        context.insert("script", SCRIPT);
        context.insert("data", &Data::new(self).json()?);
        let html = tera.render("page.html", &context)?;
        if html.len() > LIMIT {
            return Err(Error::TooLarge { bytes: html.len() });
        }
        Ok(html)
    }

    /// Writes the page into a file: a complete one takes the place of what was there, or nothing
    /// changes.
    ///
    /// # Errors
    ///
    /// As for [`Report::html`], and if the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let html = self.html()?;
        replace(path, html.as_bytes()).map_err(|source| Error::File { path: path.into(), source })
    }
}

/// Writes a file beside `path` and renames it.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut name = path.file_name().ok_or(std::io::ErrorKind::InvalidInput)?.to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let part: PathBuf = path.with_file_name(name);
    let written = std::fs::File::create(&part)
        .and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        })
        .and_then(|()| std::fs::rename(&part, path));
    if written.is_err() {
        // What is left of it is of no use to anybody.
        let _ = std::fs::remove_file(&part);
    }
    written
}

/// What the template shows.
#[derive(Serialize)]
struct View<'r> {
    title: &'r str,
    summary: &'r str,
    tables: Vec<TableView<'r>>,
    robots: Vec<RobotView<'r>>,
    runs: Vec<RunView<'r>>,
}

#[derive(Serialize)]
struct TableView<'r> {
    title: &'r str,
    note: &'r str,
    columns: Vec<Column<'r>>,
    rows: Vec<Vec<Cell<'r>>>,
}

#[derive(Serialize)]
struct Column<'r> {
    title: &'r str,
    number: bool,
}

#[derive(Serialize)]
struct Cell<'r> {
    text: &'r str,
    number: bool,
    /// Number of the run to which the first cell of a row links, from one.
    run: Option<usize>,
}

#[derive(Serialize)]
struct RobotView<'r> {
    name: &'r str,
    summary: &'r str,
    /// HTML.
    equations: String,
    /// HTML.
    certificate: String,
    parameters: Vec<ParameterView<'r>>,
    control: Option<ControlView<'r>>,
}

#[derive(Serialize)]
struct ParameterView<'r> {
    name: &'r str,
    value: String,
    unit: String,
    range: String,
    docs: &'r str,
}

#[derive(Serialize)]
struct ControlView<'r> {
    summary: &'r str,
    figures: &'r [DesignFigure],
    poles: bool,
}

#[derive(Serialize)]
struct RunView<'r> {
    title: &'r str,
    /// Name of its robot and number of the robot's page, from one.
    robot: &'r str,
    robot_number: usize,
    notes: &'r [String],
    figures: Vec<FigureView<'r>>,
    animated: bool,
    plots: bool,
    start: f64,
    end: f64,
}

#[derive(Serialize)]
struct FigureView<'r> {
    name: &'r str,
    unit: String,
    ours: String,
    paper: String,
}

impl<'r> View<'r> {
    fn of(report: &'r Report) -> Self {
        Self {
            title: &report.title,
            summary: &report.summary,
            tables: report.tables.iter().map(TableView::of).collect(),
            robots: report.robots.iter().map(RobotView::of).collect(),
            runs: report.runs.iter().map(|run| RunView::of(report, run)).collect(),
        }
    }
}

impl<'r> TableView<'r> {
    fn of(table: &'r Table) -> Self {
        let number = |column: usize| {
            let cells = table.rows.iter().filter_map(|row| row.cells.get(column));
            let mut shown = cells.filter(|cell| cell.chars().any(char::is_alphanumeric)).peekable();
            shown.peek().is_some() && shown.all(|cell| begins_like_a_number(cell))
        };
        let numbers: Vec<bool> = (0..table.columns.len()).map(number).collect();
        let columns = table.columns.iter().zip(&numbers);
        let row = |row: &'r crate::Row| -> Vec<Cell<'r>> {
            let cell = |(i, (text, &number)): (usize, (&'r String, &bool))| Cell {
                text,
                number,
                run: row.run.filter(|_| i == 0).map(|run| run + 1),
            };
            row.cells.iter().zip(&numbers).enumerate().map(cell).collect()
        };
        Self {
            title: &table.title,
            note: &table.note,
            columns: columns.map(|(title, &number)| Column { title, number }).collect(),
            rows: table.rows.iter().map(row).collect(),
        }
    }
}

fn begins_like_a_number(cell: &str) -> bool {
    let digits = cell.trim_start_matches(['-', '−', '+', '±', '<', '≤', '≥', '>', '~', ' ', '.']);
    digits.starts_with(|c: char| c.is_ascii_digit() || c == '∞')
}

impl<'r> RobotView<'r> {
    fn of(robot: &'r RobotPage) -> Self {
        let control = robot.control.as_ref().map(|control| ControlView {
            summary: &control.summary,
            figures: &control.figures,
            poles: !(control.open_loop.is_empty() && control.closed_loop.is_empty()),
        });
        Self {
            name: &robot.name,
            summary: &robot.summary,
            equations: latex::to_html(&robot.equations),
            certificate: certificate::to_html(&robot.certificate),
            parameters: robot.parameters.iter().map(ParameterView::of).collect(),
            control,
        }
    }
}

impl<'r> ParameterView<'r> {
    fn of(parameter: &'r Parameter) -> Self {
        let [low, high] = parameter.range;
        let range = if low.is_finite() || high.is_finite() {
            format!("{} … {}", text::number(low, 6), text::number(high, 6))
        } else {
            String::new()
        };
        Self {
            name: &parameter.name,
            value: text::number(parameter.value, 6),
            unit: text::unit(&parameter.unit),
            range,
            docs: &parameter.docs,
        }
    }
}

impl<'r> RunView<'r> {
    fn of(report: &'r Report, run: &'r RunPage) -> Self {
        let figure = |figure: &'r crate::Figure| FigureView {
            name: &figure.name,
            unit: text::unit(&figure.unit),
            ours: text::number(figure.ours, 3),
            paper: figure.paper.map_or("–".to_owned(), |paper| text::number(paper, 3)),
        };
        let robot = report.robots.iter().position(|robot| robot.name == run.robot);
        Self {
            title: &run.title,
            robot: &run.robot,
            robot_number: robot.map_or(0, |robot| robot + 1),
            notes: &run.notes,
            figures: run.figures.iter().map(figure).collect(),
            animated: run.animation.is_some(),
            plots: !run.panels.is_empty(),
            start: run.time.first().copied().unwrap_or(0.0),
            end: run.time.last().copied().unwrap_or(0.0),
        }
    }
}
