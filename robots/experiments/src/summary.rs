//! What many runs say together.

use crate::rows::Row;

/// Values that half, nine tenths, 99 of 100 and all runs stay within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Percentiles {
    /// Half of them.
    pub median: f64,
    /// Nine tenths.
    pub p90: f64,
    /// 99 of 100.
    pub p99: f64,
    /// All of them.
    pub largest: f64,
}

impl Percentiles {
    /// Of values; `None` if there are none. The value of rank ⌈p n⌉ is taken, never one in between.
    #[must_use]
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let largest = *values.last()?;
        let at = |part: f64| {
            let rank = (part * values.len() as f64).ceil() as usize;
            values.get(rank.saturating_sub(1)).copied().unwrap_or(largest)
        };
        Some(Self { median: at(0.5), p90: at(0.9), p99: at(0.99), largest })
    }
}

/// Falls, percentiles and the worst of some runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Number of runs.
    pub runs: usize,
    /// Those that fell, in their order.
    pub falls: Vec<u64>,
    /// Root of the mean squared distance from the plan, of those that did not fall.
    pub plan_rmse: Option<Percentiles>,
    /// Distance from the goal at the end, of those that did not fall.
    pub end_error: Option<Percentiles>,
    /// The worst runs by distance from the plan, falls first.
    pub worst: Vec<u64>,
}

/// How many of the worst runs are named.
const WORST: usize = 5;

impl Summary {
    /// Of runs.
    #[must_use]
    pub fn of(rows: &[Row]) -> Self {
        let standing = || rows.iter().filter(|row| row.fell.is_none());
        let mut order: Vec<&Row> = rows.iter().collect();
        order.sort_by(|a, b| {
            let falls = b.fell.is_some().cmp(&a.fell.is_some());
            falls.then(b.plan_rmse().total_cmp(&a.plan_rmse())).then(a.run.cmp(&b.run))
        });
        Self {
            runs: rows.len(),
            falls: rows.iter().filter(|row| row.fell.is_some()).map(|row| row.run).collect(),
            plan_rmse: Percentiles::of(standing().map(Row::plan_rmse).collect()),
            end_error: Percentiles::of(standing().map(Row::end_error).collect()),
            worst: order.iter().take(WORST).map(|row| row.run).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Percentiles;

    #[test]
    fn percentiles_are_values_of_the_sample() {
        let found = Percentiles::of((1..=200).rev().map(f64::from).collect()).unwrap();
        let expected = Percentiles { median: 100.0, p90: 180.0, p99: 198.0, largest: 200.0 };
        assert_eq!(found, expected);
        assert_eq!(Percentiles::of(vec![7.0]).map(|p| (p.median, p.largest)), Some((7.0, 7.0)));
        assert_eq!(Percentiles::of(Vec::new()), None);
    }
}
