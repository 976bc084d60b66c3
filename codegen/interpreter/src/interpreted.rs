//! The runtime traits on top of the tapes.

use crate::tape::State;
use crate::{Error, Tapes};
use nalgebra::{SMatrix, SVector};
use shapebot_codegen::derive::{Derivation, Quantity};
use shapebot_dynamics::{
    Description, LagrangianSystem, Motion, Real, Response, Robot, ShapeAccelerated,
};

/// A model behind the runtime traits, with sizes known at compile time: N = NX + NS coordinates.
///
/// ```text
/// let derivation = shapebot_codegen::derive::derive(&model, Parameters::Symbolic)?;
/// let robot = Interpreted::<4, 2, 2>::new(&derivation, &parameters)?;
/// let gamma = robot.gamma(&qs, &qsd, &qsdd);
/// ```
///
/// Where the sizes follow from the model, [`with_interpreted!`](crate::with_interpreted) picks them.
#[derive(Debug)]
pub struct Interpreted<const N: usize, const NX: usize, const NS: usize, T = f64> {
    tapes: Tapes<T>,
}

impl<const N: usize, const NX: usize, const NS: usize, T: Real> Interpreted<N, NX, NS, T> {
    /// Compiles a derivation. `parameters` are values in SI units in the order of the model.
    ///
    /// # Errors
    ///
    /// Another number of parameters, a model of other sizes, or one that is not shape-accelerated.
    pub fn new(derivation: &Derivation, parameters: &[T]) -> Result<Self, Error> {
        Self::from_tapes(Tapes::new(derivation, parameters)?)
    }

    /// Puts compiled functions behind the traits.
    ///
    /// # Errors
    ///
    /// A model of other sizes, or one that is not shape-accelerated.
    pub fn from_tapes(tapes: Tapes<T>) -> Result<Self, Error> {
        const { assert!(N == NX + NS, "N must be NX + NS") };
        let description = tapes.description();
        check("coordinates", description.coordinates.len(), N)?;
        check("position coordinates", description.position_count, NX)?;
        if !tapes.has(Quantity::Response) {
            return Err(Error::NotShapeAccelerated { model: description.name.to_owned() });
        }
        Ok(Self { tapes })
    }

    /// The functions behind the traits.
    #[must_use]
    pub const fn tapes(&self) -> &Tapes<T> {
        &self.tapes
    }

    fn vector<const L: usize>(&self, quantity: Quantity, state: &State<'_, T>) -> SVector<T, L> {
        let mut vector = SVector::<T, L>::from_element(zero());
        self.tapes.visit(quantity, state, |i, value| put(vector.as_mut_slice(), i, value));
        vector
    }

    fn matrix<const R: usize, const C: usize>(
        &self,
        quantity: Quantity,
        state: &State<'_, T>,
    ) -> SMatrix<T, R, C> {
        let mut matrix = SMatrix::<T, R, C>::from_element(zero());
        self.tapes.visit(quantity, state, |i, value| put_row_major(&mut matrix, i, value));
        matrix
    }

    fn scalar(&self, quantity: Quantity, state: &State<'_, T>) -> T {
        self.vector::<1>(quantity, state)[0]
    }
}

fn check(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { what, found, expected }) }
}

fn zero<T: Real>() -> T {
    T::from_f64(0.0)
}

fn put<T>(slice: &mut [T], index: usize, value: T) {
    if let Some(entry) = slice.get_mut(index) {
        *entry = value;
    }
}

fn put_row_major<T: Real, const R: usize, const C: usize>(
    matrix: &mut SMatrix<T, R, C>,
    index: usize,
    value: T,
) {
    if let Some(entry) = matrix.get_mut((index / C, index % C)) {
        *entry = value;
    }
}

/// q = [0, …, 0, shape]: functions of the shape read nothing else.
fn padded<const N: usize, const NS: usize, T: Real>(shape: &SVector<T, NS>) -> SVector<T, N> {
    SVector::from_fn(|i, _| if i + NS < N { zero() } else { shape[i + NS - N] })
}

fn at<'a, const N: usize, T>(q: &'a SVector<T, N>) -> State<'a, T> {
    State { q: q.as_slice(), ..State::EMPTY }
}

fn moving<'a, const N: usize, T>(q: &'a SVector<T, N>, qd: &'a SVector<T, N>) -> State<'a, T> {
    State { q: q.as_slice(), qd: qd.as_slice(), ..State::EMPTY }
}

impl<const N: usize, const NX: usize, const NS: usize, T: Real> LagrangianSystem<T, N>
    for Interpreted<N, NX, NS, T>
{
    fn mass_matrix(&self, q: &SVector<T, N>) -> SMatrix<T, N, N> {
        self.matrix(Quantity::MassMatrix, &at(q))
    }

    fn coriolis_matrix(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SMatrix<T, N, N> {
        self.matrix(Quantity::CoriolisMatrix, &moving(q, qd))
    }

    fn coriolis_vector(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SVector<T, N> {
        self.vector(Quantity::CoriolisVector, &moving(q, qd))
    }

    fn gravity(&self, q: &SVector<T, N>) -> SVector<T, N> {
        self.vector(Quantity::Gravity, &at(q))
    }

    fn kinetic_energy(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> T {
        self.scalar(Quantity::KineticEnergy, &moving(q, qd))
    }

    fn potential_energy(&self, q: &SVector<T, N>) -> T {
        self.scalar(Quantity::PotentialEnergy, &at(q))
    }

    fn mass_matrix_jacobian(&self, q: &SVector<T, N>) -> [SMatrix<T, N, N>; N] {
        let mut layers = [SMatrix::from_element(zero()); N];
        self.tapes.visit(Quantity::MassMatrixJacobian, &at(q), |i, value| {
            if let Some(layer) = layers.get_mut(i / (N * N)) {
                put_row_major(layer, i % (N * N), value);
            }
        });
        layers
    }

    fn coriolis_vector_jacobian_q(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
    ) -> SMatrix<T, N, N> {
        self.matrix(Quantity::CoriolisVectorJacobianQ, &moving(q, qd))
    }

    fn coriolis_vector_jacobian_qd(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
    ) -> SMatrix<T, N, N> {
        self.matrix(Quantity::CoriolisVectorJacobianQd, &moving(q, qd))
    }

    fn gravity_jacobian(&self, q: &SVector<T, N>) -> SMatrix<T, N, N> {
        self.matrix(Quantity::GravityJacobian, &at(q))
    }

    fn inverse_dynamics(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
        qdd: &SVector<T, N>,
    ) -> SVector<T, N> {
        let state = State { qdd: qdd.as_slice(), ..moving(q, qd) };
        self.vector(Quantity::InverseDynamics, &state)
    }

    fn forward_dynamics(
        &self,
        q: &SVector<T, N>,
        qd: &SVector<T, N>,
        force: &SVector<T, N>,
    ) -> SVector<T, N> {
        let state = State { force: force.as_slice(), ..moving(q, qd) };
        self.vector(Quantity::ForwardDynamics, &state)
    }

    fn motion(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> Motion<T, N> {
        let mut mass_matrix = SMatrix::from_element(zero());
        let mut coriolis_vector = SVector::<T, N>::from_element(zero());
        let mut gravity = SVector::<T, N>::from_element(zero());
        let square = N * N;
        self.tapes.visit(Quantity::Motion, &moving(q, qd), |i, value| {
            if i < square {
                put_row_major(&mut mass_matrix, i, value);
            } else if i < square + N {
                coriolis_vector[i - square] = value;
            } else {
                put(gravity.as_mut_slice(), i - square - N, value);
            }
        });
        Motion { mass_matrix, coriolis_vector, gravity }
    }

    fn dissipative_force(&self, q: &SVector<T, N>, qd: &SVector<T, N>) -> SVector<T, N> {
        self.vector(Quantity::DissipativeForce, &moving(q, qd))
    }

    fn description(&self) -> &Description {
        self.tapes.description()
    }

    fn input_column(&self, q: &SVector<T, N>, actuator: usize) -> SVector<T, N> {
        self.vector(Quantity::InputColumn(actuator), &at(q))
    }

    fn center_of_mass(&self, q: &SVector<T, N>) -> SVector<T, 3> {
        self.vector(Quantity::CenterOfMass, &at(q))
    }

    fn frame_rotation(&self, q: &SVector<T, N>, frame: usize) -> SMatrix<T, 3, 3> {
        if !self.tapes.has(Quantity::FrameRotation(frame)) {
            return SMatrix::identity();
        }
        self.matrix(Quantity::FrameRotation(frame), &at(q))
    }

    fn point_position(&self, q: &SVector<T, N>, point: usize) -> SVector<T, 3> {
        self.vector(Quantity::PointPosition(point), &at(q))
    }

    fn point_jacobian(&self, q: &SVector<T, N>, point: usize) -> SMatrix<T, 3, N> {
        self.matrix(Quantity::PointJacobian(point), &at(q))
    }
}

impl<const N: usize, const NX: usize, const NS: usize, T: Real> ShapeAccelerated<T, NX, NS>
    for Interpreted<N, NX, NS, T>
{
    fn gamma(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> SVector<T, NX> {
        let (q, qd, qdd) =
            (padded::<N, NS, T>(qs), padded::<N, NS, T>(qsd), padded::<N, NS, T>(qsdd));
        self.vector(Quantity::Gamma, &State { qdd: qdd.as_slice(), ..moving(&q, &qd) })
    }

    fn gamma_prime(&self, qs: &SVector<T, NS>) -> SVector<T, NX> {
        self.vector(Quantity::GammaPrime, &at(&padded::<N, NS, T>(qs)))
    }

    fn gamma_prime_jacobian(&self, qs: &SVector<T, NS>) -> SMatrix<T, NX, NS> {
        self.matrix(Quantity::GammaPrimeJacobian, &at(&padded::<N, NS, T>(qs)))
    }

    fn shape_gain(&self) -> SMatrix<T, NX, NS> {
        self.matrix(Quantity::ShapeGain, &State::EMPTY)
    }

    fn response(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> Response<T, NX, NS> {
        let (q, qd, qdd) =
            (padded::<N, NS, T>(qs), padded::<N, NS, T>(qsd), padded::<N, NS, T>(qsdd));
        let state = State { qdd: qdd.as_slice(), ..moving(&q, &qd) };
        let mut gamma = SVector::<T, NX>::from_element(zero());
        let mut jacobians = [SMatrix::from_element(zero()); 3];
        self.tapes.visit(Quantity::Response, &state, |i, value| match i.checked_sub(NX) {
            None => gamma[i] = value,
            Some(i) => {
                if let Some(jacobian) = jacobians.get_mut(i / (NX * NS)) {
                    put_row_major(jacobian, i % (NX * NS), value);
                }
            }
        });
        let [d_qs, d_qsd, d_qsdd] = jacobians;
        Response { gamma, d_qs, d_qsd, d_qsdd }
    }

    fn output(&self, qx: &SVector<T, NX>, qs: &SVector<T, NS>) -> SVector<T, NX> {
        self.vector(Quantity::Output, &at(&<Self as Robot<T, N, NX, NS>>::join(qx, qs)))
    }

    fn output_jacobian_position(&self) -> SMatrix<T, NX, NX> {
        let origin = SVector::<T, N>::from_element(zero());
        self.matrix(Quantity::OutputJacobianPosition, &at(&origin))
    }

    fn output_jacobian_shape(
        &self,
        qx: &SVector<T, NX>,
        qs: &SVector<T, NS>,
    ) -> SMatrix<T, NX, NS> {
        let q = <Self as Robot<T, N, NX, NS>>::join(qx, qs);
        self.matrix(Quantity::OutputJacobianShape, &at(&q))
    }

    fn shape_description(&self) -> &Description {
        self.tapes.description()
    }
}

impl<const N: usize, const NX: usize, const NS: usize, T: Real> Robot<T, N, NX, NS>
    for Interpreted<N, NX, NS, T>
{
}
