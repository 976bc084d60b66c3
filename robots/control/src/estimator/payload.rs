//! Payload and net centre of gravity.

use crate::linear_algebra::solve_definite;
use crate::plant::Plant;
use crate::signal::Finite;
use crate::{Error, State};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, Robot};

/// What is assumed about a payload before anything moves. Start from [`PayloadSettings::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadSettings<T> {
    /// Time between steps, s.
    pub period: T,
    /// Index of the point of the description that carries the payload.
    pub point: usize,
    /// How long a measurement counts, s.
    pub memory: T,
    /// Over what time momentum is balanced, s: slower changes are left out.
    pub window: T,
    /// Deviation of the unknowns that is expected beforehand: mass, kg; viscous and dry friction of the
    /// drives, in units of force per rate and force.
    pub prior: [T; 3],
    /// Deviation of the momentum's error, in the unit of the position variables' momentum.
    pub noise: T,
    /// Gravity, m/s².
    pub gravity: T,
}

impl<T: Ordered> PayloadSettings<T> {
    /// A payload of some kilograms on a robot whose largest drive force is `limit`.
    pub fn new(period: T, point: usize, limit: T) -> Self {
        let c = T::from_f64;
        Self {
            period,
            point,
            memory: c(60.0),
            window: c(4.0),
            prior: [c(10.0), c(0.02) * limit, c(0.1) * limit],
            noise: c(1e-3) * limit,
            gravity: c(9.81),
        }
    }
}

/// A payload, and what follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload<T> {
    /// Its mass, kg; negative if the robot is lighter than its model.
    pub mass: T,
    /// Viscous friction of the drives beyond what the model declares, force per rate.
    pub viscous: T,
    /// Dry friction of the drives, force.
    pub dry: T,
    /// Centre of mass of all rigid bodies and the payload, world axes, m.
    pub center_of_mass: SVector<T, 3>,
}

/// Finds a payload from the momentum of position variables that are actuated, cyclic and free of
/// gravity: M gains m J_pᵀ J_p, so that p_x + m (J_pᵀ J_p q̇)_x changes by the force alone. Least squares
/// with forgetting, friction beside it; both sides lose their slow part first, so that no drift adds up.
#[derive(Clone, Copy, Debug)]
pub struct PayloadEstimator<'r, R, T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    robot: &'r R,
    settings: PayloadSettings<T>,
    /// Mass of the model's rigid bodies.
    rigid: T,
    last: Option<[SVector<T, NX>; 2]>,
    /// Unexplained momentum and what may explain it, without slow parts.
    unexplained: SVector<T, NX>,
    regressors: [SVector<T, NX>; 3],
    information: SMatrix<T, 3, 3>,
    evidence: SVector<T, 3>,
}

impl<'r, R, T, const N: usize, const NX: usize, const NS: usize>
    PayloadEstimator<'r, R, T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    /// An estimator that knows nothing yet.
    ///
    /// # Errors
    ///
    /// Settings out of range, no such point, or a robot whose position variables are not actuated.
    pub fn new(robot: &'r R, settings: &PayloadSettings<T>) -> Result<Self, Error> {
        let PayloadSettings { period, memory, window, prior, noise, gravity, point } = *settings;
        let numbers = [period, memory, window, noise, gravity, prior[0], prior[1], prior[2]];
        if !numbers.iter().all(|&x| x.is_finite() && x > T::zero()) {
            return Err(Error::Gain { what: "payload settings" });
        }
        if point >= robot.description().points.len() {
            return Err(Error::NoPoint);
        }
        if !Plant::new(robot)?.balancing {
            return Err(Error::Kind);
        }
        let mut estimator = Self {
            robot,
            settings: *settings,
            rigid: rigid_mass(robot, gravity),
            last: None,
            unexplained: SVector::from_element(T::zero()),
            regressors: [SVector::from_element(T::zero()); 3],
            information: SMatrix::zeros(),
            evidence: SVector::from_element(T::zero()),
        };
        estimator.information = estimator.prior();
        Ok(estimator)
    }

    /// Information of the prior in units of the noise.
    fn prior(&self) -> SMatrix<T, 3, 3> {
        let PayloadSettings { prior, noise, .. } = &self.settings;
        SMatrix::from_fn(|i, j| {
            let share = *noise / prior[i];
            if i == j { share * share } else { T::zero() }
        })
    }

    /// Takes a state and the generalised forces that acted since the last one.
    pub fn step(&mut self, state: &State<T, N>, force: &SVector<T, N>) -> Payload<T> {
        if !Finite::new().and(&state.q).and(&state.qd).and(force).holds() {
            return self.payload(&state.q);
        }
        let PayloadSettings { period, point, memory, window, .. } = self.settings;
        let momentum = self.robot.mass_matrix(&state.q) * state.qd;
        let jacobian = self.robot.point_jacobian(&state.q, point);
        let share = jacobian.transpose() * (jacobian * state.qd);
        let drag = self.robot.dissipative_force(&state.q, &state.qd);
        let [momentum, share, acting, rate] =
            [momentum, share, force + drag, state.qd].map(|v| R::split(&v).0);
        let [before, share_before] = self.last.unwrap_or([momentum, share]);
        self.last = Some([momentum, share]);
        // x ← x + ẋ T − x T / window: the washout of every part of the balance.
        let keep = T::one() - period / window;
        self.unexplained = self.unexplained * keep + (momentum - before) - acting * period;
        let direction = rate.map(sign);
        let changes = [share - share_before, rate * period, direction * period];
        for (regressor, change) in self.regressors.iter_mut().zip(&changes) {
            *regressor = *regressor * keep - change;
        }
        self.learn(period / memory);
        self.payload(&state.q)
    }

    /// Least squares; what is forgotten is replaced by the prior.
    fn learn(&mut self, forgotten: T) {
        let keep = T::one() - forgotten;
        let mut information = self.information * keep + self.prior() * forgotten;
        let mut evidence = self.evidence * keep;
        for axis in 0..NX {
            let row: SVector<T, 3> = SVector::from_fn(|k, _| self.regressors[k][axis]);
            information += row * row.transpose();
            evidence += row * self.unexplained[axis];
        }
        (self.information, self.evidence) = (information, evidence);
    }

    fn payload(&self, q: &SVector<T, N>) -> Payload<T> {
        let solution = solve_definite(self.information, self.evidence);
        let mass = solution[0];
        let point = self.robot.point_position(q, self.settings.point);
        let center = self.robot.center_of_mass(q);
        let share = mass / (self.rigid + mass);
        Payload {
            mass,
            viscous: solution[1],
            dry: solution[2],
            center_of_mass: center + (point - center) * share,
        }
    }
}

fn sign<T: Ordered>(x: T) -> T {
    // A rate of a hundredth counts as standing.
    let scaled = x * T::from_f64(100.0);
    let clipped = if scaled > T::one() { T::one() } else { scaled };
    if clipped < -T::one() { -T::one() } else { clipped }
}

/// Mass of what gravity acts on: G = m g ∂z/∂q along the coordinate that lifts the centre of mass most.
fn rigid_mass<R, T, const N: usize, const NX: usize, const NS: usize>(robot: &R, gravity: T) -> T
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let c = T::from_f64;
    let q = SVector::<T, N>::from_fn(|i, _| c(if i < NX { 0.0 } else { 0.2 }));
    let force = robot.gravity(&q);
    let step = c(0.01);
    let (mut best, mut mass) = (T::zero(), T::zero());
    for i in 0..N {
        let (mut before, mut after) = (q, q);
        before[i] -= step;
        after[i] += step;
        let height = |q: &SVector<T, N>| robot.center_of_mass(q)[2];
        let lift = (height(&after) - height(&before)) / (step + step);
        if lift.abs() > best {
            (best, mass) = (lift.abs(), force[i] / (gravity * lift));
        }
    }
    mass
}
