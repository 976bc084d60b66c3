//! Whether the loop keeps its times.

use std::fmt;

/// Counts of a loop's cycles; times in µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Deadlines {
    /// Cycles in which the controller ran.
    pub cycles: u64,
    /// Cycles whose commands went out only when the next SYNC was due.
    pub missed: u64,
    /// Longest time of the controller and of sending its commands.
    pub longest_us: u64,
    /// Longest time from SYNC to the last command handed to its bus.
    pub latest_us: u64,
}

impl Deadlines {
    /// Counts a cycle: SYNC, begin and end of the controller's turn, and the period.
    pub fn add(&mut self, sync: u64, begin: u64, end: u64, period: u64) {
        let late = end.saturating_sub(sync);
        self.cycles += 1;
        self.missed += u64::from(late >= period);
        self.longest_us = self.longest_us.max(end.saturating_sub(begin));
        self.latest_us = self.latest_us.max(late);
    }
}

impl fmt::Display for Deadlines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cycles, missed, longest_us, latest_us } = self;
        write!(
            f,
            "{cycles} cycles, {missed} missed their deadline; controller at most {longest_us} us, \
             commands out at most {latest_us} us after SYNC"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::Deadlines;

    #[test]
    fn a_cycle_that_ends_with_the_next_sync_is_missed() {
        let mut deadlines = Deadlines::default();
        deadlines.add(10_000, 11_000, 11_150, 2000);
        deadlines.add(12_000, 13_900, 14_000, 2000);
        let expected = Deadlines { cycles: 2, missed: 1, longest_us: 150, latest_us: 2000 };
        assert_eq!(deadlines, expected);
    }
}
