//! The three traits: Lagrangian system, shape-accelerated system, and the robot that is both.

use crate::{Description, Real};
use nalgebra::{SMatrix, SVector};

/// M, C q̇ and G of one state, computed together so that they share their common terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T: Real, const N: usize> {
    /// Mass matrix M(q).
    pub mass_matrix: SMatrix<T, N, N>,
    /// Coriolis and centrifugal vector C(q, q̇) q̇.
    pub coriolis_vector: SVector<T, N>,
    /// Gravity vector G(q).
    pub gravity: SVector<T, N>,
}

/// Γ and its three Jacobians, computed together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<T: Real, const NX: usize, const NS: usize> {
    /// Γ(q_s, q̇_s, q̈_s), Eq. 9: the acceleration of the position variables.
    pub gamma: SVector<T, NX>,
    /// ∂Γ/∂q_s.
    pub d_qs: SMatrix<T, NX, NS>,
    /// ∂Γ/∂q̇_s.
    pub d_qsd: SMatrix<T, NX, NS>,
    /// ∂Γ/∂q̈_s.
    pub d_qsdd: SMatrix<T, NX, NS>,
}

/// A mechanical system M(q) q̈ + C(q, q̇) q̇ + G(q) = f (Eq. 2) with f the generalised forces on all
/// N coordinates. Coordinates are ordered q = [q_x, q_s]. SI units throughout.
pub trait LagrangianSystem<T: Real, const N: usize> {
    /// Mass matrix M(q), symmetric positive definite.
    fn mass_matrix(&self, q: &SVector<T, N>) -> SMatrix<T, N, N>;

    /// Coriolis matrix C(q, q̇) of the Christoffel symbols, so that Ṁ − 2C is skew-symmetric.
    fn coriolis_matrix(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SMatrix<T, N, N>;

    /// C(q, q̇) q̇, without forming C.
    fn coriolis_vector(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SVector<T, N>;

    /// Gravity vector G(q) = ∂V/∂q.
    fn gravity(&self, q: &SVector<T, N>) -> SVector<T, N>;

    /// Kinetic energy, joules.
    fn kinetic_energy(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> T;

    /// Potential energy, joules.
    fn potential_energy(&self, q: &SVector<T, N>) -> T;

    /// `[k]` is ∂M/∂q_k.
    fn mass_matrix_jacobian(&self, q: &SVector<T, N>) -> [SMatrix<T, N, N>; N];

    /// ∂(C q̇)/∂q, entry (i, l) = ∂(C q̇)_i/∂q_l.
    fn coriolis_vector_jacobian_q(&self, q: &SVector<T, N>, qd: &SVector<T, N>)
    -> SMatrix<T, N, N>;

    /// ∂(C q̇)/∂q̇.
    fn coriolis_vector_jacobian_qd(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
    ) -> SMatrix<T, N, N>;

    /// ∂G/∂q.
    fn gravity_jacobian(&self, q: &SVector<T, N>) -> SMatrix<T, N, N>;

    /// Generalised forces that produce q̈: M q̈ + C q̇ + G.
    fn inverse_dynamics(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
        qdd: &SVector<T, N>,
    ) -> SVector<T, N>;

    /// Accelerations under generalised forces: M⁻¹(f − C q̇ − G).
    fn forward_dynamics(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
        force: &SVector<T, N>,
    ) -> SVector<T, N>;

    /// M, C q̇ and G in one pass.
    fn motion(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> Motion<T, N> {
        Motion {
            mass_matrix: self.mass_matrix(q),
            coriolis_vector: self.coriolis_vector(q, qd),
            gravity: self.gravity(q),
        }
    }

    /// Generalised forces of the declared viscous and other Rayleigh dissipation, −∂D/∂q̇.
    /// Zero unless the model declares `dissipation`.
    fn dissipative_force(&self, _q: &SVector<T, N>, _qd: &SVector<T, N>) -> SVector<T, N> {
        SVector::from_element(T::from_f64(0.0))
    }

    /// Names, units, ranges, actuators and shape sets.
    fn description(&self) -> &Description;

    /// Column of the input matrix B(q): generalised forces per unit of the actuator's force.
    /// `actuator` indexes [`Description::actuators`]; out of range gives zeros.
    fn input_column(&self, q: &SVector<T, N>, actuator: usize) -> SVector<T, N>;

    /// Centre of mass of all rigid bodies in world axes, metres.
    fn center_of_mass(&self, q: &SVector<T, N>) -> SVector<T, 3>;

    /// Orientation (frame axes as columns, in world axes) of frame `frame` of
    /// [`Description::frames`]; identity when out of range.
    fn frame_rotation(&self, q: &SVector<T, N>, frame: usize) -> SMatrix<T, 3, 3>;

    /// World position of point `point` of [`Description::points`], metres; zero when out of range.
    fn point_position(&self, q: &SVector<T, N>, point: usize) -> SVector<T, 3>;

    /// ∂(position of the point)/∂q; zero when out of range.
    fn point_jacobian(&self, q: &SVector<T, N>, point: usize) -> SMatrix<T, 3, N>;
}

/// A system whose shape maps to accelerations of its position variables (Sec. III-B).
pub trait ShapeAccelerated<T: Real, const NX: usize, const NS: usize> {
    /// Γ(q_s, q̇_s, q̈_s), Eq. 9.
    fn gamma(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> SVector<T, NX>;

    /// Γ′(q_s), Eq. 15: the acceleration of a constant shape.
    fn gamma_prime(&self, qs: &SVector<T, NS>) -> SVector<T, NX>;

    /// ∂Γ′/∂q_s.
    fn gamma_prime_jacobian(&self, qs: &SVector<T, NS>) -> SMatrix<T, NX, NS>;

    /// K⁰_qs, Eq. 16: ∂Γ′/∂q_s at the origin.
    fn shape_gain(&self) -> SMatrix<T, NX, NS>;

    /// Γ with its Jacobians in one pass.
    fn response(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> Response<T, NX, NS>;

    /// Task-space output h(q_x, q_s), in [`Description::output_unit`].
    fn output(&self, qx: &SVector<T, NX>, qs: &SVector<T, NS>) -> SVector<T, NX>;

    /// ∂h/∂q_x, constant and invertible.
    fn output_jacobian_position(&self) -> SMatrix<T, NX, NX>;

    /// ∂h/∂q_s.
    fn output_jacobian_shape(&self, qx: &SVector<T, NX>, qs: &SVector<T, NS>)
    -> SMatrix<T, NX, NS>;

    /// Names, units, ranges, actuators and shape sets.
    fn shape_description(&self) -> &Description;
}

/// A robot: both traits with N = NX + NS.
pub trait Robot<T: Real, const N: usize, const NX: usize, const NS: usize>:
    LagrangianSystem<T, N> + ShapeAccelerated<T, NX, NS>
{
    /// q = [q_x, q_s]. A wrong split of N does not compile.
    fn join(qx: &SVector<T, NX>, qs: &SVector<T, NS>) -> SVector<T, N>
    where
        Self: Sized,
    {
        const { assert!(N == NX + NS, "N must be NX + NS") };
        SVector::from_fn(|i, _| if i < NX { qx[i] } else { qs[i - NX] })
    }

    /// (q_x, q_s) of q.
    fn split(q: &SVector<T, N>) -> (SVector<T, NX>, SVector<T, NS>)
    where
        Self: Sized,
    {
        const { assert!(N == NX + NS, "N must be NX + NS") };
        (SVector::from_fn(|i, _| q[i]), SVector::from_fn(|i, _| q[NX + i]))
    }
}
