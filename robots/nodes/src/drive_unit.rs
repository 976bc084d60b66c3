//! Gears, pairs of motors and the yaw axis between motors and a robot's coordinates.

use shapebot_drive_build::{DriveDescription, SimulatedKind};

use crate::{Motion, Plant, Quantity};

/// A robot's mechanics: coordinates q of the model and forces on them.
pub trait Mechanism {
    /// Coordinate by its index in q, rad or m.
    fn coordinate(&self, index: usize) -> f64;

    /// Its rate, per second.
    fn rate(&self, index: usize) -> f64;

    /// What a sensor that counts as exactly as one likes says of a coordinate.
    fn sensed(&self, index: usize) -> f64 {
        self.coordinate(index)
    }

    /// The same of its rate.
    fn sensed_rate(&self, index: usize) -> f64 {
        self.rate(index)
    }

    /// Force of all motors on a coordinate from now on, N·m or N.
    fn set_force(&mut self, index: usize, force: f64);

    /// Extension of the legs from now on: 0 retracted, 1 on the floor.
    fn set_legs(&mut self, extension: f64);

    /// Lets `seconds` pass.
    fn advance(&mut self, seconds: f64);
}

/// The yaw axis: body and drive unit turn against each other about the vertical, as an axis of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YawAxis {
    /// Moment of inertia of the body about the vertical, kg·m².
    pub body_inertia: f64,
    /// Moment of inertia of the drive unit, kg·m².
    pub unit_inertia: f64,
    /// Friction between body and drive unit, N·m·s/rad.
    pub bearing_friction: f64,
    /// What the ball's contact with the floor does against turning of the drive unit, N·m·s/rad.
    pub floor_friction: f64,
}

impl Default for YawAxis {
    /// A body of 2.5 kg·m² on a drive unit that the floor holds.
    fn default() -> Self {
        Self { body_inertia: 2.5, unit_inertia: 0.2, bearing_friction: 0.1, floor_friction: 200.0 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Joint {
    /// A coordinate of the model.
    Coordinate(usize),
    /// The first or second axis of the drive unit.
    Plane(usize),
    /// Body against drive unit.
    Yaw,
}

#[derive(Clone, Copy, Debug)]
struct Mount {
    joint: Joint,
    /// Radians of the motor per unit of the joint, with the sign of its mounting.
    gain: f64,
    motion: Motion,
    torque: f64,
}

/// Longest step over which the heading counts as constant, s.
const STEP: f64 = 0.5e-3;

/// The motors of a drive description on a robot: Eq. 13 read backwards, in the frame of the drive unit.
///
/// The model's coordinates are in the frame of the body; the two axes of the plane are driven and
/// measured in the frame of the drive unit, which is turned against the body by the yaw angle. A
/// positive force of the yaw axis turns the body to a larger heading and the drive unit back.
#[derive(Clone, Debug)]
pub struct DriveUnit<M> {
    mechanism: M,
    mounts: Vec<Mount>,
    plane: Option<[usize; 2]>,
    axis: YawAxis,
    body: Motion,
    unit: Motion,
}

impl<M: Mechanism> DriveUnit<M> {
    /// The motors of `description` on `mechanism`, all angles zero where they are.
    #[must_use]
    pub fn new(description: &DriveDescription, mechanism: M, axis: YawAxis) -> Self {
        let coordinate = |axis: u8| {
            let axis = description.axes.get(usize::from(axis))?;
            axis.coordinate.map(usize::from)
        };
        let plane = description.yaw.and_then(|yaw| {
            let [x, y] = yaw.plane;
            Some([coordinate(x)?, coordinate(y)?])
        });
        let mut mounts = Vec::new();
        for node in &description.simulated {
            let SimulatedKind::Drive(drive) = &node.kind else { continue };
            let in_plane =
                |index| plane.and_then(|plane: [usize; 2]| plane.iter().position(|p| *p == index));
            let joint = match drive.coordinate {
                None => Joint::Yaw,
                Some(index) => in_plane(index).map_or(Joint::Coordinate(index), Joint::Plane),
            };
            let gain = f64::from(drive.mounting) * drive.ratio;
            mounts.push(Mount { joint, gain, motion: Motion::default(), torque: 0.0 });
        }
        let still = Motion::default();
        Self { mechanism, mounts, plane, axis, body: still, unit: still }
    }

    /// The robot.
    pub const fn mechanism(&self) -> &M {
        &self.mechanism
    }

    /// The robot, to change.
    pub const fn mechanism_mut(&mut self) -> &mut M {
        &mut self.mechanism
    }

    /// Torque of a motor on its shaft, N·m.
    #[must_use]
    pub fn torque(&self, motor: usize) -> f64 {
        self.mounts.get(motor).map_or(0.0, |mount| mount.torque)
    }

    /// Heading of the body and of the drive unit against the floor.
    #[must_use]
    pub const fn headings(&self) -> [Motion; 2] {
        [self.body, self.unit]
    }

    /// Turns the body by hand, rad.
    pub const fn set_heading(&mut self, angle: f64) {
        self.body.angle = angle;
    }

    fn yaw(&self) -> f64 {
        self.unit.angle - self.body.angle
    }

    /// Rates along the two axes of the drive unit.
    fn plane_rates(&self) -> [f64; 2] {
        let Some([x, y]) = self.plane else { return [0.0; 2] };
        let (x, y) = (self.mechanism.rate(x), self.mechanism.rate(y));
        let (sin, cos) = self.yaw().sin_cos();
        [cos * x + sin * y, cos * y - sin * x]
    }

    /// Rate of a motor's shaft.
    fn shaft_rate(&self, mount: &Mount) -> f64 {
        let rate = match mount.joint {
            Joint::Coordinate(index) => self.mechanism.rate(index),
            Joint::Plane(which) => self.plane_rates().get(which).copied().unwrap_or(0.0),
            Joint::Yaw => self.body.rate - self.unit.rate,
        };
        mount.gain * rate
    }

    /// Torque of all motors on a joint.
    fn joint_force(&self, joint: Joint) -> f64 {
        let on = self.mounts.iter().filter(|mount| mount.joint == joint);
        on.map(|mount| mount.gain * mount.torque).sum()
    }

    fn push(&mut self) {
        for index in 0..self.mounts.len() {
            if let Some(Mount { joint: Joint::Coordinate(coordinate), .. }) = self.mounts.get(index)
            {
                let coordinate = *coordinate;
                let force = self.joint_force(Joint::Coordinate(coordinate));
                self.mechanism.set_force(coordinate, force);
            }
        }
        if let Some([x, y]) = self.plane {
            let along = [0, 1].map(|which| self.joint_force(Joint::Plane(which)));
            let (sin, cos) = self.yaw().sin_cos();
            self.mechanism.set_force(x, cos * along[0] - sin * along[1]);
            self.mechanism.set_force(y, sin * along[0] + cos * along[1]);
        }
    }

    fn turn(&mut self, seconds: f64) {
        let torque = self.joint_force(Joint::Yaw);
        let axis = self.axis;
        let bearing = axis.bearing_friction * (self.body.rate - self.unit.rate);
        self.body.rate += (torque - bearing) / axis.body_inertia * seconds;
        // The floor's friction is stiff: implicit.
        let free = self.unit.rate + (bearing - torque) / axis.unit_inertia * seconds;
        self.unit.rate = free / (1.0 + axis.floor_friction / axis.unit_inertia * seconds);
        self.body.angle += self.body.rate * seconds;
        self.unit.angle += self.unit.rate * seconds;
    }

    fn step(&mut self, seconds: f64) {
        let before: Vec<f64> = self.mounts.iter().map(|mount| self.shaft_rate(mount)).collect();
        self.push();
        self.mechanism.advance(seconds);
        if self.mounts.iter().any(|mount| mount.joint == Joint::Yaw) {
            self.turn(seconds);
        }
        let after: Vec<f64> = self.mounts.iter().map(|mount| self.shaft_rate(mount)).collect();
        for (mount, (before, after)) in self.mounts.iter_mut().zip(before.iter().zip(after)) {
            mount.motion.angle += 0.5 * (before + after) * seconds;
            mount.motion.rate = after;
        }
    }
}

impl<M: Mechanism> Plant for DriveUnit<M> {
    fn motor(&self, motor: usize) -> Motion {
        self.mounts.get(motor).map_or_else(Motion::default, |mount| mount.motion)
    }

    fn drive(&mut self, motor: usize, torque: f64) {
        if let Some(mount) = self.mounts.get_mut(motor) {
            mount.torque = torque;
        }
    }

    fn measure(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Coordinate(index) => self.mechanism.sensed(index),
            Quantity::Rate(index) => self.mechanism.sensed_rate(index),
            Quantity::Heading => self.body.angle,
            Quantity::HeadingRate => self.body.rate,
            Quantity::Yaw => self.yaw(),
        }
    }

    fn set_legs(&mut self, extension: f64) {
        self.mechanism.set_legs(extension);
    }

    fn advance(&mut self, seconds: f64) {
        let mut left = seconds;
        while left > 0.0 {
            let step = left.min(STEP);
            self.step(step);
            left -= step;
        }
    }
}
