//! Runs as lines of text, which merge by concatenation.

use nalgebra::SVector;
use shapebot_dynamics::Description;
use shapebot_sim::{Run, Scenario};
use std::fmt;

/// Head of the columns, without a line's end.
pub const HEAD: &str = "task,method,robot,seed,of,run,fell,fell_at,plan_rmse,desired_rmse,plan_max,\
    end_error,compensation,saturated,drive_viscous,drive_coulomb,contact_viscous,contact_coulomb,\
    delay_sensors,delay_actuators,lean_noise,rate_noise,bias,slope,start_position,start_lean";

/// Numbers of a row behind its identity and fall.
const NUMBERS: usize = 18;

/// What all rows of a set of runs share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The task's name.
    pub task: String,
    /// How it was planned.
    pub method: String,
    /// Name and fingerprint of the robot's parameters.
    pub robot: String,
    /// Of the draws.
    pub seed: u64,
    /// How many runs there are.
    pub of: u64,
}

/// One random run.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What it is part of.
    pub identity: Identity,
    /// Its number, from zero.
    pub run: u64,
    /// The coordinate that left its range, and when, if it fell.
    pub fell: Option<(String, f64)>,
    /// In the order of [`HEAD`], from `plan_rmse`; SI units.
    pub numbers: [f64; NUMBERS],
}

impl Row {
    pub(crate) fn of<const N: usize, const NX: usize, const NS: usize>(
        identity: &Identity,
        run: u64,
        robot: &Description,
        scenario: &Scenario<NX, NS>,
        done: &Run<N, NX, NS>,
    ) -> Self {
        let (errors, sensors) = (&done.errors, &scenario.sensors);
        let name = |index: usize| robot.coordinates.get(index).map_or("", |c| c.name);
        let norm = |v: &SVector<f64, NS>| v.norm();
        let [slope_x, slope_y] = scenario.floor.slope;
        Self {
            identity: identity.clone(),
            run,
            fell: done.fell.map(|fall| (name(fall.coordinate).to_owned(), fall.time)),
            numbers: [
                errors.plan_rmse,
                errors.desired_rmse,
                errors.plan_max,
                errors.end_error,
                errors.compensation_peak.max(),
                errors.saturated,
                scenario.drive.viscous,
                scenario.drive.coulomb,
                scenario.contact.viscous,
                scenario.contact.coulomb,
                sensors.delay,
                scenario.actuation_delay,
                sensors.lean_noise,
                sensors.lean_rate_noise,
                norm(&sensors.lean_bias),
                slope_x.hypot(slope_y),
                scenario.start_position.norm(),
                norm(&scenario.start_shape),
            ],
        }
    }

    /// Root of the mean squared distance from the plan.
    #[must_use]
    pub const fn plan_rmse(&self) -> f64 {
        self.numbers[0]
    }

    /// Distance from the goal at the end.
    #[must_use]
    pub const fn end_error(&self) -> f64 {
        self.numbers[3]
    }

    /// From a line of text; `None` if it is none.
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let mut cells = line.split(',');
        let mut text = || cells.next().map(str::to_owned);
        let (task, method, robot) = (text()?, text()?, text()?);
        let mut whole = || text()?.parse::<u64>().ok();
        let (seed, of, run) = (whole()?, whole()?, whole()?);
        let (fell, at) = (text()?, text()?);
        let fell = match (fell.is_empty(), at.is_empty()) {
            (true, true) => None,
            (false, false) => Some((fell, at.parse().ok()?)),
            _ => return None,
        };
        let mut numbers = [0.0; NUMBERS];
        for number in &mut numbers {
            *number = text()?.parse().ok()?;
        }
        let identity = Identity { task, method, robot, seed, of };
        (text().is_none() && run < of).then_some(Self { identity, run, fell, numbers })
    }
}

impl fmt::Display for Row {
    /// The line of text, without its end. Numbers read back as they were.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Identity { task, method, robot, seed, of } = &self.identity;
        write!(f, "{task},{method},{robot},{seed},{of},{}", self.run)?;
        match &self.fell {
            Some((coordinate, time)) => write!(f, ",{coordinate},{time}")?,
            None => write!(f, ",,")?,
        }
        self.numbers.iter().try_for_each(|number| write!(f, ",{number}"))
    }
}

/// Why files are not the runs of one whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MergeError {
    /// A line is no row.
    Malformed {
        /// File.
        file: String,
        /// From one.
        line: usize,
    },
    /// A row is of another task, method, robot, seed or number of runs.
    Different {
        /// File.
        file: String,
        /// From one.
        line: usize,
        /// What differs.
        what: &'static str,
    },
    /// A run is there twice.
    Overlap {
        /// Which.
        run: u64,
        /// The file that has it again.
        file: String,
    },
    /// Runs are missing.
    Gap {
        /// The first of them.
        first: u64,
        /// The last of them.
        last: u64,
    },
    /// There is no row at all.
    Empty,
}

impl fmt::Display for MergeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed { file, line } => write!(f, "{file}:{line}: this is no row of runs"),
            Self::Different { file, line, what } => {
                write!(f, "{file}:{line}: this run is of another {what} than the first one")
            }
            Self::Overlap { run, file } => write!(f, "{file}: run {run} is there twice"),
            Self::Gap { first, last } if first == last => write!(f, "run {first} is missing"),
            Self::Gap { first, last } => write!(f, "runs {first} to {last} are missing"),
            Self::Empty => f.write_str("there are no runs"),
        }
    }
}

impl std::error::Error for MergeError {}

/// Puts shards together, given as names and texts of files in any order, with or without a head.
///
/// # Errors
///
/// Lines that are no rows, rows of different sets of runs, runs that are missing or there twice.
pub fn merge(files: &[(String, String)]) -> Result<Vec<Row>, MergeError> {
    let mut rows: Vec<(Row, &String)> = Vec::new();
    for (file, text) in files {
        for (index, line) in text.lines().enumerate().filter(|(_, line)| *line != HEAD) {
            let line_number = index + 1;
            let malformed = || MergeError::Malformed { file: file.clone(), line: line_number };
            let row = Row::parse(line).ok_or_else(malformed)?;
            if let Some((first, _)) = rows.first()
                && let Some(what) = difference(&first.identity, &row.identity)
            {
                let file = file.clone();
                return Err(MergeError::Different { file, line: line_number, what });
            }
            rows.push((row, file));
        }
    }
    rows.sort_by_key(|(row, _)| row.run);
    let of = rows.first().ok_or(MergeError::Empty)?.0.identity.of;
    let mut next = 0;
    for (row, file) in &rows {
        if row.run < next {
            return Err(MergeError::Overlap { run: row.run, file: (*file).clone() });
        }
        if row.run > next {
            return Err(MergeError::Gap { first: next, last: row.run - 1 });
        }
        next += 1;
    }
    if next < of {
        return Err(MergeError::Gap { first: next, last: of - 1 });
    }
    Ok(rows.into_iter().map(|(row, _)| row).collect())
}

fn difference(a: &Identity, b: &Identity) -> Option<&'static str> {
    let parts = [
        (a.task == b.task, "task"),
        (a.method == b.method, "method"),
        (a.robot == b.robot, "robot, or of other parameters,"),
        (a.seed == b.seed, "seed"),
        (a.of == b.of, "number of runs"),
    ];
    parts.into_iter().find(|(same, _)| !same).map(|(_, what)| what)
}

#[cfg(test)]
mod tests {
    use super::{HEAD, Identity, MergeError, NUMBERS, Row, merge};

    fn row(run: u64, of: u64) -> Row {
        let identity =
            Identity { task: "t".into(), method: "gain".into(), robot: "r:0".into(), seed: 3, of };
        let fell = (run % 2 == 1).then(|| ("phi".to_owned(), 0.1 + run as f64 / 3.0));
        Row { identity, run, fell, numbers: [1.0 / (run as f64 + 3.0); NUMBERS] }
    }

    fn file(name: &str, runs: &[u64], of: u64) -> (String, String) {
        let lines = runs.iter().map(|run| format!("{}\n", row(*run, of)));
        (name.to_owned(), lines.collect())
    }

    #[test]
    fn rows_read_back_as_they_were() {
        for run in 0..4 {
            assert_eq!(Row::parse(&row(run, 9).to_string()), Some(row(run, 9)));
        }
        assert_eq!(HEAD.split(',').count(), row(0, 1).to_string().split(',').count());
        assert_eq!(Row::parse(HEAD), None);
        assert_eq!(Row::parse(&format!("{},1", row(0, 9))), None);
    }

    #[test]
    fn shards_merge_in_any_order_and_never_with_gaps_or_overlaps() {
        let headed = ("a".to_owned(), format!("{HEAD}\n{}", file("a", &[0, 1], 5).1));
        let rest = file("b", &[2, 3, 4], 5);
        let merged = merge(&[rest.clone(), headed.clone()]).unwrap();
        assert_eq!(merged, (0..5).map(|run| row(run, 5)).collect::<Vec<_>>());
        let gap = |first, last| MergeError::Gap { first, last };
        assert_eq!(merge(std::slice::from_ref(&headed)), Err(gap(2, 4)));
        assert_eq!(merge(std::slice::from_ref(&rest)), Err(gap(0, 1)));
        assert_eq!(merge(&[file("a", &[0, 3, 4], 5)]), Err(gap(1, 2)));
        let twice = merge(&[headed.clone(), file("b", &[1, 2, 3, 4], 5)]);
        assert!(matches!(twice, Err(MergeError::Overlap { run: 1, .. })));
        let other = merge(&[headed, file("b", &[2, 3, 4, 5], 6)]);
        let expected = MergeError::Different { file: "b".into(), line: 1, what: "number of runs" };
        assert_eq!(other, Err(expected));
        let broken = merge(&[("c".into(), "x\n".into())]);
        assert_eq!(broken, Err(MergeError::Malformed { file: "c".into(), line: 1 }));
        assert_eq!(merge(&[]), Err(MergeError::Empty));
    }
}
