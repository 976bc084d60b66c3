//! The cycle: SysTick, and who does what in it.

use crate::Board;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use shapebot_drive::{Fault, Frame};

/// What runs on the board: frames and time in, frames out.
pub trait Application {
    /// A frame of bus `bus` that arrived, in the order of arrival. `now` is in µs since the start.
    fn receive(&mut self, bus: usize, frame: &Frame, now: u64);
    /// A bus takes no frames, or its controller is in trouble: before the cycle in which it is noticed.
    fn fault(&mut self, fault: Fault, now: u64);
    /// Once in a cycle, after the frames: passes on the frames to send.
    fn cycle(&mut self, now: u64, send: &mut dyn FnMut(usize, &Frame));
}

/// Serves the board for ever: waits for a cycle's begin, hands over the frames that came, then sends.
///
/// A frame that finds no room to be sent is lost, which is a fault like a controller's trouble.
pub fn run<B: Board, A: Application>(board: &mut B, application: &mut A) -> ! {
    let mut lost = false;
    loop {
        board.wait();
        while let Some((bus, frame)) = board.receive() {
            application.receive(bus, &frame, board.now());
        }
        let now = board.now();
        let fault = if lost { Some(Fault::Bus) } else { board.fault() };
        if let Some(fault) = fault {
            application.fault(fault, now);
        }
        lost = false;
        application.cycle(now, &mut |bus, frame| lost |= !board.send(bus, frame));
        board.alive();
    }
}

/// Cycles begun since the start; it wraps.
static BEGUN: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    // One writer, and the Cortex-M4 has no other core.
    BEGUN.store(BEGUN.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
}

/// Cycles counted by SysTick.
pub struct Cycles {
    timer: SYST,
    seen: u32,
    count: u64,
    period: u32,
}

impl Cycles {
    /// Starts SysTick.
    ///
    /// `clock` is the core's frequency in Hz, `period` the cycle in µs; together at most 2²⁴ clocks,
    /// the timer's range: a longer period is cut to that.
    #[must_use]
    pub fn start(mut timer: SYST, clock: u32, period: u32) -> Self {
        let clocks = u64::from(clock) * u64::from(period) / 1_000_000;
        let clocks = clocks.clamp(2, 1 << 24) as u32;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(clocks - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        Self { timer, seen: BEGUN.load(Ordering::Acquire), count: 0, period }
    }

    /// Sleeps until a cycle begins that was not waited for before. Returns how many began: more than
    /// one if the last took too long.
    pub fn wait(&mut self) -> u32 {
        loop {
            let begun = BEGUN.load(Ordering::Acquire);
            let new = begun.wrapping_sub(self.seen);
            if new > 0 {
                self.seen = begun;
                self.count += u64::from(new);
                return new;
            }
            cortex_m::asm::wfi();
        }
    }

    /// Begin of the present cycle, µs since the start.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.count * u64::from(self.period)
    }

    /// The timer back, stopped.
    #[must_use]
    pub fn stop(mut self) -> SYST {
        self.timer.disable_interrupt();
        self.timer.disable_counter();
        self.timer
    }
}
