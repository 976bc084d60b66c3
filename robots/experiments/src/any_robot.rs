//! A robot whose sizes are known when the program runs.

use crate::subject::{Plants, SizedRobot, Subject};
use crate::trials::{Runs, Trials};
use crate::{Error, Experiment};
use shapebot_dynamics::Description;
use shapebot_dynamics::control::ControlDesign;
use shapebot_planner::value::RobotId;
use shapebot_planning::{PlannedMotion, Refusal};
use shapebot_tasks::Task;

/// A robot of any supported size: one to three position variables, each with one to four shape
/// variables. Planning and simulation are compiled here, once for each size.
#[expect(missing_docs, reason = "a variant's name says its position and shape variables")]
pub enum AnyRobot {
    P1S1(Box<SizedRobot<2, 1, 1>>),
    P1S2(Box<SizedRobot<3, 1, 2>>),
    P1S3(Box<SizedRobot<4, 1, 3>>),
    P1S4(Box<SizedRobot<5, 1, 4>>),
    P2S2(Box<SizedRobot<4, 2, 2>>),
    P2S4(Box<SizedRobot<6, 2, 4>>),
    P2S6(Box<SizedRobot<8, 2, 6>>),
    P2S8(Box<SizedRobot<10, 2, 8>>),
    P3S3(Box<SizedRobot<6, 3, 3>>),
    P3S6(Box<SizedRobot<9, 3, 6>>),
    P3S9(Box<SizedRobot<12, 3, 9>>),
    P3S12(Box<SizedRobot<15, 3, 12>>),
}

/// Runs an expression with the robot of an [`AnyRobot`] reference: the name between the bars is a
/// reference to the [`SizedRobot`](crate::SizedRobot) of its sizes.
#[macro_export]
macro_rules! with_sized {
    ($any:expr, |$robot:ident| $body:expr) => {
        $crate::with_sized!(@arms $any, |$robot| $body,
            P1S1, P1S2, P1S3, P1S4, P2S2, P2S4, P2S6, P2S8, P3S3, P3S6, P3S9, P3S12)
    };
    (@arms $any:expr, |$robot:ident| $body:expr, $($variant:ident),*) => {
        match $any {
            $($crate::AnyRobot::$variant(boxed) => { let $robot = &**boxed; $body })*
        }
    };
}

/// A robot of known sizes as one of any size.
#[diagnostic::on_unimplemented(
    message = "no robot of these numbers of coordinates is supported",
    note = "supported are 1 to 3 position variables, each with 1 to 4 shape variables"
)]
pub trait Supported {
    /// Hides the sizes.
    fn any(self: Box<Self>) -> AnyRobot;
}

macro_rules! supported {
    ($($variant:ident: $n:literal, $nx:literal, $ns:literal;)*) => {
        $(impl Supported for SizedRobot<$n, $nx, $ns> {
            fn any(self: Box<Self>) -> AnyRobot {
                AnyRobot::$variant(self)
            }
        })*
    };
}

supported! {
    P1S1: 2, 1, 1;
    P1S2: 3, 1, 2;
    P1S3: 4, 1, 3;
    P1S4: 5, 1, 4;
    P2S2: 4, 2, 2;
    P2S4: 6, 2, 4;
    P2S6: 8, 2, 6;
    P2S8: 10, 2, 8;
    P3S3: 6, 3, 3;
    P3S6: 9, 3, 6;
    P3S9: 12, 3, 9;
    P3S12: 15, 3, 12;
}

/// A planned task: what is to be followed.
#[derive(Clone, Copy)]
pub struct Planned<'a> {
    /// The task.
    pub task: &'a Task,
    /// Its plan.
    pub motion: &'a PlannedMotion,
    /// The robot that the plan has to be for.
    pub id: &'a RobotId<'a>,
}

/// What drives a robot, and what takes its place.
#[derive(Clone, Copy)]
pub struct Driven<'a> {
    /// The controller's gains.
    pub design: &'a ControlDesign,
    /// Plants.
    pub plants: &'a dyn Plants,
}

impl AnyRobot {
    /// Names, units, ranges, actuators and shape sets.
    #[must_use]
    pub fn description(&self) -> &Description {
        with_sized!(self, |robot| robot.description())
    }

    /// Plans a task; `id` is what the plan's files say about the robot.
    ///
    /// # Errors
    ///
    /// As [`shapebot_planning::plan`].
    pub fn plan(&self, task: &Task, id: &RobotId<'_>) -> Result<PlannedMotion, Refusal> {
        with_sized!(self, |robot| shapebot_planning::plan(&robot, task, id))
    }

    /// Lets a controller follow a plan, as its task says.
    ///
    /// # Errors
    ///
    /// As [`crate::run`].
    pub fn simulate(&self, driven: Driven<'_>, planned: Planned<'_>) -> Result<Experiment, Error> {
        let (Driven { design, plants }, Planned { task, motion, id }) = (driven, planned);
        with_sized!(self, |model| crate::run(Subject { model, design, plants }, task, motion, id))
    }

    /// Random runs of a planned task of a name: seed and number of runs.
    ///
    /// # Errors
    ///
    /// As [`crate::run`].
    pub fn trials<'a>(
        &'a self,
        driven: Driven<'a>,
        (name, planned): (&str, Planned<'a>),
        runs: [u64; 2],
    ) -> Result<Box<dyn Runs + 'a>, Error> {
        let (Driven { design, plants }, Planned { task, motion, id }) = (driven, planned);
        with_sized!(self, |model| {
            let subject = Subject { model, design, plants };
            Ok(Box::new(Trials::new(subject, (name, task), motion, id, runs)?))
        })
    }

    /// Poles at the origin without control, 1/s: real and imaginary parts.
    ///
    /// # Errors
    ///
    /// A mass matrix without an inverse.
    pub fn poles(&self) -> Result<Vec<[f64; 2]>, Error> {
        let linear = with_sized!(self, |robot| shapebot_sim::lqr::linearise(robot))?;
        let poles = linear.state.complex_eigenvalues();
        Ok(poles.iter().map(|pole| [pole.re, pole.im]).collect())
    }
}
