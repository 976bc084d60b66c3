//! What is written, without building it.

use shapebot_deploy::{Error, Files, Request, Target, Text, deploy, write};
use shapebot_dynamics::LagrangianSystem as _;
use shapebot_generated::ballbot_planar::BallbotPlanar;
use shapebot_planner::value::{
    FileError, PlanBytes, RobotId, Sizes, encode_values, encoded_values_len,
};
use std::fs;

fn request(name: &str, target: Target) -> Result<Files, Error> {
    request_with(name, target, None)
}

fn request_with(name: &str, target: Target, plan: Option<&[u8]>) -> Result<Files, Error> {
    let file = |ending: &str| format!("{name}.{ending}");
    let model = shapebot_models::text(name).expect("a bundled model");
    let drive = shapebot_drives::text(name).expect("a bundled drive");
    deploy(&Request {
        model: Text { name: &file("robot"), text: model },
        drive: Text { name: &file("toml"), text: drive },
        target,
        plan,
    })
}

fn planar(target: Target) -> Files {
    request("ballbot_planar", target).unwrap_or_else(|error| panic!("{error}"))
}

fn text<'f>(files: &'f Files, path: &str) -> &'f str {
    let content = files.get(path).unwrap_or_else(|| panic!("no `{path}`"));
    std::str::from_utf8(content).expect("text")
}

#[test]
fn files_are_the_same_each_time_and_name_no_place() {
    let files = planar(Target::Linux);
    assert_eq!(files, planar(Target::Linux));
    let here = env!("CARGO_MANIFEST_DIR");
    let root = here.strip_suffix("/robots/deploy").unwrap_or(here);
    for (path, content) in files.iter() {
        let content = String::from_utf8_lossy(content);
        assert!(!content.contains(root), "{path} names the checkout");
        assert!(!path.starts_with('/') && !path.contains(".."), "{path}");
    }
    assert!(files.iter().count() > 100);
}

#[test]
fn manifests_stand_alone_at_pinned_versions() {
    for target in [Target::Linux, Target::CortexM] {
        let files = planar(target);
        let manifests: Vec<&str> = files.iter().map(|(path, _)| path).collect();
        let manifests = manifests.into_iter().filter(|path| path.ends_with("Cargo.toml"));
        for path in manifests {
            let manifest = text(&files, path);
            assert!(!manifest.contains("workspace = true"), "{path}");
            assert!(!manifest.contains("dev-dependencies]\nproptest"), "{path}");
            for line in
                manifest.lines().filter(|line| line.contains("version = \"") && line.contains('{'))
            {
                assert!(line.contains("version = \"="), "{path}: {line}");
            }
            for part in manifest.split("path = \"").skip(1) {
                let to = part.split('"').next().unwrap_or_default();
                let inside = to.starts_with("crates/")
                    || to.starts_with("../shapebot-")
                    || to == "src/main.rs";
                assert!(inside, "{path}: {to}");
            }
        }
    }
}

/// The sources that go along are the project's.
#[test]
fn the_licences_go_along() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for target in [Target::Linux, Target::CortexM] {
        let files = planar(target);
        for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let original = fs::read_to_string(root.join(name)).expect("the project's licence");
            assert_eq!(text(&files, name), original);
        }
    }
}

#[test]
fn the_page_has_the_wiring() {
    let files = planar(Target::Linux);
    let page = text(&files, "README.md");
    let drive = shapebot_drives::text("ballbot_planar").expect("a drive");
    for line in drive.lines().filter_map(|line| line.strip_prefix("[node.")) {
        let node = line.trim_end_matches(']');
        assert!(page.contains(&format!("| {node} | ")), "{node} is not in the table");
    }
    assert!(!page.contains("{{") && !page.contains("{%"), "{page}");
    assert!(text(&files, "can/load.txt").contains("SYNC to last frame"));
    assert!(files.iter().any(|(path, _)| path.ends_with(".dbc")));
}

#[test]
fn mistakes_in_either_text_are_told_with_their_place() {
    let model = shapebot_models::text("ballbot_planar").expect("a model");
    let drive = shapebot_drives::text("ballbot_planar").expect("a drive");
    let both = |model, drive| {
        let model = Text { name: "a/my.robot", text: model };
        let drive = Text { name: "my.toml", text: drive };
        deploy(&Request { model, drive, target: Target::Linux, plan: None }).expect_err("a mistake")
    };
    let error = both("robot X {", drive);
    assert!(
        matches!(error, Error::Model(_)) && error.to_string().contains("a/my.robot"),
        "{error}"
    );
    let error = both(model, "title = 1");
    assert!(matches!(error, Error::Drive(_)) && error.to_string().contains("my.toml:1"), "{error}");
}

#[test]
fn a_folder_of_somebody_else_is_left_alone() {
    let files = planar(Target::CortexM);
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("robot");
    fs::create_dir(&folder).expect("a folder");
    write(&files, &folder).expect("into an empty folder");
    assert_eq!(
        fs::read(folder.join("README.md")).expect("a file"),
        files.get("README.md").expect("it")
    );
    // Again, with what cargo makes, and with a board that was filled in.
    fs::create_dir(folder.join("target")).expect("a folder");
    fs::write(folder.join("src/board.rs"), "mine").expect("a file");
    fs::write(folder.join("Cargo.lock"), "").expect("a file");
    write(&files, &folder).expect("over its own");
    assert!(folder.join("target").is_dir());
    assert_eq!(fs::read_to_string(folder.join("src/board.rs")).expect("a file"), "mine");
    // Edited.
    fs::write(folder.join("src/main.rs"), "mine").expect("a file");
    fs::write(folder.join("notes"), "mine").expect("a file");
    let error = write(&files, &folder).expect_err("edited");
    assert!(
        matches!(&error, Error::Edited { files, .. } if files == &["notes", "src/main.rs"]),
        "{error}"
    );
    assert_eq!(fs::read_to_string(folder.join("src/main.rs")).expect("a file"), "mine");
    // Somebody else's.
    fs::remove_file(folder.join("deployed.txt")).expect("a file");
    assert!(matches!(write(&files, &folder), Err(Error::Occupied { .. })));
    let file = parent.path().join("file");
    fs::write(&file, "mine").expect("a file");
    assert!(matches!(write(&files, &file), Err(Error::Occupied { .. })));
    let left: Vec<_> = fs::read_dir(parent.path()).expect("a folder").flatten().collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

/// A ball that stays at .25 rad, as a binary plan of three nodes.
fn stay(id: &RobotId<'_>) -> Vec<u8> {
    let sizes = Sizes { positions: 1, shapes: 1, forces: 2 };
    let mut file = vec![0; encoded_values_len::<f64>(&sizes, 3)];
    let value = |_: usize, index: usize| if index == 0 { 0.25 } else { 0.0 };
    encode_values::<f64>(id, &sizes, 3, |node| node as f64, value, &mut file).expect("a plan");
    file
}

#[test]
fn a_plan_goes_along_in_the_targets_scalar() {
    let id = RobotId::of(BallbotPlanar::<f64>::from_model().description());
    let plan = stay(&id);
    for (target, scalar) in [(Target::Linux, 8), (Target::CortexM, 4)] {
        let files = request_with("ballbot_planar", target, Some(&plan)).expect("its plan");
        let bytes = files.get("src/plan.bin").expect("the plan");
        let kept = PlanBytes::open(bytes).expect("a plan");
        assert_eq!((kept.scalar(), kept.nodes(), kept.value(1, 0)), (scalar, 3, 0.25));
        id.check(kept.robot()).expect("the same robot");
        assert!(text(&files, "src/lib.rs").contains("include_bytes!(\"plan.bin\")"));
    }
    assert!(planar(Target::Linux).get("src/plan.bin").is_none());
    // Another robot's plan, a changed one, and what is none.
    let other = request_with("ballbot3d", Target::Linux, Some(&plan));
    assert!(matches!(other, Err(Error::GivenPlan(FileError::OtherRobot { .. }))));
    let mut changed = plan.clone();
    changed[100] ^= 1;
    for wrong in [&changed[..], b"SBPL", b""] {
        let refused = request_with("ballbot_planar", Target::CortexM, Some(wrong));
        assert!(matches!(refused, Err(Error::GivenPlan(_))));
    }
}
