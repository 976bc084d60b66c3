//! From the signals of a run to panels.

use crate::data::{Panel, Series, Stroke};
use shapebot_dynamics::{Coordinate, Description};

/// A vector over time: one vector per shown instant, all of one length; empty if there is none.
pub type Signals = Vec<Vec<f64>>;

/// The signals of a run, in SI units, at the shown instants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Desired output.
    pub desired: Signals,
    /// Output of the plan.
    pub planned: Signals,
    /// Output of the robot.
    pub actual: Signals,
    /// Planned shape q_s.
    pub planned_shape: Signals,
    /// Shape q_s of the robot.
    pub shape: Signals,
    /// Compensation shape (Eq. 36).
    pub compensation: Signals,
    /// Forces of the actuators.
    pub forces: Signals,
}

impl Trace {
    /// Panels of all signals that are there, with the description's names; angles in degrees. One
    /// panel each for output, errors against plan and against the desired motion, each shape set,
    /// compensation, and actuators of one unit.
    #[must_use]
    pub fn panels(&self, description: &Description) -> Vec<Panel> {
        let mut panels = vec![self.output(description)];
        panels.extend(self.errors(description));
        panels.extend(self.shape(description));
        panels.push(self.compensation(description));
        panels.extend(self.forces(description));
        panels.retain(|panel| !panel.series.is_empty());
        panels
    }

    fn output(&self, description: &Description) -> Panel {
        let signals = [
            (&self.desired, Stroke::Desired, "desired"),
            (&self.planned, Stroke::Planned, "planned"),
            (&self.actual, Stroke::Actual, "actual"),
        ];
        let names = description.outputs.iter().map(|name| readable(name)).collect::<Vec<_>>();
        let mut panel = panel("Output", description.output_unit);
        for (signal, stroke, word) in signals {
            panel.add(signal, &names, stroke, word, |value, _| value);
        }
        panel
    }

    fn errors(&self, description: &Description) -> [Panel; 2] {
        let names = description.outputs.iter().map(|name| readable(name)).collect::<Vec<_>>();
        let against = |title: &str, reference: &Signals| {
            // Errors are small: millimetres where the output is in metres.
            let (unit, scale) = match description.output_unit {
                "m" => ("mm", 1e3),
                "rad" => ("deg", 1f64.to_degrees()),
                other => (other, 1.0),
            };
            let mut panel = panel(title, unit);
            if reference.len() == self.actual.len() {
                let error = self.actual.iter().zip(reference).map(|(actual, reference)| {
                    actual.iter().zip(reference).map(|(a, r)| scale * (a - r)).collect()
                });
                panel.add(&error.collect(), &names, Stroke::Actual, "", |value, _| value);
            }
            panel.unit = unit.to_owned();
            panel
        };
        [
            against("Error against the plan", &self.planned),
            against("Error against the desired motion", &self.desired),
        ]
    }

    fn shape(&self, description: &Description) -> Vec<Panel> {
        let coordinates = description.shape_coordinates();
        let of_set = |(k, set): (usize, &shapebot_dynamics::ShapeSet)| {
            let range = set.first..set.first + set.len;
            let members = coordinates.get(range.clone()).unwrap_or(&[]);
            let part = |signals: &Signals| -> Signals {
                let part = |row: &Vec<f64>| row.get(range.clone()).map(<[f64]>::to_vec);
                signals.iter().filter_map(part).collect()
            };
            let title = format!("Shape {}", readable(set.name));
            let mut panel = of_coordinates(&title, members);
            panel.add_coordinates(&part(&self.planned_shape), members, Stroke::Planned, "planned");
            panel.add_coordinates(&part(&self.shape), members, Stroke::Actual, "actual");
            (k, panel)
        };
        // The lean, which no actuator moves, first.
        let mut panels: Vec<(usize, Panel)> =
            description.shape_sets.iter().enumerate().map(of_set).collect();
        panels.sort_by_key(|(k, _)| (description.shape_sets[*k].actuated, *k));
        panels.into_iter().map(|(_, panel)| panel).collect()
    }

    fn compensation(&self, description: &Description) -> Panel {
        let coordinates = description.shape_coordinates();
        let mut panel = of_coordinates("Compensation", coordinates);
        panel.add_coordinates(&self.compensation, coordinates, Stroke::Actual, "");
        panel
    }

    fn forces(&self, description: &Description) -> Vec<Panel> {
        let mut units: Vec<&str> = description.actuators.iter().map(|a| a.unit).collect();
        units.dedup();
        units.into_iter().map(|unit| self.forces_in(description, unit)).collect()
    }

    fn forces_in(&self, description: &Description, unit: &str) -> Panel {
        let alike: Vec<usize> = (0..description.actuators.len())
            .filter(|&i| description.actuators[i].unit == unit)
            .collect();
        let names: Vec<String> =
            alike.iter().map(|&i| readable(description.actuators[i].name)).collect();
        let entry = |row: &Vec<f64>, i: usize| row.get(i).copied().unwrap_or(f64::NAN);
        let rows = self.forces.iter().map(|row| alike.iter().map(|&i| entry(row, i)).collect());
        let mut panel = panel("Actuators", &unit.replace('*', "·"));
        panel.add(&rows.collect(), &names, Stroke::Actual, "", |value, _| value);
        panel
    }
}

fn panel(title: &str, unit: &str) -> Panel {
    Panel { title: title.to_owned(), unit: unit.to_owned(), series: Vec::new() }
}

/// A panel in the unit of its coordinates; degrees if they are angles.
fn of_coordinates(title: &str, coordinates: &[Coordinate]) -> Panel {
    let unit = coordinates.first().map_or("", |c| c.unit);
    panel(title, if unit == "rad" { "deg" } else { unit })
}

impl Panel {
    fn add(
        &mut self,
        signals: &Signals,
        names: &[String],
        stroke: Stroke,
        word: &str,
        convert: impl Fn(f64, usize) -> f64,
    ) {
        let Some(first) = signals.first() else { return };
        for (i, name) in names.iter().enumerate().take(first.len()) {
            let entry = |row: &Vec<f64>| row.get(i).map_or(f64::NAN, |&value| convert(value, i));
            let values: Vec<f64> = signals.iter().map(entry).collect();
            let label = format!("{name} {word}").trim_end().to_owned();
            self.series.push(Series { label, stroke, color: i, values });
        }
    }

    fn add_coordinates(
        &mut self,
        signals: &Signals,
        coordinates: &[Coordinate],
        stroke: Stroke,
        word: &str,
    ) {
        let names: Vec<String> = coordinates.iter().map(|c| readable(c.name)).collect();
        let convert = |value: f64, i: usize| {
            if coordinates.get(i).is_some_and(|c| c.unit == "rad") {
                value.to_degrees()
            } else {
                value
            }
        };
        self.add(signals, &names, stroke, word, convert);
    }
}

/// `alpha_l_x` as `α l x`: Greek letters, blanks.
fn readable(name: &str) -> String {
    const GREEK: [(&str, &str); 12] = [
        ("alpha", "α"),
        ("beta", "β"),
        ("gamma", "γ"),
        ("delta", "δ"),
        ("phi", "φ"),
        ("psi", "ψ"),
        ("theta", "θ"),
        ("tau", "τ"),
        ("omega", "ω"),
        ("rho", "ρ"),
        ("mu", "μ"),
        ("eta", "η"),
    ];
    let letter = |word: &str| {
        let greek = GREEK.iter().find(|(latin, _)| *latin == word);
        greek.map_or(word, |(_, greek)| greek).to_owned()
    };
    name.split(['_', '.']).map(letter).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_readable() {
        assert_eq!(readable("alpha_l_x"), "α l x");
        assert_eq!(readable("ball.x"), "ball x");
        assert_eq!(readable("alphabet"), "alphabet");
    }

    #[test]
    fn errors_are_counted_from_plan_and_desired_in_millimetres() {
        let description = &shapebot_generated::ballbot_planar::DESCRIPTION;
        let trace = Trace {
            desired: vec![vec![1.0]],
            planned: vec![vec![0.9]],
            actual: vec![vec![0.88]],
            shape: vec![vec![std::f64::consts::FRAC_PI_6]],
            ..Trace::default()
        };
        let panels = trace.panels(description);
        let titles: Vec<&str> = panels.iter().map(|panel| panel.title.as_str()).collect();
        assert_eq!(
            titles,
            ["Output", "Error against the plan", "Error against the desired motion", "Shape φ"]
        );
        let value = |panel: usize, series: usize| panels[panel].series[series].values[0];
        assert!((value(1, 0) + 20.0).abs() < 1e-9, "plan: {}", value(1, 0));
        assert!((value(2, 0) + 120.0).abs() < 1e-9, "desired: {}", value(2, 0));
        assert!((value(3, 0) - 30.0).abs() < 1e-9, "lean: {}", value(3, 0));
        assert_eq!([&*panels[1].unit, &*panels[3].unit], ["mm", "deg"]);
    }
}
