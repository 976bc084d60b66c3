//! Fault campaigns: every fault in every state, and what must hold whatever happens.
//!
//! [`checkpoints`] takes a robot through a task and keeps it, buses and all, in each state. [`cases`]
//! lists the faults of a drive. [`inject`] lets a copy of a checkpoint run on with a fault and says how it
//! went; [`campaign`] does that for all of them.
//!
//! What must hold:
//!
//! - No motor's torque is ever above its limit.
//! - The master commands torque in states that permit it alone; a drive gives torque in "operation
//!   enabled" alone; torque ends two cycles after the state that permitted it, or with the drive's own
//!   deadline where nobody can tell the drive.
//! - A fault that can be seen is noticed within five cycles of its first effect, one that shows in
//!   heartbeats only within their timeout; up to four lost cycles are nothing.
//! - Legs are told to come down at most a cycle after the state that keeps them up ends.
//! - Nothing but a reset leads out of "fault, legs down".

mod case;
mod checkpoint;
mod judge;
mod verdict;

pub use case::{Case, Expect, Injection, cases};
pub use checkpoint::{Checkpoint, Subject, checkpoints};
pub use judge::inject;
pub use verdict::{Verdict, Violation};

use crate::Error;
use shapebot_drive::safety::{STATES, State};
use shapebot_dynamics::Robot;
use std::fmt;

/// How much of a campaign is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Every so many of all pairs of checkpoint and case; 1 for all.
    pub stride: usize,
    /// The first of them.
    pub first: usize,
}

/// What came out of a campaign.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Faults injected.
    pub injections: usize,
    /// By state: injections, and those after which a fault was noticed.
    pub by_state: [(usize, usize); STATES.len()],
    /// Most cycles from a fault's effect to its being noticed, where five are allowed.
    pub slowest_cycles: f64,
    /// Most time from the end of a state with legs up to the legs' command, µs.
    pub slowest_legs_us: u64,
    /// Largest lean at touchdown after a fault, rad, and the case.
    pub touchdown: Option<(f64, String)>,
    /// Leans at touchdown, rad, sorted.
    pub touchdowns: Vec<f64>,
    /// What did not hold.
    pub violations: Vec<String>,
}

impl Summary {
    /// Adds how an injection went.
    pub fn add(&mut self, verdict: &Verdict) {
        self.injections += 1;
        if let Some((count, noticed)) = self.by_state.get_mut(verdict.state as usize) {
            *count += 1;
            *noticed += usize::from(verdict.noticed.is_some());
        }
        if verdict.expect == Expect::Cycles
            && let Some(cycles) = verdict.cycles
        {
            self.slowest_cycles = self.slowest_cycles.max(cycles);
        }
        self.slowest_legs_us = self.slowest_legs_us.max(verdict.legs_us.unwrap_or(0));
        if let Some(touchdown) = verdict.touchdown {
            let lean = touchdown.lean;
            self.touchdowns.insert(self.touchdowns.partition_point(|other| *other < lean), lean);
            if self.touchdown.as_ref().is_none_or(|(most, _)| lean > *most) {
                self.touchdown = Some((lean, verdict.name()));
            }
        }
        for violation in &verdict.violations {
            self.violations.push(format!("{}: {violation}", verdict.name()));
        }
    }

    /// Adds another campaign's.
    pub fn join(&mut self, other: Self) {
        self.injections += other.injections;
        for ((count, noticed), (more, too)) in self.by_state.iter_mut().zip(other.by_state) {
            *count += more;
            *noticed += too;
        }
        self.slowest_cycles = self.slowest_cycles.max(other.slowest_cycles);
        self.slowest_legs_us = self.slowest_legs_us.max(other.slowest_legs_us);
        let lean = |touchdown: &Option<(f64, String)>| touchdown.as_ref().map_or(-1.0, |t| t.0);
        if lean(&other.touchdown) > lean(&self.touchdown) {
            self.touchdown = other.touchdown;
        }
        self.touchdowns.extend(other.touchdowns);
        self.touchdowns.sort_by(f64::total_cmp);
        self.violations.extend(other.violations);
    }

    /// A quantile of the leans at touchdown, rad.
    #[must_use]
    pub fn touchdown_quantile(&self, part: f64) -> Option<f64> {
        let last = self.touchdowns.len().checked_sub(1)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "`as` saturates"
        )]
        let place = (part * last as f64).round() as usize;
        self.touchdowns.get(place.min(last)).copied()
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} injections, {} violations", self.injections, self.violations.len())?;
        for (state, (count, noticed)) in STATES.iter().zip(self.by_state) {
            if count > 0 {
                writeln!(f, "  {:16} {count:6}, noticed {noticed:6}", format!("{state:?}"))?;
            }
        }
        writeln!(f, "noticed within {:.2} cycles", self.slowest_cycles)?;
        writeln!(f, "legs commanded within {} µs", self.slowest_legs_us)?;
        let degrees = |part| self.touchdown_quantile(part).unwrap_or(f64::NAN).to_degrees();
        write!(
            f,
            "lean at touchdown: median {:.2}°, 90 % {:.2}°, 99 % {:.2}°",
            degrees(0.5),
            degrees(0.9),
            degrees(0.99)
        )?;
        match &self.touchdown {
            Some((lean, case)) => write!(f, ", most {:.2}° ({case})", lean.to_degrees()),
            None => Ok(()),
        }
    }
}

/// Injects faults at the checkpoints of a task; `each` sees every verdict.
///
/// # Errors
///
/// If the task itself does not succeed without faults.
pub fn campaign<R, const N: usize, const NX: usize, const NS: usize>(
    subject: &Subject<'_, R, N, NX, NS>,
    extent: Extent,
    each: &mut dyn FnMut(&Verdict),
) -> Result<Summary, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let checkpoints = checkpoints(subject)?;
    let cases = cases(subject.description);
    let mut summary = Summary::default();
    let pairs = checkpoints.iter().flat_map(|at| cases.iter().map(move |case| (at, case)));
    let fitting = pairs.filter(|(at, case)| case.fits(at.state, at.powered_up));
    for (index, (at, case)) in fitting.enumerate() {
        if index % extent.stride.max(1) == extent.first {
            let phase = phase(index, subject.description.timing.period_us);
            let verdict = inject(subject, at, case, phase)?;
            each(&verdict);
            summary.add(&verdict);
        }
    }
    Ok(summary)
}

/// Faults come at all times of a cycle.
fn phase(index: usize, period: u32) -> u64 {
    (index as u64).wrapping_mul(619) % u64::from(period.max(1))
}

/// Whether a state is one of those that the campaign calls moving or standing on the ball.
pub(crate) const fn balances(state: State) -> bool {
    state.permits_torque()
}
