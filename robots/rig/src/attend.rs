//! A robot under an operator: the loop of a robot's program on the buses of a rig.

use crate::{Error, Job};
use shapebot_bus::Buses;
use shapebot_dynamics::Robot;
use shapebot_host::{Ending, Plans, Service, Socket};

impl<R> Job<'_, R> {
    /// As an operator says, on the operator's bus and over a socket, until `signals` counts a signal:
    /// see [`Service::run`]. The job's plan is there to be followed; others can be uploaded.
    ///
    /// # Errors
    ///
    /// Parts that do not fit each other; errors of the buses.
    pub fn attend<B, const N: usize, const NX: usize, const NS: usize>(
        &self,
        buses: B,
        socket: Option<Socket>,
        signals: &mut dyn FnMut(u64) -> usize,
    ) -> Result<Ending, Error>
    where
        R: Robot<f64, N, NX, NS>,
        B: Buses,
    {
        let tables = self.description.tables();
        let table = self.script.forgiving(tables.table());
        let plan = self.view::<N, NX, NS>()?;
        let runtime = self.runtime(&table, plan)?;
        let mut service = Service::new(runtime, buses, Plans::new(*self.id), socket);
        Ok(service.run(signals)?)
    }
}
