//! A figure of panels over one time axis, and its SVG text.

use super::axis::Axis;
use std::fmt::Write;

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A thin line: what is planned.
    Line,
    /// A broad, light line for others to be drawn upon: what is desired.
    Band,
}

/// A line.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Name in the legend.
    pub(crate) name: String,
    /// Which colour of the palette.
    pub(crate) color: usize,
    /// Thin or broad.
    pub(crate) stroke: Stroke,
    /// One value per time.
    pub(crate) values: Vec<f64>,
}

/// Lines that share a vertical axis.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// Quantity with its unit: `lean [deg]`.
    pub(crate) label: String,
    /// Lines.
    pub(crate) series: Vec<Series>,
}

/// Panels below each other.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// Heading.
    pub(crate) title: String,
    /// Text under the heading.
    pub(crate) subtitle: String,
    /// Times in seconds.
    pub(crate) times: Vec<f64>,
    /// Panels.
    pub(crate) panels: Vec<Panel>,
}

/// Colours that stay apart for colour-blind readers (Okabe and Ito), darkest first for print.
const PALETTE: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"];

const WIDTH: f64 = 760.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 150.0;
const TOP: f64 = 62.0;
const PANEL: f64 = 170.0;
const GAP: f64 = 24.0;
const BOTTOM: f64 = 52.0;

impl Figure {
    /// The figure as SVG text.
    pub(crate) fn svg(&self) -> String {
        let count = self.panels.len().max(1) as f64;
        let height = TOP + count * PANEL + (count - 1.0) * GAP + BOTTOM;
        let mut svg = Svg::new(WIDTH, height);
        svg.text(LEFT, 26.0, "class=\"title\"", &self.title);
        svg.text(LEFT, 46.0, "class=\"subtitle\"", &self.subtitle);
        let time = Axis::exactly(self.times.iter().copied(), 10);
        for (i, panel) in self.panels.iter().enumerate() {
            let last = i + 1 == self.panels.len();
            let top = TOP + i as f64 * (PANEL + GAP);
            Frame { top, time, value: panel.axis() }.draw(&mut svg, &self.times, panel, last);
        }
        svg.finish()
    }
}

impl Panel {
    fn axis(&self) -> Axis {
        Axis::around(self.series.iter().flat_map(|series| series.values.iter().copied()), 4)
    }
}

/// Where a panel is on paper.
struct Frame {
    top: f64,
    time: Axis,
    value: Axis,
}

impl Frame {
    fn x(&self, time: f64) -> f64 {
        LEFT + self.time.fraction(time) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        self.top + (1.0 - self.value.fraction(value)) * PANEL
    }

    fn draw(&self, svg: &mut Svg, times: &[f64], panel: &Panel, last: bool) {
        self.draw_grid(svg, last);
        self.draw_label(svg, &panel.label);
        for series in &panel.series {
            self.draw_series(svg, times, series);
        }
        self.draw_legend(svg, panel);
    }

    fn draw_grid(&self, svg: &mut Svg, last: bool) {
        let (right, bottom) = (WIDTH - RIGHT, self.top + PANEL);
        for (value, text) in self.value.ticks() {
            let y = self.y(value);
            svg.line(
                [LEFT, y, right, y],
                if value == 0.0 { "class=\"zero\"" } else { "class=\"grid\"" },
            );
            svg.text(LEFT - 8.0, y + 4.0, "text-anchor=\"end\"", &text);
        }
        for (time, text) in self.time.ticks() {
            let x = self.x(time);
            svg.line([x, self.top, x, bottom], "class=\"grid\"");
            if last {
                svg.text(x, bottom + 18.0, "text-anchor=\"middle\"", &text);
            }
        }
        svg.rectangle([LEFT, self.top, right - LEFT, PANEL]);
        if last {
            svg.text(
                f64::midpoint(LEFT, right),
                bottom + 40.0,
                "text-anchor=\"middle\"",
                "time [s]",
            );
        }
    }

    fn draw_label(&self, svg: &mut Svg, label: &str) {
        let (x, y) = (20.0, self.top + PANEL / 2.0);
        let turn = format!("text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\"");
        svg.text(x, y, &turn, label);
    }

    fn draw_series(&self, svg: &mut Svg, times: &[f64], series: &Series) {
        let points = times.iter().zip(&series.values);
        let finite = points.filter(|(_, value)| value.is_finite());
        svg.polyline(
            finite.map(|(&time, &value)| (self.x(time), self.y(value))),
            series.attributes(),
        );
    }

    fn draw_legend(&self, svg: &mut Svg, panel: &Panel) {
        let x = WIDTH - RIGHT + 14.0;
        for (i, series) in panel.series.iter().enumerate() {
            let y = self.top + 12.0 + 18.0 * i as f64;
            svg.polyline([(x, y), (x + 26.0, y)].into_iter(), series.attributes());
            svg.text(x + 34.0, y + 4.0, "", &series.name);
        }
    }
}

impl Series {
    fn attributes(&self) -> String {
        let color = PALETTE[self.color % PALETTE.len()];
        let band = if self.stroke == Stroke::Band { " class=\"band\"" } else { "" };
        format!("stroke=\"{color}\"{band}")
    }
}

/// SVG text under construction.
struct Svg {
    text: String,
}

impl Svg {
    fn new(width: f64, height: f64) -> Self {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n\
             <style>\n\
             text {{ font: 12px Helvetica, Arial, sans-serif; fill: #222; }}\n\
             .title {{ font-size: 16px; font-weight: bold; }}\n\
             .subtitle {{ fill: #555; }}\n\
             .grid {{ stroke: #ddd; stroke-width: 0.8; }}\n\
             .zero {{ stroke: #999; stroke-width: 0.8; }}\n\
             .frame {{ fill: none; stroke: #444; stroke-width: 1; }}\n\
             polyline {{ fill: none; stroke-width: 1.6; stroke-linejoin: round; }}\n\
             .band {{ stroke-width: 6; stroke-opacity: 0.35; }}\n\
             </style>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        Self { text }
    }

    // Writing to a string cannot fail.
    fn text(&mut self, x: f64, y: f64, attributes: &str, content: &str) {
        let content = escape(content);
        let _ =
            writeln!(self.text, "<text x=\"{x:.1}\" y=\"{y:.1}\" {attributes}>{content}</text>");
    }

    fn line(&mut self, [x1, y1, x2, y2]: [f64; 4], attributes: &str) {
        let _ = writeln!(
            self.text,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {attributes}/>"
        );
    }

    fn rectangle(&mut self, [x, y, width, height]: [f64; 4]) {
        let _ = writeln!(
            self.text,
            "<rect class=\"frame\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>"
        );
    }

    fn polyline(&mut self, points: impl Iterator<Item = (f64, f64)>, attributes: String) {
        let _ = write!(self.text, "<polyline {attributes} points=\"");
        for (x, y) in points {
            let _ = write!(self.text, "{x:.2},{y:.2} ");
        }
        self.text.push_str("\"/>\n");
    }

    fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{Figure, Panel, Series, Stroke};

    #[test]
    fn a_figure_is_closed_and_escaped() {
        let series = Series {
            name: "a<b".into(),
            color: 9,
            stroke: Stroke::Band,
            values: vec![0.0, f64::NAN],
        };
        let panel = Panel { label: "x & y".into(), series: vec![series] };
        let figure = Figure {
            title: "t".into(),
            subtitle: String::new(),
            times: vec![0.0, 1.0],
            panels: vec![panel],
        };
        let svg = figure.svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(svg.contains("a&lt;b") && svg.contains("x &amp; y") && !svg.contains("NaN"));
    }
}
