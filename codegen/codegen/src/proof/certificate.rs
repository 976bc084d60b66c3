//! What a proof leaves behind: plain data, for documentation, tool and generator.

use shapebot_model_dsl::{Code, Diagnostic};

/// What was proved about a model, and by what means.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// Type name of the robot.
    pub robot: String,
    /// Whether the robot is one the planner can plan for.
    pub class: Class,
    /// Coordinates as the file addresses them: q = [q_x, q_s].
    pub coordinates: Vec<String>,
    /// n_x, the number of position variables.
    pub position_count: usize,
    /// Coordinates on which exactly one actuator works, with its name, in the order of the
    /// coordinates. Rows go by role, wherever they stand.
    pub actuated: Vec<(usize, String)>,
    /// Coordinates whose equations no actuator enters.
    pub unactuated: Vec<usize>,
    /// The conditions (a) to (f).
    pub conditions: Vec<Condition>,
    /// Membership of the strict class of Eqs. 3-5.
    pub strict: Strict,
    /// What each position variable offers to a controller.
    pub positions: Vec<PositionFacts>,
    /// The map Γ near the origin; there only if conditions (a) to (d) hold.
    pub shape_map: Option<ShapeMap>,
    /// Integrability of each unactuated equation.
    pub integrability: Integrability,
    /// Poles and zeros at the origin; there only if the origin is a regular point.
    pub linearisation: Option<Linearisation>,
    /// The mass matrix.
    pub mass: MassFacts,
    /// Mirror symmetries that were required, and hold.
    pub mirrors: Vec<Mirror>,
    /// What is probably not meant.
    pub warnings: Vec<Diagnostic>,
}

impl Certificate {
    /// n, the number of coordinates.
    #[must_use]
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// Never: a model has coordinates.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// n_s, the number of shape variables.
    #[must_use]
    pub fn shape_count(&self) -> usize {
        self.len() - self.position_count
    }

    /// k with n_s = k n_x, if there is one.
    #[must_use]
    pub fn shape_sets(&self) -> Option<usize> {
        let (n_x, n_s) = (self.position_count, self.shape_count());
        (n_x > 0 && n_s > 0 && n_s.is_multiple_of(n_x)).then(|| n_s / n_x)
    }

    /// Whether the functions of a shape-accelerated system may be emitted.
    #[must_use]
    pub fn is_shape_accelerated(&self) -> bool {
        self.class == Class::ShapeAccelerated
    }
}

/// Whether the planner's conditions hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Class {
    /// Conditions (a) to (f) hold.
    ShapeAccelerated,
    /// At least one does not.
    NotShapeAccelerated {
        /// Why not.
        reasons: Vec<Reason>,
    },
}

/// Why a model is not of the class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// Code of the diagnostic that says the same.
    pub code: Code,
    /// Letter of the condition that fails.
    pub condition: char,
    /// What is wrong.
    pub text: String,
    /// Line of the model file, from 1.
    pub line: usize,
    /// What would mend it.
    pub help: Option<String>,
}

/// One of the conditions (a) to (f).
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Its letter.
    pub letter: char,
    /// What is claimed.
    pub statement: String,
    /// How it came out.
    pub evidence: Evidence,
}

/// How a claim came out, and how far the answer reaches.
#[derive(Clone, Debug, PartialEq)]
pub enum Evidence {
    /// Decided exactly, for all values of parameters and coordinates.
    Exact,
    /// Enclosed in intervals at the model's parameter values.
    AtModelValues,
    /// Does not hold.
    Fails,
    /// Was not looked at, because something before it fails.
    NotExamined,
}

impl Evidence {
    /// As it is printed.
    #[must_use]
    pub const fn as_str(&self) -> &'static str {
        match self {
            Self::Exact => "proved for all parameter values",
            Self::AtModelValues => "proved at the model's parameter values",
            Self::Fails => "fails",
            Self::NotExamined => "not examined",
        }
    }
}

/// A claim over declared ranges.
#[derive(Clone, Debug, PartialEq)]
pub enum RangeClaim {
    /// Proved by interval subdivision; so many boxes were needed.
    Proved {
        /// Sub-boxes.
        boxes: usize,
    },
    /// The budget of the subdivision ran out; it holds at so many sample points, which proves nothing.
    SampledOnly {
        /// Sample points.
        samples: usize,
    },
    /// Neither proved nor refuted; nearest to failing at this point.
    Undecided {
        /// Values of coordinates and parameters.
        at: Vec<(String, f64)>,
    },
    /// Does not hold at this point.
    Fails {
        /// Values of coordinates and parameters.
        at: Vec<(String, f64)>,
    },
    /// Cannot be asked: these coordinates have no declared range.
    NoRange {
        /// Their names.
        coordinates: Vec<String>,
    },
    /// Nothing it depends on has a range of its own.
    NothingVaries,
}

/// The strict class of Eqs. 3-5.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strict {
    /// M, C and G of all rows are free of q_x and q̇_x, and G_x = 0.
    pub holds: bool,
    /// What departs from it: `M depends on x`, `gravity acts on x`.
    pub departures: Vec<String>,
}

/// What a position variable offers to a controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PositionFacts {
    /// As the file addresses it.
    pub coordinate: String,
    /// An actuator works on it.
    pub actuated: bool,
    /// ∂M/∂q_x = 0 and ∂V/∂q_x = 0.
    pub cyclic: bool,
    /// Its momentum changes by its actuator alone, dp/dt = τ + disturbance: an observer of
    /// disturbances needs no accelerations.
    pub momentum_observer: bool,
}

/// The map Γ (Eq. 9), Γ′ (Eq. 15) and K⁰_qs (Eq. 16).
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeMap {
    /// det M_{u,x}(0) at the model's parameter values (Theorem 1, Eq. 8).
    pub determinant: f64,
    /// M_{u,x} invertible over the declared ranges of the coordinates, at the model's parameter values.
    pub over_coordinates: RangeClaim,
    /// M_{u,x} invertible over the declared ranges of coordinates and parameters together.
    pub over_parameters: RangeClaim,
    /// K⁰_qs (Eq. 16) at the model's parameter values, n_x × n_s.
    pub gain: Vec<Vec<f64>>,
    /// Block K⁰_j of each shape set.
    pub sets: Vec<SetGain>,
    /// Theorem 2: Γ′ and K⁰_qs are invertible near the origin.
    pub invertible: bool,
}

/// The block of K⁰_qs that belongs to a shape set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetGain {
    /// Name of the set.
    pub name: String,
    /// Number of its coordinates.
    pub size: usize,
    /// Whether the block is square and nonsingular, so that this set alone can make every acceleration.
    pub nonsingular: bool,
}

/// Integrability of the dynamic constraint by the condition of Oriolo and Nakamura (1991).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Integrability {
    /// Unactuated equations, in order.
    pub rows: Vec<RowIntegrability>,
    /// If every row is partially integrable: whether the distribution M_u(q) q̇ = 0 is involutive, that
    /// is, whether the constraint is one on the configuration.
    pub involutive: Option<bool>,
}

impl Integrability {
    /// No unactuated equation is even partially integrable.
    #[must_use]
    pub fn is_nonholonomic(&self) -> bool {
        !self.rows.is_empty() && self.rows.iter().all(|row| !row.partially_integrable())
    }
}

/// One unactuated equation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RowIntegrability {
    /// Its coordinate.
    pub coordinate: String,
    /// Its gravity term is constant.
    pub gravity_constant: bool,
    /// The mass matrix does not depend on its coordinate.
    pub inertia_free: bool,
}

impl RowIntegrability {
    /// Both conditions: the equation is the time derivative of a momentum (plus a constant).
    #[must_use]
    pub const fn partially_integrable(&self) -> bool {
        self.gravity_constant && self.inertia_free
    }
}

/// A root in the complex plane, 1/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

/// Poles and zeros at the origin and the model's parameter values, without friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// Poles of M q̈ + (∂G/∂q) q = 0: no torque beside what holds the origin.
    pub poles: Vec<Root>,
    /// The same with the position variables locked.
    pub locked_poles: Vec<Root>,
    /// τ² in ẍ = u − τ² ü, q_s = K⁰ u with equal weights on the shape variables named in
    /// `through`, n_x × n_x, s².
    pub time_constants: Vec<Vec<f64>>,
    /// Shape variables that carry the motion in `time_constants`.
    pub through: Vec<String>,
    /// Zeros of the position's response to u: the roots of det(1 − τ² s²).
    pub zeros: Vec<Root>,
    /// The same τ² for the task-space output, in coordinates in which it moves with q_x:
    /// τ² − (∂h/∂q_x)⁻¹ (∂h/∂q_s) K⁰_qx, s².
    pub output_time_constants: Vec<Vec<f64>>,
    /// Zeros of the output's response to u.
    pub output_zeros: Vec<Root>,
}

/// The mass matrix is symmetric positive definite.
#[derive(Clone, Debug, PartialEq)]
pub struct MassFacts {
    /// Smallest and largest eigenvalue at the origin and the model's parameter values.
    pub eigenvalues: (f64, f64),
    /// Sample points of the declared ranges at which it is positive definite as well.
    pub samples: usize,
}

/// A mirror symmetry of the dynamics in the x-z plane.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mirror {
    /// The two instances that change places.
    pub instances: (String, String),
    /// For each coordinate the one it is taken to, and whether its sign flips.
    pub images: Vec<(usize, bool)>,
}
