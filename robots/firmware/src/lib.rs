//! Control loop of a Cortex-M4F: a SysTick interrupt per cycle, a [`Board`] below, an [`Application`]
//! above.
//!
//! To use another board, implement [`Board`] for it, put its memories into `memory.x` and say what a
//! panic does there. [`board::Mps2An386`] is the board that QEMU emulates, filled in;
//! [`board::Lockstep`] is the same with a simulation's clock.
#![no_std]

pub mod board;
mod cycle;

pub use board::Board;
pub use cycle::{Application, Cycles, run};
