//! A plot with logarithmic axes, as SVG.

use std::fmt::Write;

/// A line of the plot.
pub(crate) struct Curve {
    /// Name in the legend.
    pub(crate) name: &'static str,
    /// Samples and seconds.
    pub(crate) points: Vec<(f64, f64)>,
    /// Seconds per plan and per sample.
    pub(crate) fit: (f64, f64),
}

const COLORS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"];
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 460.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 200.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 56.0;
/// Decades of samples, and of seconds.
const SAMPLES: (i32, i32) = (2, 5);
const SECONDS: (i32, i32) = (-5, 0);
const TIMES: [&str; 6] = ["10 µs", "100 µs", "1 ms", "10 ms", "100 ms", "1 s"];

fn x(samples: f64) -> f64 {
    LEFT + fraction(samples, SAMPLES) * (WIDTH - LEFT - RIGHT)
}

fn y(seconds: f64) -> f64 {
    HEIGHT - BOTTOM - fraction(seconds, SECONDS) * (HEIGHT - TOP - BOTTOM)
}

fn fraction(value: f64, (low, high): (i32, i32)) -> f64 {
    (value.log10() - f64::from(low)) / f64::from(high - low)
}

/// Time over samples: what was measured as points, the straight line through them, which the logarithmic
/// axes bend, and a dashed line of exact proportion.
pub(crate) fn figure(curves: &[Curve]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    text(&mut svg, LEFT, 24.0, "start", "Time per plan, 2 m in 5 s");
    grid(&mut svg);
    line(&mut svg, [x(1e2), y(1e-4), x(1e5), y(1e-1)], "#888888\" stroke-dasharray=\"4 4");
    text(&mut svg, x(1e5) + 6.0, y(1e-1), "start", "proportional");
    for (index, (curve, color)) in curves.iter().zip(COLORS).enumerate() {
        let (fixed, slope) = curve.fit;
        let at = |k: i32| 10_f64.powf(2.0 + f64::from(k) / 10.0);
        let points = (0..=30).map(|k| {
            let count = at(k);
            format!("{:.1},{:.1}", x(count), y(fixed + slope * count))
        });
        let points = points.collect::<Vec<_>>().join(" ");
        // Writing to a String cannot fail.
        let _ = writeln!(
            svg,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.8\"/>"
        );
        for &(count, time) in &curve.points {
            let (x, y) = (x(count), y(time));
            let _ =
                writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"{color}\"/>");
        }
        let (left, at) = (WIDTH - RIGHT + 16.0, TOP + 200.0 + 20.0 * index as f64);
        line(&mut svg, [left, at - 4.0, left + 18.0, at - 4.0], color);
        text(&mut svg, left + 24.0, at, "start", curve.name);
    }
    svg + "</svg>\n"
}

fn grid(svg: &mut String) {
    for decade in SAMPLES.0..=SAMPLES.1 {
        let at = x(10_f64.powi(decade));
        line(svg, [at, TOP, at, HEIGHT - BOTTOM], "#dddddd");
        text(svg, at, HEIGHT - BOTTOM + 20.0, "middle", &10_i32.pow(decade as u32).to_string());
    }
    for (decade, label) in (SECONDS.0..=SECONDS.1).zip(TIMES) {
        let at = y(10_f64.powi(decade));
        line(svg, [LEFT, at, WIDTH - RIGHT, at], "#dddddd");
        text(svg, LEFT - 8.0, at + 4.0, "end", label);
    }
    text(svg, (LEFT + WIDTH - RIGHT) / 2.0, HEIGHT - 12.0, "middle", "samples");
}

fn line(svg: &mut String, [x1, y1, x2, y2]: [f64; 4], stroke: &str) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{stroke}\"/>"
    );
}

fn text(svg: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>");
}
