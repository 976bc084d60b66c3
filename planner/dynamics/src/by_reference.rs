//! A reference to a robot is a robot: `&dyn Robot<f64, N, NX, NS>` stands wherever one is expected, so
//! that code which need not be specialised is compiled once for each size and not once for each robot.

use crate::{Description, LagrangianSystem, Motion, Real, Response, Robot, ShapeAccelerated};
use nalgebra::{SMatrix, SVector};

impl<R, T: Real, const N: usize> LagrangianSystem<T, N> for &R
where
    R: LagrangianSystem<T, N> + ?Sized,
{
    fn mass_matrix(&self, q: &SVector<T, N>) -> SMatrix<T, N, N> {
        (**self).mass_matrix(q)
    }

    fn coriolis_matrix(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SMatrix<T, N, N> {
        (**self).coriolis_matrix(q, qd)
    }

    fn coriolis_vector(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SVector<T, N> {
        (**self).coriolis_vector(q, qd)
    }

    fn gravity(&self, q: &SVector<T, N>) -> SVector<T, N> {
        (**self).gravity(q)
    }

    fn kinetic_energy(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> T {
        (**self).kinetic_energy(q, qd)
    }

    fn potential_energy(&self, q: &SVector<T, N>) -> T {
        (**self).potential_energy(q)
    }

    fn mass_matrix_jacobian(&self, q: &SVector<T, N>) -> [SMatrix<T, N, N>; N] {
        (**self).mass_matrix_jacobian(q)
    }

    fn coriolis_vector_jacobian_q(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
    ) -> SMatrix<T, N, N> {
        (**self).coriolis_vector_jacobian_q(q, qd)
    }

    fn coriolis_vector_jacobian_qd(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
    ) -> SMatrix<T, N, N> {
        (**self).coriolis_vector_jacobian_qd(q, qd)
    }

    fn gravity_jacobian(&self, q: &SVector<T, N>) -> SMatrix<T, N, N> {
        (**self).gravity_jacobian(q)
    }

    fn inverse_dynamics(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
        qdd: &SVector<T, N>,
    ) -> SVector<T, N> {
        (**self).inverse_dynamics(q, qd, qdd)
    }

    fn forward_dynamics(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
        force: &SVector<T, N>,
    ) -> SVector<T, N> {
        (**self).forward_dynamics(q, qd, force)
    }

    fn motion(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> Motion<T, N> {
        (**self).motion(q, qd)
    }

    fn dissipative_force(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SVector<T, N> {
        (**self).dissipative_force(q, qd)
    }

    fn description(&self) -> &Description {
        (**self).description()
    }

    fn input_column(&self, q: &SVector<T, N>, actuator: usize) -> SVector<T, N> {
        (**self).input_column(q, actuator)
    }

    fn center_of_mass(&self, q: &SVector<T, N>) -> SVector<T, 3> {
        (**self).center_of_mass(q)
    }

    fn frame_rotation(&self, q: &SVector<T, N>, frame: usize) -> SMatrix<T, 3, 3> {
        (**self).frame_rotation(q, frame)
    }

    fn point_position(&self, q: &SVector<T, N>, point: usize) -> SVector<T, 3> {
        (**self).point_position(q, point)
    }

    fn point_jacobian(&self, q: &SVector<T, N>, point: usize) -> SMatrix<T, 3, N> {
        (**self).point_jacobian(q, point)
    }
}

impl<R, T: Real, const NX: usize, const NS: usize> ShapeAccelerated<T, NX, NS> for &R
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
{
    fn gamma(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> SVector<T, NX> {
        (**self).gamma(qs, qsd, qsdd)
    }

    fn gamma_prime(&self, qs: &SVector<T, NS>) -> SVector<T, NX> {
        (**self).gamma_prime(qs)
    }

    fn gamma_prime_jacobian(&self, qs: &SVector<T, NS>) -> SMatrix<T, NX, NS> {
        (**self).gamma_prime_jacobian(qs)
    }

    fn shape_gain(&self) -> SMatrix<T, NX, NS> {
        (**self).shape_gain()
    }

    fn response(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> Response<T, NX, NS> {
        (**self).response(qs, qsd, qsdd)
    }

    fn output(&self, qx: &SVector<T, NX>, qs: &SVector<T, NS>) -> SVector<T, NX> {
        (**self).output(qx, qs)
    }

    fn output_jacobian_position(&self) -> SMatrix<T, NX, NX> {
        (**self).output_jacobian_position()
    }

    fn output_jacobian_shape(
        &self,
        qx: &SVector<T, NX>,
        qs: &SVector<T, NS>,
    ) -> SMatrix<T, NX, NS> {
        (**self).output_jacobian_shape(qx, qs)
    }

    fn shape_description(&self) -> &Description {
        (**self).shape_description()
    }
}

impl<R, T: Real, const N: usize, const NX: usize, const NS: usize> Robot<T, N, NX, NS> for &R where
    R: Robot<T, N, NX, NS> + ?Sized
{
}
