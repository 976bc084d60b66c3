//! Many runs at random.

use crate::Error;
use crate::experiment::Experiment;
use crate::loops::Loops;
use crate::onsets::OnsetOf;
use crate::rows::{Identity, Row};
use crate::scenario::scenario;
use crate::subject::Subject;
use rayon::prelude::*;
use shapebot_planner::value::RobotId;
use shapebot_planning::PlannedMotion;
use shapebot_sim::{Draw, Ranges, Scenario, draw};
use shapebot_tasks::{Method, Task};

/// Part of the runs: `index` of `count`, from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1.
    pub index: u64,
    /// Of how many.
    pub count: u64,
}

impl Shard {
    /// All runs.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Its runs out of `of`: shards in their order are all runs in theirs.
    #[must_use]
    pub fn runs(&self, of: u64) -> std::ops::Range<u64> {
        let bound = |index: u64| {
            let product = u128::from(of) * u128::from(index);
            (product / u128::from(self.count.max(1))) as u64
        };
        bound(self.index.saturating_sub(1))..bound(self.index)
    }
}

/// Runs of a task with everything that is uncertain drawn at random: run k is the same by itself as
/// among others.
pub struct Trials<'a, const N: usize, const NX: usize, const NS: usize> {
    pub(crate) loops: Loops<'a, N, NX, NS>,
    /// What the task says, onto which draws are put.
    pub(crate) base: Scenario<NX, NS>,
    ranges: Ranges,
    identity: Identity,
}

impl<'a, const N: usize, const NX: usize, const NS: usize> Trials<'a, N, NX, NS> {
    /// `of` runs of a planned task from a seed; `name` is that of the task.
    ///
    /// # Errors
    ///
    /// As [`crate::run`].
    pub fn new(
        subject: Subject<'a, N, NX, NS>,
        (name, task): (&str, &'a Task),
        planned: &'a PlannedMotion,
        id: &RobotId<'_>,
        [seed, of]: [u64; 2],
    ) -> Result<Self, Error> {
        let loops = Loops::new(subject, task, planned, id)?;
        let method = match task.method {
            Method::Gain => "gain",
            Method::Refined => "refined",
        };
        let identity = Identity {
            task: name.replace([',', '\n', '\r', '"'], "_"),
            method: method.to_owned(),
            robot: format!("{}:{:08x}", id.name(), id.fingerprint()),
            seed,
            of,
        };
        Ok(Self {
            base: scenario(subject.model, &task.simulation)?,
            ranges: Ranges::default(),
            loops,
            identity,
        })
    }

    fn draw(&self, run: u64) -> Draw<NX, NS> {
        let description = self.loops.subject.model.description();
        let from = [self.identity.seed, run];
        let duration = self.loops.duration();
        let mut draw = draw(description, &self.loops.scale, &self.ranges, duration, from);
        draw.scenario.weights.clone_from(&self.base.weights);
        draw.scenario.strength = self.base.strength;
        draw.scenario.pushes.extend_from_slice(&self.base.pushes);
        draw
    }

    fn row(&self, run: u64) -> Result<Row, Error> {
        let draw = self.draw(run);
        let plant = self.loops.plant(&draw.parameters)?;
        let description = self.loops.subject.model.description();
        let done = self.loops.run(&*plant, &draw.scenario, None)?;
        Ok(Row::of(&self.identity, run, description, &draw.scenario, &done))
    }
}

/// Random runs of a task, whatever the robot's sizes.
pub trait Runs: Sync {
    /// The runs of a shard in their order, on all processors; `done` is called after each.
    ///
    /// # Errors
    ///
    /// As [`crate::run`].
    fn rows(&self, shard: Shard, done: &(dyn Fn() + Sync)) -> Result<Vec<Row>, Error>;

    /// One of the runs, by itself: its row, and its record.
    ///
    /// # Errors
    ///
    /// As [`crate::run`].
    fn replay(&self, run: u64) -> Result<(Row, Experiment), Error>;

    /// Where falls begin, each disturbance alone: delay of the actuators, mass of the heaviest part, a
    /// push of a tenth of a second at the highest point in the middle of the motion, bias of the lean.
    /// `done` is called after each.
    ///
    /// # Errors
    ///
    /// As [`crate::run`].
    fn onsets(&self, done: &(dyn Fn() + Sync)) -> Result<Vec<OnsetOf>, Error>;
}

impl<const N: usize, const NX: usize, const NS: usize> Runs for Trials<'_, N, NX, NS> {
    fn rows(&self, shard: Shard, done: &(dyn Fn() + Sync)) -> Result<Vec<Row>, Error> {
        let runs = shard.runs(self.identity.of).into_par_iter();
        let row = |run| {
            let row = self.row(run);
            done();
            row
        };
        runs.map(row).collect()
    }

    fn replay(&self, run: u64) -> Result<(Row, Experiment), Error> {
        let draw = self.draw(run);
        let plant = self.loops.plant(&draw.parameters)?;
        let experiment = self.loops.recorded(&*plant, &draw.scenario)?;
        Ok((self.row(run)?, experiment))
    }

    fn onsets(&self, done: &(dyn Fn() + Sync)) -> Result<Vec<OnsetOf>, Error> {
        let trials = self.disturbances();
        let found = trials.par_iter().map(|trial| {
            let found = self.onset(trial);
            done();
            found
        });
        found.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn shards_in_a_row_are_the_whole() {
        for (of, count) in [(10, 3), (7, 7), (5, 8), (1000, 1), (u64::MAX, 5)] {
            let mut next = 0;
            for index in 1..=count {
                let runs = Shard { index, count }.runs(of);
                assert_eq!(runs.start, next, "shard {index} of {count}");
                next = runs.end;
            }
            assert_eq!(next, of);
        }
    }
}
