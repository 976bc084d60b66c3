//! Task files: every bundled one is planned, and wrong ones are refused with their place.

mod common;

use common::{Run, root, shapebot};
use serde_json::Value;
use shapebot_planner::value::verify_text;
use std::path::{Path, PathBuf};

fn tasks() -> Vec<PathBuf> {
    let files = std::fs::read_dir(root().join("robots/tasks")).unwrap();
    let files = files.map(|entry| entry.unwrap().path());
    let is_task = |path: &PathBuf| {
        path.extension().is_some_and(|extension| extension == "toml")
            && path.file_stem().is_some_and(|stem| stem != "Cargo")
    };
    let mut files: Vec<PathBuf> = files.filter(is_task).collect();
    files.sort();
    files
}

fn report(folder: &Path, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(format!("{name}.report.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

#[test]
fn every_task_file_is_planned_by_both_methods() {
    let here = tempfile::tempdir().unwrap();
    assert!(tasks().len() >= 12);
    for file in tasks() {
        let name = file.file_stem().unwrap().to_str().unwrap();
        let mut errors = Vec::new();
        for method in ["gain", "refined"] {
            let args = ["plan", file.to_str().unwrap(), "--method", method, "-o", method, "--plot"];
            let run = shapebot(here.path(), &args, "").ok();
            assert!(run.stdout.contains("converged") && !run.stdout.contains("not converged"));
            let folder = here.path().join(method);
            let found = report(&folder, name);
            assert_eq!(found["method"], method);
            errors.push(number(&found, "output_rmse"));
            for text in ["csv", "json"] {
                let text = std::fs::read_to_string(folder.join(format!("{name}.{text}"))).unwrap();
                assert_eq!(verify_text(&text), Ok(()), "{name}");
            }
            assert!(
                std::fs::read(folder.join(format!("{name}.plan"))).unwrap().starts_with(b"SBPL")
            );
            let plot = std::fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
            assert!(plot.ends_with("</svg>\n"));
        }
        assert!(errors[1] < 0.4 * errors[0] && errors[1] < 0.015, "{name}: {errors:?}");
    }
}

/// What an independent program's refined planner reached, and the least that can be reached.
#[test]
fn refined_plans_reach_their_figures() {
    let here = tempfile::tempdir().unwrap();
    for (task, reached) in [
        ("table2_cartpole", 0.0020),
        ("table2_ballbot_planar", 0.0093),
        ("table2_ballbot3d", 0.0093),
        ("table2_ballbot3d_arms", 0.0092),
        ("straight_line", 0.0148),
        ("bezier_curve", 1.5e-5),
        ("arms_forward", 3e-5),
        ("body_and_arms", 2.1e-4),
        ("arms_horizontal", 5e-5),
        ("equal_thirds", 8.1e-4),
    ] {
        shapebot(here.path(), &["plan", task, "-o", "."], "").ok();
        let found = report(here.path(), task);
        let (rmse, floor) = (number(&found, "output_rmse"), number(&found, "floor"));
        assert!(rmse <= reached && floor < rmse, "{task}: {rmse}, floor {floor}");
    }
    shapebot(here.path(), &["plan", "table2_ballbot3d", "--standing", "1", "-o", "."], "").ok();
    let found = report(here.path(), "table2_ballbot3d");
    assert!(number(&found, "output_rmse") < 5e-4, "{found}");
}

const WALK: &str = r#"robot = "mine.robot"
method = "refined"
samples = 301

[motion]
kind = "waypoints"
points = [{ time = "0 s", at = "0 m" }, { time = "3 s", at = "50 cm" }, { time = "6 s", at = "2 m" }]
"#;

fn plan(folder: &Path, text: &str) -> Run {
    std::fs::write(folder.join("tasks/walk.toml"), text).unwrap();
    shapebot(folder, &["plan", "tasks/walk.toml"], "")
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tasks")).unwrap();
    let model = root().join("robots/models/cartpole_planar.robot");
    std::fs::copy(model, folder.path().join("tasks/mine.robot")).unwrap();
    folder
}

#[test]
fn a_model_file_stands_beside_its_task() {
    let here = folder();
    let run = plan(here.path(), WALK).ok();
    assert!(run.stdout.contains("refined") && run.stdout.contains("floor"), "{}", run.stdout);
}

#[test]
fn wrong_tasks_are_refused_with_line_and_key() {
    let here = folder();
    let at = |place: &str| format!("tasks/walk.toml:{place}");
    for (from, to, code, message) in [
        ("samples", "sampels", 2, at("3:1: `sampels`: unknown key; did you mean `samples`?")),
        ("mine.robot", "yours.robot", 2, at("1:9: `robot`: cannot read tasks/yours.robot")),
        ("mine.robot", "cartpole", 2, at("1:9: `robot`: no file or bundled robot")),
        ("\"2 m\"", "\"2, 0 m\"", 2, at("7:94: `motion.points[2].at`: 2 numbers")),
        ("\"2 m\"", "\"2 rad\"", 2, at("7:94: `motion.points[2].at`: given in rad")),
        ("\"3 s\"", "\"3\"", 2, at("7:50: `motion.points[1].time`: no unit in")),
        ("\"6 s\"", "\"2 s\"", 2, at("5:1: `motion`: entry 2 of the times")),
        ("samples = 301", "samples = 1", 2, "samples".to_owned()),
        ("\"6 s\"", "\"3.1 s\"", 1, "outside of its range".to_owned()),
        ("samples =", "shares = { psi = 1 }\nsamples =", 2, at("3:12: `shares.psi`: no shape set")),
        (
            "samples =",
            "limits = { phi = \"1 m\" }\nsamples =",
            2,
            at("3:12: `limits.phi`: expected rad"),
        ),
        ("samples =", "shares = \"auto\"\nsamples =", 2, "kinds of free shape sets".to_owned()),
    ] {
        assert!(WALK.contains(from), "{from}");
        plan(here.path(), &WALK.replacen(from, to, 1)).fails(code, &message);
    }
    let with = |rest: &[&str]| {
        plan(here.path(), WALK).ok();
        shapebot(here.path(), &[&["plan", "tasks/walk.toml"][..], rest].concat(), "")
    };
    with(&["--line", "1"]).fails(2, "--line is for a robot");
    with(&["--method", "fast"]).fails(2, "possible values: gain, refined");
    shapebot(here.path(), &["plan", "tasks/none.toml"], "").fails(2, "none.toml");
    shapebot(here.path(), &["plan", "arms_wavin"], "").fails(2, "did you mean `arms_waving`?");
}

#[test]
fn shares_are_chosen_from_limits_and_constraints_hold() {
    let here = folder();
    let auto = r#"robot = "ballbot3d_arms"
method = "refined"
samples = 401
shares = "auto"
spare = "unactuated"
limits = { alpha_l = "40 deg", alpha_r = "40 deg", phi = "10 deg" }
[motion]
kind = "line"
goal = "2, 0 m"
duration = "8 s"
"#;
    let run = plan(here.path(), auto).ok();
    let arm = run.stdout.lines().find(|line| line.contains("peak alpha_l_y")).unwrap();
    assert!(arm.contains("(39.") || arm.contains("(40.0"), "{arm}");
    plan(here.path(), &auto.replace("\"refined\"", "\"gain\"")).fails(2, "automatic shares");
    let held =
        format!("{auto}[constraints]\nphi = [{{ to = \"0, 1 deg\", duration = \"8 s\" }}]\n");
    plan(here.path(), &held).fails(2, "kinds of free shape sets");
    let unknown = format!("{auto}[constraints]\nphy = []\n");
    plan(here.path(), &unknown).fails(2, "`constraints.phy`: no shape set `phy`");
}

/// Table II's ball takes 6 N m by the gain plan, the arms of the lateral move 4 N m.
#[test]
fn actuators_keep_their_limits() {
    let here = folder();
    for (task, limit, actuator) in [
        ("table2_ballbot3d", "tau_ball = \"2 N m\"", "`tau_ball_x` would be"),
        ("arms_lateral", "tau_l = \"2, 2 N m\"", "`tau_l_x` would be"),
    ] {
        let text = shapebot_tasks::text(task).unwrap();
        let limited = text.replace("samples", &format!("force_limits = {{ {limit} }}\nsamples"));
        for method in ["gain", "refined"] {
            std::fs::write(here.path().join("tasks/walk.toml"), &limited).unwrap();
            let args = ["plan", "tasks/walk.toml", "--method", method];
            let run = shapebot(here.path(), &args, "").fails(1, actuator);
            let seconds = run.stderr.split(" s for the motion would do").next().unwrap();
            let seconds: f64 = seconds.rsplit(' ').next().unwrap().parse().unwrap();
            let duration = format!("duration = \"{} s\"", seconds + 0.01);
            let line = limited.lines().find(|line| line.starts_with("duration")).unwrap();
            let longer = limited.replace(line, &duration);
            std::fs::write(here.path().join("tasks/walk.toml"), longer).unwrap();
            let run = shapebot(here.path(), &args, "").ok();
            assert!(run.stdout.contains("peak tau_ball_x"), "{}", run.stdout);
        }
    }
    let unknown = WALK.replace("samples =", "force_limits = { f_z = \"1 N\" }\nsamples =");
    plan(here.path(), &unknown).fails(2, "`force_limits.f_z`: no actuator `f_z`");
    let wrong = WALK.replace("samples =", "force_limits = { f_x = \"1 N m\" }\nsamples =");
    plan(here.path(), &wrong).fails(2, "`force_limits.f_x`: expected N, found N*m");
}

#[test]
fn what_a_method_would_leave_out_is_refused() {
    let here = folder();
    let standing = WALK.replace("samples =", "standing = \"1 s\"\nsamples =");
    plan(here.path(), &standing).ok();
    let gain = standing.replace("\"refined\"", "\"gain\"");
    plan(here.path(), &gain).fails(2, "`standing`: standing before and after is for refined plans");
    let objective = WALK.replace("samples =", "objective = \"acceleration\"\nsamples =");
    plan(here.path(), &objective).fails(2, "`objective`: an objective is for gain plans");
    // Both halves have a floor, and may stand outside.
    let lateral = shapebot_tasks::text("arms_lateral").unwrap();
    let standing = lateral.replace("samples", "standing = \"1 s\"\nsamples");
    let run = plan(here.path(), &standing).ok();
    assert!(
        run.stdout.contains("  floor ") && run.stdout.contains("brake: sweeps"),
        "{}",
        run.stdout
    );
}
