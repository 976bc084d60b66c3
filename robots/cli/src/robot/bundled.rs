//! The robots that are compiled in: whatever `shapebot-generated` was generated from.

use super::compiled::{Compiled, Lagrangian};
use super::{Dynamics, ModelText};
use crate::failure::{Failure, Outcome};
use shapebot_dynamics::Parameter;
use shapebot_dynamics::control::ControlDesign;
use shapebot_experiments::{AnySystem, SizedRobot, Supported};

/// Parameters by name, with their values.
type Settings = [(String, f64)];

/// A robot that is compiled in.
pub(crate) struct Bundled {
    name: &'static str,
    /// The compiled code with some parameters set, the model's own values for the rest.
    compiled: fn(&Settings) -> Outcome<Box<dyn Dynamics>>,
    /// The same as a plant.
    system: fn(&Settings) -> Outcome<AnySystem>,
}

/// A model for whose controller no gains were found.
#[derive(Clone, Copy)]
struct NoDesign;

/// Stands where a generated module has no constant of this name, which then is nearer.
#[allow(dead_code, reason = "all modules may have theirs")]
const CONTROL: NoDesign = NoDesign;

/// A controller's design, if there is one.
trait Design {
    fn design(&'static self) -> Option<&'static ControlDesign>;
}

impl Design for NoDesign {
    fn design(&'static self) -> Option<&'static ControlDesign> {
        None
    }
}

impl Design for ControlDesign {
    fn design(&'static self) -> Option<&'static ControlDesign> {
        Some(self)
    }
}

/// The design that a generated module holds.
macro_rules! design {
    ($module:ident) => {{
        #[allow(unused_imports, reason = "some modules have no design")]
        use shapebot_generated::$module::*;
        const DESIGN: &dyn Design = &CONTROL;
        DESIGN.design()
    }};
}

/// The parameters of a generated module with some of them set by name.
macro_rules! parameters {
    ($module:ident, $robot:ident, $set:expr) => {{
        let mut parameters = shapebot_generated::$module::Params::<f64>::model();
        let known = shapebot_generated::$module::DESCRIPTION.parameters;
        check_names(known, $set)?;
        for (name, value) in $set {
            parameters.set(&identifier(name), *value);
        }
        shapebot_generated::$module::$robot::try_new(parameters).map_err(Failure::usage)?
    }};
}

/// All models as Lagrangian systems.
macro_rules! systems {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        &[$(Bundled {
            name: $name,
            compiled: |set| {
                Ok(Box::new(Lagrangian::<$n>(Box::new(parameters!($module, $robot, set)))))
            },
            system: |set| {
                Ok(AnySystem::new::<$n>(Box::new(parameters!($module, $robot, set))))
            },
        }),*]
    };
}

/// Those of them that are shape-accelerated, as robots.
macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        &[$(Bundled {
            name: $name,
            compiled: |set| {
                let system: fn(&Settings) -> _ = |set| {
                    Ok(AnySystem::new::<$n>(Box::new(parameters!($module, $robot, set))))
                };
                let robot: Box<SizedRobot<$n, $nx, $ns>> =
                    Box::new(parameters!($module, $robot, set));
                let (design, set) = (design!($module), set.to_vec());
                Ok(Box::new(Compiled { robot: robot.any(), system, set, design }))
            },
            system: |set| {
                Ok(AnySystem::new::<$n>(Box::new(parameters!($module, $robot, set))))
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

    /// The compiled code with some parameters set.
    pub(crate) fn dynamics(&self, set: &Settings) -> Outcome<Box<dyn Dynamics>> {
        (self.compiled)(set)
    }

    /// The compiled code as a plant.
    pub(super) fn system(&self, set: &Settings) -> Outcome<AnySystem> {
        (self.system)(set)
    }

    /// The model's text.
    pub(crate) fn text(&self) -> Outcome<ModelText> {
        let text = shapebot_models::text(self.name);
        let text = text.ok_or_else(|| Failure::refused(format!("no text of `{}`", self.name)))?;
        Ok(ModelText { name: format!("{}.robot", self.name), bytes: text.as_bytes().to_vec() })
    }
}

/// Refuses unknown names and names that are set twice.
fn check_names(known: &[Parameter], set: &Settings) -> Outcome {
    for (i, (name, _)) in set.iter().enumerate() {
        if !known.iter().any(|p| p.name == identifier(name)) {
            return Err(Failure::unknown("parameter", name, known.iter().map(|p| p.name)));
        }
        if set[..i].iter().any(|(other, _)| identifier(other) == identifier(name)) {
            return Err(Failure::usage(format!("parameter `{name}` is set twice")));
        }
    }
    Ok(())
}

/// The identifier of a parameter that a file may address by a path: `I_b.xx` is `I_b_xx`.
pub(super) fn identifier(name: &str) -> String {
    name.replace('.', "_")
}
