//! Bodies and where they stand.

use nalgebra::{Matrix3, Rotation3, SVector, UnitQuaternion, Vector3};
use serde_derive::Serialize;
use shapebot_dynamics::{Geometry, LagrangianSystem, Solid};

/// A solid of the animation. Lengths in metres; see [`Solid`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Form.
    #[serde(flatten)]
    pub shape: Shape,
}

/// Form of a body, centred at its origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A box.
    Box {
        /// Edge lengths along x, y, z.
        edges: [f64; 3],
    },
    /// A cylinder along z with half balls on both ends.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length between the centres of the half balls.
        length: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length.
        length: f64,
    },
}

impl From<&Geometry> for Body {
    fn from(geometry: &Geometry) -> Self {
        let shape = match geometry.solid {
            Solid::Sphere(radius) => Shape::Sphere { radius },
            Solid::Box(edges) => Shape::Box { edges },
            Solid::Capsule(radius, length) => Shape::Capsule { radius, length },
            Solid::Cylinder(radius, length) => Shape::Cylinder { radius, length },
        };
        Self { name: geometry.name.to_owned(), shape }
    }
}

impl Shape {
    /// Distance from the centre to the lowest point when the body stands at `pose`, m.
    #[must_use]
    pub fn depth(&self, pose: &Pose) -> f64 {
        let axes = pose.quaternion().to_rotation_matrix();
        // z components of the body's axes; its own z axis last.
        let z = [axes[(2, 0)].abs(), axes[(2, 1)].abs(), axes[(2, 2)].abs()];
        match *self {
            Self::Sphere { radius } => radius,
            Self::Box { edges } => edges.iter().zip(z).map(|(edge, z)| edge * z / 2.0).sum(),
            Self::Capsule { radius, length } => radius + length * z[2] / 2.0,
            Self::Cylinder { radius, length } => {
                radius * (1.0_f64 - z[2] * z[2]).max(0.0).sqrt() + length * z[2] / 2.0
            }
        }
    }
}

/// Where a body stands, in world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// Centre, m.
    pub position: [f64; 3],
    /// Rotation from body axes to world axes: unit quaternion w, x, y, z.
    pub rotation: [f64; 4],
}

impl Pose {
    pub(crate) fn new(position: Vector3<f64>, rotation: UnitQuaternion<f64>) -> Self {
        let q = rotation.quaternion();
        Self { position: position.into(), rotation: [q.w, q.i, q.j, q.k] }
    }

    pub(crate) fn quaternion(&self) -> UnitQuaternion<f64> {
        let [w, x, y, z] = self.rotation;
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
    }
}

/// Pose of each geometry of the robot's description at coordinates `q`, in its order.
pub fn poses<const N: usize>(
    robot: &impl LagrangianSystem<f64, N>,
    q: &SVector<f64, N>,
) -> Vec<Pose> {
    let pose = |geometry: &Geometry| {
        let axes: Matrix3<f64> = robot.frame_rotation(q, geometry.frame);
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Pose::new(robot.point_position(q, geometry.center), rotation)
    };
    robot.description().geometry.iter().map(pose).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn leaning(angle: f64) -> Pose {
        Pose::new(Vector3::zeros(), UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle))
    }

    #[test]
    fn the_lowest_point_of_a_body_is_that_of_its_form() {
        let upright = leaning(0.0);
        let lying = leaning(std::f64::consts::FRAC_PI_2);
        let tilted = leaning(std::f64::consts::FRAC_PI_4);
        let cylinder = Shape::Cylinder { radius: 0.1, length: 2.0 };
        assert_relative_eq!(cylinder.depth(&upright), 1.0, epsilon = 1e-12);
        assert_relative_eq!(cylinder.depth(&lying), 0.1, epsilon = 1e-12);
        assert_relative_eq!(cylinder.depth(&tilted), 1.1 / 2f64.sqrt(), epsilon = 1e-12);
        let capsule = Shape::Capsule { radius: 0.1, length: 2.0 };
        assert_relative_eq!(capsule.depth(&upright), 1.1, epsilon = 1e-12);
        assert_relative_eq!(capsule.depth(&lying), 0.1, epsilon = 1e-12);
        let brick = Shape::Box { edges: [2.0, 9.0, 4.0] };
        assert_relative_eq!(brick.depth(&tilted), 3.0 / 2f64.sqrt(), epsilon = 1e-12);
    }
}
