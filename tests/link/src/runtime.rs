//! Controller and runtime of the ballbot with arms, and the operator's end.

use crate::drive::tables;
use crate::{unknown, with_bytes};
use core::hint::black_box;
use shapebot_control::{Controller, Gains, State, Target};
use shapebot_drive::operator::{Operator, PlanStore, command, stream};
use shapebot_drive::safety::{Request, State as Safety};
use shapebot_drive::{Fault, Frame};
use shapebot_dynamics::nalgebra::SVector;
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL};
use shapebot_planner::value::PlanView;
use shapebot_runtime::{Runtime, Settings};

fn gains(robot: &Ballbot3dArms<f32>) -> Option<Gains<f32, 2, 6>> {
    Gains::from_design(robot, &unknown(CONTROL)).ok().map(unknown)
}

/// Steps of a controller with any gains on any states and targets.
pub(crate) fn controller_of_any_numbers() {
    let robot = unknown(Ballbot3dArms::<f32>::default());
    let Some(gains) = gains(&robot) else { return };
    let Ok(mut controller) = Controller::new(&robot, &gains) else { return };
    let rest = SVector::from([0.0; 8]);
    while unknown(true) {
        let state = unknown(State { q: rest, qd: rest });
        let target = unknown(Target::stand(SVector::from([0.0; 2])));
        black_box(controller.step(&state, &target));
        if unknown(true) {
            controller.reset();
        }
    }
}

/// All that a runtime is asked for, in any order, with tables, frames and plans of any content.
pub(crate) fn runtime_of_any_tables() {
    let robot = unknown(Ballbot3dArms::<f32>::default());
    let table = unknown(tables());
    let file = unknown([0; 4096]);
    let Some(gains) = gains(&robot) else { return };
    let settings = unknown(Settings::default());
    let Ok(mut runtime) = Runtime::new(&robot, &table, &gains, &settings) else { return };
    let (mut active, mut pending) = ([0; 512], [0; 512]);
    let store =
        PlanStore::new(with_length(&mut active, unknown(9)), with_length(&mut pending, unknown(9)));
    let mut operator = Operator::new(unknown(0), store);
    let mut out = |bus: usize, frame: Frame| {
        black_box((bus, frame));
    };
    while unknown(true) {
        let now = unknown(0_u64);
        match unknown(0) {
            0 => with_bytes(|bytes| {
                runtime.receive(unknown(0), &Frame::new(unknown(0), bytes), now);
            }),
            1 => runtime.poll(now, &mut out),
            2 => {
                black_box(runtime.request(unknown(Request::Start), now));
            }
            3 => runtime.report(unknown(Fault::EmergencyStop), now),
            4 => {
                if let Ok(plan) = PlanView::open_any(file.get(..unknown(9)).unwrap_or(&file)) {
                    black_box(runtime.load(plan).is_ok());
                }
            }
            5 => with_bytes(|bytes| {
                black_box(operator.receive(bytes, &mut runtime, now).is_ok());
            }),
            6 => {
                black_box(operator.telemetry(runtime.master(), &runtime.tuned()));
            }
            7 => {
                let swapped = operator.plans().swap(unknown(Safety::Off), |_| unknown(true));
                black_box((swapped.is_ok(), operator.plans().active().map(<[u8]>::len)));
            }
            _ => {
                black_box((runtime.next_wake(), runtime.snapshot().cycle));
            }
        }
    }
}

fn with_length(bytes: &mut [u8], length: usize) -> &mut [u8] {
    bytes.get_mut(..length).unwrap_or_default()
}

/// The operator protocol's both ends.
pub(crate) fn operator_of_any_bytes() {
    with_bytes(|bytes| {
        let mut reader = stream::Reader::default();
        for byte in bytes {
            black_box(reader.push(*byte));
        }
        let mut record = [0; stream::LONGEST];
        black_box((stream::encode(bytes, &mut record), record));
        if let Ok((order, sequence)) = command::decode(bytes, unknown(0)) {
            black_box(command::encode(order, sequence, unknown(0)));
        }
        black_box(command::encode_chunk(unknown(0), bytes));
    });
}
