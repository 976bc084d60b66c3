//! Plan files: what is read is what was written; whatever is cut or altered is refused.

use proptest::prelude::*;
use shapebot_dynamics::{Description, Parameter};
use shapebot_planner::value::{
    FileError, HEADER_BYTES, PlanBytes, PlanText, PlanView, RobotId, Sizes, TextForm, TextWriter,
    encode_values, encoded_values_len,
};

const PARAMETERS: [Parameter; 2] = [
    Parameter { name: "m", unit: "kg", value: 1.5, lower: 0.0, upper: 9.0, docs: "" },
    Parameter { name: "l", unit: "m", value: 0.5, lower: 0.0, upper: 9.0, docs: "" },
];

const fn described(name: &'static str, parameters: &'static [Parameter]) -> Description {
    Description {
        name,
        summary: "",
        coordinates: &[],
        position_count: 1,
        shape_sets: &[],
        actuators: &[],
        parameters,
        outputs: &[],
        output_unit: "m",
        frames: &[],
        points: &[],
        geometry: &[],
        friction: &[],
    }
}

const ROBOT: Description = described("a robot", &PARAMETERS);
const SIZES: Sizes = Sizes { positions: 1, shapes: 2, forces: 3 };

/// Nodes of n_x = 1, n_s = 2, n_f = 3.
fn binary(robot: &RobotId<'_>, rows: &[Vec<f64>]) -> Vec<u8> {
    let mut bytes = vec![0; encoded_values_len::<f64>(&SIZES, rows.len())];
    let time = |node| 0.25 * node as f64;
    let value = |node: usize, index: usize| rows[node][index];
    let used = encode_values::<f64>(robot, &SIZES, rows.len(), time, value, &mut bytes);
    assert_eq!(used, Ok(bytes.len()));
    bytes
}

fn text(form: TextForm, robot: &RobotId<'_>, rows: &[Vec<f64>]) -> String {
    let mut text = String::new();
    let columns = (0..SIZES.values()).map(|index| format!("c{index}"));
    let mut writer = TextWriter::new(&mut text, form, robot, columns).expect("a head");
    for row in rows {
        writer.row(row.iter().copied()).expect("a row");
    }
    writer.finish().expect("an end");
    text
}

fn rows() -> impl Strategy<Value = Vec<Vec<f64>>> {
    let number = prop_oneof![-1e3..1e3_f64, Just(0.0), Just(-0.0), Just(1e-300), -1e15..1e15];
    prop::collection::vec(prop::collection::vec(number, SIZES.values()), 2..6)
}

type View<'a> = PlanView<'a, f64, 1, 2, 3>;

fn refused(bytes: &[u8], robot: &RobotId<'_>) -> bool {
    let text = std::str::from_utf8(bytes);
    PlanBytes::open(bytes).is_err()
        && View::open(bytes, robot).is_err()
        && text.map_or(true, |text| PlanText::open(text).is_err())
}

proptest! {
    #[test]
    fn numbers_read_back_as_written(rows in rows()) {
        let robot = RobotId::of(&ROBOT);
        let bytes = binary(&robot, &rows);
        let plan = PlanBytes::open(&bytes).expect("a plan");
        prop_assert_eq!((plan.robot(), plan.sizes(), plan.nodes()), (&robot, SIZES, rows.len()));
        let view = View::open(&bytes, &robot).expect("a plan");
        for (node, row) in rows.iter().enumerate() {
            for (index, value) in row.iter().enumerate() {
                prop_assert_eq!(plan.value(node, index).to_bits(), value.to_bits());
            }
            let state = view.at(plan.time(node));
            prop_assert!((state.position[0][0] - row[0]).abs() <= 1e-9 * (1.0 + row[0].abs()));
        }
        for form in [TextForm::Csv, TextForm::Json] {
            let text = text(form, &robot, &rows);
            let plan = PlanText::open(&text).expect("a plan");
            prop_assert_eq!((plan.form(), plan.robot()), (form, &robot));
            prop_assert_eq!(plan.columns().count(), SIZES.values());
            let read: Vec<Vec<f64>> = plan.rows().map(|row| row.flatten().collect()).collect();
            prop_assert_eq!(&read, &rows);
        }
    }

    #[test]
    fn cut_files_are_refused(rows in rows(), part in 0.0..1.0_f64) {
        let robot = RobotId::of(&ROBOT);
        let texts = [TextForm::Csv, TextForm::Json].map(|form| text(form, &robot, &rows).into_bytes());
        for bytes in texts.into_iter().chain([binary(&robot, &rows)]) {
            let cut = (part * bytes.len() as f64) as usize;
            prop_assert!(refused(&bytes[..cut], &robot));
            prop_assert!(refused(&[&bytes[..], &[0]].concat(), &robot));
        }
    }

    #[test]
    fn a_flipped_bit_is_refused(rows in rows(), part in 0.0..1.0_f64) {
        let robot = RobotId::of(&ROBOT);
        let texts = [TextForm::Csv, TextForm::Json].map(|form| text(form, &robot, &rows).into_bytes());
        for mut bytes in texts.into_iter().chain([binary(&robot, &rows)]) {
            let bit = (part * 8.0 * bytes.len() as f64) as usize;
            bytes[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(refused(&bytes, &robot), "bit {}", bit);
        }
    }

    #[test]
    fn no_bytes_make_it_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..200), sound: bool) {
        if sound && bytes.len() > 8 {
            bytes[..8].copy_from_slice(b"SBPL\x02\x00\x08\x03");
        }
        prop_assert!(refused(&bytes, &RobotId::of(&ROBOT)));
    }
}

/// Every bit of the ends, where header and checksum are.
#[test]
fn every_bit_of_short_files_counts() {
    let robot = RobotId::of(&ROBOT);
    let rows = vec![vec![0.5; SIZES.values()]; 2];
    let texts = [TextForm::Csv, TextForm::Json].map(|form| text(form, &robot, &rows).into_bytes());
    for bytes in texts.into_iter().chain([binary(&robot, &rows)]) {
        for cut in 0..bytes.len() {
            assert!(refused(&bytes[..cut], &robot), "{cut}");
        }
        for bit in 0..8 * bytes.len() {
            let mut altered = bytes.clone();
            altered[bit / 8] ^= 1 << (bit % 8);
            assert!(refused(&altered, &robot), "bit {bit}");
        }
    }
}

#[test]
fn a_plan_for_another_robot_is_refused() {
    let robot = RobotId::of(&ROBOT);
    let bytes = binary(&robot, &vec![vec![0.0; SIZES.values()]; 2]);
    assert_eq!(bytes.len(), HEADER_BYTES + 2 * 8 * (SIZES.values() + SIZES.forces) + 4);
    let other = described("another robot", &PARAMETERS);
    let heavier = RobotId::with(&ROBOT, |name| (name == "m").then_some(1.6));
    for other in [RobotId::of(&other), heavier] {
        let (found, expected) = (robot.fingerprint(), other.fingerprint());
        let refusal = View::open(&bytes, &other).map(|_| ());
        assert_eq!(refusal, Err(FileError::OtherRobot { found, expected }));
        assert_eq!(View::open_any(&bytes).expect("a plan").robot(), &robot);
    }
    // The same values, said again.
    assert_eq!(RobotId::with(&ROBOT, |name| (name == "l").then_some(0.5)), robot);
}

#[test]
fn long_names_are_cut_in_the_binary_form() {
    const LONG: Description =
        described("ein Roboter mit langem Namen, müde und schwer", &PARAMETERS);
    let robot = RobotId::of(&LONG);
    let bytes = binary(&robot, &vec![vec![0.0; SIZES.values()]; 2]);
    let kept = *View::open(&bytes, &robot).expect("a plan").robot();
    assert_eq!(kept.fingerprint(), robot.fingerprint());
    assert!(robot.name().starts_with(kept.name()) && kept.name().len() >= 30);
}

#[test]
fn rows_that_are_none_are_refused() {
    let robot = RobotId::of(&ROBOT);
    for form in [TextForm::Csv, TextForm::Json] {
        for (cells, line) in [(vec![1.0], 2), (vec![1.0, f64::NAN], 2)] {
            let mut text = String::new();
            let columns = ["t", "x"].into_iter();
            let mut writer = TextWriter::new(&mut text, form, &robot, columns).expect("a head");
            writer.row([0.0, 1.0].into_iter()).expect("a row");
            writer.row(cells.into_iter()).expect("a row");
            writer.finish().expect("an end");
            let first = if form == TextForm::Csv { 2 } else { 7 };
            let refusal = PlanText::open(&text).map(|_| ());
            assert_eq!(refusal, Err(FileError::Malformed { line: first + line }), "{text}");
        }
    }
    assert_eq!(PlanText::open("t,x\n0,1\n").map(|_| ()), Err(FileError::NotAPlan));
}
