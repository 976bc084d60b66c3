//! The examples of the language reference are read.
#![allow(missing_docs)]

use shapebot_model_dsl::{parse, render};

#[test]
fn examples_of_the_reference_are_clean() {
    let page = include_str!("../LANGUAGE.md");
    let examples: Vec<&str> =
        page.split("```robot\n").skip(1).filter_map(|t| t.split("\n```").next()).collect();
    assert!(examples.len() >= 5);
    for text in examples {
        let parsed = parse("example.robot", text);
        assert!(
            parsed.diagnostics.is_empty(),
            "{}",
            render(&parsed.diagnostics, "example.robot", text, false)
        );
    }
}
