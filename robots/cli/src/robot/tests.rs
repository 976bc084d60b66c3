//! Tasks at random, for every bundled robot: planned, or refused at the key that is to blame.

use crate::failure::{Failure, Outcome};
use crate::robot::{Dynamics, Source, bundled, identity};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use shapebot_planning::PlannedMotion;
use shapebot_tasks::parse;

fn robots() -> Vec<(&'static str, Box<dyn Dynamics>)> {
    let open = |robot| Source::Bundled(robot).dynamics(&[]).expect("the model's own parameters");
    let all = bundled().map(|robot| (robot.name(), open(robot)));
    all.filter(|(_, robot)| robot.is_shape_accelerated()).collect()
}

fn plan(robot: &dyn Dynamics, text: &str) -> Outcome<PlannedMotion> {
    let task = parse("t.toml", text).map_err(Failure::usage)?;
    robot.plan(&task, &identity(robot.description(), &[]))
}

/// Planned with finite numbers, or refused: wrong input with its place.
fn check(robot: &dyn Dynamics, text: &str) -> Result<(), TestCaseError> {
    match plan(robot, text) {
        Ok(motion) => {
            let numbers = [motion.output_rmse, motion.output_max_error, motion.output_end_error];
            let numbers = numbers.iter().chain(&motion.peak_shape).chain(&motion.peak_force);
            prop_assert!(numbers.copied().all(f64::is_finite), "{}", text);
            prop_assert!(motion.rows.iter().all(|row| row.output.iter().all(|x| x.is_finite())));
        }
        Err(Failure::Usage(message, _)) => {
            prop_assert!(
                message.starts_with("t.toml:") && message.contains(": `"),
                "{}\n{}",
                message,
                text
            );
        }
        Err(Failure::Refused(message)) => prop_assert!(!message.is_empty()),
        Err(other) => prop_assert!(false, "{:?}\n{}", other, text),
    }
    Ok(())
}

const NUMBERS: [&str; 14] = [
    "0", "1", "-0.3", "0.5", "2", "1e-3", "-7", "40", "1e-300", "1e300", "-1e308", "nan", "inf",
    "x",
];
const TIMES: [&str; 10] =
    ["5 s", "2 s", "8 s", "1 s", "500 ms", "0 s", "-1 s", "1e-300 s", "1e300 s", "nan s"];
const SAMPLES: [&str; 10] = ["0", "1", "3", "4", "8", "9", "51", "201", "1000001", "-1"];

/// What a random task is made of: indices into lists of what may be written.
#[derive(Clone, Debug)]
struct Draw {
    kind: usize,
    refined: bool,
    sound: bool,
    picks: Vec<Index>,
}

fn draw() -> impl Strategy<Value = Draw> {
    let picks = prop::collection::vec(any::<Index>(), 60);
    (0..7_usize, any::<bool>(), any::<bool>(), picks)
        .prop_map(|(kind, refined, sound, picks)| Draw { kind, refined, sound, picks })
}

struct Writer<'d> {
    draw: &'d Draw,
    used: usize,
}

impl Writer<'_> {
    fn index(&mut self, count: usize) -> usize {
        self.used += 1;
        self.draw.picks[self.used % self.draw.picks.len()].index(count)
    }

    /// One of a list: in sound tasks one of its first few.
    fn of<'a>(&mut self, list: &[&'a str], sound: usize) -> &'a str {
        let count = if self.draw.sound { sound } else { list.len() };
        list[self.index(count)]
    }

    fn point(&mut self, count: usize, unit: &str) -> String {
        let extra = usize::from(!self.draw.sound && self.index(9) == 0);
        let numbers: Vec<&str> = (0..count + extra).map(|_| self.of(&NUMBERS, 4)).collect();
        format!("\"{} {unit}\"", numbers.join(", "))
    }

    fn time(&mut self) -> String {
        format!("\"{}\"", self.of(&TIMES, 3))
    }

    fn simple(&mut self, outputs: usize, unit: &str) -> String {
        match self.index(3) {
            0 => format!("kind = \"rest\", duration = {}", self.time()),
            1 => {
                let degree = ["9", "7", "11", "8", "0", "99"];
                let degree = self.of(&degree, 3);
                let (goal, time) = (self.point(outputs, unit), self.time());
                format!("kind = \"line\", goal = {goal}, degree = {degree}, duration = {time}")
            }
            _ => {
                let points: Vec<String> = (0..6).map(|_| self.point(outputs, unit)).collect();
                let time = self.time();
                format!("kind = \"bezier\", points = [{}], duration = {time}", points.join(", "))
            }
        }
    }

    fn motion(&mut self, outputs: usize, unit: &str, sets: &[&str]) -> String {
        match self.draw.kind {
            0..=2 => self.simple(outputs, unit),
            3 => {
                let times = ["0 s", "2 s", "5 s", "9 s", "-1 s", "1 s", "inf s"];
                let points = (0..4).map(|i| {
                    let time = if self.draw.sound { times[i] } else { self.of(&times, 1) };
                    format!("{{ time = \"{time}\", at = {} }}", self.point(outputs, unit))
                });
                let points: Vec<String> = points.collect();
                format!("kind = \"waypoints\", points = [{}]", points.join(", "))
            }
            4 => {
                let legs: Vec<String> =
                    (0..3).map(|_| format!("{{ {} }}", self.simple(outputs, unit))).collect();
                format!("kind = \"legs\", legs = [{}]", legs.join(", "))
            }
            5 => "kind = \"legs\", legs = []".to_owned(),
            _ => {
                let (goal, time) = (self.point(outputs, unit), self.time());
                let (one, two) = (self.shares(sets), self.shares(sets));
                format!(
                    "kind = \"two-phases\", goal = {goal}, duration = {time}, accelerate = {one}, \
                     brake = {two}"
                )
            }
        }
    }

    fn shares(&mut self, sets: &[&str]) -> String {
        let numbers = ["1", "0.5", "0", "-1", "2", "1e300", "1e-300", "nan"];
        match self.index(5) {
            0 => "\"auto\"".to_owned(),
            1 => "{}".to_owned(),
            _ => {
                let shares: Vec<String> =
                    sets.iter().map(|set| format!("{set} = {}", self.of(&numbers, 3))).collect();
                format!("{{ {} }}", shares.join(", "))
            }
        }
    }
}

fn task(name: &str, robot: &dyn Dynamics, draw: &Draw) -> String {
    let description = robot.description();
    let mut writer = Writer { draw, used: 0 };
    let sets: Vec<&str> = description.shape_sets.iter().map(|set| set.name).collect();
    let method = if draw.refined { "refined" } else { "gain" };
    let samples = if draw.sound { "201" } else { writer.of(&SAMPLES, 1) };
    let mut text = format!("robot = \"{name}\"\nmethod = \"{method}\"\nsamples = {samples}\n");
    let mut sometimes = |writer: &mut Writer<'_>, line: &dyn Fn(&mut Writer<'_>) -> String| {
        if writer.index(3) == 0 {
            text += &line(writer);
        }
    };
    sometimes(&mut writer, &|w| format!("shares = {}\n", w.shares(&sets)));
    sometimes(&mut writer, &|w| format!("standing = {}\n", w.time()));
    sometimes(&mut writer, &|w| {
        let limit = w.of(&["10 deg", "1 rad", "0 deg", "-1 deg", "1e300 deg", "1 m"], 2);
        format!("limits = {{ {} = \"{limit}\" }}\n", sets[w.index(sets.len())])
    });
    sometimes(&mut writer, &|w| {
        let actuator = description.actuators[w.index(description.actuators.len())];
        let limit = w.of(&["100", "1", "0", "-1", "1e300", "nan"], 2);
        format!("force_limits = {{ {} = \"{limit} {}\" }}\n", actuator.name, actuator.unit)
    });
    let motion = writer.motion(description.outputs.len(), description.output_unit, &sets);
    text += &format!("motion = {{ {motion} }}\n");
    if writer.index(4) == 0 {
        let set = description.shape_sets[writer.index(sets.len())];
        let unit = description.shape_coordinates()[set.first].unit;
        let (to, time) = (writer.point(set.len, unit), writer.time());
        text += &format!("constraints.{} = [{{ to = {to}, duration = {time} }}]\n", set.name);
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn tasks_are_planned_or_refused_at_their_place(draw in draw()) {
        thread_local! {
            static ROBOTS: Vec<(&'static str, Box<dyn Dynamics>)> = robots();
        }
        ROBOTS.with(|robots| {
            robots.iter().try_for_each(|(name, robot)| {
                check(robot.as_ref(), &task(name, robot.as_ref(), &draw))
            })
        })?;
    }

    #[test]
    fn bundled_tasks_survive_a_changed_letter(
        (name, text) in select(shapebot_tasks::TASKS),
        at in any::<Index>(),
        with in select(&b"0-9e .\",{}[]=#\n"[..]),
    ) {
        let _ = name;
        let mut bytes = text.as_bytes().to_vec();
        let at = at.index(bytes.len());
        bytes[at] = with;
        if let Ok(text) = String::from_utf8(bytes) {
            // Whatever it says now, reading it ends.
            let _ = parse("t.toml", &text);
        }
    }
}

/// Wrong input, and the key that is named.
#[test]
fn wrong_input_names_its_key() {
    for (name, robot) in robots() {
        let description = robot.description();
        let (unit, set) = (description.output_unit, description.shape_sets[0]);
        let goal = vec!["0.2"; description.outputs.len()].join(", ");
        let zeros = vec!["0"; set.len].join(", ");
        let nines = vec!["9e3"; set.len].join(", ");
        let shape_unit = description.shape_coordinates()[set.first].unit;
        let set = set.name;
        let sound = |shares: &str, samples: &str, goal: &str, duration: &str| {
            format!(
                "robot = \"{name}\"\n{shares}samples = {samples}\n[motion]\nkind = \"line\"\n\
                 goal = \"{goal} {unit}\"\nduration = \"{duration}\"\n"
            )
        };
        let constrained = |to: &str| {
            let text = sound("", "201", &goal, "8 s");
            format!(
                "{text}[constraints]\n{set} = [{{ to = \"{to} {shape_unit}\", duration = \"8 s\" }}]\n"
            )
        };
        let nothing = format!("shares = {{ {set} = 0 }}\n");
        let lone = description.shape_sets.len() == 1;
        let limit = format!("limits = {{ {set} = \"inf deg\" }}\n");
        for method in ["gain", "refined"] {
            let refusal = |text: &str| {
                let text = format!("method = \"{method}\"\n{text}");
                match plan(robot.as_ref(), &text) {
                    Err(Failure::Usage(message, _) | Failure::Refused(message)) => message,
                    other => panic!("{text}: {:?}", other.map(|_| ())),
                }
            };
            for (text, key) in [
                (sound("", "201", &goal, "0 s"), "`motion.duration`"),
                (sound("", "201", &goal, "nan s"), "`motion.duration`"),
                (sound("", "201", "inf", "8 s"), "`motion.goal`"),
                (sound("", "2", &goal, "8 s"), "`samples`"),
                (sound(&nothing, "201", &goal, "8 s"), "`shares`"),
                (sound("shares = {}\n", "201", &goal, "8 s"), "`shares`"),
                (sound(&limit, "201", &goal, "8 s"), "`limits."),
                (constrained(&format!("{zeros}, 0")), "`constraints."),
                (constrained(&nines), "`constraints."),
                (constrained("nan"), "`constraints."),
            ] {
                let message = refusal(&text);
                assert!(message.contains(key), "{name}, {method}, {key}: {message}\n{text}");
            }
            if lone {
                let message = refusal(&constrained(&zeros));
                assert!(message.contains("`constraints."), "{message}");
            }
        }
    }
}
