//! Simulations, experiments and random runs through the tool.

mod common;

use common::{root, shapebot};
use std::path::Path;

/// The number behind a name in a summary.
fn number(summary: &str, name: &str) -> f64 {
    let line = summary.lines().find(|line| line.trim_start().starts_with(name));
    let line = line.unwrap_or_else(|| panic!("no `{name}` in {summary}"));
    let value = line.trim_start()[name.len()..].split_whitespace().next();
    value.and_then(|text| text.parse().ok()).unwrap_or_else(|| panic!("{line}"))
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn a_task_is_simulated_and_written() {
    let here = tempfile::tempdir().unwrap();
    let args = ["simulate", "straight_line", "-o", "out", "--plot"];
    let run = shapebot(here.path(), &args, "").ok();
    assert!(number(&run.stdout, "RMSE against plan") <= 0.001, "{}", run.stdout);
    // The paper's figure stands beside ours.
    assert!(run.stdout.contains("(paper 0.0180 m)"), "{}", run.stdout);
    let csv = read(here.path(), "out/straight_line.run.csv");
    let mut rows = csv.lines();
    let columns = rows.next().unwrap().split(',').count();
    assert_eq!(columns, 1 + 3 * 2 + 2 * 8 + 2 * 6 + 6);
    let last: Vec<f64> = rows.next_back().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    assert_eq!(last.len(), columns);
    assert!((last[0] - 6.0).abs() < 1e-9, "4 s and 2 s of standing: {}", last[0]);
    assert!((last[5] - 1.414).abs() < 1e-3, "ends at its goal: {}", last[5]);
    assert!(read(here.path(), "out/straight_line.svg").ends_with("</svg>\n"));
    let page = read(here.path(), "out/straight_line.html");
    assert!(page.contains("straight line, 1.414 m") && page.contains("</html>"));
    assert!(
        std::fs::read(here.path().join("out/straight_line.plan")).unwrap().starts_with(b"SBPL")
    );
}

#[test]
fn settings_change_the_run_and_only_that_run() {
    let here = tempfile::tempdir().unwrap();
    let error = |set: &[&str]| {
        let mut args = vec!["simulate", "table2_ballbot_planar"];
        set.iter().for_each(|line| args.extend(["--set", line]));
        number(&shapebot(here.path(), &args, "").ok().stdout, "RMSE against plan")
    };
    let nominal = error(&[]);
    let friction = "drive = { viscous = \"0.3 N m s\", coulomb = \"2 N m\" }";
    let (observed, unobserved) = (error(&[friction]), error(&[friction, "observer=false"]));
    // The observer is worth about ten times under friction at the drive.
    assert!(nominal < 0.2 * observed && observed < 0.2 * unobserved, "{observed} {unobserved}");
    assert!(observed <= 0.008 && unobserved <= 0.08, "{observed} {unobserved}");
    assert!(error(&["delay=6 ms"]) <= 0.002);
    assert!(error(&["plant.m_b=84.36"]) <= 0.02);
    assert_eq!(error(&["seed=3"]), nominal, "a seed without noise is nothing");
    let noise = "noise={lean=\"0.05 deg\",rate=\"0.3 deg/s\",counts=4096}";
    let (told, estimated) = (error(&[noise]), error(&[noise, "estimator=true"]));
    assert!(told <= 0.002 && estimated <= 0.006 && told != estimated, "{told} {estimated}");
}

#[test]
fn a_push_beyond_measure_is_a_fall_and_said() {
    let here = tempfile::tempdir().unwrap();
    let push = |newtons: u32| {
        let set = format!(
            "pushes=[{{point=\"head\",force=\"{newtons},0,0 N\",start=\"2 s\",duration=\"100 ms\"}}]"
        );
        shapebot(here.path(), &["simulate", "table2_ballbot_planar", "--set", &set], "").ok().stdout
    };
    assert!(!push(100).contains("fell"));
    assert!(push(5000).contains("fell"), "{}", push(5000));
}

#[test]
fn wrong_simulations_are_refused_at_their_key() {
    let here = tempfile::tempdir().unwrap();
    let refused = |set: &str, about: &str| {
        shapebot(here.path(), &["simulate", "straight_line", "--set", set], "").fails(2, about);
    };
    refused("colour=1", "unknown key");
    refused("observe=true", "did you mean `observer`?");
    refused("observer", "is not KEY=VALUE");
    refused("observer=2", "`observer`: expected true or false");
    refused("estimator=2", "`estimator`: expected true or false");
    refused("delay=6", "`delay`");
    refused("delay=-6 ms", "a time cannot be negative");
    refused("drive.coulomb=2 N", "expected N*m, found N");
    refused("drive.coulomb=-2 N m", "from 0 up");
    refused("gains.lean=[1,2,3]", "expected one number or 2, found 3");
    refused("gains.leen=1", "did you mean `lean`?");
    refused("plant.m_q=1", "no parameter `m_q`");
    refused("start.position=1 m", "expected 2 numbers, found 1");
    refused("slope=1 m", "expected an angle");
    refused("weights.nose=1 N", "no point `nose`");
    refused("controller=lqr", "`lqr`: this key is missing");
    refused("plant_model=balbot", "did you mean");
    refused("plant_model=cartpole_planar", "has no 8 coordinates");
    let simulate = |task: &str| shapebot(here.path(), &["simulate", task], "");
    simulate("straigt_line").fails(2, "did you mean `straight_line`?");
    simulate("nowhere.toml").fails(2, "cannot read nowhere.toml");
    let text = "robot = \"marble_maze_full\"\nsamples = 9\n[motion]\nkind = \"rest\"\nduration = \"1 s\"\n";
    std::fs::write(here.path().join("full.toml"), text).unwrap();
    simulate("full.toml").fails(1, "not shape-accelerated");
}

/// The same equations, once compiled and once interpreted, with gains designed at run time.
#[test]
fn a_model_file_is_simulated_as_its_compiled_twin() {
    let here = tempfile::tempdir().unwrap();
    let model = root().join("robots/models/cartpole_planar.robot");
    std::fs::copy(model, here.path().join("twin.robot")).unwrap();
    let text = shapebot_tasks::text("table2_cartpole").unwrap();
    let twin = text.replace("\"cartpole_planar\"", "\"twin.robot\"");
    std::fs::write(here.path().join("twin.toml"), twin).unwrap();
    let of = |task: &str| {
        let args = ["simulate", task, "--set", "start.lean=2 deg", "-o", "out"];
        let run = shapebot(here.path(), &args, "").ok().stdout;
        number(&run, "RMSE against plan")
    };
    let (compiled, interpreted) = (of("table2_cartpole"), of("twin.toml"));
    assert!((compiled - interpreted).abs() <= 1e-3 * compiled, "{compiled} {interpreted}");
    assert!(read(here.path(), "out/twin.html").contains("</html>"));
}

/// All of the paper's experiments by both planners: no fall, and the bounds of the refined plans.
#[test]
fn no_experiment_falls_and_the_report_is_whole() {
    let here = tempfile::tempdir().unwrap();
    let run = shapebot(here.path(), &["experiments", "-o", "out"], "").ok();
    assert!(!run.stdout.contains("fell"), "{}", run.stdout);
    let mut experiment = "";
    let mut seen = 0;
    for line in run.stdout.lines() {
        let cells: Vec<&str> = line.split_whitespace().collect();
        let by = cells.iter().position(|cell| ["LQR", "gain", "refined"].contains(cell));
        let Some(by) = by.filter(|by| *by < 2 && cells.len() > 5) else { continue };
        if by == 1 {
            experiment = cells[0];
        }
        seen += 1;
        if cells[by] != "LQR" {
            let loop_error: f64 = cells[by + 2].parse().unwrap();
            assert!(loop_error <= 0.001, "{line}");
        }
    }
    assert!(seen >= 2 * 15 && !experiment.is_empty(), "{seen} runs:\n{}", run.stdout);
    let page = read(here.path(), "out/report.html");
    assert!(page.len() < 10 << 20 && page.contains("</html>"));
}

/// Against the desired motion: the plans' loops beside the regulator's.
#[test]
fn plans_beat_the_regulator() {
    let here = tempfile::tempdir().unwrap();
    let error = |args: &[&str]| {
        let run =
            shapebot(here.path(), &[&["simulate", "lqr_fast"], args].concat(), "").ok().stdout;
        number(&run, "RMSE against desired")
    };
    let regulator = error(&[]);
    let refined = error(&["--set", "controller=law"]);
    let gain = error(&["--set", "controller=law", "--method", "gain"]);
    assert!(regulator >= 8.0 * refined && regulator >= 2.0 * gain, "{regulator} {refined} {gain}");
}

const RUNS: [&str; 5] = ["robustness", "table2_ballbot_planar", "-n", "11", "--no-onset"];

#[test]
fn shards_in_a_row_are_the_whole_and_merge() {
    let here = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| shapebot(here.path(), &[&RUNS, more].concat(), "").ok();
    let whole = run(&["--csv", "whole.csv"]).stdout;
    let mut joined = String::new();
    for (shard, file) in [("1/3", "1.csv"), ("2/3", "2.csv"), ("3/3", "3.csv")] {
        run(&["--shard", shard, "--csv", file]);
        joined += &read(here.path(), file);
    }
    assert_eq!(joined, read(here.path(), "whole.csv"));
    assert_eq!(joined.lines().count(), 12);
    let merge =
        |files: &[&str]| shapebot(here.path(), &[&["robustness", "merge"], files].concat(), "");
    // Whatever their order, and with the same words as the whole.
    let merged = merge(&["3.csv", "1.csv", "2.csv", "--csv", "all.csv"]).ok().stdout;
    assert_eq!(read(here.path(), "all.csv"), joined);
    assert_eq!(merged.replace("all.csv", "whole.csv"), whole);
    merge(&["1.csv", "3.csv"]).fails(2, "are missing");
    merge(&["1.csv", "2.csv", "2.csv", "3.csv"]).fails(2, "is there twice");
    let other = ["robustness", "table2_ballbot_planar", "-n", "11", "--seed", "2", "--no-onset"];
    shapebot(here.path(), &[&other[..], &["--shard", "2/3", "--csv", "o.csv"]].concat(), "").ok();
    merge(&["1.csv", "o.csv", "3.csv"]).fails(2, "of another seed");
    merge(&["1.csv", "none.csv"]).fails(2, "none.csv");
}

#[test]
fn a_replayed_run_is_the_run() {
    let here = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| shapebot(here.path(), &[&RUNS, more].concat(), "");
    run(&["--csv", "whole.csv"]).ok();
    let row = read(here.path(), "whole.csv").lines().nth(1 + 7).unwrap().to_owned();
    let replayed = run(&["--replay", "7", "-o", "out"]).ok().stdout;
    assert!(replayed.lines().any(|line| line == row), "{row}\n{replayed}");
    assert!(read(here.path(), "out/table2_ballbot_planar-1-7.html").contains("</html>"));
    run(&["--replay", "11"]).fails(2, "from 0 to 10");
    run(&["--shard", "4/3"]).fails(2, "is not I/N");
    run(&["-n", "0"]).fails(2, "");
}

#[test]
fn where_falls_begin_is_found() {
    let here = tempfile::tempdir().unwrap();
    let args = ["robustness", "table2_cartpole", "-n", "2"];
    let run = shapebot(here.path(), &args, "").ok().stdout;
    for what in ["delay of the actuators", "times the model's own", "push at", "bias of the"] {
        let line = run.lines().find(|line| line.contains(what));
        let line = line.unwrap_or_else(|| panic!("no `{what}` in {run}"));
        let cells: Vec<&str> = line.split("  ").map(str::trim).filter(|c| !c.is_empty()).collect();
        let (stands, falls): (f64, f64) = (cells[1].parse().unwrap(), cells[2].parse().unwrap());
        assert!(stands < falls && falls <= 1.06 * stands, "{line}");
    }
}
