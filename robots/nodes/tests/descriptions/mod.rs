//! The bundled drive descriptions with their models.

use shapebot_drive_build::{DriveDescription, Source};
use shapebot_dynamics::Description;

macro_rules! models {
    ($({ $name:literal, $module:ident, $($rest:tt)* })*) => {
        &[$((&shapebot_generated::$module::DESCRIPTION, $name)),*]
    };
}

const MODELS: &[(&Description, &str)] = shapebot_generated::for_each_system!(models);

/// A bundled description.
pub(crate) fn description(name: &str) -> DriveDescription {
    let source = Source::parse(name, shapebot_drives::text(name).unwrap()).unwrap();
    let model = MODELS.iter().find(|(_, robot)| *robot == source.robot()).unwrap().0;
    source.check(model).unwrap_or_else(|errors| panic!("{errors}"))
}
