//! A deployed program on vcan0, as it runs on a robot's computer, under an operator on the same bus. The other
//! side is the tool's simulated robot.

mod common;
mod traffic;

use common::{TASK, can_utils, drive, folder, on_vcan, user_mode_linux};
use shapebot_drive::{DriveTable, Role};
use shapebot_tests::copies::{build_folder, cargo_output, write_if_changed};
use shapebot_tests::environment::{say, skip};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use traffic::Traffic;

const ROBOT: &str = "ballbot_planar";

/// Lateness that is forgiven, in ms and cycles of the drive's limits: the program has a pace of its own, and
/// on a busy computer Linux keeps 50 ms of each second for programs without SCHED_FIFO.
const TIMES: &str = "[timing]\njitter = \"60 ms\"\nmissed-fault = 30\n";
const CYCLES: &str = "[safety]\nstale-fault = 30\nsilent-fault = 30\n";
const SLACK: u32 = 60;

/// How often the computer may be too busy.
const TRIES: usize = 4;

/// Faults that say that a process did not run when it should have.
const LATE: [&str; 5] = ["SyncJitter", "MissedInputs", "ControllerSilent", "8700", "8250"];

/// The tool.
const TOOL: &str = env!("CARGO_BIN_EXE_vcan-shapebot");

/// The tool in a folder, which has to succeed.
fn shapebot(folder: &Path, arguments: &[&str]) {
    let output = Command::new(TOOL).args(arguments).current_dir(folder).output().expect("the tool");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The text of the drive with limits that forgive.
fn drive_text() -> String {
    let text = shapebot_drives::text(ROBOT).expect("a drive");
    text.replace("[timing]\n", TIMES).replace("[safety]\n", CYCLES)
}

/// Copies all files below a folder, those that differ.
fn update(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("a file");
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        match source.is_dir() {
            true => update(&source, &target),
            false => write_if_changed(&target, &fs::read(&source).expect("a file")),
        }
    }
}

/// Deploys what is in `folder` and builds it; the program. `None`, after a line that says so, where cargo's
/// cache lacks a package.
///
/// The crate stays in one place and unchanged files keep their times, so that cargo builds what has changed;
/// what others wrote is shared with the tests of `deploy`, which use the same target folder.
fn deployed(folder: &Path) -> Option<PathBuf> {
    let arguments = ["deploy", ROBOT, "--drive", "drive.toml", "--target", "linux"];
    let rest = ["--plan", "plans/walk.plan", "-o", "robot"];
    shapebot(folder, &[&arguments[..], &rest].concat());
    let (kept, target) = (build_folder("vcan/kept"), build_folder("deployed"));
    update(&folder.join("robot"), &kept);
    let build = cargo_output(&kept, &target, &["build", "--release", "--offline", "--quiet"], "");
    let errors = String::from_utf8_lossy(&build.stderr);
    let lacking = ["no matching package", "unable to update", "failed to download"];
    if !build.status.success() && lacking.iter().any(|text| errors.contains(text)) {
        skip("deploy", errors.lines().next().unwrap_or_default());
        return None;
    }
    assert!(build.status.success(), "{errors}");
    Some(target.join("release/drive-robot"))
}

/// The program, the simulated robot, `candump -L`, and an operator who asks again while a state is on its
/// way; exit code 3 where it does not come. What they say is in memory until the end: writing to the host's
/// files stops all of them.
fn commands(robot: &Path) -> String {
    let robot = robot.display();
    format!(
        "mkdir -p /dev/shm && mount -t tmpfs none /dev/shm && mkdir /dev/shm/said || exit 70\n\
         said=/dev/shm/said; n=0\n\
         again() {{ n=$((n + 1)); [ $n -lt 40 ] && ! grep -q fault $said/orders.txt || exit 3; }}\n\
         operate() {{ {TOOL} $1 drive.toml --bus vcan0 $2 2>&1 | tee -a $said/orders.txt; }}\n\
         order() {{ until operate command $1 | grep -qv error; do again; sleep 0.2; done; }}\n\
         reaches() {{ until operate monitor '--for 0.5' | grep -q \"$1\"; do again; done; }}\n\
         candump -L -r 8388608 vcan0 >$said/dump.log & dump=$!\n\
         {TOOL} drive-sim walk.toml --drive drive.toml --bus vcan0 --slack {SLACK} >$said/nodes.txt 2>&1 & nodes=$!\n\
         sleep 1\n\
         {robot} --bus main=vcan0 >$said/robot.txt 2>&1 & robot=$!\n\
         (order start && order keep-station && order track && sleep 3 && reaches 'keeping station'); code=$?\n\
         sleep 1; kill $robot; wait $robot || code=4\n\
         sleep 1; kill $dump $nodes; wait\n\
         cp $said/* .\n\
         exit $code\n"
    )
}

/// One drive; what was on the bus, or what was said of lateness. `None` where user-mode Linux is missing.
fn run(folder: &Path, robot: &Path, table: &DriveTable<'_>) -> Option<Result<Traffic, String>> {
    let output = on_vcan(folder, &commands(robot))?;
    let text = |name| fs::read_to_string(folder.join(name)).unwrap_or_default();
    let said = text("robot.txt");
    if !output.status.success() {
        let all = format!("{said}\n{}\nnodes: {}", text("orders.txt"), text("nodes.txt"));
        assert!(LATE.iter().any(|fault| all.contains(fault)), "{all}\n{output:?}");
        return Some(Err(all));
    }
    assert!(said.contains("stopped in state LegsDown"), "{said}");
    say(&said);
    Some(Ok(Traffic::read(&folder.join("dump.log"), table)))
}

/// How far the rollers of a drive took the ball, m: its counts times a roller's circumference.
fn way(traffic: &Traffic, node: u8) -> f64 {
    let [first, last] = traffic.positions[&node];
    (last - first) as f64 / 16_384.0 * std::f64::consts::TAU * 6.335e-3
}

#[test]
fn a_deployed_program_drives_a_robot_over_socketcan() {
    if !can_utils() || !user_mode_linux() {
        return;
    }
    let folder = folder("deployed");
    let text = drive_text();
    fs::write(folder.join("walk.toml"), TASK).expect("the task");
    fs::write(folder.join("drive.toml"), &text).expect("the drive");
    shapebot(&folder, &["plan", "walk.toml", "-o", "plans"]);
    let Some(robot) = deployed(&folder) else { return };
    let description = drive(&text);
    let tables = description.tables();
    let table = tables.table();
    for _ in 0..TRIES {
        let Some(result) = run(&folder, &robot, &table) else { return };
        let traffic = match result {
            Ok(traffic) => traffic,
            Err(said) => {
                say(&format!("deployed, vcan0: {}", said.trim()));
                continue;
            }
        };
        let drives = table.nodes.iter().filter(|node| node.role == Role::Drive);
        let ways: Vec<f64> = drives.map(|node| way(&traffic, node.id.raw())).collect();
        say(&format!(
            "deployed, vcan0: {traffic}; {} orders; ball at {ways:.4?} m",
            traffic.orders
        ));
        traffic.check(&table);
        // Three at least, and each drive turns its own way.
        assert!(traffic.orders >= 3, "{} orders", traffic.orders);
        assert_eq!(ways.len(), 2);
        if traffic.keeps_time(table.timing.period_us) {
            assert!((ways[0].abs() - 0.5).abs() < 0.01 && (ways[0] + ways[1]).abs() < 0.01);
            return;
        }
    }
    panic!("this computer keeps no time");
}
