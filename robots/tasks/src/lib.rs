//! Task files: what a robot is to do, in TOML with a unit at every quantity.
//!
//! The schema is documented in this crate's `README.md`. Every `*.toml` file of the crate's folder but
//! its manifest is a bundled task; there is no other list of tasks.
//!
//! ```
//! use shapebot_tasks::{Motion, parse};
//!
//! let task = parse(
//!     "walk.toml",
//!     r#"
//!     robot = "ballbot3d"
//!     samples = 501
//!
//!     [motion]
//!     kind = "line"
//!     goal = "2, 0 m"
//!     duration = "5 s"
//!     "#,
//! )?;
//! assert_eq!(task.robot.value, "ballbot3d");
//! assert!(matches!(task.motion.value, Motion::Line { degree: 9, .. }));
//!
//! let error = parse("walk.toml", "robot = \"ballbot3d\"\nsamles = 501\n").unwrap_err();
//! let text = "walk.toml:2:1: `samles`: unknown key; did you mean `samples`?";
//! assert_eq!(error.to_string(), text);
//! # Ok::<(), shapebot_tasks::Error>(())
//! ```
#![forbid(unsafe_code)]

mod error;
mod quantity;
mod read;
mod read_simulation;
mod reader;
pub mod simulation;
mod task;

pub use error::Error;
pub use quantity::{Dimension, Quantities};
pub use read::{MOST_SAMPLES, parse};
pub use read_simulation::GAINS;
pub use task::{
    Constraint, ConstraintLeg, Method, Motion, Objective, Said, Shares, Spare, Task, Waypoint,
};

/// Name (the file's stem) and text of every bundled task, in the order of their names.
pub const TASKS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/tasks.rs"));

/// The text of a bundled task.
#[must_use]
pub fn text(name: &str) -> Option<&'static str> {
    TASKS.iter().find(|(stem, _)| *stem == name).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::{TASKS, parse, text};

    #[test]
    fn bundled_tasks_are_sorted_found_and_sound() {
        assert!(TASKS.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for (name, task) in TASKS {
            assert_eq!(text(name), Some(*task));
            let parsed = parse(&format!("{name}.toml"), task).unwrap_or_else(|e| panic!("{e}"));
            assert!(parsed.title.is_some(), "{name} has no title");
        }
        assert_eq!(text("no such task"), None);
    }
}
