//! What is said about wrong descriptions: each with line, key and figure.

mod common;

use common::check;

/// The bundled description with texts replaced, each of which must be there.
fn altered(name: &str, changes: &[(&str, &str)]) -> String {
    let mut text = shapebot_drives::text(name).expect("a drive").to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    text
}

/// The line on which a text first stands.
fn line(text: &str, what: &str) -> usize {
    let at = text.find(what).unwrap_or_else(|| panic!("no {what}"));
    text[..at].matches('\n').count() + 1
}

#[test]
fn messages_have_line_key_and_figure() {
    let mut wrong = Vec::new();
    for (name, from, to, place, message) in [
        // Form.
        (
            "ballbot3d",
            "period = \"2 ms\"",
            "period = 2",
            "period = 2",
            "`timing.period`: expected a string",
        ),
        ("ballbot3d", "period = \"2 ms\"", "perod = \"2 ms\"", "perod", "did you mean `period`?"),
        (
            "ballbot3d",
            "\"2 ms\"",
            "\"2 m\"",
            "\"2 m\"",
            "`timing.period`: \"2 m\" is no quantity in s",
        ),
        ("ballbot3d", "id = 3", "id = 200", "id = 200", "expected a whole number from 1 to 127"),
        ("ballbot3d", "\"0x2100:01\"", "\"2100.01\"", "\"2100.01\"", "is no object such as"),
        ("ballbot3d", "[timing]", "[timing", "[timing", ""),
        // Names and identifiers.
        (
            "ballbot3d",
            "id = 2\n",
            "id = 1\n",
            "id = 1\nserial = 1002",
            "`node.back.id`: node-ID 1 is that of `front` too",
        ),
        (
            "ballbot3d",
            "command = 0x521",
            "command = 0x191",
            "id = 17",
            "COB-ID 0x191 is that of operator commands and of TPDO 1 of `legs`",
        ),
        (
            "ballbot3d",
            "telemetry = 0x4A1",
            "telemetry = 0x581",
            "telemetry = 0x581",
            "CiA 301 restricts COB-ID 0x581",
        ),
        (
            "ballbot3d",
            "bus = \"drive\"",
            "bus = \"drve\"",
            "bus = \"drve\"",
            "there is no bus `drve`; did you mean `drive`?",
        ),
        (
            "ballbot3d",
            "type = \"roller\"",
            "type = \"rollr\"",
            "type = \"rollr\"",
            "there is no type `rollr`; did you mean `roller`?",
        ),
        // Coordinates.
        (
            "ballbot3d",
            "[axis.theta_y]",
            "[axis.theta_z]",
            "robot =",
            "coordinate `theta_y` is actuated, but no axis drives it",
        ),
        (
            "ballbot3d",
            "[axis.theta_y]",
            "[axis.phi_x]",
            "axis.phi_x",
            "this coordinate has no actuator in the model",
        ),
        (
            "ballbot3d",
            "[\"left\", \"right\"]",
            "[\"left\", \"front\"]",
            "node.right",
            "0 axes name this drive, expected 1",
        ),
        (
            "ballbot3d",
            "\"phi_x\", \"phi_y\"",
            "\"phi_x\", \"phi_x\"",
            "robot =",
            "coordinate `phi_y` has no motor and is sent by 0 sensors, expected 1",
        ),
        (
            "ballbot3d",
            "pair-tolerance = \"20 deg\"\n",
            "",
            "[axis.theta_x]",
            "2 drives share this axis: `pair-tolerance` is missing",
        ),
        (
            "cartpole_planar",
            "force = \"20 N\"",
            "force = \"25 N\"",
            "\"25 N\"",
            "25 N; the model's `f_x` ends at 20 N",
        ),
        // Range and resolution.
        (
            "ballbot3d",
            "peak-torque = \"2 N*m\"",
            "peak-torque = \"1.5 N*m\"",
            "\"60 N*m\"",
            "60 N*m take 1.796 N*m of each motor, its peak is 1.5 N*m",
        ),
        (
            "ballbot3d",
            "torque-step = \"0.1 N*m\"",
            "torque-step = \"0.03 N*m\"",
            "\"0.03 N*m\"",
            "torque of theta_x: one count is 0.033 N*m, at most 0.03 N*m are wanted",
        ),
        (
            "ballbot3d",
            "position-step = \"0.1 mrad\"",
            "position-step = \"0.01 mrad\"",
            "\"0.01 mrad\"",
            "position of theta_x: one count is 2.296e-5 rad",
        ),
        (
            "ballbot3d",
            "unit = \"20 urad\"",
            "unit = \"10 urad\"",
            "type = \"imu\"",
            "phi_x: the object holds 0.328 rad, 0.349 rad are needed",
        ),
        (
            "ballbot3d",
            "lean-step = \"0.05 mrad\"",
            "lean-step = \"0.01 mrad\"",
            "\"0.01 mrad\"",
            "phi_x: one count is 2.000e-5 rad",
        ),
        (
            "cartpole_planar",
            "type = \"i16\", unit = \"1 mA\"",
            "type = \"i8\", unit = \"1 mA\"",
            "\"20 N\"",
            "2222 counts of the torque object, signed, which ends at 127",
        ),
        (
            "ballbot3d",
            "rated-torque = \"1 N*m\"",
            "rated-torque = \"0.9005 N*m\"",
            "\"0.9005 N*m\"",
            "900.5 mN*m; 0x6076 holds whole mN*m",
        ),
        // Frames and time.
        (
            "ballbot3d",
            "\"error\", \"position\"",
            "\"error\", \"position\", \"torque-actual\"",
            "{ entries = [\"statusword\"",
            "10 bytes; a PDO has 1 to 8",
        ),
        (
            "ballbot3d",
            "compute = \"200 us\"",
            "compute = \"600 us\"",
            "\"1 Mbit/s\"",
            "`bus.drive.rate`: the last frame of a cycle is through 2185 us after SYNC, the period is 2000 us",
        ),
        (
            "ballbot3d",
            "rate = \"1 Mbit/s\"",
            "rate = \"800 kbit/s\"",
            "\"800 kbit/s\"",
            "worst-case load 91.6 %, at most 80.0 % are accepted",
        ),
        (
            "ballbot3d",
            "period = \"2 ms\"",
            "period = \"2.56 ms\"",
            "\"2.56 ms\"",
            "2560 us cannot be said in 0x60C2: 1 to 255 times a power of ten",
        ),
        (
            "ballbot3d",
            "counts = 16384",
            "counts = 16384\ninterpolation = \"1 ms\"",
            "interpolation",
            "0x60C2 says 1000 us, 0x1006 says 2000 us: they must agree",
        ),
        (
            "ballbot3d",
            "deadline = \"10 ms\"",
            "deadline = \"2 ms\"",
            "deadline = \"2 ms\"",
            "2 ms is not above the period of 2 ms",
        ),
        (
            "ballbot3d",
            "heartbeat-timeout = \"250 ms\"",
            "heartbeat-timeout = \"40 ms\"",
            "\"40 ms\"",
            "40 ms, but the master's heartbeat comes each 50 ms",
        ),
        // A shared receive PDO.
        (
            "ballbot3d_1khz",
            "sign = -1\nsign-in = \"drive\"",
            "sign = -1",
            "[node.back]",
            "hears the shared PDO 0x191: `sign-in = \"drive\"` is needed (0x607E)",
        ),
        (
            "ballbot3d_1khz",
            "dummy-mapping = true\n",
            "",
            "[type.roller]",
            "has 1 fields for others: `dummy-mapping = true` is needed",
        ),
        (
            "ballbot3d_1khz",
            "rpdo = [{ entries = [\"controlword\"], transmission = \"event\" }]\n",
            "",
            "[type.roller]",
            "receives `controlword` 0 times, expected once",
        ),
        (
            "ballbot3d_1khz",
            "fields = [\"theta_x\", \"theta_y\"]",
            "fields = [\"front\", \"back\", \"left\", \"right\", \"theta_x\"]",
            "[[shared]]",
            "5 fields are 10 bytes, a frame has 8",
        ),
        (
            "ballbot3d_1khz",
            "fields = [\"theta_x\", \"theta_y\"]",
            "fields = [\"theta_x\", \"theta_y\", \"controlword\"]",
            "fields",
            "a shared PDO has torques alone",
        ),
    ] {
        let text = altered(name, &[(from, to)]);
        let errors = check(&text).expect_err(to);
        let place = place.trim_start_matches('[').trim_end_matches(']');
        let start = format!("d.toml:{}:", line(&text, place));
        let found = errors.0.iter().map(ToString::to_string);
        if !found.clone().any(|error| error.starts_with(&start) && error.contains(message)) {
            wrong.push(format!("{to}: {start} ... {message}\n  but:\n{errors}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn several_mistakes_are_told_at_once() {
    let text = altered(
        "ballbot3d",
        &[
            ("peak-torque = \"2 N*m\"", "peak-torque = \"1.5 N*m\""),
            ("torque-step = \"0.1 N*m\"", "torque-step = \"0.03 N*m\""),
            ("compute = \"200 us\"", "compute = \"600 us\""),
            ("id = 17", "id = 127"),
        ],
    );
    let errors = check(&text).unwrap_err();
    let lines: Vec<usize> = errors.0.iter().map(|error| error.spot.line).collect();
    assert!(lines.is_sorted(), "{errors}");
    for part in ["its peak is 1.5 N*m", "at most 0.03 N*m", "2185 us after SYNC", "node-ID 127"] {
        assert!(errors.to_string().contains(part), "{part} in\n{errors}");
    }
}

#[test]
fn no_text_makes_it_panic() {
    let text = shapebot_drives::text("ballbot3d_1khz").expect("a drive");
    for cut in (0..text.len()).filter(|cut| text.is_char_boundary(*cut)).step_by(7) {
        let _ = shapebot_drive_build::read("d.toml", &text[..cut], common::model("ballbot3d"));
    }
    for line in 0..text.lines().count() {
        let without: Vec<&str> =
            text.lines().enumerate().filter(|(at, _)| *at != line).map(|(_, text)| text).collect();
        let _ =
            shapebot_drive_build::read("d.toml", &without.join("\n"), common::model("ballbot3d"));
    }
}
