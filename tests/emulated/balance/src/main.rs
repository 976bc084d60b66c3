//! The control step of the ballbot as firmware: its buses are slcan on two UARTs, its clock is the
//! simulation's, its operator is on the bus, its plan file is in the external memory.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use shapebot_answers::ballbot3d::DRIVE;
use shapebot_control::Gains;
use shapebot_drive::operator::{Operator, PlanStore};
use shapebot_drive::{Fault, Frame};
use shapebot_firmware::board::{Lockstep, finish};
use shapebot_firmware::{Application, run};
use shapebot_generated::ballbot3d::{Ballbot3d, CONTROL};
use shapebot_planner::value::PlanView;
use shapebot_runtime::{Runtime, Settings};

/// From tick to tick, µs.
const TICK: u32 = 200;

/// Where the plan is: its length in four bytes, then the file. 16 MB of RAM begin there.
const PLAN: *const u8 = 0x2100_0000 as *const u8;

/// Most bytes of a plan.
const LONGEST: usize = 1 << 20;

/// The plan file that was put into memory before the start.
fn plan() -> &'static [u8] {
    // SAFETY: the memory is there on this board, nobody writes to it, and all bytes are values.
    let room = unsafe { core::slice::from_raw_parts(PLAN, 4 + LONGEST) };
    let (length, rest) = room.split_first_chunk::<4>().unwrap_or((&[0; 4], &[]));
    rest.get(..u32::from_le_bytes(*length) as usize).unwrap_or_default()
}

struct Robot<'a> {
    runtime: Runtime<'a, Ballbot3d<f32>, f32, 4, 2, 2>,
    operator: Operator<'a>,
}

impl Application for Robot<'_> {
    fn receive(&mut self, bus: usize, frame: &Frame, now: u64) {
        self.runtime.receive(bus, frame, now);
        let to = &DRIVE.operator;
        if bus == usize::from(to.bus) && frame.standard_id() == Some(to.command) {
            // Telemetry tells why a command is refused.
            let _ = self.operator.receive(frame.bytes(), &mut self.runtime, now);
        }
    }

    fn fault(&mut self, fault: Fault, now: u64) {
        self.runtime.report(fault, now);
    }

    fn cycle(&mut self, now: u64, send: &mut dyn FnMut(usize, &Frame)) {
        self.runtime.poll(now, &mut |bus, frame| send(bus, &frame));
        if let Some(page) = self.operator.telemetry(self.runtime.master(), &self.runtime.tuned()) {
            let to = &DRIVE.operator;
            send(usize::from(to.bus), &Frame::new(to.telemetry, &page));
        }
    }
}

#[entry]
fn main() -> ! {
    let robot = Ballbot3d::<f32>::default();
    let Ok(mut gains) = Gains::from_design(&robot, &CONTROL) else { finish(false) };
    gains.period = DRIVE.timing.period_us as f32 * 1e-6;
    let runtime = Runtime::new(&robot, &DRIVE, &gains, &Settings::default());
    let (Ok(mut runtime), Some(mut board)) = (runtime, Lockstep::new(TICK)) else { finish(false) };
    let Ok(plan) = PlanView::open_any(plan()) else { finish(false) };
    if runtime.load(plan).is_err() {
        finish(false);
    }
    let store = PlanStore::new(&mut [], &mut []);
    let operator = Operator::new(DRIVE.fingerprint, store);
    run(&mut board, &mut Robot { runtime, operator })
}
