//! A controller design as figures to read.

use crate::data::{Control, DesignFigure};
use crate::text::{number, unit};
use shapebot_dynamics::Description;
use shapebot_dynamics::control::{ControlDesign, ParameterRange};

impl Control {
    /// Gains, poles, margins and ranges of a design; `open_loop` are the poles without control, 1/s. The
    /// description gives the units of the parameters.
    #[must_use]
    pub fn from_design(
        description: &Description,
        design: &ControlDesign,
        open_loop: &[[f64; 2]],
    ) -> Self {
        let mut figures = vec![figure("Control period", milliseconds(design.period))];
        figures.extend(gains(design));
        figures.extend(margins(design));
        figures.extend(ranges(description, design));
        let summary = if design.balancing {
            "The position actuators balance the lean; an outer loop holds the output."
        } else {
            "The shape is servoed; an outer loop holds the output."
        };
        Self {
            summary: summary.to_owned(),
            figures,
            open_loop: open_loop.to_vec(),
            closed_loop: design.figures.poles.iter().map(|pole| [pole.re, pole.im]).collect(),
        }
    }
}

fn figure(name: impl Into<String>, value: impl Into<String>) -> DesignFigure {
    DesignFigure { name: name.into(), value: value.into() }
}

fn milliseconds(seconds: f64) -> String {
    format!("{} ms", number(1e3 * seconds, 3))
}

/// One number per axis, or one for all if they agree.
fn axes(values: &[f64], unit: &str) -> String {
    let mut texts: Vec<String> = values.iter().map(|&value| number(value, 3)).collect();
    texts.dedup();
    format!("{} {unit}", texts.join(", ")).trim_end().to_owned()
}

fn gains(design: &ControlDesign) -> Vec<DesignFigure> {
    let mut figures = Vec::new();
    if design.balancing {
        figures.push(figure("Lean", axes(design.lean, "")));
        figures.push(figure("Lean rate", axes(design.lean_rate, "s")));
        figures.push(figure("Integral of the lean", axes(design.lean_integral, "1/s")));
    }
    figures.push(figure("Output", axes(design.position, "1/s²")));
    figures.push(figure("Output rate", axes(design.velocity, "1/s")));
    let servo = &design.servo;
    let text = format!("{}, damping {}", axes(&[servo.rate], "rad/s"), number(servo.damping, 2));
    figures.push(figure("Servo of the actuated shape", text));
    let observer = match design.observer_rate {
        rate if rate > 0.0 => axes(&[rate], "1/s"),
        _ => "none".to_owned(),
    };
    figures.push(figure("Momentum observer", observer));
    figures
}

fn margins(design: &ControlDesign) -> [DesignFigure; 3] {
    let known = &design.figures;
    let pair = |home: String, worst: String| format!("{home}; over the ranges {worst}");
    [
        figure(
            "Smallest damping ratio",
            pair(number(known.damping, 3), number(known.worst_damping, 3)),
        ),
        figure(
            "Slowest decay",
            pair(axes(&[known.decay], "1/s"), axes(&[known.worst_decay], "1/s")),
        ),
        figure(
            "Delay margin",
            pair(milliseconds(known.delay_margin), milliseconds(known.worst_delay_margin)),
        ),
    ]
}

fn ranges(description: &Description, design: &ControlDesign) -> Vec<DesignFigure> {
    let unit_of = |name: &str| {
        let parameter = description.parameters.iter().find(|parameter| parameter.name == name);
        parameter.map_or(String::new(), |parameter| unit(parameter.unit))
    };
    let range = |range: &ParameterRange| {
        let text = format!(
            "{} … {} {}",
            number(range.lower, 4),
            number(range.upper, 4),
            unit_of(range.name)
        );
        figure(format!("Holds for {}", range.name), text.trim_end())
    };
    let known = &design.figures;
    let mut figures: Vec<DesignFigure> = known.ranges.iter().map(range).collect();
    let together = format!(
        "±{} % of all parameters together, {} points computed",
        number(100.0 * known.together, 3),
        known.samples
    );
    figures.push(figure("Holds for", together));
    figures
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapebot_dynamics::control::{LoopFigures, Pole, Servo};

    const DESIGN: ControlDesign = ControlDesign {
        period: 0.002,
        balancing: true,
        lean: &[4.56, 4.56],
        lean_rate: &[0.87, 0.88],
        lean_integral: &[1.14, 1.14],
        position: &[1.78, 1.78],
        velocity: &[1.18, 1.18],
        servo: Servo { rate: 12.0, damping: 0.9, integral: 0.0 },
        observer_rate: 0.0,
        offset_rate: 0.5,
        figures: LoopFigures {
            poles: &[Pole { re: -1.0, im: 2.0 }],
            damping: 0.45,
            decay: 1.0,
            worst_damping: 0.3,
            worst_decay: 0.5,
            delay_margin: 0.03,
            worst_delay_margin: 0.012,
            ranges: &[ParameterRange { name: "m_b", lower: 50.0, upper: 90.0 }],
            together: 0.1,
            samples: 40,
        },
    };

    #[test]
    fn a_design_is_told_in_words() {
        let description = &shapebot_generated::ballbot3d::DESCRIPTION;
        let control = Control::from_design(description, &DESIGN, &[[6.2, 0.0]]);
        let value = |name: &str| {
            let found = control.figures.iter().find(|figure| figure.name == name);
            found.unwrap_or_else(|| panic!("no `{name}`")).value.as_str()
        };
        assert_eq!(value("Control period"), "2 ms");
        assert_eq!(value("Lean"), "4.56");
        assert_eq!(value("Lean rate"), "0.87, 0.88 s");
        assert_eq!(value("Momentum observer"), "none");
        assert_eq!(value("Delay margin"), "30 ms; over the ranges 12 ms");
        assert_eq!(value("Holds for m_b"), "50 … 90 kg");
        assert_eq!(control.closed_loop, [[-1.0, 2.0]]);
        assert_eq!(control.open_loop, [[6.2, 0.0]]);
    }
}
