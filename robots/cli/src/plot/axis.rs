//! Axes: limits and ticks at round numbers.

/// A linear scale from values to positions on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    /// Smallest value shown.
    pub(crate) lower: f64,
    /// Largest value shown.
    pub(crate) upper: f64,
    /// Distance between ticks.
    step: f64,
}

impl Axis {
    /// An axis that shows all values with some room. Values that are not finite are left out.
    pub(crate) fn around(values: impl Iterator<Item = f64>, ticks: usize) -> Self {
        let (lower, upper) = extent(values);
        let room = (upper - lower) * 0.06;
        let step = round_step((upper - lower) / ticks.max(1) as f64);
        Self { lower: lower - room, upper: upper + room, step }
    }

    /// An axis that ends with its values rather than at a tick.
    pub(crate) fn exactly(values: impl Iterator<Item = f64>, ticks: usize) -> Self {
        let (lower, upper) = extent(values);
        Self { lower, upper, step: round_step((upper - lower) / ticks.max(1) as f64) }
    }

    /// Where a value is, as a fraction of the axis.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.lower) / (self.upper - self.lower)
    }

    /// Values at ticks with their texts.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let (first, last) = ((self.lower / self.step).ceil(), (self.upper / self.step).floor());
        let count = (last - first).clamp(0.0, 100.0) as usize;
        let decimals = (-self.step.log10().floor()).clamp(0.0, 12.0) as usize;
        let tick = |i: usize| {
            let value = (first + i as f64) * self.step;
            // No tick is called -0.
            (value, format!("{:.decimals$}", if value == 0.0 { 0.0 } else { value }))
        };
        (0..=count).map(tick).collect()
    }
}

/// Smallest and largest value, some distance apart.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    let (lower, upper) = finite
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lower, upper), v| (lower.min(v), upper.max(v)));
    if lower > upper {
        return (0.0, 1.0);
    }
    // A flat line is drawn in the middle; what is rounding noise is flat.
    let least = 1e-9_f64.max(lower.abs().max(upper.abs()) * 1e-9);
    if upper - lower < least {
        let half = 1e-3_f64.max(lower.abs() * 0.1);
        return (lower - half, upper + half);
    }
    (lower, upper)
}

/// The smallest of 1, 2, 5 times a power of ten that is no smaller.
fn round_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    let choices = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    choices.into_iter().find(|choice| *choice >= step * (1.0 - 1e-9)).unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::Axis;

    fn texts(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_and_all_values_are_inside() {
        let axis = Axis::around([-0.013, 2.04].into_iter(), 5);
        assert_eq!(texts(&axis), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert!(axis.fraction(-0.013) > 0.0 && axis.fraction(2.04) < 1.0);
    }

    #[test]
    fn an_exact_axis_ends_with_its_values() {
        let axis = Axis::exactly([0.0, 5.0].into_iter(), 5);
        assert_eq!(texts(&axis), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!((axis.fraction(0.0), axis.fraction(5.0)), (0.0, 1.0));
    }

    #[test]
    fn flat_empty_and_infinite_data_still_have_an_axis() {
        for values in
            [vec![], vec![0.0], vec![3.0, 3.0], vec![f64::NAN, f64::INFINITY, 1.0], vec![1e-17]]
        {
            let axis = Axis::around(values.iter().copied(), 4);
            assert!(axis.upper > axis.lower);
            assert!((1..12).contains(&axis.ticks().len()));
        }
    }
}
