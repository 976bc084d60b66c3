//! Whole tasks: a plan over simulated buses or over real ones.

use crate::session::Stage;
use crate::{Cycle, Error, Outcome, Script, log_to, network, run};
use shapebot_bus::Wired;
use shapebot_control::Gains;
use shapebot_drive::DriveTable;
use shapebot_drive_build::DriveDescription;
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_planner::value::{PlanView, RobotId};
use shapebot_runtime::{Runtime, Settings};
use shapebot_sim::Plant;
use std::io::Write;

/// A robot with its drive and a plan: what is to be run.
pub struct Job<'a, R> {
    /// The robot.
    pub robot: &'a R,
    /// What its plan has to say about it.
    pub id: &'a RobotId<'a>,
    /// Its controller's design.
    pub design: &'a ControlDesign,
    /// Its drive.
    pub description: &'a DriveDescription,
    /// Bytes of the plan's file.
    pub plan: &'a [u8],
    /// Times of the session.
    pub script: Script,
}

impl<R> Job<'_, R> {
    /// Through the task over buses in virtual time, with simulated nodes over a plant. Frames are logged
    /// as candump does if there is a log.
    ///
    /// # Errors
    ///
    /// Parts that do not fit each other; a state that is not reached.
    pub fn simulate<W, const N: usize, const NX: usize, const NS: usize>(
        &self,
        plant: &Plant<'_, N, NX, NS>,
        log: Option<W>,
        each: &mut dyn FnMut(&Cycle<'_, f64, N, NX, NS>),
    ) -> Result<Outcome, Error>
    where
        R: Robot<f64, N, NX, NS>,
        W: Write + Clone + Send + 'static,
    {
        let mut world = network(self.description, self.robot, plant, 1)?;
        if let Some(log) = log {
            log_to(&mut world, self.description, log);
        }
        self.on(&mut world, each)
    }

    /// Through the task over real buses.
    ///
    /// # Errors
    ///
    /// Those of [`Self::simulate`]; errors of the buses.
    pub fn run<const N: usize, const NX: usize, const NS: usize>(
        &self,
        buses: &mut Wired,
        each: &mut dyn FnMut(&Cycle<'_, f64, N, NX, NS>),
    ) -> Result<Outcome, Error>
    where
        R: Robot<f64, N, NX, NS>,
    {
        self.on(buses, each)
    }

    pub(crate) fn view<const N: usize, const NX: usize, const NS: usize>(
        &self,
    ) -> Result<PlanView<'_, f64, NX, NS, N>, Error> {
        Ok(PlanView::open(self.plan, self.id)?)
    }

    pub(crate) fn runtime<'r, const N: usize, const NX: usize, const NS: usize>(
        &'r self,
        table: &'r DriveTable<'r>,
        plan: PlanView<'r, f64, NX, NS, N>,
    ) -> Result<Runtime<'r, R, f64, N, NX, NS>, Error>
    where
        R: Robot<f64, N, NX, NS>,
    {
        let refused = shapebot_runtime::Error::from;
        let mut gains = Gains::from_design(self.robot, self.design).map_err(refused)?;
        gains.period = f64::from(table.timing.period_us) * 1e-6;
        let mut runtime = Runtime::new(self.robot, table, &gains, &Settings::default())?;
        runtime.load(plan)?;
        Ok(runtime)
    }

    fn on<S, const N: usize, const NX: usize, const NS: usize>(
        &self,
        stage: &mut S,
        each: &mut dyn FnMut(&Cycle<'_, f64, N, NX, NS>),
    ) -> Result<Outcome, Error>
    where
        R: Robot<f64, N, NX, NS>,
        S: Stage<N>,
    {
        let tables = self.description.tables();
        let table = self.script.forgiving(tables.table());
        let plan = self.view::<N, NX, NS>()?;
        let mut runtime = self.runtime(&table, plan)?;
        run(&mut runtime, (self.robot, &plan), stage, &self.script, each)
    }
}
