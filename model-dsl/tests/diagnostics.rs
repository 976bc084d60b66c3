//! Every code has a page, every page's examples do what they say, and every message is pinned.
#![allow(missing_docs)]

use shapebot_model_dsl::{codes, explain, parse, render};
use std::path::Path;

/// The first `robot` fence under a heading.
fn example<'a>(page: &'a str, heading: &str) -> Option<&'a str> {
    let section = page.split(&format!("\n## {heading}\n")).nth(1)?;
    let section = section.split("\n## ").next()?;
    let body = section.split("```robot\n").nth(1)?;
    body.split("\n```").next()
}

/// Codes whose offence is not text that a page can show; tested in `robustness.rs`.
const WITHOUT_EXAMPLE: &[&str] = &["E0001", "E0002", "E0005", "E0010"];

#[test]
fn every_code_has_a_page_and_every_page_a_code() {
    for (code, title) in codes() {
        let page = explain(code.as_str()).unwrap();
        assert!(page.starts_with(&format!("# {code}: {title}\n")), "{code}: heading");
        assert!(page.contains("\n## Why\n"), "{code}: no reason is given");
        assert_eq!(explain(&code.as_str().to_lowercase()), Some(page));
    }
    assert_eq!(explain("E9999"), None);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("diagnostics");
    for file in std::fs::read_dir(folder).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        let code = name.strip_suffix(".md").unwrap();
        assert!(codes().any(|(c, _)| c.as_str() == code), "{name} belongs to no code");
    }
}

#[test]
fn wrong_examples_are_refused_and_right_ones_are_clean() {
    for (code, _) in codes().filter(|(c, _)| !c.as_str().starts_with('P')) {
        let page = explain(code.as_str()).unwrap();
        let (Some(wrong), Some(right)) = (example(page, "Wrong"), example(page, "Right")) else {
            assert!(WITHOUT_EXAMPLE.contains(&code.as_str()), "{code} has no examples");
            continue;
        };
        let found = parse("wrong.robot", wrong).diagnostics;
        let text = render(&found, "wrong.robot", wrong, false);
        assert!(
            found.iter().any(|d| d.code == code),
            "{code} is not produced by its example:\n{text}"
        );
        let found = parse("right.robot", right).diagnostics;
        assert!(
            found.is_empty(),
            "{code}: the right example is not clean:\n{}",
            render(&found, "right.robot", right, false)
        );
    }
}

#[test]
fn messages_of_the_pages_examples() {
    for (code, _) in codes() {
        let Some(wrong) = example(explain(code.as_str()).unwrap(), "Wrong") else { continue };
        let found = parse("wrong.robot", wrong).diagnostics;
        insta::assert_snapshot!(code.as_str(), render(&found, "wrong.robot", wrong, false));
    }
}

/// A file with many mistakes: all of them come in one go, in the order of the text.
#[test]
fn all_errors_of_a_file_at_once() {
    let text = include_str!("inputs/many_errors.robot");
    let found = parse("many_errors.robot", text).diagnostics;
    insta::assert_snapshot!("many_errors", render(&found, "many_errors.robot", text, false));
    assert!(found.windows(2).all(|w| w[0].span.start <= w[1].span.start));
    assert_eq!(found, parse("many_errors.robot", text).diagnostics);
}
