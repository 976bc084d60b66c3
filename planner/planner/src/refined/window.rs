//! The time that a refined plan covers: the motion, and standing before and after it.

use crate::Error;
use crate::motion::check_duration;
use crate::reference::Grid;
use shapebot_dynamics::Ordered;

/// Fewest samples of a refined plan: two for each of four spans.
pub const MIN_REFINED_SAMPLES: usize = 9;

/// Equidistant samples of the window; those of the motion itself lie among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window<T> {
    grid: Grid<T>,
    /// Samples ahead of the motion.
    before: usize,
    pub(crate) count: usize,
    pub(crate) spans: usize,
}

impl<T: Ordered> Window<T> {
    /// Standing times are rounded up to whole sampling intervals.
    pub(crate) fn new(grid: Grid<T>, standing: [T; 2], spans: Option<usize>, points: usize)
    -> Result<Self, Error> {
        if grid.count < MIN_REFINED_SAMPLES {
            return Err(Error::Invalid {
                field: "samples",
                value: grid.count as f64,
                expected: "at least 9",
            });
        }
        let [before, after] = [whole(standing[0] / grid.step())?, whole(standing[1] / grid.step())?];
        let count = grid.count + before + after;
        let mut window = Self { grid, before, count, spans: 4 };
        check_duration(window.length())?;
        let most = points.saturating_sub(super::basis::DEGREE).min((count - 1) / 2);
        if most < 4 {
            return Err(Error::Invalid {
                field: "control points of the workspace",
                value: points as f64,
                expected: "at least 11",
            });
        }
        window.spans = match spans {
            None => {
                // Bounded above by the control points, so that the cast is exact.
                let wanted = (window.length().to_f64() * 5.0).min(most as f64) as usize;
                wanted.max(20).min(most)
            }
            Some(spans) if (4..=most).contains(&spans) => spans,
            Some(spans) => {
                return Err(Error::Invalid {
                    field: "number of spans",
                    value: spans as f64,
                    expected: "from 4 to the workspace's control points less 7, \
                               and at most half of the samples",
                });
            }
        };
        Ok(window)
    }

    /// Seconds.
    pub(crate) fn length(&self) -> T {
        self.grid.step() * T::from_f64((self.count - 1) as f64)
    }

    pub(crate) fn step(&self) -> T {
        self.grid.step()
    }

    /// Seconds before the motion at which the window opens, not positive.
    pub(crate) fn start(&self) -> T {
        -(self.grid.step() * T::from_f64(self.before as f64))
    }

    pub(crate) fn end(&self) -> T {
        self.time(self.count - 1)
    }

    /// Time of a sample since the motion's start.
    pub(crate) fn time(&self, index: usize) -> T {
        if index >= self.before {
            self.grid.time(index - self.before)
        } else {
            -(self.grid.step() * T::from_f64((self.before - index) as f64))
        }
    }

    /// Whether a sample is one of the motion's.
    pub(crate) fn in_motion(&self, index: usize) -> bool {
        (self.before..self.before + self.grid.count).contains(&index)
    }

    pub(crate) fn motion_samples(&self) -> usize {
        self.grid.count
    }

    /// Length of a span, seconds.
    pub(crate) fn span_length(&self) -> T {
        self.length() / T::from_f64(self.spans as f64)
    }

    /// Span of a sample, and the fraction of it that has passed: exact, in whole numbers.
    pub(crate) fn place(&self, index: usize) -> (usize, T) {
        let intervals = self.count - 1;
        let (whole, part) = (index * self.spans / intervals, index * self.spans % intervals);
        if whole >= self.spans {
            return (self.spans - 1, T::one());
        }
        (whole, T::from_f64(part as f64) / T::from_f64(intervals as f64))
    }

    /// The same for any time since the motion's start, limited to the window.
    pub(crate) fn place_at(&self, time: T) -> (usize, T) {
        let position = (time - self.start()) / self.span_length();
        if !(position > T::zero()) {
            return (0, T::zero());
        }
        if position >= T::from_f64(self.spans as f64) {
            return (self.spans - 1, T::one());
        }
        let span = (position.to_f64() as usize).min(self.spans - 1);
        (span, position - T::from_f64(span as f64))
    }
}

/// A number of sampling intervals, rounded up; rounding errors of the division do not add one.
fn whole<T: Ordered>(intervals: T) -> Result<usize, Error> {
    let intervals = intervals.to_f64();
    if !(0.0..1e9).contains(&intervals) {
        return Err(Error::Invalid {
            field: "number of samples while standing",
            value: intervals,
            expected: "less than 1e9",
        });
    }
    let floor = intervals as usize;
    Ok(if intervals - floor as f64 > 1e-3 { floor + 1 } else { floor })
}
