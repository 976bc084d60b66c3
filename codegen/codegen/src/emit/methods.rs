//! The methods of the traits: which quantity each computes from which inputs.

use super::names::{SymbolNames, identifier};
use crate::derive::Quantity;
use shapebot_model_dsl::model::Model;
use shapebot_symbolic::Symbol;

/// A vector argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Input {
    /// q
    Q,
    /// q̇
    Qd,
    /// q̈
    Qdd,
    /// f
    Force,
    /// q_x
    Qx,
    /// q_s
    Qs,
    /// q̇_s
    Qsd,
    /// q̈_s
    Qsdd,
}

/// A method that computes one quantity.
pub(super) struct Method {
    pub(super) name: &'static str,
    pub(super) quantity: Quantity,
    pub(super) inputs: &'static [Input],
    pub(super) docs: &'static str,
}

/// A method that picks one of several quantities by an index.
pub(super) struct Indexed {
    pub(super) name: &'static str,
    pub(super) index: &'static str,
    pub(super) quantity: fn(usize) -> Quantity,
    /// What comes back when the index is out of range.
    pub(super) otherwise: &'static str,
    pub(super) docs: &'static str,
}

const fn method(
    name: &'static str,
    quantity: Quantity,
    inputs: &'static [Input],
    docs: &'static str,
) -> Method {
    Method { name, quantity, inputs, docs }
}

use Input::{Force, Q, Qd, Qdd, Qs, Qsd, Qsdd, Qx};

/// `LagrangianSystem`, methods without an index.
pub(super) const LAGRANGIAN: &[Method] = &[
    method("mass_matrix", Quantity::MassMatrix, &[Q], "Mass matrix M(q), Eq. 2."),
    method(
        "coriolis_matrix",
        Quantity::CoriolisMatrix,
        &[Q, Qd],
        "Coriolis matrix C(q, q̇) of the Christoffel symbols, Eq. 2.",
    ),
    method(
        "coriolis_vector",
        Quantity::CoriolisVector,
        &[Q, Qd],
        "Coriolis and centrifugal vector C(q, q̇) q̇, Eq. 2.",
    ),
    method("gravity", Quantity::Gravity, &[Q], "Gravity vector G(q), Eq. 2."),
    method("kinetic_energy", Quantity::KineticEnergy, &[Q, Qd], "Kinetic energy, joules."),
    method("potential_energy", Quantity::PotentialEnergy, &[Q], "Potential energy, joules."),
    method(
        "mass_matrix_jacobian",
        Quantity::MassMatrixJacobian,
        &[Q],
        "∂M/∂q, one matrix per coordinate.",
    ),
    method("coriolis_vector_jacobian_q", Quantity::CoriolisVectorJacobianQ, &[Q, Qd], "∂(C q̇)/∂q."),
    method(
        "coriolis_vector_jacobian_qd",
        Quantity::CoriolisVectorJacobianQd,
        &[Q, Qd],
        "∂(C q̇)/∂q̇.",
    ),
    method("gravity_jacobian", Quantity::GravityJacobian, &[Q], "∂G/∂q."),
    method(
        "inverse_dynamics",
        Quantity::InverseDynamics,
        &[Q, Qd, Qdd],
        "Generalised forces M q̈ + C q̇ + G that produce q̈, Eq. 2.",
    ),
    method(
        "forward_dynamics",
        Quantity::ForwardDynamics,
        &[Q, Qd, Force],
        "Accelerations under generalised forces, Eq. 2 solved for q̈.",
    ),
    method("motion", Quantity::Motion, &[Q, Qd], "M, C q̇ and G in one pass."),
    method(
        "dissipative_force",
        Quantity::DissipativeForce,
        &[Q, Qd],
        "Generalised forces of the declared dissipation, −∂D/∂q̇.",
    ),
    method(
        "center_of_mass",
        Quantity::CenterOfMass,
        &[Q],
        "Centre of mass of all rigid bodies, metres.",
    ),
];

/// `LagrangianSystem`, methods with an index.
pub(super) const INDEXED: &[Indexed] = &[
    Indexed {
        name: "input_column",
        index: "actuator",
        quantity: Quantity::InputColumn,
        otherwise: "zeros",
        docs: "Column of the input matrix B(q) for one actuator.",
    },
    Indexed {
        name: "frame_rotation",
        index: "frame",
        quantity: Quantity::FrameRotation,
        otherwise: "identity",
        docs: "Axes of a frame as columns, in world axes.",
    },
    Indexed {
        name: "point_position",
        index: "point",
        quantity: Quantity::PointPosition,
        otherwise: "zeros",
        docs: "World position of a point, metres.",
    },
    Indexed {
        name: "point_jacobian",
        index: "point",
        quantity: Quantity::PointJacobian,
        otherwise: "zeros",
        docs: "∂(position of a point)/∂q.",
    },
];

/// `ShapeAccelerated`.
pub(super) const SHAPE: &[Method] = &[
    method("gamma", Quantity::Gamma, &[Qs, Qsd, Qsdd], "Γ(q_s, q̇_s, q̈_s), Eq. 9."),
    method("gamma_prime", Quantity::GammaPrime, &[Qs], "Γ′(q_s), Eq. 15."),
    method("gamma_prime_jacobian", Quantity::GammaPrimeJacobian, &[Qs], "∂Γ′/∂q_s."),
    method("shape_gain", Quantity::ShapeGain, &[], "K⁰_qs, Eq. 16: ∂Γ′/∂q_s at the origin."),
    method(
        "response",
        Quantity::Response,
        &[Qs, Qsd, Qsdd],
        "Γ and its Jacobians in one pass, Eq. 9.",
    ),
    method("output", Quantity::Output, &[Qx, Qs], "Task-space output h(q_x, q_s)."),
    method("output_jacobian_position", Quantity::OutputJacobianPosition, &[], "∂h/∂q_x, constant."),
    method("output_jacobian_shape", Quantity::OutputJacobianShape, &[Qx, Qs], "∂h/∂q_s."),
];

impl Input {
    /// Name of the argument.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Q => "q",
            Qd => "qd",
            Qdd => "qdd",
            Force => "force",
            Qx => "qx",
            Qs => "qs",
            Qsd => "qsd",
            Qsdd => "qsdd",
        }
    }

    /// The symbols of its entries, of `count` coordinates of which `positions` are q_x.
    pub(super) fn symbols(self, count: usize, positions: usize) -> Vec<Symbol> {
        let range = match self {
            Q | Qd | Qdd | Force => 0..count,
            Qx => 0..positions,
            Qs | Qsd | Qsdd => positions..count,
        };
        let symbol = |i: usize| {
            let i = u32::try_from(i).unwrap_or(u32::MAX);
            match self {
                Q | Qx | Qs => Symbol::Coordinate(i),
                Qd | Qsd => Symbol::Rate(i),
                Qdd | Qsdd => Symbol::Acceleration(i),
                Force => Symbol::Force(i),
            }
        };
        range.map(symbol).collect()
    }
}

/// Stem of names in the schedule of a quantity.
pub(super) fn stem(quantity: Quantity) -> String {
    let plain = LAGRANGIAN.iter().chain(SHAPE).find(|method| method.quantity == quantity);
    let name = match (plain, quantity) {
        (Some(method), _) => method.name,
        (None, Quantity::InputColumn(_)) => "input",
        (None, Quantity::FrameRotation(_)) => "rotation",
        (None, _) => "position",
    };
    name.to_owned()
}

/// Names of the entries of a block: `mass_phi_x_phi_y`, `gamma_theta_x_by_phi_y_dd`.
pub(super) struct EntryNames<'a> {
    pub(super) model: &'a Model,
    pub(super) symbols: &'a SymbolNames,
}

impl EntryNames<'_> {
    /// The name of the entry at `index` of a block of this quantity.
    pub(super) fn entry(&self, quantity: Quantity, block: &str, index: &[usize]) -> String {
        let positions = self.model.position_count();
        let q = |i: usize| self.symbols.coordinates.get(i).map_or("q", String::as_str);
        let s = |i: usize| q(positions + i);
        let axis = |i: usize| ["x", "y", "z"].get(i).copied().unwrap_or("w");
        let out = |i: usize| {
            let declared = self.model.output.as_ref().and_then(|output| output.names.get(i));
            declared.map_or_else(|| q(i).to_owned(), |name| identifier(name))
        };
        let at = |k: usize| index.get(k).copied().unwrap_or(0);
        let (i, j) = (at(0), at(1));
        match (quantity, block) {
            (Quantity::MassMatrix, _) | (Quantity::Motion, "mass_matrix") => {
                format!("mass_{}_{}", q(i), q(j))
            }
            (Quantity::CoriolisMatrix, _) => format!("coriolis_{}_{}", q(i), q(j)),
            (Quantity::CoriolisVector, _) | (Quantity::Motion, "coriolis_vector") => {
                format!("coriolis_{}", q(i))
            }
            (Quantity::Gravity | Quantity::Motion, _) => format!("gravity_{}", q(i)),
            (Quantity::MassMatrixJacobian, _) => format!("mass_{}_{}_by_{}", q(j), q(at(2)), q(i)),
            (Quantity::CoriolisVectorJacobianQ, _) => format!("coriolis_{}_by_{}", q(i), q(j)),
            (Quantity::CoriolisVectorJacobianQd, _) => format!("coriolis_{}_by_{}_d", q(i), q(j)),
            (Quantity::GravityJacobian, _) => format!("gravity_{}_by_{}", q(i), q(j)),
            (Quantity::InverseDynamics, _) => format!("force_{}", q(i)),
            (Quantity::ForwardDynamics, _) => format!("{}_dd", q(i)),
            (Quantity::DissipativeForce, _) => format!("dissipation_{}", q(i)),
            (Quantity::InputColumn(_), _) => format!("input_{}", q(i)),
            (Quantity::CenterOfMass, _) => format!("center_of_mass_{}", axis(i)),
            (Quantity::FrameRotation(_), _) => format!("{}_axis_{}", axis(j), axis(i)),
            (Quantity::PointPosition(_), _) => format!("position_{}", axis(i)),
            (Quantity::PointJacobian(_), _) => format!("position_{}_by_{}", axis(i), q(j)),
            (Quantity::Output, _) => format!("output_{}", out(i)),
            (Quantity::OutputJacobianPosition, _) => format!("output_{}_by_{}", out(i), q(j)),
            (Quantity::OutputJacobianShape, _) => format!("output_{}_by_{}", out(i), s(j)),
            (Quantity::GammaPrime, _) => format!("gamma_prime_{}", q(i)),
            (Quantity::GammaPrimeJacobian, _) => format!("gamma_prime_{}_by_{}", q(i), s(j)),
            (Quantity::ShapeGain, _) => format!("gain_{}_by_{}", q(i), s(j)),
            (Quantity::Response, "d_qs") => format!("gamma_{}_by_{}", q(i), s(j)),
            (Quantity::Response, "d_qsd") => format!("gamma_{}_by_{}_d", q(i), s(j)),
            (Quantity::Response, "d_qsdd") => format!("gamma_{}_by_{}_dd", q(i), s(j)),
            (Quantity::Gamma | Quantity::Response, _) => format!("gamma_{}", q(i)),
            (Quantity::KineticEnergy | Quantity::PotentialEnergy, _) => stem(quantity),
        }
    }
}
