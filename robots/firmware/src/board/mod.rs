//! Boards.

#[cfg(feature = "mps2-an386")]
mod lockstep;
#[cfg(feature = "mps2-an386")]
mod mps2_an386;

#[cfg(feature = "mps2-an386")]
pub use lockstep::Lockstep;
#[cfg(feature = "mps2-an386")]
pub use mps2_an386::{CLOCK, Instructions, Mps2An386, Serial, Uart, finish};

use shapebot_drive::{Fault, Frame};

/// What the control loop needs of a board.
pub trait Board {
    /// Sleeps until the next cycle begins.
    fn wait(&mut self);

    /// Begin of the present cycle, µs since the start.
    fn now(&self) -> u64;

    /// The oldest frame not yet taken, with the index of its bus. Filters and queues are the board's;
    /// it need not hold more frames than a cycle can bring.
    fn receive(&mut self) -> Option<(usize, Frame)>;

    /// Puts a frame into the queue of a bus; `false` if there is no such bus or no room.
    fn send(&mut self, bus: usize, frame: &Frame) -> bool;

    /// What the states of the CAN controllers mean: [`Fault::Bus`] if one is bus-off,
    /// [`Fault::BusErrors`] if one is error-passive.
    fn fault(&self) -> Option<Fault>;

    /// The cycle was completed: restart the watchdog. A board without watchdog must not drive a robot.
    fn alive(&mut self);
}
