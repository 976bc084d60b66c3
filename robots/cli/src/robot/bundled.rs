//! The robots that are compiled in: whatever `shapebot-generated` was generated from.

use super::compiled::{Compiled, Lagrangian};
use super::{Dynamics, ModelText, interpreted};
use crate::failure::{Failure, Outcome};

/// A robot that is compiled in.
pub(crate) struct Bundled {
    name: &'static str,
    /// The compiled code with the model's own parameters.
    model: fn() -> Box<dyn Dynamics>,
}

/// All models as Lagrangian systems.
macro_rules! systems {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        &[$(Bundled {
            name: $name,
            model: || Box::new(Lagrangian::<_, $n>(shapebot_generated::$module::$robot::<f64>::from_model())),
        }),*]
    };
}

/// Those of them that are shape-accelerated, as robots.
macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        &[$(Bundled {
            name: $name,
            model: || {
                Box::new(Compiled::<_, $n, $nx, $ns>(shapebot_generated::$module::$robot::<f64>::from_model()))
            },
        }),*]
    };
}

const SYSTEMS: &[Bundled] = shapebot_generated::for_each_system!(systems);
const ROBOTS: &[Bundled] = shapebot_generated::for_each_robot!(robots);

/// Every bundled model once, by name: as a robot if it is one.
pub(crate) fn bundled() -> impl Iterator<Item = &'static Bundled> {
    SYSTEMS
        .iter()
        .map(|system| ROBOTS.iter().find(|robot| robot.name == system.name).unwrap_or(system))
}

impl Bundled {
    pub(crate) const fn name(&self) -> &'static str {
        self.name
    }

    /// The compiled code. Its parameters are fields, which have no names at run time: with some of them
    /// set, the same model goes through the interpreter.
    pub(crate) fn dynamics(&self, set: &[(String, f64)]) -> Outcome<Box<dyn Dynamics>> {
        if set.is_empty() {
            return Ok((self.model)());
        }
        interpreted::open(&self.text()?, set)
    }

    /// The model's text.
    pub(crate) fn text(&self) -> Outcome<ModelText> {
        let text = shapebot_models::text(self.name);
        let text = text.ok_or_else(|| Failure::refused(format!("no text of `{}`", self.name)))?;
        Ok(ModelText { name: format!("{}.robot", self.name), bytes: text.as_bytes().to_vec() })
    }
}
