//! Instructions of one step of the controller, counted by callgrind at random states.
//!
//! States fill half of the declared ranges: beyond 45° libm reduces an angle, some 50 instructions each.
//! The spread is that of all states but the fastest half percent, over the mean: single precision's sine
//! of an angle below 2⁻¹² takes a short cut. No state may take longer than the mean by that spread.
//!
//! `cargo bench -p shapebot-control` starts itself under valgrind; without valgrind it says so.

use nalgebra::SVector;
use shapebot_control::{Command, Controller, Gains, State, Target};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{Ordered, Robot};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::io::Write;

/// States per robot and scalar.
const STATES: usize = 10_000;

/// Largest spread that is accepted.
const SPREAD: f64 = 0.05;

/// Set in the process that runs under valgrind: robot and scalar.
const CHILD: &str = "SHAPEBOT_STEP_OF";

/// Numbers in [-1, 1], the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// The only part that is counted.
#[inline(never)]
fn measured_step<R, T, const N: usize, const NX: usize, const NS: usize>(
    controller: &mut Controller<'_, R, T, N, NX, NS>,
    state: &State<T, N>,
    target: &Target<T, N, NX, NS>,
) -> Command<T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    controller.step(state, target)
}

/// Ends the count of a step.
#[inline(never)]
fn counted_step<C>(command: C) {
    black_box(command);
}

/// Steps at random states: coordinates in half of their ranges, rates up to 3/s.
fn walk<R, T, const N: usize, const NX: usize, const NS: usize>(robot: &R, design: &ControlDesign)
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let gains = Gains::from_design(robot, design).expect("gains");
    let mut controller = Controller::new(robot, &gains).expect("a controller");
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let coordinates = robot.description().coordinates;
    let scale = |i: usize| (0.5 * coordinates[i].upper).min(3.0);
    for _ in 0..STATES {
        let mut vector = |size: &dyn Fn(usize) -> f64| {
            SVector::<T, N>::from_fn(|i, _| T::from_f64(size(i) * random.next()))
        };
        let state = State { q: vector(&scale), qd: vector(&|_| 3.0) };
        let [at, rate, acceleration] = [vector(&scale), vector(&|_| 3.0), vector(&|_| 3.0)];
        let [a, b, c] = [at, rate, acceleration].map(|v| R::split(&v));
        let target = Target { position: [a.0, b.0, c.0], shape: [a.1, b.1, c.1], force: at };
        counted_step(measured_step(&mut controller, black_box(&state), black_box(&target)));
    }
}

macro_rules! walks {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        vec![$(($name, {
            fn single() {
                use shapebot_generated::$module::{$robot, CONTROL};
                walk::<_, f32, $n, $nx, $ns>(&$robot::<f32>::from_model(), &CONTROL);
            }
            fn double() {
                use shapebot_generated::$module::{$robot, CONTROL};
                walk::<_, f64, $n, $nx, $ns>(&$robot::<f64>::from_model(), &CONTROL);
            }
            [single as fn(), double as fn()]
        })),*]
    };
}

fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Instructions of each counted call.
fn counted(wanted: &str) -> Option<Vec<u64>> {
    let folder = std::env::temp_dir().join(format!("shapebot-callgrind-{}", std::process::id()));
    std::fs::create_dir_all(&folder).ok()?;
    let status = std::process::Command::new("valgrind")
        .args(["--quiet", "--tool=callgrind", "--toggle-collect=*measured_step*"])
        .arg("--dump-before=*counted_step*")
        .arg(format!("--callgrind-out-file={}", folder.join("step").display()))
        .arg(std::env::current_exe().ok()?)
        .env(CHILD, wanted)
        .status();
    let total = |text: String| {
        let line = text.lines().find_map(|line| line.strip_prefix("totals:"))?.trim().parse().ok();
        line.filter(|&count: &u64| count > 0)
    };
    let files = (1..=STATES).map(|i| folder.join(format!("step.{i}")));
    let counts = files.filter_map(|file| total(std::fs::read_to_string(file).ok()?)).collect();
    let _ = std::fs::remove_dir_all(&folder);
    status.is_ok_and(|status| status.success()).then_some(counts)
}

fn main() {
    let robots: BTreeMap<&str, [fn(); 2]> =
        shapebot_generated::for_each_robot!(walks).into_iter().collect();
    if let Ok(wanted) = std::env::var(CHILD) {
        let (name, scalar) = wanted.split_once(' ').expect("robot and scalar");
        robots[name][usize::from(scalar == "f64")]();
        return;
    }
    say(&format!(
        "{:<18} {:>4} {:>8} {:>8} {:>8} {:>7}",
        "robot", "", "least", "mean", "most", "spread"
    ));
    for name in robots.keys() {
        for scalar in ["f32", "f64"] {
            let Some(counts) = counted(&format!("{name} {scalar}")) else {
                return say("skipped: valgrind does not run here");
            };
            assert_eq!(counts.len(), STATES, "every step is counted");
            // The first step fills the memory.
            let mut counts = counts[1..].to_vec();
            counts.sort_unstable();
            let (least, most) = (counts[0], counts[counts.len() - 1]);
            let mean = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
            let spread = (most - counts[STATES / 200]) as f64 / mean;
            say(&format!(
                "{name:<18} {scalar:>4} {least:>8} {mean:>8.0} {most:>8} {:>6.2}%",
                100.0 * spread
            ));
            assert!(spread <= SPREAD, "{name} {scalar}: the work depends on the state");
        }
    }
}
