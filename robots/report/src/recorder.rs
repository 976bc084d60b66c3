//! From states to an animation.

use crate::data::{Animation, Path, Stroke};
use crate::scene::{Body, Pose, Shape, poses};
use nalgebra::{SVector, UnitQuaternion, Vector3};
use shapebot_dynamics::Robot;

/// Slack for lengths that should be equal, m.
const SAME: f64 = 1e-9;

/// Where a robot's output is measured: the point that has the output as its coordinates, in world
/// axes or in those of a body that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    carrier: Option<usize>,
    point: usize,
}

/// Records the states of a run for its animation.
///
/// A ball without a frame of its own whose centre stays above the output's point is taken to roll
/// without slipping on what carries it; its turning follows from its path.
pub struct Recorder<'r, R, const N: usize, const NX: usize, const NS: usize> {
    robot: &'r R,
    bodies: Vec<Body>,
    place: Option<Place>,
    rolling: Vec<bool>,
    frames: Vec<Vec<Pose>>,
    desired: Vec<SVector<f64, NX>>,
    planned: Vec<SVector<f64, NX>>,
    actual: Vec<SVector<f64, NX>>,
}

impl<'r, R, const N: usize, const NX: usize, const NS: usize> Recorder<'r, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    /// A recorder without states.
    pub fn new(robot: &'r R) -> Self {
        let bodies: Vec<Body> = robot.description().geometry.iter().map(Body::from).collect();
        let place = find_place(robot);
        let rolling = (0..bodies.len()).map(|body| rolls(robot, &bodies, place, body)).collect();
        let (desired, planned, actual) = (Vec::new(), Vec::new(), Vec::new());
        Self { robot, bodies, place, rolling, frames: Vec::new(), desired, planned, actual }
    }

    /// Adds the next shown instant: coordinates q, and the output as desired and as planned.
    pub fn push(
        &mut self,
        q: &SVector<f64, N>,
        desired: &SVector<f64, NX>,
        planned: &SVector<f64, NX>,
    ) {
        let mut frame = poses(self.robot, q);
        if let Some(before) = self.frames.last() {
            for body in 0..frame.len() {
                if self.rolling[body] {
                    frame[body] = self.rolled(body, before, &frame);
                }
                frame[body] = nearer(&before[body], frame[body]);
            }
        }
        self.frames.push(frame);
        let (qx, qs) = R::split(q);
        self.actual.push(self.robot.output(&qx, &qs));
        self.desired.push(*desired);
        self.planned.push(*planned);
    }

    /// The animation of what was recorded.
    pub fn finish(self) -> Animation {
        let lowest = self.frames.iter().flat_map(|frame| {
            frame.iter().zip(&self.bodies).map(|(p, body)| p.position[2] - body.shape.depth(p))
        });
        let floor = lowest.fold(f64::INFINITY, f64::min);
        let floor = if floor.is_finite() { floor } else { 0.0 };
        let carrier = self.place.and_then(|place| place.carrier);
        let height = match carrier.and_then(|body| self.bodies.get(body)).map(|body| body.shape) {
            Some(Shape::Box { edges }) => edges[2] / 2.0,
            Some(Shape::Sphere { radius }) => radius,
            Some(Shape::Capsule { radius, length }) => radius + length / 2.0,
            Some(Shape::Cylinder { length, .. }) => length / 2.0,
            None => floor,
        };
        let path = |stroke, outputs: &[SVector<f64, NX>]| {
            let points = outputs.iter().map(|output| {
                let entry = |i: usize| output.as_slice().get(i).copied().unwrap_or(0.0);
                [entry(0), entry(1), height]
            });
            Path { stroke, points: points.collect() }
        };
        let paths = if self.place.is_some() {
            vec![
                path(Stroke::Desired, &self.desired),
                path(Stroke::Planned, &self.planned),
                path(Stroke::Actual, &self.actual),
            ]
        } else {
            Vec::new()
        };
        Animation { frames: self.frames, carrier, floor, paths }
    }

    /// Pose of a ball that rolled from one frame to the next.
    fn rolled(&self, body: usize, before: &[Pose], now: &[Pose]) -> Pose {
        let Shape::Sphere { radius } = self.bodies[body].shape else { return now[body] };
        let carrier = self.place.and_then(|place| place.carrier);
        // The ball's centre and orientation in the axes of what it rolls on.
        let ground = |frame: &[Pose]| match carrier {
            Some(carrier) => (Vector3::from(frame[carrier].position), frame[carrier].quaternion()),
            None => (Vector3::zeros(), UnitQuaternion::identity()),
        };
        let ((origin, axes), (origin_before, axes_before)) = (ground(now), ground(before));
        let center = axes.inverse() * (Vector3::from(now[body].position) - origin);
        let center_before =
            axes_before.inverse() * (Vector3::from(before[body].position) - origin_before);
        let turn = Vector3::z().cross(&(center - center_before)) / radius;
        let rotation = axes_before.inverse() * before[body].quaternion();
        let rotation = axes * UnitQuaternion::from_scaled_axis(turn) * rotation;
        Pose::new(now[body].position.into(), rotation)
    }
}

/// The pose with that sign of its quaternion that is nearer to the one before.
fn nearer(before: &Pose, now: Pose) -> Pose {
    let dot: f64 = before.rotation.iter().zip(now.rotation).map(|(a, b)| a * b).sum();
    if dot < 0.0 { Pose { rotation: now.rotation.map(|x| -x), ..now } } else { now }
}

/// Coordinates at which places are told apart: generic, small, fixed.
fn probe<const N: usize>(k: usize) -> SVector<f64, N> {
    SVector::from_fn(|i, _| 0.1 * ((k * 7 + i * 3 + 1) as f64).sin())
}

/// Probes that a coincidence must survive.
const PROBES: usize = 4;

/// Position of a point at a probe, in the axes of a body or of the world.
fn seen<R, const N: usize>(
    robot: &R,
    k: usize,
    point: usize,
    carrier: Option<usize>,
) -> Vector3<f64>
where
    R: shapebot_dynamics::LagrangianSystem<f64, N>,
{
    let q = probe::<N>(k);
    let position: Vector3<f64> = robot.point_position(&q, point);
    match carrier.and_then(|body| poses(robot, &q).get(body).copied()) {
        Some(pose) => pose.quaternion().inverse() * (position - Vector3::from(pose.position)),
        None => position,
    }
}

/// Finds the point whose coordinates are the output: in world axes, else in those of a body.
fn find_place<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> Option<Place>
where
    R: Robot<f64, N, NX, NS>,
{
    let description = robot.description();
    if NX > 2 || description.output_unit != "m" {
        return None;
    }
    let fits = |place: &Place| (0..PROBES).all(|k| above_output(robot, k, *place));
    let carriers = std::iter::once(None).chain((0..description.geometry.len()).map(Some));
    let points = 0..description.points.len();
    carriers
        .flat_map(|carrier| points.clone().map(move |point| Place { carrier, point }))
        .find(fits)
}

/// Whether the point's coordinates along the floor are the output at a probe.
fn above_output<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    k: usize,
    place: Place,
) -> bool
where
    R: Robot<f64, N, NX, NS>,
{
    let (qx, qs) = R::split(&probe::<N>(k));
    let output = robot.output(&qx, &qs);
    let position = seen(robot, k, place.point, place.carrier);
    output.iter().zip(position.iter()).all(|(a, b)| (a - b).abs() < SAME)
}

/// Whether a body is a ball that rolls on the carrier of the output.
fn rolls<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    bodies: &[Body],
    place: Option<Place>,
    body: usize,
) -> bool
where
    R: Robot<f64, N, NX, NS>,
{
    let geometry = &robot.description().geometry[body];
    let ball = matches!(bodies[body].shape, Shape::Sphere { .. }) && geometry.frame == 0;
    let Some(place) = place.filter(|_| ball) else { return false };
    let above = Place { point: geometry.center, ..place };
    let height = |k| seen(robot, k, above.point, above.carrier)[2];
    (0..PROBES).all(|k| above_output(robot, k, above) && (height(k) - height(0)).abs() < SAME)
}

#[cfg(test)]
mod tests;
