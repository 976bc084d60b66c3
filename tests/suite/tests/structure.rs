//! The rules of ARCHITECTURE that can be checked on the text of the checkout.

use shapebot_tests::checkout::{Manifest, members};
use shapebot_tests::environment::{files, read, robot_names};

/// The rooms, and the small files beside them.
const FOLDERS: [&str; 6] = ["codegen", "generated", "model-dsl", "planner", "robots", "tests"];

/// Longest handwritten source file, lines.
const LONGEST: usize = 500;

/// The crate of the models: texts, the only thing under `robots/` that a lower room may see.
const MODELS: &str = "shapebot-models";

fn room(manifest: &Manifest) -> &str {
    manifest.folder.split('/').next().unwrap_or_default()
}

/// Names of the workspace's crates in a room.
fn crates<'a>(members: &'a [Manifest], name: &'a str) -> impl Iterator<Item = &'a str> {
    members.iter().filter(move |m| room(m) == name).map(|m| m.name.as_str())
}

/// Fails for every crate of `from` that is built from a crate of `to`.
fn assert_apart(members: &[Manifest], from: &str, to: &str, except: &[&str]) {
    let forbidden: Vec<&str> = crates(members, to).filter(|name| !except.contains(name)).collect();
    for member in members.iter().filter(|m| room(m) == from) {
        for needed in member.needs() {
            assert!(
                !forbidden.contains(&needed),
                "{from}: `{}` depends on `{needed}`",
                member.name
            );
        }
    }
}

#[test]
fn the_top_level_has_the_rooms_and_no_other_folder() {
    let Some(files) = files() else { return };
    let mut folders: Vec<&str> =
        files.iter().filter_map(|path| Some(path.split_once('/')?.0)).collect();
    folders.dedup();
    folders.retain(|folder| !folder.starts_with('.'));
    assert_eq!(folders, FOLDERS);
}

#[test]
fn every_crate_is_in_a_room_and_named_in_the_workspace() {
    let Some(files) = files() else { return };
    let members = members();
    for member in &members {
        assert!(FOLDERS.contains(&room(member)), "{}", member.folder);
    }
    let manifests = files.iter().filter_map(|path| path.strip_suffix("/Cargo.toml"));
    for folder in manifests.filter(|folder| !folder.starts_with("tests/foreign")) {
        let excluded = read("Cargo.toml").contains(&format!("\"{folder}\""));
        assert!(excluded, "`{folder}` is neither a member nor excluded");
    }
}

#[test]
fn the_language_depends_on_no_other_room() {
    let members = members();
    for other in ["codegen", "generated", "planner", "robots", "tests"] {
        assert_apart(&members, "model-dsl", other, &[]);
    }
}

#[test]
fn the_generator_knows_neither_planner_nor_robots() {
    let members = members();
    assert_apart(&members, "codegen", "robots", &[MODELS]);
    assert_apart(&members, "codegen", "planner", &["shapebot-dynamics"]);
    assert_apart(&members, "codegen", "generated", &[]);
    assert_apart(&members, "generated", "robots", &[MODELS]);
}

#[test]
fn the_planner_knows_neither_generator_nor_robots() {
    let members = members();
    for other in ["model-dsl", "codegen", "generated", "robots"] {
        assert_apart(&members, "planner", other, &[]);
    }
}

#[test]
fn the_dynamics_depend_on_nothing_of_ours() {
    let members = members();
    let dynamics = members.iter().find(|m| m.folder == "planner/dynamics").expect("the traits");
    for needed in dynamics.needs() {
        assert!(members.iter().all(|member| member.name != needed), "depends on `{needed}`");
    }
}

#[test]
fn generated_code_needs_the_traits_alone() {
    let members = members();
    let generated = members.iter().find(|m| m.folder == "generated").expect("the generated crate");
    assert_eq!(generated.dependencies, ["shapebot-dynamics"]);
}

#[test]
fn nothing_is_built_from_the_tests() {
    let members = members();
    for other in FOLDERS.into_iter().filter(|&folder| folder != "tests") {
        assert_apart(&members, other, "tests", &[]);
    }
}

#[test]
fn libraries_forbid_unsafe_code() {
    for member in members() {
        let path = format!("{}/src/lib.rs", member.folder);
        if shapebot_tests::environment::root().join(&path).exists() {
            assert!(read(&path).contains("#![forbid(unsafe_code)]"), "{path}");
        }
    }
}

#[test]
fn runtime_crates_need_no_standard_library() {
    for folder in [
        "planner/dynamics",
        "planner/planner",
        "generated",
        "robots/models",
        "robots/control",
        "robots/drive",
        "robots/drives",
        "robots/runtime",
    ] {
        let text = read(&format!("{folder}/src/lib.rs"));
        assert!(text.contains("#![no_std]"), "{folder}");
    }
}

/// Handwritten sources: neither inputs of tests nor generated.
fn sources() -> Option<Vec<String>> {
    let mut files = files()?;
    files.retain(|path| path.ends_with(".rs"));
    assert!(files.len() > 100, "only {} sources were found", files.len());
    Some(files)
}

#[test]
fn files_are_short_enough_to_read() {
    let Some(sources) = sources() else { return };
    let long = sources.iter().map(|path| (read(path).lines().count(), path));
    let long: Vec<_> = long.filter(|(lines, _)| *lines > LONGEST).collect();
    assert!(long.is_empty(), "more than {LONGEST} lines: {long:?}");
}

/// Text without the tests at its end, without comments and without the command lines that help texts
/// show: what runs.
fn code(path: &str) -> String {
    let text = read(path);
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = text
        .lines()
        .map(str::trim_start)
        .filter(|line| !line.starts_with("//") && !line.starts_with("shapebot "));
    lines.collect::<Vec<_>>().join("\n")
}

fn is_word(text: &str, at: usize, length: usize) -> bool {
    let part_of_name = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    let (before, after) = (text[..at].chars().next_back(), text[at + length..].chars().next());
    !part_of_name(before) && !part_of_name(after)
}

#[test]
fn no_robot_is_named_in_code() {
    /// Where the four systems of Table II are listed, as the data of that command.
    const TABLE: &str = "robots/cli/src/commands/table.rs";
    let Some(sources) = sources() else { return };
    let rooms = [
        "codegen/",
        "planner/",
        "generated/",
        "robots/cli/src/",
        "robots/control/src/",
        "robots/deploy/src/",
        "robots/experiments/",
        "robots/host/src/",
        "robots/models/",
        "robots/planning/",
        "robots/report/src/",
        "robots/rig/src/",
        "robots/runtime/src/",
        "robots/sim/src/",
    ];
    let searched = |path: &&String| {
        let test =
            path.contains("/tests/") || path.ends_with("/tests.rs") || path.contains("/examples/");
        rooms.iter().any(|room| path.starts_with(room)) && !test && path.as_str() != TABLE
    };
    let mut named = Vec::new();
    for path in sources.iter().filter(searched) {
        let text = code(path);
        for name in robot_names() {
            let mut places = text.match_indices(&name);
            if places.any(|(at, _)| is_word(&text, at, name.len())) {
                named.push(format!("{path}: {name}"));
            }
        }
    }
    assert!(named.is_empty(), "robots are named in {named:#?}");
}
