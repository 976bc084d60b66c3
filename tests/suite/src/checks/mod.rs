//! What holds for every robot, as functions over the traits: each takes an implementation (compiled,
//! baked, interpreted, handwritten) and fails with the robot, the state and the entry.

mod derivatives;
mod energy;
mod identities;
mod kinematics;
mod origin;
mod precision;
mod reference_states;
mod shape;

pub use derivatives::{lagrangian_jacobians, shape_jacobians};
pub use energy::energy_is_conserved;
pub use identities::{coriolis_matrix, dynamics, energies, inputs, mass_matrix};
pub use kinematics::{frames, points};
pub use origin::origin;
pub use precision::{agrees, single_precision};
pub use reference_states::{reference_states, shape_gain};
pub use shape::{motion_of_the_shape, shape_map};

/// Expected agreement of double-precision code with exact values, of the largest entry.
pub const EXACT: f64 = 1e-12;

/// Number of states per robot.
pub const STATES: usize = 12;
