//! `shapebot drive` and `shapebot deploy`: what they print and write, and what they refuse.

mod common;

use common::{root, shapebot};
use std::collections::BTreeSet;
use std::path::Path;

/// Names of what is in a folder, sorted.
fn entries(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

fn planar() -> String {
    std::fs::read_to_string(root().join("robots/drives/ballbot_planar.toml")).unwrap()
}

#[test]
fn every_description_is_listed_and_reported() {
    let here = tempfile::tempdir().unwrap();
    let list = shapebot(here.path(), &["drive"], "").ok().stdout;
    for file in entries(&root().join("robots/drives")) {
        let Some(name) = file.strip_suffix(".toml").filter(|name| *name != "Cargo") else {
            continue;
        };
        let listed = list.lines().any(|line| line.split_whitespace().next() == Some(name));
        assert!(listed, "{name} is not in\n{list}");
        let report = shapebot(here.path(), &["drive", name], "").ok().stdout;
        for part in ["SYNC to last frame", "load:", "worst-case bit stuffing"] {
            assert!(report.contains(part), "{name}: no `{part}` in\n{report}");
        }
    }
    assert!(entries(here.path()).is_empty());
}

#[test]
fn generated_files_are_written_for_a_file_of_one_s_own() {
    let here = tempfile::tempdir().unwrap();
    std::fs::write(here.path().join("mine.toml"), planar()).unwrap();
    let run = shapebot(here.path(), &["drive", "mine.toml", "-o", "out"], "").ok();
    let files = entries(&here.path().join("out"));
    let texts = files.iter().filter(|file| !file.ends_with(".dbc"));
    assert!(texts.eq(&["mine.report.txt", "mine.rs", "mine.setup.txt"]), "{files:?}");
    assert_eq!(run.stdout.matches("wrote ").count(), files.len());
    let rust = std::fs::read_to_string(here.path().join("out/mine.rs")).unwrap();
    assert!(rust.contains("pub mod mine") && rust.contains("pub const DRIVE"));
    let dbc = files.iter().find(|file| file.ends_with(".dbc")).expect("a DBC file for its bus");
    let dbc = std::fs::read_to_string(here.path().join("out").join(dbc)).unwrap();
    assert!(dbc.contains("BO_ "), "{dbc}");
}

#[test]
fn mistakes_are_told_with_their_place_and_nothing_is_written() {
    let here = tempfile::tempdir().unwrap();
    let wrong = planar().replace("period = \"2 ms\"", "period = \"2 N\"");
    assert_ne!(wrong, planar());
    std::fs::write(here.path().join("wrong.toml"), &wrong).unwrap();
    let line = 1 + wrong.lines().position(|line| line.contains("2 N\"")).unwrap();
    let place = format!("wrong.toml:{line}:");
    shapebot(here.path(), &["drive", "wrong.toml", "-o", "out"], "").fails(2, &place);
    let deploy =
        ["deploy", "ballbot_planar", "--drive", "wrong.toml", "--target", "linux", "-o", "out"];
    shapebot(here.path(), &deploy, "").fails(2, &place);
    shapebot(here.path(), &["drive", "balbot3d"], "").fails(2, "ballbot3d");
    shapebot(here.path(), &["drive", "ballbot3d", "--robot", "cartpole_planar"], "")
        .fails(2, "axis");
    assert_eq!(entries(here.path()).into_iter().collect::<Vec<_>>(), ["wrong.toml"]);
}

#[test]
fn a_deployed_crate_says_how_to_go_on_and_is_the_same_again() {
    let here = tempfile::tempdir().unwrap();
    for (target, own) in [("linux", "src/main.rs"), ("cortex-m", "src/board.rs")] {
        let deploy = |folder: &str| {
            let args =
                ["deploy", "ballbot_planar", "--drive", "ballbot_planar", "--target", target];
            let args: Vec<&str> = args.into_iter().chain(["-o", folder]).collect();
            shapebot(here.path(), &args, "").ok().stdout
        };
        let (one, two) = (format!("{target}-one"), format!("{target}-two"));
        let said = deploy(&one);
        assert!(said.contains(&format!("{one}/README.md")), "{said}");
        deploy(&two);
        let (one, two) = (here.path().join(one), here.path().join(two));
        assert_eq!(entries(&one), entries(&two));
        for file in ["Cargo.toml", "README.md", own] {
            let [a, b] = [&one, &two].map(|folder| std::fs::read(folder.join(file)).unwrap());
            assert_eq!(a, b, "{target}: {file}");
            let text = String::from_utf8(a).unwrap();
            assert!(!text.contains(&*here.path().to_string_lossy()), "{file} names a place");
        }
        let crates = entries(&one.join("crates"));
        assert!(crates.contains("shapebot-drive"), "{crates:?}");
    }
}

#[test]
fn drive_and_model_must_go_together_and_plans_must_be_plans() {
    let here = tempfile::tempdir().unwrap();
    let deploy = |robot: &str, more: &[&str]| {
        let args = ["deploy", robot, "--drive", "ballbot_planar", "--target", "linux", "-o", "out"];
        let args: Vec<&str> = args.into_iter().chain(more.iter().copied()).collect();
        shapebot(here.path(), &args, "")
    };
    deploy("segway_planar", &[]).fails(2, "ballbot_planar.toml");
    deploy("no_such_robot", &[]).fails(2, "no_such_robot");
    std::fs::write(here.path().join("text.plan"), "no plan").unwrap();
    deploy("ballbot_planar", &["--plan", "missing.plan"]).fails(2, "missing.plan");
    deploy("ballbot_planar", &["--plan", "text.plan"]).fails(2, "text.plan is no binary plan file");
    assert!(!here.path().join("out").exists());
}
