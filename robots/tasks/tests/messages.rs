//! What is said about wrong task files.

use shapebot_tasks::{Motion, Shares, Spare, parse};

const SOUND: &str = r#"robot = "ballbot3d_arms"
samples = 501
shares = "auto"
spare = "actuated"
standing = { before = "1 s" }
limits = { alpha_l = "40 deg", phi = "5, 5 deg" }

[motion]
kind = "legs"
legs = [
    { kind = "rest", duration = "500 ms" },
    { kind = "waypoints", points = [{ time = "0 s", at = "0, 0 m" }, { time = "2 s", at = "1, 0 m" }] },
]

[constraints]
alpha_r = [{ to = "0, -90 deg", duration = "1 s" }, { duration = "1 s" }]
"#;

#[test]
fn every_key_is_read() {
    let task = parse("a.toml", SOUND).unwrap();
    assert_eq!(task.standing.value, [1.0, 0.0]);
    assert_eq!(task.shares.value, Shares::Automatic(Spare::Actuated));
    assert_eq!(task.limits[1].1.values.len(), 2);
    let Motion::Legs(legs) = &task.motion.value else { panic!("{:?}", task.motion) };
    assert_eq!(legs[0], Motion::Rest { duration: 0.5 });
    assert_eq!(task.constraints[0].set.value, "alpha_r");
    assert_eq!(task.constraints[0].set.place, "a.toml:16:1: `constraints.alpha_r`");
    assert!(task.constraints[0].legs[1].to.is_none());
}

#[test]
fn messages_have_line_and_key() {
    for (from, to, message) in [
        ("samples = 501", "samples = -1", "a.toml:2:11: `samples`: expected a number from 0 up"),
        (
            "samples = 501",
            "samles = 501",
            "a.toml:2:1: `samles`: unknown key; did you mean `samples`?",
        ),
        ("samples = 501", "", "a.toml:1:1: `samples`: this key is missing"),
        ("\"500 ms\"", "0.5", "a.toml:11:33: `motion.legs[0].duration`: expected a string of"),
        ("\"500 ms\"", "\"0.5\"", "a.toml:11:33: `motion.legs[0].duration`: no unit in \"0.5\""),
        ("\"500 ms\"", "\"5 m\"", "`motion.legs[0].duration`: expected one time such as"),
        (
            "\"rest\"",
            "\"rset\"",
            "a.toml:11:14: `motion.legs[0].kind`: no such choice: `rset`; did you mean `rest`?",
        ),
        ("\"rest\"", "\"legs\"", "`motion.legs[0].kind`: no such choice: `legs`"),
        ("duration = \"1 s\" }]", "durtion = \"1 s\" }]", "did you mean `duration`?"),
        ("\"auto\"", "{ phi = 1 }", "a.toml:4:9: `spare`: goes with shares"),
        (
            "\"auto\"",
            "{ phi = \"1\" }",
            "a.toml:3:18: `shares.phi`: expected a number, found a string",
        ),
        ("\"40 deg\"", "\"-40 deg\"", "`limits.alpha_l`: a limit is a magnitude, found -0.69"),
        (
            "[motion]",
            "force_limits = { tau = \"-1 N m\" }\n[motion]",
            "a.toml:8:24: `force_limits.tau`: a limit is a magnitude",
        ),
        ("\"500 ms\"", "\"0 s\"", "`motion.legs[0].duration`: a duration is longer than zero"),
        ("\"1 s\" }\nlim", "\"-1 s\" }\nlim", "`standing.before`: a time cannot be negative"),
        ("samples = 501", "samples = 1000001", "`samples`: more than 1000000 samples"),
        ("[motion]", "[motion", "a.toml:8:"),
        ("[motion]", "samples = 3\n[motion]", "a.toml:8:1: duplicate key"),
    ] {
        assert!(SOUND.contains(from), "{from}");
        let text = SOUND.replacen(from, to, 1);
        let error = parse("a.toml", &text).expect_err(to).to_string();
        assert!(error.contains(message), "{to}: {error}");
    }
}

#[test]
fn a_motion_in_two_phases_has_its_own_shares() {
    let lateral = shapebot_tasks::text("arms_lateral").unwrap();
    for (from, to, message) in [
        ("samples = 1231", "samples = 1230", "expected an odd number"),
        ("samples = 1231", "samples = 1231\nshares = { phi = 1 }", "`shares`: a motion of kind"),
        (
            "samples = 1231",
            "samples = 1231\nconstraints = { phi = [] }",
            "`constraints`: does not go with a motion of kind \"two-phases\": where its halves meet",
        ),
        ("brake = ", "break = ", "did you mean `brake`?"),
    ] {
        let error = parse("l.toml", &lateral.replacen(from, to, 1)).expect_err(to).to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn no_text_makes_it_panic() {
    for text in
        ["", "=", "[", "motion = 3", "robot = \"\\u{1}\"", "é = 1", "motion = { kind = [] }"]
    {
        parse("t.toml", text).unwrap_err();
    }
    // Cut anywhere, the text is refused or read, and nothing worse.
    for cut in (0..SOUND.len()).filter(|cut| SOUND.is_char_boundary(*cut)) {
        let _ = parse("t.toml", &SOUND[..cut]);
    }
    let many = "robot = \"r\"\nsamples = 9\n[motion]\nkind = \"bezier\"\nduration = \"1 s\"\n\
                points = [{ at = \"0 m\", times = 18446744073709551615 }]";
    assert!(parse("t.toml", many).unwrap_err().to_string().contains("control points"));
}
