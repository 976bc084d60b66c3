//! A report of invented but plausible runs of every bundled robot, to look at.
//!
//! `cargo run -p shapebot-report --example demo -- report.html`

use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Robot;
use shapebot_report::{
    Control, DesignFigure, Figure, Recorder, Report, RobotPage, Row, RunPage, Table, Trace,
};

const RATE: f64 = 50.0;
/// Peak of the shape, rad.
const LEAN: f64 = 0.09;

/// Smooth step of degree nine.
fn step(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s.powi(5) * (126.0 - 420.0 * s + 540.0 * s * s - 315.0 * s.powi(3) + 70.0 * s.powi(4))
}

/// First and second derivative by central differences.
fn rates<const D: usize>(
    f: &impl Fn(f64) -> SVector<f64, D>,
    t: f64,
) -> (SVector<f64, D>, SVector<f64, D>) {
    let h = 1e-2;
    let (before, now, after) = (f(t - h), f(t), f(t + h));
    ((after - before) / (2.0 * h), (after - 2.0 * now + before) / (h * h))
}

struct Demo<'r, R, const N: usize, const NX: usize, const NS: usize> {
    robot: &'r R,
    reach: f64,
    duration: f64,
    curved: bool,
    inverse: SMatrix<f64, NS, NX>,
}

impl<R, const N: usize, const NX: usize, const NS: usize> Demo<'_, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    fn desired(&self, t: f64) -> SVector<f64, NX> {
        let s = t / self.duration;
        SVector::from_fn(|i, _| match (i, self.curved) {
            (0, _) => self.reach * step(s),
            (_, true) => 0.7 * self.reach * step(1.6 * s - 0.6),
            _ => 0.0,
        })
    }

    /// The wobble of a loop that settles, as a fraction of the way.
    fn wobble(&self, t: f64) -> SVector<f64, NX> {
        let envelope = step(t / 1.2) * (-0.35 * t).exp();
        SVector::from_fn(|i, _| 0.02 * self.reach * envelope * (2.1 * t + i as f64).sin())
    }

    fn planned(&self, t: f64) -> SVector<f64, NX> {
        0.97 * self.desired(t) + 0.03 * self.desired(t - 0.2)
    }

    fn shape(&self, t: f64, output: impl Fn(f64) -> SVector<f64, NX>) -> SVector<f64, NS> {
        let jacobian = self.robot.output_jacobian_position().try_inverse().expect("invertible");
        self.inverse * jacobian * rates(&output, t).1
    }

    fn actual_shape(&self, t: f64) -> SVector<f64, NS> {
        let wave = 0.7 * step(t / 2.0) * (1.0 - step(t / self.duration)) * (1.9 * t).sin();
        let mut shape = self.shape(t, |t| self.planned(t) + 0.5 * self.wobble(t));
        for set in self.robot.description().shape_sets.iter().filter(|set| set.actuated) {
            if self.robot.description().shape_sets.len() > 1 {
                shape[set.first] += if set.first == 0 { wave.abs() } else { -wave.abs() };
                shape[set.first + 1] += -wave;
            }
        }
        shape
    }

    fn coordinates(&self, t: f64) -> SVector<f64, N> {
        let shape = self.actual_shape(t);
        let output = self.planned(t) + self.wobble(t);
        let jacobian = self.robot.output_jacobian_position().try_inverse().expect("invertible");
        let offset = self.robot.output(&SVector::zeros(), &shape);
        R::join(&(jacobian * (output - offset)), &shape)
    }

    fn run(&self, title: &str) -> RunPage {
        let description = self.robot.description();
        let count = ((self.duration + 2.0) * RATE) as usize;
        let time: Vec<f64> = (0..=count).map(|k| k as f64 / RATE).collect();
        let mut recorder = Recorder::new(self.robot);
        let mut trace = Trace::default();
        let list = |v: &[f64]| v.to_vec();
        for &t in &time {
            let q = self.coordinates(t);
            let (qd, qdd) = rates(&|t| self.coordinates(t), t);
            let force = self.robot.inverse_dynamics(&q, &qd, &qdd);
            recorder.push(&q, &self.desired(t), &self.planned(t));
            let (qx, qs) = R::split(&q);
            trace.desired.push(list(self.desired(t).as_slice()));
            trace.planned.push(list(self.planned(t).as_slice()));
            trace.actual.push(list(self.robot.output(&qx, &qs).as_slice()));
            trace.planned_shape.push(list(self.shape(t, |t| self.planned(t)).as_slice()));
            trace.shape.push(list(qs.as_slice()));
            trace.compensation.push(list((0.2 * self.shape(t, |t| self.wobble(t))).as_slice()));
            let torques = (0..description.actuators.len())
                .map(|actuator| self.robot.input_column(&q, actuator).dot(&force));
            trace.forces.push(torques.collect());
        }
        let error = |signal: &[Vec<f64>]| {
            let squares = trace.actual.iter().zip(signal).flat_map(|(a, b)| {
                a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).collect::<Vec<_>>()
            });
            (squares.sum::<f64>() / time.len() as f64).sqrt()
        };
        let figure =
            |name: &str, ours, paper| Figure { name: name.into(), ours, paper, unit: "m".into() };
        RunPage {
            title: title.into(),
            robot: description.name.into(),
            notes: vec!["invented data".into(), format!("{:.1} s", self.duration)],
            figures: vec![
                figure("RMSE against the plan", error(&trace.planned), Some(0.0071)),
                figure("RMSE against the desired motion", error(&trace.desired), None),
            ],
            panels: trace.panels(description),
            animation: Some(recorder.finish()),
            time,
        }
    }
}

/// Page and runs of a robot.
fn show<R, const N: usize, const NX: usize, const NS: usize>(robot: &R, report: &mut Report)
where
    R: Robot<f64, N, NX, NS>,
{
    let description = robot.description();
    let mut page = RobotPage::from_description(description);
    (page.equations, page.certificate) = toolchain(description.name);
    page.control = Some(control());
    report.robots.push(page);
    let gain = robot.shape_gain();
    let inverse = gain.transpose() * (gain * gain.transpose()).try_inverse().expect("full rank");
    let jacobian = robot.output_jacobian_position().try_inverse().expect("invertible");
    let size = description
        .points
        .iter()
        .enumerate()
        .map(|(point, _)| robot.point_position(&SVector::<f64, N>::zeros(), point).norm());
    let reach = (1.2 * size.fold(0.05, f64::max)).min(2.0);
    let reach = if description.name.contains("maze") { 0.1 } else { reach };
    let duration = (9.4 * reach * (inverse * jacobian).norm() / LEAN).sqrt().max(3.0);
    for curved in [false, true] {
        if curved && NX < 2 {
            continue;
        }
        let demo = Demo { robot, reach, duration, curved, inverse };
        let title = format!(
            "{}: {reach:.2} m {}",
            description.name,
            if curved { "around a bend" } else { "straight ahead" }
        );
        report.runs.push(demo.run(&title));
    }
}

fn control() -> Control {
    let figure = |name: &str, value: &str| DesignFigure { name: name.into(), value: value.into() };
    Control {
        summary: "Balancing loop through the position actuators, outer loop on the position."
            .into(),
        figures: vec![
            figure("Smallest damping", "0.71"),
            figure("Delay margin", "31 ms"),
            figure("Body mass", "×0.5 … ×1.7"),
        ],
        open_loop: vec![[6.25, 0.0], [6.23, 0.0], [0.0, 0.0], [-6.25, 0.0], [-6.23, 0.0]],
        closed_loop: vec![[-1.1, 0.8], [-1.1, -0.8], [-6.0, 5.8], [-6.0, -5.8], [-20.0, 0.0]],
    }
}

/// Equations and certificate of a bundled model.
fn toolchain(name: &str) -> (String, String) {
    let text = shapebot_models::text(name).expect("a bundled model");
    let model = shapebot_model_dsl::parse_bytes(name, text.as_bytes()).model.expect("a model");
    let (equations, certificate) = shapebot_codegen::derive::prove(&model).expect("equations");
    let latex = shapebot_codegen::equations::to_latex((&model, &equations, &certificate));
    (latex, certificate.to_text())
}

macro_rules! show_all {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        |report: &mut Report| {
            $(show::<_, $n, $nx, $ns>(&shapebot_generated::$module::$robot::<f64>::default(), report);)*
        }
    };
}

fn main() -> Result<(), shapebot_report::Error> {
    let mut report = Report {
        title: "Balancing by shape: a demonstration".into(),
        summary: "Invented runs of every bundled robot, to look at the report. Nothing here was simulated.".into(),
        ..Report::default()
    };
    (shapebot_generated::for_each_robot!(show_all))(&mut report);
    let rows = report.runs.iter().enumerate().map(|(run, page)| Row {
        cells: vec![
            page.title.clone(),
            format!("{:.4}", page.figures[0].ours),
            format!("{:.4}", page.figures[1].ours),
            "–".into(),
        ],
        run: Some(run),
    });
    report.tables = vec![Table {
        title: "Closed loop".into(),
        note: "RMSE of the output in metres.".into(),
        columns: ["run", "against plan", "against desired", "paper"].map(String::from).to_vec(),
        rows: rows.collect(),
    }];
    let path = std::env::args().nth(1).unwrap_or_else(|| "report.html".into());
    report.write(path)
}
