//! What a task says.

use crate::Quantities;
use crate::simulation::{Paper, Simulation};

/// A value, with where it was said for messages about it: `walk.toml:7:8: \`motion.goal\``.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said<T> {
    /// The value.
    pub value: T,
    /// Where it was said; empty if it was not.
    pub place: String,
}

/// How the shape trajectory is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The constant gain of Algorithm 1.
    #[default]
    Gain,
    /// The refined planner.
    Refined,
}

/// What a gain plan makes small.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Objective {
    /// Squared error of the output position.
    #[default]
    Position,
    /// Squared error of the acceleration (Eq. 33).
    Acceleration,
    /// Squared error of the position coordinates.
    Coordinates,
}

/// Which shape sets move least if the shares are chosen automatically.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spare {
    /// Those without an actuator: the smallest lean.
    #[default]
    Unactuated,
    /// Those with an actuator: the smallest movement of the arms.
    Actuated,
}

/// How the shape sets share the work.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Shares {
    /// Left to the planner: the one set without an actuator, else the smallest shape.
    #[default]
    Default,
    /// Chosen from the limits.
    Automatic(Spare),
    /// Contributions by shape set, together 1; sets not named rest.
    Given(Vec<(Said<String>, f64)>),
}

/// A desired motion of the output, beginning at the origin or where the leg before ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// A straight line, timed by a smooth step.
    Line {
        /// Where to.
        goal: Said<Quantities>,
        /// Degree of the smooth step.
        degree: usize,
        /// Seconds.
        duration: f64,
    },
    /// A Bézier curve.
    Bezier {
        /// Its control points.
        points: Vec<Said<Quantities>>,
        /// Seconds.
        duration: f64,
    },
    /// The smoothest curve through points.
    Waypoints(Vec<Waypoint>),
    /// Standing still.
    Rest {
        /// Seconds.
        duration: f64,
    },
    /// Motions in a row.
    Legs(Vec<Motion>),
    /// A straight line in two halves, each with shares of its own.
    TwoPhases {
        /// Where to.
        goal: Said<Quantities>,
        /// Seconds.
        duration: f64,
        /// Shares of the half that accelerates, and of the half that brakes.
        shares: [Said<Shares>; 2],
    },
}

/// A point to pass, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    /// Seconds since the motion's start.
    pub time: f64,
    /// Where.
    pub at: Said<Quantities>,
}

/// A shape set that follows a trajectory of its own, from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// The shape set.
    pub set: Said<String>,
    /// Smooth steps in a row.
    pub legs: Vec<ConstraintLeg>,
}

/// A smooth step of a shape set.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintLeg {
    /// Seconds.
    pub duration: f64,
    /// The set's coordinates at the end; without, it stays where it is.
    pub to: Option<Said<Quantities>>,
}

/// What a robot is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// In words.
    pub title: Option<String>,
    /// A bundled robot, or a model file relative to the task file.
    pub robot: Said<String>,
    /// How it is planned.
    pub method: Method,
    /// What a gain plan makes small.
    pub objective: Said<Objective>,
    /// Number of samples of the motion, both ends included.
    pub samples: Said<usize>,
    /// Seconds of standing before and after the motion, for refined plans.
    pub standing: Said<[f64; 2]>,
    /// How the shape sets share the work.
    pub shares: Said<Shares>,
    /// Largest magnitudes of the coordinates of shape sets.
    pub limits: Vec<(Said<String>, Quantities)>,
    /// Largest magnitudes of the actuators' forces, by actuator or vector of actuators.
    pub force_limits: Vec<(Said<String>, Quantities)>,
    /// The desired motion of the output.
    pub motion: Said<Motion>,
    /// Shape sets that follow trajectories of their own.
    pub constraints: Vec<Constraint>,
    /// What is simulated.
    pub simulation: Simulation,
    /// Whether the task says anything about its simulation.
    pub is_experiment: bool,
    /// What the paper reports.
    pub paper: Paper,
}
