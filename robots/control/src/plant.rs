//! What the law needs of a robot, once: roles, gains at the origin, actuators.

use crate::Error;
use crate::linear_algebra::{Factors, inverse, solve_near_identity};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Motion, Ordered, Robot};

/// Constants of a robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plant<T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    /// The position variables are actuated and balance the unactuated shape.
    pub(crate) balancing: bool,
    /// One for coordinates that are servoed: actuated shape variables.
    pub(crate) servoed: SVector<T, NS>,
    /// Whether there is any.
    pub(crate) has_servo: bool,
    /// K⁰_qs.
    pub(crate) shape_gain: SMatrix<T, NX, NS>,
    /// K⁰_qs with the columns of actuated shape variables zero.
    pub(crate) lean_gain: SMatrix<T, NX, NS>,
    /// Right inverse of K⁰_qs through the unactuated shape variables (balancing) or all of them.
    pub(crate) body_gain: SMatrix<T, NS, NX>,
    /// ∂Γ/∂q̈_s at the origin.
    pub(crate) response: SMatrix<T, NX, NS>,
    /// Coordinates without an actuator: the rows of Γ.
    free: [usize; NX],
    /// Inverse of M_ux at the origin: with it in front, no elimination near the origin needs pivots.
    coupling: SMatrix<T, NX, NX>,
    /// (∂h/∂q_x)⁻¹ ∂h/∂q_s at the origin.
    pub(crate) output_shape: SMatrix<T, NX, NS>,
    /// Actuator of each coordinate; N for none.
    pub(crate) actuator: [usize; N],
    /// Force of the actuator per generalised force.
    pub(crate) ratio: SVector<T, N>,
    /// Largest generalised force; zero without an actuator.
    pub(crate) limit: SVector<T, N>,
    /// Range of the shape.
    pub(crate) lower: SVector<T, NS>,
    pub(crate) upper: SVector<T, NS>,
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> Plant<T, N, NX, NS> {
    pub(crate) fn new<R: Robot<T, N, NX, NS>>(robot: &R) -> Result<Self, Error> {
        let zero = T::zero();
        let (actuator, ratio, limit) = actuators(robot)?;
        let driven = |i: usize| actuator[i] < N;
        let servoed: SVector<T, NS> =
            SVector::from_fn(|i, _| if driven(NX + i) { T::one() } else { zero });
        let passive = (0..NS).filter(|&i| !driven(NX + i)).count();
        let positions = (0..NX).filter(|&i| driven(i)).count();
        let balancing = match (positions, passive) {
            (p, u) if p == NX && u == NX => true,
            (0, 0) => false,
            _ => return Err(Error::Roles),
        };
        let mut free = [0; NX];
        for (row, i) in free.iter_mut().zip((0..N).filter(|&i| !driven(i))) {
            *row = i;
        }
        let mass = robot.mass_matrix(&SVector::from_element(zero));
        let coupling = inverse(SMatrix::from_fn(|i, j| mass[(free[i], j)]))
            .ok_or(Error::Singular { matrix: "coupling of the unactuated rows" })?;
        let shape_gain = robot.shape_gain();
        let lean_gain = SMatrix::from_fn(|i, j| {
            if servoed[j] > zero && balancing { zero } else { shape_gain[(i, j)] }
        });
        let rest = SVector::from_element(zero);
        let (qx, qs) = (SVector::from_element(zero), SVector::from_element(zero));
        let position = inverse(robot.output_jacobian_position())
            .ok_or(Error::Singular { matrix: "output's Jacobian" })?;
        let ranges = robot.description().shape_coordinates();
        let bound = |pick: fn(&shapebot_dynamics::Coordinate) -> f64| {
            SVector::from_iterator(ranges.iter().map(|c| T::from_f64(pick(c))))
        };
        Ok(Self {
            balancing,
            servoed,
            has_servo: servoed.iter().any(|&s| s > zero),
            shape_gain,
            lean_gain,
            body_gain: right_inverse(&lean_gain)?,
            response: robot.response(&rest, &rest, &rest).d_qsdd,
            free,
            coupling,
            output_shape: position * robot.output_jacobian_shape(&qx, &qs),
            actuator,
            ratio,
            limit,
            lower: bound(|c| c.lower),
            upper: bound(|c| c.upper),
        })
    }

    /// Γ(q_s, q̇_s, q̈_s) from what is computed already, with the declared dissipation: the unactuated
    /// rows of the equations of motion, solved for q̈_x.
    pub(crate) fn gamma(
        &self,
        dynamics: &Dynamics<'_, T, N>,
        qsdd: &SVector<T, NS>,
    ) -> SVector<T, NX> {
        let rows = SMatrix::<T, NX, NX>::from_fn(|i, j| dynamics.mass(self.free[i], j));
        let rest = SVector::<T, NX>::from_fn(|i, _| {
            let row = self.free[i];
            let bias = dynamics.bias(row);
            (0..NS).fold(bias, |sum, j| sum + dynamics.mass(row, NX + j) * qsdd[j])
        });
        solve_near_identity(self.coupling * rows, -(self.coupling * rest))
    }

    /// Adds the accelerations of what is not servoed to those of what is, under forces on the position
    /// variables: M q̈ = f − C q̇ − G − ∂D/∂q̇ in the rows of the position variables, A, and of the
    /// unactuated shape where there is one, D, coupled by B; by the complement D − B A⁻¹ Bᵀ.
    pub(crate) fn accelerate(
        &self,
        dynamics: &Dynamics<'_, T, N>,
        force: &SVector<T, NX>,
        acceleration: &mut SVector<T, N>,
    ) {
        let missing = |row: usize| -dynamics.needed(row, acceleration);
        let factors = Factors::of(SMatrix::<T, NX, NX>::from_fn(|i, j| dynamics.mass(i, j)));
        let position = SVector::<T, NX>::from_fn(|i, _| force[i] + missing(i));
        let mut found = factors.solve(position);
        if self.balancing {
            let shape = SVector::<T, NX>::from_fn(|i, _| missing(self.free[i]));
            let coupling = SMatrix::<T, NX, NX>::from_fn(|i, j| dynamics.mass(self.free[i], j));
            // A⁻¹ Bᵀ, column by column.
            let mut carried = SMatrix::<T, NX, NX>::from_element(T::zero());
            for i in 0..NX {
                carried.set_column(i, &factors.solve(coupling.row(i).transpose()));
            }
            let complement = SMatrix::<T, NX, NX>::from_fn(|i, j| {
                let own = dynamics.mass(self.free[i], self.free[j]);
                (0..NX).fold(own, |sum, k| sum - coupling[(i, k)] * carried[(k, j)])
            });
            let lean = Factors::of(complement).solve(shape - coupling * found);
            found -= carried * lean;
            for (i, &row) in self.free.iter().enumerate() {
                if let Some(entry) = acceleration.get_mut(row) {
                    *entry = lean[i];
                }
            }
        }
        for i in 0..NX {
            acceleration[i] = found[i];
        }
    }

    /// Forces per actuator.
    pub(crate) fn actuator_force(&self, force: &SVector<T, N>) -> SVector<T, N> {
        let mut out = SVector::<T, N>::from_element(T::zero());
        for (i, &actuator) in self.actuator.iter().enumerate() {
            if let Some(entry) = out.get_mut(actuator) {
                *entry = force[i] * self.ratio[i];
            }
        }
        out
    }
}

/// The equations of motion at a state.
pub(crate) struct Dynamics<'a, T: Ordered, const N: usize> {
    pub(crate) motion: &'a Motion<T, N>,
    /// Declared dissipation.
    pub(crate) drag: &'a SVector<T, N>,
}

// Rows may be computed, and be below N without the compiler knowing: an index could panic.
impl<T: Ordered, const N: usize> Dynamics<'_, T, N> {
    /// An entry of M.
    fn mass(&self, row: usize, column: usize) -> T {
        self.motion.mass_matrix.get((row, column)).copied().unwrap_or(T::zero())
    }

    /// A row of C q̇ + G + ∂D/∂q̇.
    fn bias(&self, row: usize) -> T {
        let entry = |vector: &SVector<T, N>| vector.get(row).copied().unwrap_or(T::zero());
        let Motion { coriolis_vector, gravity, .. } = self.motion;
        entry(coriolis_vector) + entry(gravity) - entry(self.drag)
    }

    /// A row of M q̈ + C q̇ + G + ∂D/∂q̇.
    pub(crate) fn needed(&self, row: usize, acceleration: &SVector<T, N>) -> T {
        (0..N).fold(self.bias(row), |sum, j| sum + self.mass(row, j) * acceleration[j])
    }
}

type Actuators<T, const N: usize> = ([usize; N], SVector<T, N>, SVector<T, N>);

/// Actuator, force per generalised force and largest generalised force of each coordinate.
fn actuators<T, R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
) -> Result<Actuators<T, N>, Error>
where
    T: Ordered,
    R: Robot<T, N, NX, NS>,
{
    let zero = T::zero();
    let origin = SVector::from_element(zero);
    let mut of = [N; N];
    let (mut ratio, mut limit) = (SVector::from_element(zero), SVector::from_element(zero));
    for (index, actuator) in robot.description().actuators.iter().enumerate() {
        let column = robot.input_column(&origin, index);
        let mut entries = column.iter().enumerate().filter(|(_, x)| **x != zero);
        let (Some((i, &lever)), None) = (entries.next(), entries.next()) else {
            return Err(Error::Actuator { index });
        };
        if index >= N || of[i] != N {
            return Err(Error::Actuator { index });
        }
        of[i] = index;
        ratio[i] = T::one() / lever;
        limit[i] = T::from_f64(actuator.limit) * lever.abs();
    }
    Ok((of, ratio, limit))
}

/// Aᵀ(A Aᵀ)⁻¹.
fn right_inverse<T: Ordered, const R: usize, const C: usize>(
    a: &SMatrix<T, R, C>,
) -> Result<SMatrix<T, C, R>, Error> {
    let square = inverse(a * a.transpose()).ok_or(Error::Singular { matrix: "shape gain" })?;
    Ok(a.transpose() * square)
}
