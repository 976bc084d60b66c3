//! Whatever bytes come in: a clear error, never a panic, a hang or a stack overflow.
#![allow(missing_docs)]

use proptest::prelude::*;
use shapebot_model_dsl::{Parsed, parse, parse_bytes, render};
use std::time::{Duration, Instant};

fn codes(parsed: &Parsed) -> Vec<&'static str> {
    parsed.diagnostics.iter().map(|d| d.code.as_str()).collect()
}

/// No model without a reason, no internal error, and the messages can be shown.
fn is_sound(parsed: &Parsed, text: &str) {
    let codes = codes(parsed);
    assert!(parsed.model.is_some() || !codes.is_empty());
    assert!(!codes.contains(&"E0010"), "shapebot failed on {text:?}");
    let shown = render(&parsed.diagnostics, "fuzz.robot", text, true);
    assert!(codes.iter().all(|c| shown.contains(c)));
}

fn check(text: &str) {
    is_sound(&parse("fuzz.robot", text), text);
}

fn cart(statement: &str) -> String {
    format!(
        "robot Cart {{\n    params {{ m: kg = 1; }}\n    position x: m;\n    kinetic 1/2*m*d/dt(x)^2;\n    {statement}\n}}\n"
    )
}

#[test]
fn an_empty_file() {
    assert_eq!(codes(&parse("empty.robot", "")), ["E0003"]);
    assert_eq!(codes(&parse("empty.robot", "\u{feff}// nothing\n")), ["E0003"]);
    check("");
}

#[test]
fn bytes_that_are_no_text() {
    let parsed = parse_bytes("bytes.robot", b"robot Cart {\n  \xff\xfe }");
    assert_eq!(codes(&parsed), ["E0001"]);
    let _ = render(&parsed.diagnostics, "bytes.robot", "robot", false);
}

#[test]
fn a_byte_order_mark_and_windows_lines_do_no_harm() {
    let text = format!("\u{feff}{}", cart("").replace('\n', "\r\n"));
    let parsed = parse("windows.robot", &text);
    assert!(
        parsed.model.is_some(),
        "{}",
        render(&parsed.diagnostics, "windows.robot", &text, false)
    );
}

#[test]
fn ten_megabytes() {
    let started = Instant::now();
    assert_eq!(codes(&parse_bytes("big.robot", &vec![b'('; 10 << 20])), ["E0002"]);
    assert!(started.elapsed() < Duration::from_secs(1));
}

#[test]
fn much_of_anything() {
    let size = 200_000;
    let big = "x ".repeat(2 << 20);
    assert_eq!(codes(&parse("big.robot", &big[..big.len() - 100])), ["E0002"]);
    for piece in [
        "x ",
        "x+",
        "-",
        "x.",
        "{}",
        "x=1;",
        "let x = 1;\n",
        "1.",
        "é",
        "²",
        "|",
        "[]",
        "robot A { let",
        "///\n",
        "a^",
    ] {
        let started = Instant::now();
        let text = piece.repeat(size / piece.len());
        check(&text);
        check(&format!("robot A {{ {} }}", &text[..text.len() / piece.len() / 2 * piece.len()]));
        check(&format!(
            "robot A {{ let y = {}; }}",
            &text[..text.len() / piece.len() / 2 * piece.len()]
        ));
        assert!(
            started.elapsed() < Duration::from_secs(30),
            "{piece:?} took {:?}",
            started.elapsed()
        );
    }
}

#[test]
fn deep_brackets_on_a_small_stack() {
    let run = || {
        for n in [257, 10_000, 100_000] {
            let text = cart(&format!("let y = {}x{};", "(".repeat(n), ")".repeat(n)));
            assert_eq!(codes(&parse("deep.robot", &text)), ["E0005"], "{n}");
            for (open, close) in [("[", "]"), ("{", "}"), ("(", "")] {
                check(&cart(&format!("let y = {}x{};", open.repeat(n), close.repeat(n))));
            }
        }
        let text = cart(&format!("let y = {}x{};", "(".repeat(200), ")".repeat(200)));
        assert!(parse("deep.robot", &text).model.is_some());
    };
    std::thread::Builder::new().stack_size(2 << 20).spawn(run).unwrap().join().unwrap();
}

#[test]
fn long_chains_without_brackets() {
    for piece in ["-", "x^", "x+", "x*", "d/dt", "|", "+-", "x.x.", "2^-"] {
        let text = cart(&format!("let y = {}x;", piece.repeat(50_000)));
        check(&text);
    }
    let sum = cart(&format!("let y = {}x;", "x + ".repeat(1_000)));
    assert!(parse("sum.robot", &sum).model.is_some());
}

#[test]
fn runaway_repetitions_are_stopped() {
    for statement in [
        "repeat i in 1..=1000000 { let a[i] = i*x; }",
        "repeat i in 1..=1000 { repeat j in 1..=1000 { let a = i*x; } }",
        "let y = sum(i in 1..=1000, sum(j in 1..=1000, x));",
        "shape p[1..=1000000]: rad;",
        "let a[0] = x; repeat i in 1..=100 { let a[i] = a[i-1]*a[i-1]; }",
        "let a[0] = 2; repeat i in 1..=100 { let a[i] = a[i-1]*a[i-1]; }",
        "component A(a: m) { b = B(a); } component B(a: m) { c = A(a); } d = A(x);",
        "let y = 9^999^999; let z = 2^(1/0);",
        "shape p[1..=999]: rad; repeat i in 1..=19000 { let a[i] = p; }",
    ] {
        let started = Instant::now();
        check(&cart(statement));
        assert!(started.elapsed() < Duration::from_secs(20), "{statement}");
    }
}

#[test]
fn spans_outside_of_the_text_are_moved_into_it() {
    let mut parsed = parse("span.robot", "robot");
    for diagnostic in &mut parsed.diagnostics {
        diagnostic.span = shapebot_model_dsl::Span { start: 3, end: u32::MAX };
    }
    for text in ["", "é", "robot\n", "\r\n\r\n"] {
        let _ = render(&parsed.diagnostics, "span.robot", text, false);
    }
}

#[test]
fn repetitions_do_not_multiply_long_things() {
    let many = |body: &str| cart(&format!("repeat i in 1..=19000 {{ {body} }}"));
    let sum = |n: usize| format!("x{}", " + x".repeat(n));
    let vectors = |n: usize| format!("[x, 0, 0]{}", " + world*[x, 0, 0]".repeat(n));
    for text in [
        many(&format!("/// {}\nrigid b[i] {{ mass: m, com: [x, 0, 0] }}", "long ".repeat(200_000))),
        many(&format!("let a{}[i] = x;", "b".repeat(1 << 20))),
        many(&format!("let a[i] = {};", sum(20_000))),
        cart(&format!("let a = sum(i in 1..=19000, {});", sum(20_000))),
        cart(&format!("let v = {}; repeat i in 1..=19000 {{ let a[i] = v + v; }}", vectors(900))),
    ] {
        let started = Instant::now();
        check(&text);
        assert!(started.elapsed() < Duration::from_secs(20), "{}", &text[..200]);
    }
}

/// Pieces of models, so that random files get past the first statement.
const PIECES: &[&str] = &[
    "robot",
    "A",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    ";",
    ":",
    ",",
    "=",
    "params",
    "position",
    "shape",
    "let",
    "const",
    "frame",
    "kinetic",
    "potential",
    "lagrangian",
    "rigid",
    "gravity",
    "component",
    "repeat",
    "actuator",
    "output",
    "point",
    "dissipation",
    "friction",
    "require",
    "x",
    "phi",
    "m",
    "kg",
    "rad",
    "world",
    "rot_y",
    "d/dt(",
    "sin(",
    "|",
    "+",
    "-",
    "*",
    "/",
    "^",
    "..",
    "..=",
    ".",
    "1",
    "0",
    "2.5",
    "80deg",
    "in",
    "on",
    "at",
    "along",
    "limit",
    "i",
    "n",
    "sum(i in 1..=3,",
    "mass",
    "com",
    "inertia",
    "<",
    "mirror",
    "shape_accelerated",
    "sphere",
    "/// doc\n",
    "//! doc\n",
    "\n",
    "θ",
    "²",
    "'",
];

/// Mutations of a good model: a token removed, doubled or replaced.
const GOOD: &str = include_str!("inputs/everything.robot");

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        is_sound(&parse_bytes("fuzz.robot", &bytes), &text);
    }

    #[test]
    fn random_text(text in "\\PC{0,200}") {
        check(&text);
    }

    #[test]
    fn random_pieces(picks in proptest::collection::vec(0..PIECES.len(), 0..120), inside in any::<bool>()) {
        let body: Vec<&str> = picks.iter().map(|i| PIECES[*i]).collect();
        let body = body.join(" ");
        check(&if inside { cart(&body) } else { body });
    }

    #[test]
    fn broken_models(at in 0..GOOD.len(), length in 0_usize..12, piece in 0..PIECES.len()) {
        let start = (0..=at).rev().find(|i| GOOD.is_char_boundary(*i)).unwrap_or(0);
        let end = (start + length..GOOD.len()).find(|i| GOOD.is_char_boundary(*i)).unwrap_or(GOOD.len());
        check(&format!("{}{}{}", &GOOD[..start], PIECES[piece], &GOOD[end..]));
    }
}
