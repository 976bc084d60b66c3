//! How late SYNC is.

/// A histogram of how late SYNC was sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Jitter {
    bins: [u32; Self::EDGES_US.len() + 1],
    worst_us: u32,
}

impl Jitter {
    /// Upper edges of the bins, µs; the last bin is above.
    pub const EDGES_US: [u32; 8] = [10, 20, 50, 100, 200, 500, 1000, 2000];

    pub(crate) fn add(&mut self, late_us: u32) {
        let bin = Self::EDGES_US.iter().position(|edge| late_us < *edge);
        let bin = bin.unwrap_or(Self::EDGES_US.len());
        if let Some(count) = self.bins.get_mut(bin) {
            *count = count.saturating_add(1);
        }
        self.worst_us = self.worst_us.max(late_us);
    }

    /// Number of SYNCs in each bin.
    #[must_use]
    pub const fn bins(&self) -> &[u32; 9] {
        &self.bins
    }

    /// The latest, µs.
    #[must_use]
    pub const fn worst_us(&self) -> u32 {
        self.worst_us
    }
}
