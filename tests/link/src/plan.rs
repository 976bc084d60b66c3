//! Plans as values.

use crate::{unknown, with_bytes};
use core::hint::black_box;
use shapebot_planner::value::{PlanView, Stored};

/// Reads a plan file and evaluates it.
pub(crate) fn of_any_bytes<T: Stored, const NX: usize, const NS: usize, const F: usize>() {
    with_bytes(|bytes| {
        if let Ok(plan) = PlanView::<T, NX, NS, F>::open_any(bytes) {
            black_box((plan.start_time(), plan.end_time(), plan.nodes()));
            black_box(plan.at(T::from_f64(unknown(1.0))));
        }
    });
}
