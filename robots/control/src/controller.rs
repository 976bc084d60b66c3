//! The controller: state, construction and the order of a step.

use crate::law::{Deviation, Outer};
use crate::observer::{MomentumObserver, OffsetObserver, flat_rate};
use crate::plant::{Dynamics, Plant};
use crate::signal::Finite;
use crate::{Command, Compensate, Error, Gains, State, Target};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, Robot};

/// Makes a robot follow a plan; one [`Controller::step`] per period.
///
/// # Example
///
/// ```
/// use shapebot_control::{Controller, Gains, State, Target};
/// use shapebot_generated::ballbot_planar::{BallbotPlanar, CONTROL};
///
/// let robot = BallbotPlanar::<f64>::from_model();
/// let mut controller = Controller::new(&robot, &Gains::from_design(&robot, &CONTROL)?)?;
/// let leaning = State { q: [0.0, 0.03].into(), qd: [0.0, 0.0].into() };
/// let command = controller.step(&leaning, &Target::stand([0.0].into()));
/// assert!(command.actuator[0] > 2.0); // N·m: the ball is driven under the body
/// # Ok::<(), shapebot_control::Error>(())
/// ```
#[derive(Debug)]
pub struct Controller<'r, R, T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    robot: &'r R,
    pub(crate) gains: Gains<T, NX, NS>,
    pub(crate) plant: Plant<T, N, NX, NS>,
    /// K⁰_qx of the compensation.
    pub(crate) compensation_gain: SMatrix<T, NS, NX>,
    /// Largest change of the compensation per period.
    pub(crate) compensation_step: SVector<T, NS>,
    /// Largest change of the generalised forces per period.
    pub(crate) force_step: SVector<T, N>,
    /// Largest magnitude of the offset b̂.
    offset_limit: SVector<T, NX>,
    memory: Option<Memory<T, N, NX, NS>>,
}

// Derived, these would ask for a robot that is Copy; only a reference to it is copied.
impl<R, T: Ordered, const N: usize, const NX: usize, const NS: usize> Clone
    for Controller<'_, R, T, N, NX, NS>
{
    fn clone(&self) -> Self {
        *self
    }
}

impl<R, T: Ordered, const N: usize, const NX: usize, const NS: usize> Copy
    for Controller<'_, R, T, N, NX, NS>
{
}

/// What is kept from step to step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Memory<T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    /// ∫e.
    pub(crate) lean_integral: SVector<T, NX>,
    /// Integrated errors of servoed shape variables.
    pub(crate) servo_integral: SVector<T, NS>,
    pub(crate) momentum: MomentumObserver<T, NX>,
    pub(crate) offset: OffsetObserver<T, NX>,
    /// Forces of the last step.
    pub(crate) force: SVector<T, N>,
    /// Dissipation at the last step.
    pub(crate) drag: SVector<T, N>,
    /// Compensation of the last step.
    pub(crate) compensation: SVector<T, NS>,
}

impl<'r, R, T, const N: usize, const NX: usize, const NS: usize> Controller<'r, R, T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    /// A controller at rest.
    ///
    /// # Errors
    ///
    /// Roles or actuators that the law does not suit, a singular K⁰_qs, gains out of range.
    pub fn new(robot: &'r R, gains: &Gains<T, NX, NS>) -> Result<Self, Error> {
        gains.check()?;
        let plant = Plant::new(robot)?;
        let compensation_gain = match gains.compensate {
            Compensate::Plan => gains.plan_gain,
            Compensate::Body => plant.body_gain,
        };
        // The largest acceleration that the body may make up for along each axis.
        let offset_limit = plant.lean_gain.map(T::abs) * gains.compensation_limit;
        let force_step = plant.limit.map(|limit| {
            if limit > T::zero() { limit * gains.force_slew * gains.period } else { T::zero() }
        });
        let gains = *gains;
        let compensation_step = gains.compensation_slew * gains.period;
        Ok(Self {
            robot,
            gains,
            plant,
            compensation_gain,
            compensation_step,
            force_step,
            offset_limit,
            memory: None,
        })
    }

    /// Goes on with other gains from the next step: integrals and estimates are kept.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`]; the gains are what they were then.
    pub fn set_gains(&mut self, gains: Gains<T, NX, NS>) -> Result<(), Error> {
        let memory = self.memory;
        *self = Self { memory, ..Self::new(self.robot, &gains)? };
        Ok(())
    }

    /// Its gains.
    pub fn gains(&self) -> &Gains<T, NX, NS> {
        &self.gains
    }

    /// Shape through which the body accelerates the robot, per acceleration in units of q_x per s²: a
    /// right inverse of K⁰_qs that leaves servoed shape variables alone where the robot balances.
    pub fn body_gain(&self) -> &SMatrix<T, NS, NX> {
        &self.plant.body_gain
    }

    /// The largest acceleration along each position variable that compensation can make.
    pub fn authority(&self) -> &SVector<T, NX> {
        &self.offset_limit
    }

    /// (∂h/∂q_x)⁻¹ ∂h/∂q_s at the origin.
    pub fn output_shape(&self) -> &SMatrix<T, NX, NS> {
        &self.plant.output_shape
    }

    /// One for each shape coordinate that is servoed while the position variables balance the rest.
    pub fn servoed(&self) -> SVector<T, NS> {
        if self.plant.balancing { self.plant.servoed } else { SVector::from_element(T::zero()) }
    }

    /// Forgets integrals and estimates: the next step is the first.
    pub fn reset(&mut self) {
        self.memory = None;
    }

    /// Forces for the period that begins now.
    ///
    /// If a measured or wanted value is not finite, the command is zero force with
    /// `fault` of the [`Command`], and nothing is remembered.
    pub fn step(
        &mut self,
        state: &State<T, N>,
        target: &Target<T, N, NX, NS>,
    ) -> Command<T, N, NX, NS> {
        let (qx, qs) = R::split(&state.q);
        let (qxd, qsd) = R::split(&state.qd);
        let deviation = Deviation {
            position: qx - target.position[0],
            velocity: qxd - target.position[1],
            shape: qs - target.shape[0],
            rate: qsd - target.shape[1],
        };
        let motion = self.robot.motion(&state.q, &state.qd);
        let momentum = SVector::<T, NX>::from_fn(|i, _| {
            (0..N).fold(T::zero(), |sum, j| sum + motion.mass_matrix[(i, j)] * state.qd[j])
        });
        let drag = self.robot.dissipative_force(&state.q, &state.qd);
        let dynamics = Dynamics { motion: &motion, drag: &drag };
        let gamma = self.plant.gamma(&dynamics, &target.shape[2]);
        let slope = gamma - self.plant.response * target.shape[2];
        let z = flat_rate(&self.plant.response, &qxd, &qsd);
        let mut memory = self.memory.unwrap_or_else(|| Memory::new(momentum, z, slope));
        self.observe(&mut memory, &momentum, &z, &slope);
        let outer = self.outer(&memory, &deviation, target);
        let error = self.errors(&deviation, &outer);
        let balance = self.balance(&memory, &deviation, &outer, &error, &motion, target);
        let wanted = self.servo(&memory, &deviation, &error, &dynamics, target, &balance);
        let force = self.limited(&wanted, &memory.force);
        self.integrate(&mut memory, &error, &wanted, &force);
        memory.force = force;
        memory.drag = drag;
        memory.compensation = outer.compensation;
        self.conclude(memory, &outer, &wanted, force)
    }

    /// Brings the observers to the present.
    fn observe(
        &self,
        memory: &mut Memory<T, N, NX, NS>,
        momentum: &SVector<T, NX>,
        z: &SVector<T, NX>,
        slope: &SVector<T, NX>,
    ) {
        let Gains { period, observer, observer_rate, offset, offset_rate, .. } = self.gains;
        let switched = |on: bool, rate: T| if on { rate } else { T::zero() };
        let (applied, _) = R::split(&(memory.force + memory.drag));
        memory.momentum.advance(momentum, &applied, [period, switched(observer, observer_rate)]);
        memory.offset.advance(z, slope, [period, switched(offset, offset_rate)]);
        memory.offset.limit(&self.offset_limit);
    }

    /// Keeps what is finite, and reports.
    fn conclude(
        &mut self,
        memory: Memory<T, N, NX, NS>,
        outer: &Outer<T, NX, NS>,
        wanted: &SVector<T, N>,
        force: SVector<T, N>,
    ) -> Command<T, N, NX, NS> {
        // The force is finite if what is wanted is.
        if !memory.added_to(Finite::new().and(wanted)).holds() {
            return Command::fault();
        }
        self.memory = Some(memory);
        Command {
            force,
            actuator: self.plant.actuator_force(&force),
            compensation: outer.compensation,
            trim: outer.trim,
            disturbance: memory.momentum.disturbance,
            position_error: outer.position_error,
            saturated: outer.limited | (force != *wanted),
            fault: false,
        }
    }
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> Memory<T, N, NX, NS> {
    fn new(momentum: SVector<T, NX>, z: SVector<T, NX>, slope: SVector<T, NX>) -> Self {
        Self {
            lean_integral: SVector::from_element(T::zero()),
            servo_integral: SVector::from_element(T::zero()),
            momentum: MomentumObserver::new(momentum),
            offset: OffsetObserver::new(z, slope),
            force: SVector::from_element(T::zero()),
            drag: SVector::from_element(T::zero()),
            compensation: SVector::from_element(T::zero()),
        }
    }

    fn added_to(&self, sum: Finite<T>) -> Finite<T> {
        let sum = sum.and(&self.lean_integral).and(&self.servo_integral);
        let sum = self.offset.added_to(self.momentum.added_to(sum));
        sum.and(&self.drag).and(&self.compensation)
    }
}
