//! A design as Rust items.

use shapebot_dynamics::control::{ControlDesign, LoopFigures, Servo};
use std::fmt::Write as _;

const PATH: &str = "::shapebot_dynamics::control";

/// `pub const CONTROL` with documentation that states the figures.
pub(crate) fn items(design: &ControlDesign) -> String {
    let mut text = String::new();
    for line in docs(design).lines() {
        let _ = writeln!(text, "/// {line}");
    }
    let ControlDesign { period, balancing, servo, observer_rate, offset_rate, .. } = design;
    let Servo { rate, damping, integral } = servo;
    let _ = write!(
        text,
        "pub const CONTROL: {PATH}::ControlDesign = {PATH}::ControlDesign {{
            period: {period:?},
            balancing: {balancing},
            lean: &{:?},
            lean_rate: &{:?},
            lean_integral: &{:?},
            position: &{:?},
            velocity: &{:?},
            servo: {PATH}::Servo {{ rate: {rate:?}, damping: {damping:?}, integral: {integral:?} }},
            observer_rate: {observer_rate:?},
            offset_rate: {offset_rate:?},
            figures: {},
        }};",
        design.lean,
        design.lean_rate,
        design.lean_integral,
        design.position,
        design.velocity,
        figures(&design.figures),
    );
    text
}

fn figures(figures: &LoopFigures) -> String {
    let pole = |p: &shapebot_dynamics::control::Pole| {
        format!("{PATH}::Pole {{ re: {:?}, im: {:?} }}", p.re, p.im)
    };
    let range = |r: &shapebot_dynamics::control::ParameterRange| {
        let (name, lower, upper) = (r.name, r.lower, r.upper);
        format!("{PATH}::ParameterRange {{ name: {name:?}, lower: {lower:?}, upper: {upper:?} }}")
    };
    let poles: Vec<String> = figures.poles.iter().map(pole).collect();
    let ranges: Vec<String> = figures.ranges.iter().map(range).collect();
    format!(
        "{PATH}::LoopFigures {{
            poles: &[{}],
            damping: {:?},
            decay: {:?},
            worst_damping: {:?},
            worst_decay: {:?},
            delay_margin: {:?},
            worst_delay_margin: {:?},
            ranges: &[{}],
            together: {:?},
            samples: {},
        }}",
        poles.join(", "),
        figures.damping,
        figures.decay,
        figures.worst_damping,
        figures.worst_decay,
        figures.delay_margin,
        figures.worst_delay_margin,
        ranges.join(", "),
        figures.together,
        figures.samples,
    )
}

/// What a reader wants to know about the loop.
fn docs(design: &ControlDesign) -> String {
    let f = &design.figures;
    let ms = |seconds: f64| 1e3 * seconds;
    format!(
        "Gains of the control law and figures of the loop that they close.\n\
         \n\
         At the model's own parameter values: slowest decay {:.3} 1/s, damping {:.2}, stable with {:.0} ms\n\
         of delay beyond the one period of {:.0} ms. Over the ranges of the figures, each parameter alone or\n\
         all together by {:.0} %, at {} points: decay {:.3} 1/s, damping {:.2}, {:.0} ms.",
        f.decay,
        f.damping,
        ms(f.delay_margin),
        ms(design.period),
        100.0 * f.together,
        f.samples,
        f.worst_decay,
        f.worst_damping,
        ms(f.worst_delay_margin),
    )
}
