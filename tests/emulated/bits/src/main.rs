//! Runs the steps of `shapebot-emulated` on the emulated Cortex-M4F and prints a line for each: name,
//! evaluations, checksum of the results, instructions on average and of the longest.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;
use shapebot_emulated::{COUNT, all};
use shapebot_firmware::board::{Instructions, finish};

#[entry]
fn main() -> ! {
    let Some(mut timer) = Instructions::start() else { finish(false) };
    all(COUNT, &mut || timer.ticks(), &mut |outcome| {
        let mean = outcome.ticks * u64::from(Instructions::PER_TICK) / u64::from(outcome.count);
        let longest = outcome.longest * Instructions::PER_TICK;
        let (name, count, checksum) = (outcome.name, outcome.count, outcome.checksum);
        hprintln!("bits {} {} {:016x} {} {}", name, count, checksum, mean, longest);
    });
    timer.stop();
    finish(true)
}
