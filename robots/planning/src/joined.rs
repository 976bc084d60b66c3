//! Phases in a row as one motion.

use crate::motion::{Phase, PlanFiles, PlannedMotion, Row};
use crate::phase::Planned;
use crate::{Samples, Shaped};
use shapebot_tasks::Task;
use std::time::Duration;

/// The phases of a plan, one after the other.
pub(crate) struct Joined<const NX: usize, const NS: usize> {
    pub(crate) samples: Samples<NX, NS>,
    phases: Vec<Phase>,
    elapsed: Duration,
    duration: f64,
    floor: Result<f64, &'static str>,
    peak_force: Vec<f64>,
}

impl<const NX: usize, const NS: usize> Joined<NX, NS> {
    pub(crate) fn of(planned: Vec<Planned<NX, NS>>) -> Self {
        let floor = floor(&planned);
        let mut joined = Self {
            samples: Vec::new(),
            phases: Vec::new(),
            elapsed: Duration::ZERO,
            duration: 0.0,
            floor,
            peak_force: Vec::new(),
        };
        for mut phase in planned {
            // Phases share the sample where they meet.
            let shared = usize::from(!joined.samples.is_empty());
            for row in &mut phase.samples {
                row.plan.time += joined.duration;
            }
            joined.samples.extend(phase.samples.drain(shared..));
            joined.elapsed += phase.elapsed;
            joined.duration += phase.duration;
            joined.add_forces(&phase.peak_force);
            joined.phases.push(phase.phase);
        }
        joined
    }

    fn add_forces(&mut self, peaks: &[f64]) {
        self.peak_force.resize(peaks.len(), 0.0);
        for (most, peak) in self.peak_force.iter_mut().zip(peaks) {
            *most = most.max(*peak);
        }
    }

    pub(crate) fn motion(
        self,
        robot: &Shaped<'_, NX, NS>,
        task: &Task,
        files: PlanFiles,
    ) -> PlannedMotion {
        let errors: Vec<(f64, f64)> = self
            .samples
            .iter()
            .map(|row| (row.plan.time, row.output_error().dot(&row.output_error())))
            .collect();
        let slack = 1e-9 * self.duration;
        let within = errors.iter().filter(|(t, _)| (-slack..=self.duration + slack).contains(t));
        let peak = |index: usize| {
            self.samples.iter().fold(0.0, |peak: f64, row| peak.max(row.plan.shape[index].abs()))
        };
        PlannedMotion {
            description: *robot.shape_description(),
            method: task.method,
            output_rmse: root_mean(errors.iter().map(|(_, square)| *square)),
            motion_rmse: root_mean(within.map(|(_, square)| *square)),
            floor: self.floor,
            output_max_error: errors.iter().fold(0.0_f64, |most, (_, e)| most.max(*e)).sqrt(),
            output_end_error: errors.last().map_or(0.0, |(_, square)| square.sqrt()),
            peak_shape: (0..NS).map(peak).collect(),
            peak_force: self.peak_force,
            elapsed: self.elapsed,
            rows: self.samples.iter().map(Row::of).collect(),
            phases: self.phases,
            files,
        }
    }
}

/// The floor over all phases: that of each, for plans whose shape is at rest where phases meet.
fn floor<const NX: usize, const NS: usize>(
    planned: &[Planned<NX, NS>],
) -> Result<f64, &'static str> {
    let (mut squares, mut duration) = (0.0, 0.0);
    for phase in planned {
        squares += phase.floor?.powi(2) * phase.window;
        duration += phase.window;
    }
    Ok(f64::sqrt(squares / duration))
}

fn root_mean(squares: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = squares.fold((0.0, 0.0), |(count, sum), square| (count + 1.0, sum + square));
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}
