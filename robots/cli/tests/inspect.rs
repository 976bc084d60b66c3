//! Plan files: read back, verified, converted.

mod common;

use common::{Run, root, shapebot};
use std::path::Path;

fn planned(name: &str, rest: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    shapebot(folder.path(), &[&["plan", name, "-o", "."][..], rest].concat(), "").ok();
    folder
}

fn inspect(folder: &Path, args: &[&str]) -> Run {
    shapebot(folder, &[&["inspect"][..], args].concat(), "")
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

const TASK: &str = "table2_ballbot3d_arms";

#[test]
fn every_form_is_read_back() {
    let here = planned(TASK, &["--method", "refined"]);
    for (ending, form) in [("csv", "CSV"), ("json", "JSON"), ("plan", "binary")] {
        let run = inspect(here.path(), &[&format!("{TASK}.{ending}")]).ok();
        for text in [form, "whole and unaltered", "ballbot3d_arms", "501", "0 s to 5.000", "3.79"] {
            assert!(run.stdout.contains(text), "{text}: {}", run.stdout);
        }
    }
}

#[test]
fn conversions_are_those_that_were_written() {
    let here = planned(TASK, &["--method", "refined"]);
    let file = |ending: &str| format!("{TASK}.{ending}");
    for (from, to) in [("csv", "json"), ("json", "csv"), ("csv", "plan"), ("json", "plan")] {
        let output = format!("out/{from}.{to}");
        inspect(here.path(), &[&file(from), "-o", &output]).ok();
        assert!(read(here.path(), &output) == read(here.path(), &file(to)), "{from} to {to}");
    }
    // The binary form has no desired motion and no output; the rest comes back as it went.
    inspect(here.path(), &[&file("plan"), "-o", "short.txt", "--format", "csv"]).ok();
    inspect(here.path(), &["short.txt", "-o", "again.plan"]).ok();
    let (again, first) = (read(here.path(), "again.plan"), read(here.path(), &file("plan")));
    assert_eq!(again.len(), first.len());
    let head = String::from_utf8(read(here.path(), "short.txt")).unwrap();
    assert!(head.lines().nth(1).unwrap().starts_with("t,theta_x,theta_y,theta_x_d"), "{head:.200}");
    inspect(here.path(), &[&file("csv"), "-o", "plan.txt"]).fails(2, "--format says which form");
    inspect(here.path(), &[&file("csv"), "--format", "json"]).fails(2, "--output");
}

#[test]
fn altered_and_foreign_files_are_refused() {
    let here = planned("table2_ballbot3d", &[]);
    for ending in ["csv", "json", "plan"] {
        let name = format!("table2_ballbot3d.{ending}");
        let whole = read(here.path(), &name);
        let write = |bytes: &[u8]| std::fs::write(here.path().join("bad"), bytes).unwrap();
        write(&whole[..whole.len() / 2]);
        inspect(here.path(), &["bad"]).fails(1, "bad: the plan file has");
        let mut altered = whole.clone();
        altered[whole.len() / 2] ^= 1;
        write(&altered);
        inspect(here.path(), &["bad"]).fails(1, "bad: the plan file was altered");
        inspect(here.path(), &[&name, "--robot", "ballbot3d_arms"]).fails(1, "is for `ballbot3d`");
        inspect(here.path(), &[&name, "--param", "m_b=60"]).fails(1, "other parameters");
        inspect(here.path(), &[&name, "--robot", "ballbot3d"]).ok();
        write(b"t,x\n0,1\n");
        inspect(here.path(), &["bad"]).fails(1, "no plan file; `shapebot plan -o DIR` writes");
    }
    inspect(here.path(), &["none.plan"]).fails(2, "cannot read none.plan");
}

#[test]
fn a_plan_knows_its_parameters_and_its_model_file() {
    let here = planned("table2_cartpole", &["--param", "l=0.6"]);
    let name = "table2_cartpole.plan";
    inspect(here.path(), &[name]).fails(1, "other parameters");
    inspect(here.path(), &[name, "--param", "l=0.6"]).ok();
    let model = root().join("robots/models/cartpole_planar.robot");
    std::fs::copy(model, here.path().join("mine.robot")).unwrap();
    let args = ["plan", "mine.robot", "--line", "1", "--duration", "5", "-o", "mine"];
    shapebot(here.path(), &args, "").ok();
    let run = inspect(here.path(), &["mine/mine.plan"]).ok();
    assert!(run.stdout.contains("not checked: --robot"), "{}", run.stdout);
    inspect(here.path(), &["mine/mine.plan", "-o", "a.csv"]).fails(2, "--robot FILE says");
    inspect(here.path(), &["mine/mine.csv", "-o", "a.json"]).ok();
    inspect(here.path(), &["mine/mine.plan", "--robot", "mine.robot", "-o", "a.csv"]).ok();
}
