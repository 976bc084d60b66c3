//! Arm MPS2 with application note 386 (Cortex-M4F), as QEMU emulates it: `-M mps2-an386`.
//!
//! It has no CAN controller: frames go as slcan lines through UART 0. Semihosting prints and ends the
//! program. Nothing here is meant for real hardware.

use super::Board;
use crate::Cycles;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{debug, hprintln};
use shapebot_bus::slcan::codec::{Command, Decoder, Token, command, encode};
use shapebot_drive::{Fault, Frame};

/// Frequency of the core, Hz.
pub const CLOCK: u32 = 25_000_000;

/// Registers of a CMSDK UART (Arm DDI 0479).
#[repr(C)]
struct Registers {
    data: u32,
    /// Bit 0: transmit buffer full; bit 1: receive buffer full.
    state: u32,
    /// Bit 0: transmitter on; bit 1: receiver on.
    control: u32,
    interrupt: u32,
    /// At least 16.
    divider: u32,
}

/// One of the first two UARTs. There is one of each: it is handed out once.
#[derive(Debug)]
pub struct Uart(*mut Registers);

impl Uart {
    /// Switches UART 0 on. `None` if that was done before.
    #[must_use]
    pub fn take() -> Option<Self> {
        static TAKEN: AtomicBool = AtomicBool::new(false);
        Self::start(0x4000_4000, &TAKEN)
    }

    /// Switches UART 1 on. `None` if that was done before.
    #[must_use]
    pub fn take_second() -> Option<Self> {
        static TAKEN: AtomicBool = AtomicBool::new(false);
        Self::start(0x4000_5000, &TAKEN)
    }

    fn start(address: usize, taken: &AtomicBool) -> Option<Self> {
        if taken.swap(true, Ordering::Relaxed) {
            return None;
        }
        let registers = address as *mut Registers;
        // SAFETY: the registers of a UART are there on this board, and `taken` makes this the only user.
        unsafe {
            (&raw mut (*registers).divider).write_volatile(16);
            (&raw mut (*registers).control).write_volatile(0b11);
        }
        Some(Self(registers))
    }

    fn state(&self) -> u32 {
        // SAFETY: as in `start`; reading the state has no effect.
        unsafe { (&raw const (*self.0).state).read_volatile() }
    }
}

/// A line of bytes, without waiting.
pub trait Serial {
    /// A byte if one has come.
    fn read(&mut self) -> Option<u8>;
    /// Sends a byte; `false` if there is no room yet.
    fn write(&mut self, byte: u8) -> bool;
}

impl Serial for Uart {
    fn read(&mut self) -> Option<u8> {
        if self.state() & 0b10 == 0 {
            return None;
        }
        // SAFETY: as in `start`; the receive buffer is full.
        Some(unsafe { (&raw const (*self.0).data).read_volatile() as u8 })
    }

    fn write(&mut self, byte: u8) -> bool {
        let room = self.state() & 0b1 == 0;
        if room {
            // SAFETY: as in `start`; the transmit buffer is empty.
            unsafe { (&raw mut (*self.0).data).write_volatile(u32::from(byte)) };
        }
        room
    }
}

/// The board with one bus behind UART 0.
pub struct Mps2An386 {
    uart: Uart,
    decoder: Decoder,
    cycles: Cycles,
}

impl Mps2An386 {
    /// Starts cycles of `period` µs. `None` if the board is in use already.
    #[must_use]
    pub fn new(period: u32) -> Option<Self> {
        let peripherals = cortex_m::Peripherals::take()?;
        let cycles = Cycles::start(peripherals.SYST, CLOCK, period);
        Some(Self { uart: Uart::take()?, decoder: Decoder::default(), cycles })
    }
}

impl Board for Mps2An386 {
    fn wait(&mut self) {
        self.cycles.wait();
    }

    fn now(&self) -> u64 {
        self.cycles.now()
    }

    fn receive(&mut self) -> Option<(usize, Frame)> {
        while let Some(byte) = self.uart.read() {
            if let Some(Token::Line(line)) = self.decoder.push(byte)
                && let Ok(Command::Send(frame)) = command(&line)
            {
                return Some((0, frame));
            }
        }
        None
    }

    fn send(&mut self, bus: usize, frame: &Frame) -> bool {
        if bus > 0 {
            return false;
        }
        let line = encode(frame, None);
        for byte in line.as_bytes() {
            // The emulated line is always faster than the program.
            while !self.uart.write(*byte) {}
        }
        true
    }

    /// A serial line has no controller whose state could be asked.
    fn fault(&self) -> Option<Fault> {
        None
    }

    fn alive(&mut self) {}
}

/// Counts instructions through SysTick: under `-icount shift=0` one takes one nanosecond, a clock of
/// the core 40.
pub struct Instructions {
    timer: SYST,
    last: u32,
}

impl Instructions {
    /// Instructions in a tick of SysTick.
    pub const PER_TICK: u32 = 1_000_000_000 / CLOCK;

    const MASK: u32 = 0x00FF_FFFF;

    /// Starts the timer, without interrupts. `None` if it is in use already.
    #[must_use]
    pub fn start() -> Option<Self> {
        let mut timer = cortex_m::Peripherals::take()?.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(Self::MASK);
        timer.clear_current();
        timer.enable_counter();
        Some(Self { timer, last: SYST::get_current() })
    }

    /// Ticks since this was last called, modulo 2²⁴: two thirds of a second.
    pub fn ticks(&mut self) -> u32 {
        let now = SYST::get_current();
        // The timer counts down.
        let spent = self.last.wrapping_sub(now) & Self::MASK;
        self.last = now;
        spent
    }

    /// Stops the timer.
    pub fn stop(mut self) {
        self.timer.disable_counter();
    }
}

/// Ends the emulator, with exit code 0 or 1.
pub fn finish(success: bool) -> ! {
    let status = if success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE };
    loop {
        debug::exit(status);
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let _ = hprintln!("{}", info);
    finish(false)
}
