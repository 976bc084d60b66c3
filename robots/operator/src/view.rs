//! Telemetry as text.

use crate::{Telemetry, fault, state};
use shapebot_drive_build::DriveDescription;
use std::fmt::Write;

/// Half the width of a bar, in characters.
const HALF: usize = 12;

/// The state in one line, for a log.
#[must_use]
pub fn line(telemetry: &Telemetry) -> String {
    let mut text = String::new();
    let Some(status) = telemetry.status else { return "no status yet".to_owned() };
    let _ = write!(text, "{}", state(status.state));
    if let Some((number, node)) = status.fault {
        let _ = write!(text, ", {}{}", fault(number), node_text(node));
    }
    if let Some([x, y, heading]) = telemetry.lean {
        let [x, y, heading] = [x, y, heading].map(f64::to_degrees);
        let _ = write!(text, ", lean {x:.2} {y:.2} deg, heading {heading:.1} deg");
    }
    text
}

/// All of it on a page, with the names of the drive's coordinates and axes, and of gains by their numbers.
#[must_use]
pub fn view(telemetry: &Telemetry, drive: &DriveDescription, gains: &[&str]) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{} ({})\n", drive.title, drive.name);
    status(&mut text, telemetry);
    lean(&mut text, telemetry, drive);
    let _ = writeln!(text, "\nforces");
    for (axis, force) in drive.axes.iter().zip(&telemetry.forces) {
        let unit = if axis.unit == "m" { "N" } else { "N·m" };
        let bar = bar(*force, axis.limit);
        let _ = writeln!(text, "  {:<12} {bar} {} {unit}", axis.name, number(*force, 2));
    }
    let _ = writeln!(text, "\npositions");
    for ((name, unit), position) in drive.coordinates.iter().zip(&telemetry.positions) {
        let _ = writeln!(text, "  {name:<12} {} {unit}", number(*position, 4));
    }
    health(&mut text, telemetry);
    tuning(&mut text, telemetry, gains);
    text
}

fn status(text: &mut String, telemetry: &Telemetry) {
    let Some(status) = telemetry.status else {
        text.push_str("state        no telemetry yet\n");
        return;
    };
    let _ = writeln!(text, "state        {}", state(status.state));
    let legs = status.legs.map_or_else(|| "-".to_owned(), |legs| format!("{legs:#04x}"));
    let balance = if status.balance { "yes" } else { "no" };
    let _ = writeln!(text, "can balance  {balance}     legs {legs}");
    let first = status.fault.map_or_else(
        || "none".to_owned(),
        |(number, node)| format!("{}{}", fault(number), node_text(node)),
    );
    let _ = writeln!(text, "first fault  {first}");
    if let Some((bits, _)) = telemetry.faults.filter(|(bits, _)| *bits != 0) {
        let all: Vec<&str> = (1..32).filter(|n| bits >> n & 1 == 1).map(fault).collect();
        let _ = writeln!(text, "all faults   {}", all.join(", "));
    }
}

fn node_text(node: u8) -> String {
    if node == 0xFF { String::new() } else { format!(" (node {node})") }
}

fn lean(text: &mut String, telemetry: &Telemetry, drive: &DriveDescription) {
    let Some(lean) = telemetry.lean else { return };
    let most = f64::from(drive.safety.limits.lean_limit);
    let _ = writeln!(text, "\nlean");
    for (angle, name) in lean.iter().zip(["first", "second"]).take(drive.safety.lean.len()) {
        let shown = number(Some(angle.to_degrees()), 2);
        let _ = writeln!(text, "  {name:<12} {} {shown} deg", bar(Some(*angle), most));
    }
    let _ = writeln!(text, "  heading      {} deg", number(Some(lean[2].to_degrees()), 1));
}

fn health(text: &mut String, telemetry: &Telemetry) {
    if let Some(health) = telemetry.health {
        let (missed, worst, strange) = (health.missed, health.worst_us, health.strange);
        let _ = writeln!(
            text,
            "\nbus          {missed} inputs missed, SYNC late by {worst} µs at most, {strange} strange frames"
        );
    }
    if let Some(upload) = telemetry.upload.filter(|upload| upload.received > 0) {
        let whole = if upload.complete { "whole" } else { "incomplete" };
        let _ = writeln!(text, "plan         {} bytes, {whole}", upload.received);
    }
}

/// Gains that are not the designed ones, and the watch.
fn tuning(text: &mut String, telemetry: &Telemetry, gains: &[&str]) {
    let Some(tuning) = telemetry.tuning else { return };
    let named = gains.iter().zip(tuning.percent).filter(|(_, percent)| *percent != 100);
    let changed: Vec<String> = named.map(|(name, percent)| format!("{name} {percent} %")).collect();
    let changed = if changed.is_empty() { "as designed".to_owned() } else { changed.join(", ") };
    let watch = if tuning.watch { "armed" } else { "off" };
    let _ = writeln!(text, "gains        {changed}\nwatch        {watch}");
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| format!("{:>10}", "-"), |value| format!("{value:>10.digits$}"))
}

/// A bar from the middle to one side; full at `limit`.
fn bar(value: Option<f64>, limit: f64) -> String {
    let part = value.map_or(0.0, |value| value / limit);
    let filled = (part.abs().min(1.0) * HALF as f64).round() as usize;
    let (full, empty) = ("=".repeat(filled), " ".repeat(HALF - filled));
    if part < 0.0 {
        format!("[{empty}{full}|{}]", " ".repeat(HALF))
    } else {
        format!("[{}|{full}{empty}]", " ".repeat(HALF))
    }
}
