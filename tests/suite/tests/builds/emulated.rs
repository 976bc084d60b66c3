//! A Cortex-M4F computes what the host computes, to the last bit, and with how many instructions.

use shapebot_emulated::{COUNT, Outcome, all};
use shapebot_tests::emulator::{board, firmware, run_within};
use shapebot_tests::environment::say;
use std::time::Duration;

/// Most instructions of an evaluation. A microcontroller of 100 MHz makes 200 000 in a cycle of 500 Hz.
const CEILINGS: [(&str, u32); 4] =
    [("sin_cos", 120), ("motion", 2_000), ("plan_at", 1_400), ("full_step", 12_000)];

/// What the host computes.
fn host() -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    all(COUNT, &mut || 0, &mut |outcome| outcomes.push(outcome));
    outcomes
}

/// A line of the microcontroller: `bits NAME COUNT CHECKSUM MEAN LONGEST`.
struct Line {
    name: String,
    count: u32,
    checksum: u64,
    mean: u32,
    longest: u32,
}

fn parse(line: &str) -> Option<Line> {
    let mut words = line.strip_prefix("bits ")?.split(' ');
    Some(Line {
        name: words.next()?.to_owned(),
        count: words.next()?.parse().ok()?,
        checksum: u64::from_str_radix(words.next()?, 16).ok()?,
        mean: words.next()?.parse().ok()?,
        longest: words.next()?.parse().ok()?,
    })
}

#[test]
fn the_microcontroller_agrees_with_the_host_to_the_bit() {
    let Some(program) = firmware("shapebot-bits", "bits") else { return };
    let output = run_within(&mut board(&program), Duration::from_secs(120));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let lines: Vec<Line> = text.lines().filter_map(parse).collect();
    let host = host();
    assert_eq!(lines.len(), host.len(), "{text}");
    for (line, host) in lines.iter().zip(&host) {
        assert_eq!((line.name.as_str(), line.count), (host.name, host.count));
        assert_eq!(line.checksum, host.checksum, "{}: other bits than on the host", line.name);
        say(&format!(
            "{}: {} evaluations equal to the bit, {} instructions, at most {}",
            line.name, line.count, line.mean, line.longest
        ));
        let ceiling = CEILINGS.iter().find(|(name, _)| *name == line.name);
        let (_, ceiling) = ceiling.unwrap_or_else(|| panic!("no ceiling for {}", line.name));
        assert!(line.longest <= *ceiling, "{}: more than {ceiling} instructions", line.name);
    }
}

#[test]
fn every_step_computes_something_of_its_own() {
    let (outcomes, fewer) = (host(), {
        let mut outcomes = Vec::new();
        all(COUNT - 1, &mut || 0, &mut |outcome| outcomes.push(outcome));
        outcomes
    });
    assert_eq!(outcomes.len(), CEILINGS.len());
    for (outcome, fewer) in outcomes.iter().zip(&fewer) {
        assert_eq!(outcome.count, COUNT);
        // One evaluation of a thousand shows.
        assert_ne!(outcome.checksum, fewer.checksum, "{}", outcome.name);
    }
}
