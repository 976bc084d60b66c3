//! Numbers for the page's script: fixed point in sixteen bits, as base64.

use crate::data::{Animation, Panel, Path, Report, RunPage, Stroke};
use crate::scene::Body;
use serde_derive::Serialize;

/// Code of a gap.
const GAP: u16 = u16::MAX;

/// Largest code of a number.
const LAST: u16 = u16::MAX - 1;

/// Values `min + step * code`.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Packed {
    min: f64,
    step: f64,
    /// Codes as little-endian pairs of bytes, in base64; empty if all values are `min`.
    codes: String,
}

/// Rounds to the nearest of 65535 levels between the extremes: an error of 8e-6 of the range at most.
pub(crate) fn pack(values: &[f64]) -> Packed {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let min = finite().fold(f64::INFINITY, f64::min);
    let max = finite().fold(f64::NEG_INFINITY, f64::max);
    if min == max && values.iter().all(|value| value.is_finite()) {
        return Packed { min, step: 0.0, codes: String::new() };
    }
    let (min, step) = if min < max { (min, (max - min) / f64::from(LAST)) } else { (0.0, 1.0) };
    let code = |&value: &f64| match value {
        // In range by construction; the cast saturates.
        value if value.is_finite() => ((value - min) / step).round().min(f64::from(LAST)) as u16,
        _ => GAP,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|value| code(value).to_le_bytes()).collect();
    Packed { min, step, codes: base64(&bytes) }
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let index = (bits >> (18 - 6 * digit)) & 63;
            let shown = if digit <= group.len() { DIGITS[index as usize] } else { b'=' };
            out.push(char::from(shown));
        }
    }
    out
}

/// What the page's script reads.
#[derive(Serialize)]
pub(crate) struct Data<'r> {
    robots: Vec<Robot<'r>>,
    runs: Vec<Run<'r>>,
}

#[derive(Serialize)]
struct Robot<'r> {
    bodies: &'r [Body],
    poles: Option<[&'r [[f64; 2]]; 2]>,
}

#[derive(Serialize)]
struct Run<'r> {
    title: &'r str,
    robot: Option<usize>,
    time: Time,
    panels: Vec<Plot<'r>>,
    animation: Option<Scene>,
}

/// Shown instants.
#[derive(Debug, PartialEq, Serialize)]
#[serde(untagged)]
enum Time {
    Even { start: f64, step: f64, count: usize },
    Listed(Vec<f64>),
}

#[derive(Serialize)]
struct Plot<'r> {
    title: &'r str,
    unit: &'r str,
    series: Vec<Line<'r>>,
}

#[derive(Serialize)]
struct Line<'r> {
    label: &'r str,
    stroke: Stroke,
    color: usize,
    values: Packed,
}

#[derive(Serialize)]
struct Scene {
    floor: f64,
    carrier: Option<usize>,
    /// Per body: x, y, z, then quaternion w, x, y, z.
    bodies: Vec<[Packed; 7]>,
    paths: Vec<Trail>,
}

#[derive(Serialize)]
struct Trail {
    stroke: Stroke,
    points: [Packed; 3],
}

impl<'r> Data<'r> {
    /// The data of a report that was found sound.
    pub(crate) fn new(report: &'r Report) -> Self {
        let robots = report.robots.iter().map(|robot| Robot {
            bodies: &robot.bodies,
            poles: robot.control.as_ref().map(|c| [&*c.open_loop, &*c.closed_loop]),
        });
        let run = |run: &'r RunPage| Run {
            title: &run.title,
            robot: report.robots.iter().position(|robot| robot.name == run.robot),
            time: Time::of(&run.time),
            panels: run.panels.iter().map(Plot::of).collect(),
            animation: run.animation.as_ref().map(Scene::of),
        };
        Self { robots: robots.collect(), runs: report.runs.iter().map(run).collect() }
    }

    /// JSON that may stand inside a `script` element.
    pub(crate) fn json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string(self)?.replace('<', "\\u003c"))
    }
}

impl Time {
    fn of(times: &[f64]) -> Self {
        let count = times.len();
        if let (Some(&start), Some(&end), true) = (times.first(), times.last(), count > 1) {
            let step = (end - start) / (count - 1) as f64;
            let even = |(k, &t): (usize, &f64)| (start + step * k as f64 - t).abs() < 1e-6;
            if times.iter().enumerate().all(even) {
                return Self::Even { start, step, count };
            }
        }
        Self::Listed(times.iter().map(|t| (t * 1e6).round() / 1e6).collect())
    }
}

impl<'r> Plot<'r> {
    fn of(panel: &'r Panel) -> Self {
        let series = panel.series.iter().map(|series| Line {
            label: &series.label,
            stroke: series.stroke,
            color: series.color,
            values: pack(&series.values),
        });
        Self { title: &panel.title, unit: &panel.unit, series: series.collect() }
    }
}

impl Scene {
    fn of(animation: &Animation) -> Self {
        let count = animation.frames.first().map_or(0, Vec::len);
        let track = |body: usize, entry: usize| {
            let value = |frame: &Vec<crate::Pose>| {
                let pose = frame[body];
                if entry < 3 { pose.position[entry] } else { pose.rotation[entry - 3] }
            };
            pack(&animation.frames.iter().map(value).collect::<Vec<f64>>())
        };
        let body = |body| std::array::from_fn(|entry| track(body, entry));
        let trail = |path: &Path| Trail {
            stroke: path.stroke,
            points: std::array::from_fn(|axis| {
                pack(&path.points.iter().map(|point| point[axis]).collect::<Vec<f64>>())
            }),
        };
        Self {
            floor: animation.floor,
            carrier: animation.carrier,
            bodies: (0..count).map(body).collect(),
            paths: animation.paths.iter().map(trail).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads base64 of whole pairs of bytes.
    fn codes(text: &str) -> Vec<u16> {
        let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut bits = String::new();
        for c in text.chars().filter(|c| *c != '=') {
            bits.push_str(&format!("{:06b}", digits.find(c).unwrap()));
        }
        let bytes: Vec<u8> = (0..bits.len() / 8)
            .map(|i| u8::from_str_radix(&bits[8 * i..8 * i + 8], 2).unwrap())
            .collect();
        bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
    }

    #[test]
    fn base64_is_the_standard_one() {
        let known =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")];
        for (text, code) in known {
            assert_eq!(base64(text.as_bytes()), code);
        }
    }

    #[test]
    fn values_come_back_within_half_a_step() {
        let values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.37).sin() * 2.5 - 1.0).collect();
        let packed = pack(&values);
        for (value, code) in values.iter().zip(codes(&packed.codes)) {
            let back = packed.min + packed.step * f64::from(code);
            assert!((back - value).abs() < 5.1 / 65534.0 / 2.0, "{back} for {value}");
        }
    }

    #[test]
    fn gaps_and_constants_have_codes_of_their_own() {
        assert_eq!(pack(&[2.0, 2.0]), Packed { min: 2.0, step: 0.0, codes: String::new() });
        assert_eq!(codes(&pack(&[0.0, f64::NAN, 1.0]).codes), [0, GAP, LAST]);
        assert_eq!(codes(&pack(&[f64::NAN, f64::INFINITY]).codes), [GAP, GAP]);
        assert_eq!(codes(&pack(&[3.0, f64::NAN]).codes)[1], GAP);
    }

    #[test]
    fn even_times_are_counted_and_others_listed() {
        let even: Vec<f64> = (0..50).map(|i| f64::from(i) / 50.0).collect();
        assert!(matches!(Time::of(&even), Time::Even { count: 50, .. }));
        assert_eq!(Time::of(&[0.0, 1.0, 3.0]), Time::Listed(vec![0.0, 1.0, 3.0]));
    }
}
