//! How much acceleration a shape gives (Fig. 5), and how much a robot's ranges allow.

use crate::Error;
use crate::gain::Weighting;
use crate::linear_algebra::{norm, solve};
use crate::reference::OutputMap;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// The output's acceleration with a constant shape, ∂h/∂q_x Γ′(q_s) (Eq. 15), in metres per second
/// squared: the curves of Fig. 5.
pub fn constant_acceleration<R, T, const NX: usize, const NS: usize>(
    robot: &R,
    shape: &SVector<T, NS>,
) -> SVector<T, NX>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    T: Ordered,
{
    robot.output_jacobian_position() * robot.gamma_prime(shape)
}

/// The largest constant acceleration in a direction, and what sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerationBound<T: Ordered, const NS: usize> {
    /// Along the direction, metres per second squared, by Γ′ and not by its linearisation.
    pub acceleration: T,
    /// The shape that gives it.
    pub shape: SVector<T, NS>,
    /// Index of the shape coordinate that is at its limit.
    pub coordinate: usize,
}

/// The largest constant acceleration along a direction of output space that keeps the shape within the
/// declared ranges and `limits` (magnitudes), the shape sets sharing it by `weighting`: a bound for
/// [`minimum_duration`](crate::motion::minimum_duration).
///
/// # Errors
///
/// Those of [`Weighting::gain`]; a direction that is zero or not finite; no finite range or limit on a
/// coordinate that takes part.
pub fn acceleration_bound<R, T, const NX: usize, const NS: usize>(
    robot: &R,
    weighting: &Weighting<'_, T, NS>,
    direction: &SVector<T, NX>,
    limits: Option<&SVector<T, NS>>,
) -> Result<AccelerationBound<T, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    T: Ordered,
{
    let length = norm(direction);
    if !(length.is_finite() && length > T::zero()) {
        let (field, value) = ("length of the direction", length.to_f64());
        return Err(Error::Invalid { field, value, expected: "a positive, finite number" });
    }
    let direction = direction / length;
    let map = OutputMap::new(robot)?;
    let singular = Error::Singular { matrix: "output Jacobian" };
    let unit = weighting.gain(robot)? * solve(map.jacobian, direction).ok_or(singular)?;
    let mut least: Option<(T, usize)> = None;
    let coordinates = robot.shape_description().shape_coordinates();
    for (index, (coordinate, &part)) in coordinates.iter().zip(unit.iter()).enumerate() {
        if part == T::zero() {
            continue;
        }
        let range = if part > T::zero() { coordinate.upper } else { -coordinate.lower };
        let limit = limits.map_or(f64::INFINITY, |limits| limits[index].to_f64());
        let scale = T::from_f64(range.min(limit)) / part.abs();
        if least.is_none_or(|(least, _)| scale < least) {
            least = Some((scale, index));
        }
    }
    match least {
        Some((scale, coordinate)) if scale.is_finite() => {
            let shape = unit * scale;
            let acceleration = constant_acceleration(robot, &shape).dot(&direction);
            Ok(AccelerationBound { acceleration, shape, coordinate })
        }
        _ => Err(Error::Invalid {
            field: "limit of the shape",
            value: f64::INFINITY,
            expected: "a finite range or limit",
        }),
    }
}
