//! Plans: what the planner hands out.

use crate::Error;
use crate::constraint::{ShapeConstraint, Unconstrained};
use crate::integrate::{Accelerated, DoubleIntegral, Integrated};
use crate::linear_algebra::norm;
use crate::motion::DesiredMotion;
use crate::reference::{Desired, Grid, OutputMap};
use crate::report::Report;
use core::fmt;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Coordinate, Ordered, ShapeAccelerated};

/// A plan at one time. Evaluating it takes no dynamics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanPoint<T: Ordered, const NX: usize, const NS: usize> {
    /// Time since the motion's start, seconds.
    pub time: T,
    /// The desired motion.
    pub desired: Desired<T, NX>,
    /// What the free shape sets are to cause, with two derivatives, in the unit of the position
    /// coordinates: of a gain plan the net acceleration q̈_x^d − a_ac (Eq. 35), of a refined plan the
    /// virtual acceleration u.
    pub net_acceleration: [SVector<T, NX>; 3],
    /// q_s^p = K q̈_x^net (Eq. 31) plus the constrained shape, in the units of the shape coordinates.
    pub shape: SVector<T, NS>,
    /// q̇_s^p.
    pub shape_velocity: SVector<T, NS>,
    /// q̈_s^p.
    pub shape_acceleration: SVector<T, NS>,
}

impl<T: Ordered, const NX: usize, const NS: usize> PlanPoint<T, NX, NS> {
    pub(crate) fn new<C: ShapeConstraint<T, NX, NS>>(
        time: T,
        desired: Desired<T, NX>,
        constraint: &C,
        gain: &SMatrix<T, NS, NX>,
    ) -> Self {
        let [a, b, c] = constraint.acceleration(time);
        let [_, _, x2, x3, x4] = &desired.position;
        let net_acceleration = [x2 - a, x3 - b, x4 - c];
        let [q, dq, ddq, ..] = constraint.shape(time);
        Self {
            time,
            shape: q + gain * net_acceleration[0],
            shape_velocity: dq + gain * net_acceleration[1],
            shape_acceleration: ddq + gain * net_acceleration[2],
            net_acceleration,
            desired,
        }
    }
}

/// One sample of the motion that follows from tracking a plan's shape exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<T: Ordered, const NX: usize, const NS: usize> {
    /// The plan.
    pub plan: PlanPoint<T, NX, NS>,
    /// q_x^p.
    pub position: SVector<T, NX>,
    /// q̇_x^p.
    pub velocity: SVector<T, NX>,
    /// q̈_x^p = Γ(q_s^p, q̇_s^p, q̈_s^p), Eq. 32.
    pub acceleration: SVector<T, NX>,
    /// h(q_x^p, q_s^p), in the output's unit (metres).
    pub output: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize, const NS: usize> Row<T, NX, NS> {
    pub(crate) fn new<R>(robot: &R, node: Integrated<Sample<T, NX, NS>, SVector<T, NX>>) -> Self
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        Self {
            output: robot.output(&node.position, &node.sample.plan.shape),
            position: node.position,
            velocity: node.velocity,
            acceleration: node.sample.acceleration,
            plan: node.sample.plan,
        }
    }

    /// Where the output is, relative to where it is desired: h(q_x^p, q_s^p) − x^d.
    pub fn output_error(&self) -> SVector<T, NX> {
        self.output - self.plan.desired.output[0]
    }

    /// Which quantity is not finite, if any.
    fn check_finite(&self) -> Result<(), Error> {
        let finite = |v: &SVector<T, NX>| v.iter().all(|x| x.is_finite());
        let quantity = if !self.plan.desired.output.iter().all(finite) {
            "desired motion"
        } else if !finite(&self.acceleration) {
            "acceleration response"
        } else if !finite(&self.position) || !finite(&self.output) {
            "planned motion"
        } else {
            return Ok(());
        };
        Err(Error::NonFinite { quantity, time: self.plan.time.to_f64() })
    }

    /// Whether every coordinate is in its declared range.
    fn check_ranges(&self, positions: &[Coordinate], shapes: &[Coordinate]) -> Result<(), Error> {
        let position = positions.iter().zip(self.position.iter());
        let shape = shapes.iter().zip(self.plan.shape.iter());
        for (coordinate, value) in position.chain(shape) {
            let value = value.to_f64();
            if !(coordinate.lower..=coordinate.upper).contains(&value) {
                return Err(Error::OutOfRange {
                    coordinate: coordinate.name,
                    unit: coordinate.unit,
                    time: self.plan.time.to_f64(),
                    value,
                    lower: coordinate.lower,
                    upper: coordinate.upper,
                });
            }
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<T: Ordered, const NX: usize, const NS: usize> {
    pub(crate) plan: PlanPoint<T, NX, NS>,
    pub(crate) acceleration: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize, const NS: usize> Accelerated<T> for Sample<T, NX, NS> {
    type Acceleration = SVector<T, NX>;
    fn acceleration(&self) -> &Self::Acceleration {
        &self.acceleration
    }
}

/// A shape trajectory that is a constant gain times a desired acceleration (Eq. 31).
pub struct Plan<'a, M: ?Sized, T: Ordered, const NX: usize, const NS: usize, C = Unconstrained> {
    pub(crate) motion: &'a M,
    pub(crate) constraint: C,
    pub(crate) map: OutputMap<T, NX>,
    pub(crate) grid: Grid<T>,
    pub(crate) initial_gain: SMatrix<T, NS, NX>,
    pub(crate) factor: SMatrix<T, NX, NX>,
    pub(crate) gain: SMatrix<T, NS, NX>,
    pub(crate) report: Report<T, NS>,
}

// By hand, because the motion is only borrowed: it need not be Clone or Debug itself.
impl<M: ?Sized, T: Ordered, const NX: usize, const NS: usize, C: Copy> Clone
    for Plan<'_, M, T, NX, NS, C>
{
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: ?Sized, T: Ordered, const NX: usize, const NS: usize, C: Copy> Copy
    for Plan<'_, M, T, NX, NS, C>
{
}

impl<M: ?Sized, T: Ordered, const NX: usize, const NS: usize, C> fmt::Debug
    for Plan<'_, M, T, NX, NS, C>
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Plan")
            .field("grid", &self.grid)
            .field("initial_gain", &self.initial_gain)
            .field("factor", &self.factor)
            .field("gain", &self.gain)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

impl<'a, M, T, const NX: usize, const NS: usize, C> Plan<'a, M, T, NX, NS, C>
where
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    /// The desired motion that the plan follows.
    pub fn motion(&self) -> &'a M {
        self.motion
    }

    /// K_qx = K⁰_qx S. Along a straight line only its product with the line's direction means
    /// anything: across it, K is still K⁰.
    pub fn gain(&self) -> &SMatrix<T, NS, NX> {
        &self.gain
    }

    /// K⁰_qx, where the optimiser began (Eq. 24).
    pub fn initial_gain(&self) -> &SMatrix<T, NS, NX> {
        &self.initial_gain
    }

    /// S, what the optimiser changed: 1 at K⁰.
    pub fn factor(&self) -> &SMatrix<T, NX, NX> {
        &self.factor
    }

    /// Number of samples that the plan was made with.
    pub fn samples(&self) -> usize {
        self.grid.count
    }

    /// How well the plan does.
    pub fn report(&self) -> &Report<T, NS> {
        &self.report
    }

    /// The plan at time `t`, seconds. Before the start and after the end the shape is at rest.
    pub fn at(&self, t: T) -> PlanPoint<T, NX, NS> {
        let desired = self.map.desired(self.motion.derivatives(t));
        PlanPoint::new(t, desired, &self.constraint, &self.gain)
    }

    /// The motion of `robot` when it tracks the planned shape exactly, at the plan's samples: Γ
    /// integrated twice from the desired initial position and velocity, with an error of the fourth
    /// order of the sampling interval.
    ///
    /// `robot` may be another than the one planned for, to see what a wrong parameter does. Nothing is
    /// checked along the way: the rows of an unsuitable robot need not be finite.
    pub fn rows<'s, R>(
        &'s self,
        robot: &'s R,
    ) -> impl ExactSizeIterator<Item = Row<T, NX, NS>> + use<'s, 'a, M, T, NX, NS, C, R>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        self.rows_on(self.grid, robot)
    }

    /// [`rows`](Self::rows) at another number of equidistant samples, both ends included. With fewer
    /// the positions lose accuracy; to show fewer rows, skip some of those of `rows`.
    ///
    /// # Errors
    ///
    /// Fewer than [`MIN_SAMPLES`](crate::MIN_SAMPLES) samples.
    pub fn resampled_rows<'s, R>(
        &'s self,
        robot: &'s R,
        samples: usize,
    ) -> Result<
        impl ExactSizeIterator<Item = Row<T, NX, NS>> + use<'s, 'a, M, T, NX, NS, C, R>,
        Error,
    >
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        Ok(self.rows_on(Grid::new(self.motion, samples)?, robot))
    }

    fn rows_on<'s, R>(
        &'s self,
        grid: Grid<T>,
        robot: &'s R,
    ) -> impl ExactSizeIterator<Item = Row<T, NX, NS>> + use<'s, 'a, M, T, NX, NS, C, R>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        let start = self.at(grid.time(0)).desired.position;
        let sample = move |index| {
            let plan = self.at(grid.time(index));
            let acceleration =
                robot.gamma(&plan.shape, &plan.shape_velocity, &plan.shape_acceleration);
            Sample { plan, acceleration }
        };
        let trajectory = DoubleIntegral::new(grid.count, grid.step(), start[1], start[0], sample);
        trajectory.map(|node| Row::new(robot, node))
    }

    /// Fills the report's errors and peaks from the plan's samples.
    pub(crate) fn survey<R>(&mut self, robot: &R) -> Result<(), Error>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        let description = robot.shape_description();
        let (positions, shapes) =
            (description.position_coordinates(), description.shape_coordinates());
        let mut report = self.report;
        let shape_gain = robot.shape_gain();
        let mut steepest = (T::zero(), SVector::zeros());
        for row in self.rows(robot) {
            let size = norm(&(shape_gain * row.plan.shape));
            if size > steepest.0 {
                steepest = (size, row.plan.shape);
            }
            row.check_finite()?;
            row.check_ranges(positions, shapes)?;
            report.add(&row);
        }
        if steepest.0 > T::zero() {
            let difference = robot.gamma_prime(&steepest.1) - shape_gain * steepest.1;
            report.nonlinearity = norm(&difference) / steepest.0;
        }
        self.report = report.averaged(self.grid.count);
        if self.report.is_finite() {
            return Ok(());
        }
        let time = self.grid.time(self.grid.count.saturating_sub(1)).to_f64();
        Err(Error::NonFinite { quantity: "squared error of the plan", time })
    }
}
