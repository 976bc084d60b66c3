//! The board: here the one that QEMU emulates, `-M mps2-an386`. This file is yours to change, and is kept
//! when the robot is deployed again.
//!
//! For a board of your own:
//!
//! 1. implement [`shapebot_firmware::Board`] for a type of yours and give it to `start`: `wait` sleeps
//!    until SysTick's next turn ([`shapebot_firmware::Cycles`] counts them), `receive` and `send` are the
//!    CAN controllers in the order of the drive's buses, `fault` is what their error states mean, `alive`
//!    restarts the watchdog;
//! 2. in `Cargo.toml`, take `default-features = false` for `shapebot-firmware`, and write a
//!    `#[panic_handler]` here that switches the drives off and lets the watchdog do the rest;
//! 3. put your memories into `memory.x`.

use shapebot_firmware::board::{Mps2An386, finish};

/// The board.
pub type Own = Mps2An386;

/// Starts the board with a turn each `turn_us` microseconds; `None` if it is in use already.
pub fn start(turn_us: u32) -> Option<Own> {
    Mps2An386::new(turn_us)
}

/// Nothing can be controlled.
pub fn fail() -> ! {
    finish(false)
}
