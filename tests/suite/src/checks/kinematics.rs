//! Frames, points and geometry.

use super::{EXACT, STATES};
use crate::compare::assert_close;
use crate::states::{State, states};
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::{Matrix3, Vector3};

/// Frames are rotations, the first is the world, and a frame that is not there is the identity.
///
/// # Panics
///
/// If not.
pub fn frames<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    let description = robot.description();
    assert_eq!(description.frames.first(), Some(&"world"), "{label}");
    for (index, State { q, .. }) in states::<N>(description, STATES).iter().enumerate() {
        for (frame, name) in description.frames.iter().enumerate() {
            let label = format!("{label}, state {index}, frame `{name}`: ");
            let axes = robot.frame_rotation(q, frame);
            let product = axes.transpose() * axes;
            assert_close(&label, &product, &Matrix3::<f64>::identity(), EXACT);
            let third = axes.fixed_view::<3, 1>(0, 0).cross(&axes.fixed_view::<3, 1>(0, 1));
            assert_close(&label, &third, &axes.fixed_view::<3, 1>(0, 2).into_owned(), EXACT);
        }
        let identity = Matrix3::identity();
        assert_eq!(robot.frame_rotation(q, 0), identity, "{label}: world");
        let beyond = description.frames.len();
        assert_eq!(robot.frame_rotation(q, beyond), identity, "{label}: no such frame");
    }
}

/// Points and geometry are where the description says they can be found; a point that is not there is
/// the origin.
///
/// # Panics
///
/// If not.
pub fn points<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    let description = robot.description();
    for geometry in description.geometry {
        assert!(geometry.frame < description.frames.len(), "{label}: frame of {geometry:?}");
        assert!(geometry.center < description.points.len(), "{label}: centre of {geometry:?}");
    }
    for State { q, .. } in &states::<N>(description, STATES) {
        for (point, name) in description.points.iter().enumerate() {
            let place = robot.point_position(q, point);
            assert!(place.iter().all(|x| x.is_finite()), "{label}: point `{name}`");
        }
        let beyond = description.points.len();
        assert_eq!(robot.point_position(q, beyond), Vector3::zeros(), "{label}: no such point");
        assert_eq!(robot.point_jacobian(q, beyond).abs().sum(), 0.0, "{label}: no such point");
        assert!(robot.center_of_mass(q).iter().all(|x| x.is_finite()), "{label}: centre of mass");
    }
}
