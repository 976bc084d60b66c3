//! A model that is dropped into `robots/models` under a new name is a robot everywhere: in the tool, in
//! the tests and in the documentation, without another change.

use serde_json::{Map, Value};
use shapebot_tests::copies::{build_folder, cargo, copy_checkout, run, write_if_changed};
use shapebot_tests::environment::read;
use shapebot_tests::reference::load;
use std::path::Path;
use std::process::Command;

/// The model that is copied.
const ORIGINAL: &str = "ballbot3d_arms";
/// Name of the copy.
const COPY: &str = "zz_dropped_in";

/// Tests that speak of every robot.
const TESTS: [&str; 4] = ["--test", "listing", "--test", "mirror"];

/// States of the reference data as the tool reads them, one per line.
fn states() -> String {
    let data = load("dynamics", ORIGINAL).expect("reference states");
    let mut lines = String::new();
    for state in data.get("states").list() {
        let fields = ["q", "qd", "qdd", "tau"].map(|field| (field.to_owned(), state.get(field).0));
        lines += &Value::Object(Map::from_iter(fields)).to_string();
        lines.push('\n');
    }
    lines
}

#[test]
fn a_model_under_a_new_name_is_found_by_tool_tests_and_docs() {
    let (folder, target) = (build_folder("dropped-in"), build_folder("dropped-in-target"));
    if !copy_checkout(&folder) {
        return;
    }
    let text = read(&format!("robots/models/{ORIGINAL}.robot"))
        .replace("robot Ballbot3dArms", "robot Newcomer");
    assert!(text.contains("robot Newcomer"));
    write_if_changed(&folder.join(format!("robots/models/{COPY}.robot")), text.as_bytes());
    // At once and with the features of the whole workspace: every crate is built once.
    let all = ["build", "--quiet", "--offline", "--workspace", "--bin", "shapebot"];
    let _ = cargo(&folder, &target, &[&all[..], &TESTS].concat(), "");
    the_tool_finds_it(&folder, &target);
    the_tests_find_it(&folder, &target);
    the_docs_find_it(&folder, &target);
}

fn the_tool_finds_it(folder: &Path, target: &Path) {
    let program = target.join("debug").join(format!("shapebot{}", std::env::consts::EXE_SUFFIX));
    let tool = |arguments: &[&str], input: &str| {
        let mut command = Command::new(&program);
        command.args(arguments).current_dir(folder);
        run(&mut command, input)
    };
    let robots = tool(&["robots"], "");
    assert!(robots.contains(COPY), "robots that the tool lists:\n{robots}");
    let states = states();
    let [original, copy] = [ORIGINAL, COPY].map(|robot| tool(&["eval", robot], &states));
    assert_eq!(copy.lines().count(), 20);
    assert_eq!(copy, original, "the same model under another name moves otherwise");
}

fn the_tests_find_it(folder: &Path, target: &Path) {
    let test = ["test", "--quiet", "--offline", "--workspace"];
    let said = cargo(folder, target, &[&test[..], &TESTS, &["--", "--nocapture"]].concat(), "");
    assert!(said.contains(&format!("robot: {COPY}")), "robots that the tests list:\n{said}");
}

fn the_docs_find_it(folder: &Path, target: &Path) {
    let doc = ["doc", "--quiet", "--offline", "--no-deps", "-p", "shapebot-generated"];
    // Beside a crate whose build script reads TOML, so that the generator has the features it was built
    // with above.
    let _ = cargo(folder, target, &[&doc[..], &["-p", "shapebot-answers"]].concat(), "");
    let page = target.join(format!("doc/shapebot_generated/{COPY}/index.html"));
    let page = std::fs::read_to_string(&page).unwrap_or_else(|e| panic!("{}: {e}", page.display()));
    for coordinate in ["alpha_l_x", "phi_y"] {
        assert!(page.contains(coordinate), "the page of the robot has no `{coordinate}`");
    }
}
