//! `vcan-echo INTERFACE COUNT PERIOD`: sends COUNT frames, one every PERIOD µs, to a second socket that
//! answers each, and fails if an answer is missing or wrong.

use shapebot_bus::BusError;
use std::process::ExitCode;

#[cfg(target_os = "linux")]
mod echo {
    use shapebot_bus::{Bus as _, BusError, Frame, SocketBus};

    /// Identifiers of requests and answers.
    const IDS: (u16, u16) = (0x201, 0x181);

    /// How long an answer may take, µs: nothing is claimed of latency.
    const PATIENCE: u64 = 1_000_000;

    /// Answers `count` requests with their bytes in reverse.
    fn answer(bus: &mut SocketBus, count: u32) -> Result<(), BusError> {
        for _ in 0..count {
            let deadline = bus.now() + 10 * PATIENCE;
            let Some(request) = bus.receive(deadline)? else { return Ok(()) };
            let mut bytes = request.frame.exactly::<4>().unwrap_or_default();
            bytes.reverse();
            bus.send(&Frame::new(IDS.1, &bytes))?;
        }
        Ok(())
    }

    /// Returns the answers that came as expected.
    pub(crate) fn run(interface: &str, count: u32, period: u64) -> Result<u32, BusError> {
        let mut bus = SocketBus::open(interface)?;
        let mut other = SocketBus::open(interface)?;
        let server = std::thread::spawn(move || answer(&mut other, count));
        let start = bus.now();
        let mut right = 0;
        for k in 0..count {
            while bus.receive(start + u64::from(k) * period)?.is_some() {}
            bus.send(&Frame::new(IDS.0, &k.to_le_bytes()))?;
            let deadline = bus.now() + PATIENCE;
            let answer = bus.receive(deadline)?.map(|answer| answer.frame);
            right += u32::from(answer == Some(Frame::new(IDS.1, &k.to_be_bytes())));
        }
        server.join().unwrap_or(Ok(()))?;
        Ok(right)
    }
}

#[cfg(not(target_os = "linux"))]
mod echo {
    use shapebot_bus::BusError;

    pub(crate) fn run(_: &str, _: u32, _: u64) -> Result<u32, BusError> {
        Err(BusError::Unsupported("SocketCAN on this system"))
    }
}

fn arguments() -> Option<(String, u32, u64)> {
    let mut words = std::env::args().skip(1);
    Some((words.next()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?))
}

#[allow(clippy::print_stdout, clippy::print_stderr)] // A program.
fn main() -> ExitCode {
    let Some((interface, count, period)) = arguments() else {
        eprintln!("vcan-echo INTERFACE COUNT PERIOD");
        return ExitCode::from(2);
    };
    let result: Result<u32, BusError> = echo::run(&interface, count, period);
    match result {
        Ok(right) => {
            println!("{right} of {count} answered");
            ExitCode::from(u8::from(right != count))
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
