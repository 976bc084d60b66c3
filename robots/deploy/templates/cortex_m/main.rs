//! The robot's program on a microcontroller.
//!
//! SysTick begins [`TURNS`] turns in each period of the drive. The runtime sends SYNC in the first of them,
//! and runs the controller in the turn in which the inputs are complete or their time is over.
#![no_std]
#![no_main]

mod board;

use cortex_m_rt::entry;
use robot::{CONTROL, DESCRIPTION, DRIVE, N, NS, NX, PLAN, ROBOT, Robot};
use shapebot_control::Gains;
use shapebot_drive::operator::{Operator, PlanStore};
use shapebot_drive::{Fault, Frame};
use shapebot_firmware::{Application, run};
use shapebot_planner::value::{PlanView, RobotId};
use shapebot_runtime::{Runtime, Settings};

/// Turns in a period of the drive.
const TURNS: u32 = 8;

struct Control {
    runtime: Runtime<'static, Robot, f32, N, NX, NS>,
    operator: Operator<'static>,
}

impl Control {
    /// `None` if robot, gains, drive and plan do not fit together; the crate's tests would have said so.
    fn new() -> Option<Self> {
        let mut gains = Gains::<f32, NX, NS>::from_design(&ROBOT, &CONTROL).ok()?;
        gains.period = DRIVE.timing.period_us as f32 * 1e-6;
        let mut runtime = Runtime::new(&ROBOT, &DRIVE, &gains, &Settings::default()).ok()?;
        if let Some(bytes) = PLAN {
            let plan = PlanView::open(bytes, &RobotId::of(&DESCRIPTION)).ok()?;
            runtime.load(plan).ok()?;
        }
        // No buffers: this target's plan is the one that it was built with.
        let plans = PlanStore::new(&mut [], &mut []);
        Some(Self { runtime, operator: Operator::new(DRIVE.fingerprint, plans) })
    }
}

impl Application for Control {
    fn receive(&mut self, bus: usize, frame: &Frame, now: u64) {
        self.runtime.receive(bus, frame, now);
        let operator = &DRIVE.operator;
        if frame.standard_id() == Some(operator.command) && bus == usize::from(operator.bus) {
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
            let operator = &DRIVE.operator;
            send(operator.bus.into(), &Frame::new(operator.telemetry, &page));
        }
    }
}

#[entry]
fn main() -> ! {
    let Some(mut control) = Control::new() else { board::fail() };
    let Some(mut own) = board::start(DRIVE.timing.period_us / TURNS) else { board::fail() };
    run(&mut own, &mut control)
}
