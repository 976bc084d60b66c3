//! Limits.

use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// `value` within `lower..=upper`.
pub(crate) fn clamp<T: Ordered>(value: T, lower: T, upper: T) -> T {
    let value = if value < lower { lower } else { value };
    if value > upper { upper } else { value }
}

/// Each entry within plus and minus its limit.
pub(crate) fn clamp_all<T: Ordered, const L: usize>(
    value: &SVector<T, L>,
    limit: &SVector<T, L>,
) -> SVector<T, L> {
    value.zip_map(limit, |v, l| clamp(v, -l, l))
}
