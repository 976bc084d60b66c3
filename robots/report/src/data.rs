//! What a report says: plain data. SI units unless a field names its unit.

use crate::scene::{Body, Pose};
use serde_derive::Serialize;

/// A report: one page.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// Heading of the page.
    pub title: String,
    /// A sentence or two under the heading.
    pub summary: String,
    /// Tables of the summary, in order.
    pub tables: Vec<Table>,
    /// Robots, in order.
    pub robots: Vec<RobotPage>,
    /// Runs, in order.
    pub runs: Vec<RunPage>,
}

/// A table of texts. A column all of whose cells begin like numbers is set to the right.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Heading.
    pub title: String,
    /// What the numbers are, under the table; may be empty.
    pub note: String,
    /// Heads of the columns, with their units.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// One text per column.
    pub cells: Vec<String>,
    /// Index into [`Report::runs`] of the run that the row is about.
    pub run: Option<usize>,
}

/// A robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RobotPage {
    /// Name by which runs refer to it: `Description::name`.
    pub name: String,
    /// One line about it.
    pub summary: String,
    /// Equations of motion as the LaTeX fragment that `shapebot_codegen::equations::to_latex` prints;
    /// empty if there are none to show.
    pub equations: String,
    /// The structure proof as the text that `shapebot_codegen::proof::Certificate::to_text` prints;
    /// empty if there is none.
    pub certificate: String,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Controller design, if there is one.
    pub control: Option<Control>,
    /// Solids for the animation.
    pub bodies: Vec<Body>,
}

/// A parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Parameter {
    /// Identifier.
    pub name: String,
    /// Value.
    pub value: f64,
    /// SI unit.
    pub unit: String,
    /// Smallest and largest value; infinite where there is no bound.
    pub range: [f64; 2],
    /// What it is.
    pub docs: String,
}

/// A controller design.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Control {
    /// What the law is, in a sentence or two; may be empty.
    pub summary: String,
    /// Figures of the design: gains, damping, delay margin, the ranges over which it holds.
    pub figures: Vec<DesignFigure>,
    /// Poles without control, 1/s, real and imaginary part.
    pub open_loop: Vec<[f64; 2]>,
    /// Poles of the closed loop, 1/s, real and imaginary part.
    pub closed_loop: Vec<[f64; 2]>,
}

/// A figure of a controller design, as texts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DesignFigure {
    /// What it is.
    pub name: String,
    /// Value with its unit.
    pub value: String,
}

/// A run of a robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunPage {
    /// Heading.
    pub title: String,
    /// [`RobotPage::name`] of its robot.
    pub robot: String,
    /// What was run, in short texts: method, weights, disturbances.
    pub notes: Vec<String>,
    /// Shown instants, s, increasing. 50 each second are enough.
    pub time: Vec<f64>,
    /// Plots over time, in order.
    pub panels: Vec<Panel>,
    /// What the animation shows.
    pub animation: Option<Animation>,
    /// Our figures beside the paper's.
    pub figures: Vec<Figure>,
}

/// A plot over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Panel {
    /// Quantity: `Tracking error`.
    pub title: String,
    /// Unit on the vertical axis.
    pub unit: String,
    /// Lines.
    pub series: Vec<Series>,
}

/// A line of a plot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Which colour of the palette; lines of the same coordinate share one.
    pub color: usize,
    /// One value per shown instant, in the panel's unit; what is not finite is a gap.
    pub values: Vec<f64>,
}

/// How a line is drawn, by what it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stroke {
    /// A broad pale line.
    Desired,
    /// A dashed line.
    Planned,
    /// A solid line.
    Actual,
}

/// What an animation shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Animation {
    /// Per shown instant the pose of each of the robot's bodies.
    pub frames: Vec<Vec<Pose>>,
    /// Body that carries the paths; the world if `None`.
    pub carrier: Option<usize>,
    /// Height of the floor in world axes, m.
    pub floor: f64,
    /// Paths on the floor or on the carrier.
    pub paths: Vec<Path>,
}

/// A path in the axes of its carrier, or of the world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Path {
    /// How it is drawn.
    pub stroke: Stroke,
    /// One point per shown instant, m.
    pub points: Vec<[f64; 3]>,
}

/// One of our figures beside the paper's.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figure {
    /// What it is: `RMSE against plan`.
    pub name: String,
    /// Ours.
    pub ours: f64,
    /// The paper's, if it prints one.
    pub paper: Option<f64>,
    /// Unit of both.
    pub unit: String,
}

impl RobotPage {
    /// Name, summary and parameters of a robot at the model's own values, and its geometry; without
    /// equations, certificate and controller.
    #[must_use]
    pub fn from_description(description: &shapebot_dynamics::Description) -> Self {
        let parameters = description.parameters.iter().map(|p| Parameter {
            name: p.name.to_owned(),
            value: p.value,
            unit: p.unit.to_owned(),
            range: [p.lower, p.upper],
            docs: p.docs.to_owned(),
        });
        Self {
            name: description.name.to_owned(),
            summary: description.summary.to_owned(),
            parameters: parameters.collect(),
            bodies: description.geometry.iter().map(Body::from).collect(),
            ..Self::default()
        }
    }
}
