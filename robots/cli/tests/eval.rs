//! `shapebot eval`: numbers, layouts, bad lines.

mod common;

use common::{Run, root, shapebot, skip};
use serde_json::Value;
use std::path::Path;

fn eval(folder: &Path, robot: &str, rest: &[&str], input: &str) -> Run {
    shapebot(folder, &[&["eval", robot][..], rest].concat(), input)
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

/// The nesting of lists, without the numbers.
fn layout(value: &Value) -> String {
    match value {
        Value::Array(list) => {
            format!("[{}]", list.iter().map(layout).collect::<Vec<_>>().join(","))
        }
        _ => ".".to_owned(),
    }
}

fn assert_close(what: &str, found: &Value, expected: &Value, tolerance: f64) {
    assert_eq!(layout(found), layout(expected), "{what}");
    let (found, expected) = (numbers(found), numbers(expected));
    let largest = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() <= tolerance * largest, "{what}: {a} instead of {b}");
    }
}

/// The states of a reference file as input lines; forces one per actuator.
fn lines(states: &[Value]) -> String {
    let line = |state: &Value| {
        let (q, qd, qdd, tau) = (&state["q"], &state["qd"], &state["qdd"], &state["tau"]);
        format!("{}\n", serde_json::json!({"q": q, "qd": qd, "qdd": qdd, "tau": tau}))
    };
    states.iter().map(line).collect()
}

fn check(robot: &str, run: &Run, data: &Value) {
    let states = data["states"].as_array().unwrap();
    let answers: Vec<Value> =
        run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), states.len());
    for (answer, state) in answers.iter().zip(states) {
        let answer = answer.as_object().unwrap();
        assert_eq!(answer.len(), 18);
        for (field, found) in answer {
            match field.as_str() {
                "K0_qs" => assert_close(&format!("{robot} K0_qs"), found, &data["K0_qs"], 1e-13),
                _ => assert_close(&format!("{robot} {field}"), found, &state[field], 1e-12),
            }
        }
    }
}

#[test]
fn compiled_and_interpreted_robots_agree_with_exact_states() {
    let here = tempfile::tempdir().unwrap();
    let folder = root().join("tests/reference/dynamics");
    let Ok(files) = std::fs::read_dir(&folder) else {
        return skip("reference", "no reference data in tests/reference");
    };
    for path in files.map(|entry| entry.unwrap().path()) {
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        let data: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let input = lines(data["states"].as_array().unwrap());
        check(&stem, &eval(here.path(), &stem, &[], &input).ok(), &data);
        // The same text under another name.
        let model = root().join(format!("robots/models/{stem}.robot"));
        std::fs::copy(model, here.path().join("renamed.robot")).unwrap();
        check(&stem, &eval(here.path(), "renamed.robot", &[], &input).ok(), &data);
    }
}

#[test]
fn fields_come_in_the_requested_order() {
    let here = tempfile::tempdir().unwrap();
    let run = eval(here.path(), "ballbot_planar", &["--fields", "G,M"], "{\"q\":[0,0]}\n").ok();
    assert!(run.stdout.starts_with("{\"G\":[0,"), "{}", run.stdout);
    assert!(run.stdout.contains(",\"M\":[["), "{}", run.stdout);
    eval(here.path(), "ballbot_planar", &["--fields", "Gama"], "")
        .fails(2, "did you mean `Gamma`?");
    eval(here.path(), "ballbot_planar", &["--fields", "M,M"], "").fails(2, "twice");
}

#[test]
fn bad_lines_are_named_and_good_ones_before_them_answered() {
    let here = tempfile::tempdir().unwrap();
    let good = "{\"q\":[0.1,0.2],\"qd\":[0,0],\"qdd\":[0,0]}\n";
    for (bad, about) in [
        ("{\"q\":[1e999,0],\"qd\":[0,0],\"qdd\":[0,0]}", "line 3"),
        ("{\"q\":[0],\"qd\":[0,0],\"qdd\":[0,0]}", "`q` has 1 entry, the robot has 2 coordinates"),
        ("{\"q\":[0,0],\"qd\":[0,0]}", "`qdd` is missing"),
        ("{\"q\":[0,0],\"qd\":[0,0],\"qdd\":[0,0],\"tau\":[0,0]}", "the robot has 1 actuator"),
        ("{\"q\":[0,NaN],\"qd\":[0,0],\"qdd\":[0,0]}", "line 3"),
        ("{\"q\":[0,null],\"qd\":[0,0],\"qdd\":[0,0]}", "line 3"),
        ("[0,0]", "line 3"),
        ("hello", "line 3: column 1"),
        ("{\"q\":[0,0]", "line 3"),
    ] {
        // The second line is blank, and counts.
        let input = format!("{good}\n{bad}\n{good}");
        let run = eval(here.path(), "ballbot_planar", &[], &input).fails(2, about);
        assert!(run.stderr.contains("line 3"), "{}", run.stderr);
        assert_eq!(run.stdout.lines().count(), 1);
    }
    let long = format!("{{\"q\":[{}0,0]}}", " ".repeat(2 << 20));
    eval(here.path(), "ballbot_planar", &[], &long).fails(2, "line 1: longer than");
}

#[test]
fn empty_input_is_no_error_and_a_last_line_needs_no_newline() {
    let here = tempfile::tempdir().unwrap();
    assert_eq!(eval(here.path(), "ballbot_planar", &[], "").ok().stdout, "");
    let run = eval(here.path(), "ballbot_planar", &["--fields", "M"], "\r\n {\"q\":[0,0]}").ok();
    assert_eq!(run.stdout.lines().count(), 1);
}

#[test]
fn output_numbers_read_back_as_the_same_doubles() {
    let here = tempfile::tempdir().unwrap();
    let line = "{\"q\":[0.1,0.2]}\n";
    let run = eval(here.path(), "ballbot_planar", &["--fields", "potential"], line).ok();
    let value: Value = serde_json::from_str(&run.stdout).unwrap();
    let number = value["potential"].as_f64().unwrap();
    assert_eq!(run.stdout, format!("{{\"potential\":{number}}}\n"));
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    use std::io::{BufRead, BufReader, Write};
    use std::process::{Command, Stdio};
    let mut child = Command::new(env!("CARGO_BIN_EXE_shapebot"))
        .args(["eval", "ballbot3d_arms"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let zeros = "[0,0,0,0,0,0,0,0]";
    let line = format!("{{\"q\":{zeros},\"qd\":{zeros},\"qdd\":{zeros}}}\n");
    let mut stdin = child.stdin.take().unwrap();
    // One line gets its answer while the pipe is still open.
    stdin.write_all(line.as_bytes()).unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    let mut answer = String::new();
    stdout.read_line(&mut answer).unwrap();
    assert!(answer.starts_with("{\"M\":"));
    drop(stdout);
    let writer = std::thread::spawn(move || stdin.write_all(line.repeat(2000).as_bytes()));
    let output = child.wait_with_output().unwrap();
    let _ = writer.join().unwrap();
    assert!(output.status.success());
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
