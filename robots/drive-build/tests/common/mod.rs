//! Bundled descriptions with their models.
#![allow(dead_code, reason = "each test uses a part")]

use shapebot_drive_build::{DriveDescription, Errors, Source};
use shapebot_dynamics::Description;

macro_rules! models {
    ($({ $name:literal, $module:ident, $($rest:tt)* })*) => {
        &[$((&shapebot_generated::$module::DESCRIPTION, $name)),*]
    };
}

const MODELS: &[(&Description, &str)] = shapebot_generated::for_each_system!(models);

/// The model of a bundled robot.
pub(crate) fn model(name: &str) -> &'static Description {
    let found = MODELS.iter().find(|(_, other)| *other == name);
    found.unwrap_or_else(|| panic!("no model `{name}`")).0
}

/// Names of the bundled descriptions.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    shapebot_drives::DRIVES.iter().map(|(name, _)| *name)
}

/// Checks a text as a description.
pub(crate) fn check(text: &str) -> Result<DriveDescription, Errors> {
    let source = Source::parse("d.toml", text)?;
    source.check(model(source.robot()))
}

/// A bundled description.
pub(crate) fn description(name: &str) -> Result<DriveDescription, Errors> {
    let text = shapebot_drives::text(name).unwrap_or_else(|| panic!("no drive `{name}`"));
    let source = Source::parse(&format!("{name}.toml"), text)?;
    source.check(model(source.robot()))
}
