//! The time that a refined plan covers: the motion, and standing before and after it.

use crate::Error;
use crate::linear_algebra::exceeds;
use crate::motion::check_duration;
use crate::reference::Grid;
use shapebot_dynamics::Ordered;

/// Fewest samples of a refined plan: two for each of four spans.
pub const MIN_REFINED_SAMPLES: usize = 9;

/// Equidistant samples of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window<T> {
    step: T,
    /// Samples ahead of the motion.
    before: usize,
    /// Samples of the motion itself.
    motion: usize,
    /// Time of the motion's last sample.
    closing: T,
    pub(crate) count: usize,
    pub(crate) spans: usize,
}

impl<T: Ordered> Window<T> {
    /// Standing times are rounded up to whole sampling intervals.
    pub(crate) fn new(
        grid: Grid<T>,
        standing: [T; 2],
        spans: Option<usize>,
        points: usize,
    ) -> Result<Self, Error> {
        if grid.count < MIN_REFINED_SAMPLES {
            return Err(Error::Invalid {
                field: "samples",
                value: grid.count as f64,
                expected: "at least 9",
            });
        }
        let [before, after] =
            [whole(standing[0] / grid.step())?, whole(standing[1] / grid.step())?];
        let count = grid.count + before + after;
        let mut window = Self {
            step: grid.step(),
            before,
            motion: grid.count,
            closing: grid.time(grid.count - 1),
            count,
            spans: 4,
        };
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
                let wanted = (window.length().to_f64() * 4.0).min(most as f64) as usize;
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
        self.step * T::from_f64((self.count - 1) as f64)
    }

    pub(crate) fn step(&self) -> T {
        self.step
    }

    /// Seconds before the motion at which the window opens, not positive.
    pub(crate) fn start(&self) -> T {
        -(self.step * T::from_f64(self.before as f64))
    }

    pub(crate) fn end(&self) -> T {
        self.time(self.count - 1)
    }

    /// Time of a sample since the motion's start; the motion's last sample is at its duration exactly.
    pub(crate) fn time(&self, index: usize) -> T {
        if index + 1 == self.before + self.motion {
            self.closing
        } else {
            self.step * T::from_f64(index as f64 - self.before as f64)
        }
    }

    /// Whether a sample is one of the motion's.
    pub(crate) fn in_motion(&self, index: usize) -> bool {
        (self.before..self.before + self.motion).contains(&index)
    }

    pub(crate) fn motion_samples(&self) -> usize {
        self.motion
    }

    /// Length of a span, seconds.
    pub(crate) fn span_length(&self) -> T {
        self.length() / T::from_f64(self.spans as f64)
    }

    /// Time at a fraction of a span.
    pub(crate) fn time_in(&self, span: usize, sigma: T) -> T {
        self.start() + (T::from_f64(span as f64) + sigma) * self.span_length()
    }

    /// Span of each sample, and the fraction of it that has passed: counted in whole numbers.
    pub(crate) fn places(&self) -> Places<T> {
        let intervals = self.count - 1;
        let unit = T::one() / T::from_f64(intervals as f64);
        Places { span: 0, part: 0, spans: self.spans, intervals, unit }
    }

    /// The same for any time since the motion's start, limited to the window.
    pub(crate) fn place_at(&self, time: T) -> (usize, T) {
        let position = (time - self.start()) / self.span_length();
        if !exceeds(position, T::zero()) {
            return (0, T::zero());
        }
        if position >= T::from_f64(self.spans as f64) {
            return (self.spans - 1, T::one());
        }
        let span = (position.to_f64() as usize).min(self.spans - 1);
        (span, position - T::from_f64(span as f64))
    }
}

/// Where the samples lie, one after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places<T> {
    span: usize,
    /// In units of a span over the number of intervals.
    part: usize,
    spans: usize,
    intervals: usize,
    unit: T,
}

impl<T: Ordered> Iterator for Places<T> {
    type Item = (usize, T);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        // The last sample ends the last span, it does not begin another.
        let place = if self.span < self.spans {
            (self.span, T::from_f64(self.part as f64) * self.unit)
        } else {
            (self.spans - 1, T::one())
        };
        // There are fewer spans than intervals.
        self.part += self.spans;
        if self.part >= self.intervals {
            self.part -= self.intervals;
            self.span += 1;
        }
        Some(place)
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
