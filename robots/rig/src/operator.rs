//! An operator beside a session: commands on a bus and over a local socket, telemetry to both.

use shapebot_bus::{BusError, Buses};
use shapebot_drive::operator::{GainBounds, Operator, PlanStore};
use shapebot_drive::{DriveTable, Frame};
use shapebot_dynamics::Robot;
use shapebot_planner::value::Stored;
use shapebot_runtime::Runtime;

#[cfg(unix)]
mod socket;

#[cfg(unix)]
pub use socket::Socket;

/// Bounds of gains: none can be set in a session.
const GAINS: &[GainBounds] = &[];

/// The robot's end of an operator's link: see [`shapebot_drive::operator`] for the protocol. Over the
/// socket its frames go in the records of [`stream`](shapebot_drive::operator::stream).
///
/// Gains and plans are refused: a session's plan is that of its task.
#[derive(Debug)]
pub struct Link {
    operator: Operator<'static>,
    bus: usize,
    command: u16,
    telemetry: u16,
    #[cfg(unix)]
    socket: Option<Socket>,
}

impl Link {
    /// For commands on the bus of a drive alone.
    #[must_use]
    pub fn new(table: &DriveTable<'_>) -> Self {
        let plans = PlanStore::new(&mut [], &mut []);
        let operator = &table.operator;
        Self {
            operator: Operator::new(table.fingerprint, GAINS, plans),
            bus: operator.bus.into(),
            command: operator.command,
            telemetry: operator.telemetry,
            #[cfg(unix)]
            socket: None,
        }
    }

    /// Also takes commands from a socket.
    #[cfg(unix)]
    #[must_use]
    pub fn with_socket(self, socket: Socket) -> Self {
        Self { socket: Some(socket), ..self }
    }

    /// Takes a frame that was received on a bus; what is no operator's is left alone.
    pub fn take<R, T, const N: usize, const NX: usize, const NS: usize>(
        &mut self,
        runtime: &mut Runtime<'_, R, T, N, NX, NS>,
        (bus, frame): (usize, &Frame),
        now: u64,
    ) where
        R: Robot<T, N, NX, NS>,
        T: Stored,
    {
        if bus == self.bus && frame.standard_id() == Some(self.command) {
            self.command(runtime, frame.bytes(), now);
        }
    }

    fn command<R, T, const N: usize, const NX: usize, const NS: usize>(
        &mut self,
        runtime: &mut Runtime<'_, R, T, N, NX, NS>,
        bytes: &[u8],
        now: u64,
    ) where
        R: Robot<T, N, NX, NS>,
        T: Stored,
    {
        self.operator.receive(bytes, runtime, now);
        // Somebody who is not understood is not there.
        let refusal = self.operator.refusal();
        if matches!(refusal, shapebot_drive::operator::Refusal::None) {
            runtime.hear_operator(now);
        }
    }

    /// Serves the socket, and sends the telemetry that is due.
    ///
    /// # Errors
    ///
    /// Errors after which the bus cannot be used any more.
    pub fn poll<R, T, const N: usize, const NX: usize, const NS: usize>(
        &mut self,
        runtime: &mut Runtime<'_, R, T, N, NX, NS>,
        buses: &mut impl Buses,
    ) -> Result<(), BusError>
    where
        R: Robot<T, N, NX, NS>,
        T: Stored,
    {
        #[cfg(unix)]
        for frame in self.socket.as_mut().map(Socket::receive).unwrap_or_default() {
            self.command(runtime, &frame, buses.now());
        }
        let Some(page) = self.operator.telemetry(runtime.master()) else { return Ok(()) };
        #[cfg(unix)]
        if let Some(socket) = &mut self.socket {
            socket.send(&page);
        }
        match buses.send(self.bus, &Frame::new(self.telemetry, &page)) {
            // Telemetry that a bus has no room for is not missed.
            Ok(()) | Err(BusError::QueueFull { .. } | BusError::BusOff) => Ok(()),
            Err(error) => Err(error),
        }
    }
}
