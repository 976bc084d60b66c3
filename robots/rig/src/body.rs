//! The robot's body: a simulated plant on its ball and on its legs.

use nalgebra::SVector;
use shapebot_control::State;
use shapebot_dynamics::{Robot, Role};
use shapebot_nodes::Mechanism;
use shapebot_sim::Plant;
use std::collections::VecDeque;

/// How the robot stands on its legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Stroke of the legs over the distance of the feet from the middle: lean at which retracted legs
    /// meet the floor, rad.
    pub free_lean: f64,
    /// Natural frequency of the lean against the legs, rad/s.
    pub stiffness: f64,
    /// Its damping ratio.
    pub damping: f64,
    /// Friction of the feet on the floor, N·s/m.
    pub friction: f64,
    /// Most that this friction can be, N.
    pub grip: f64,
}

impl Default for Stance {
    /// A stroke of 10 cm, feet 25 cm from the middle, rubber on a floor.
    fn default() -> Self {
        Self { free_lean: 0.4, stiffness: 60.0, damping: 0.7, friction: 3000.0, grip: 450.0 }
    }
}

/// How the robot met the floor with its legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touchdown {
    /// Time of the body, s.
    pub time: f64,
    /// Largest lean, rad.
    pub lean: f64,
    /// Speed of the output.
    pub speed: f64,
}

/// A plant with legs, driven by the motors that act on its coordinates. Sensors err, and forces are late,
/// as the plant's scenario says.
///
/// Legs with extension e ∈ \[0, 1\] leave a free lean of (1 − e) times that of retracted legs: beyond it
/// they push back and the feet rub on the floor.
pub struct Body<'a, R, const N: usize, const NX: usize, const NS: usize> {
    robot: &'a R,
    plant: &'a Plant<'a, N, NX, NS>,
    stance: Stance,
    /// Inertia of each lean coordinate at the origin; zero for other coordinates.
    lean_inertia: SVector<f64, N>,
    state: State<f64, N>,
    /// Forces that act, and what was asked for last.
    force: SVector<f64, N>,
    wanted: SVector<f64, N>,
    /// Forces on their way, each with the time from which it acts.
    on_the_way: VecDeque<(f64, SVector<f64, N>)>,
    time: f64,
    extension: f64,
    lowering: bool,
    touchdown: Option<Touchdown>,
    largest_lean: f64,
}

impl<R, const N: usize, const NX: usize, const NS: usize> Clone for Body<'_, R, N, NX, NS> {
    fn clone(&self) -> Self {
        Self { on_the_way: self.on_the_way.clone(), ..*self }
    }
}

impl<'a, R, const N: usize, const NX: usize, const NS: usize> Body<'a, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    /// A body at rest at the origin, on its legs.
    #[must_use]
    pub fn new(robot: &'a R, plant: &'a Plant<'a, N, NX, NS>, stance: Stance) -> Self {
        let zero = SVector::zeros();
        let mass = robot.mass_matrix(&zero);
        let coordinates = robot.description().coordinates;
        let is_lean =
            |i: usize| coordinates.get(i).is_some_and(|c| c.role == Role::Shape && !c.actuated);
        Self {
            robot,
            plant,
            stance,
            lean_inertia: SVector::from_fn(|i, _| if is_lean(i) { mass[(i, i)] } else { 0.0 }),
            state: State { q: zero, qd: zero },
            force: zero,
            wanted: zero,
            on_the_way: VecDeque::new(),
            time: 0.0,
            extension: 1.0,
            lowering: false,
            touchdown: None,
            largest_lean: 0.0,
        }
    }

    /// Coordinates and rates.
    #[must_use]
    pub const fn state(&self) -> &State<f64, N> {
        &self.state
    }

    /// Generalised forces of the motors, N·m or N.
    #[must_use]
    pub const fn force(&self) -> &SVector<f64, N> {
        &self.force
    }

    /// h(q) in the output's unit.
    #[must_use]
    pub fn output(&self) -> SVector<f64, NX> {
        let (qx, qs) = R::split(&self.state.q);
        self.robot.output(&qx, &qs)
    }

    /// Extension of the legs: 0 retracted, 1 on the floor.
    #[must_use]
    pub const fn extension(&self) -> f64 {
        self.extension
    }

    /// The first contact of the legs with the floor since they were last told to come down.
    #[must_use]
    pub const fn touchdown(&self) -> Option<Touchdown> {
        self.touchdown
    }

    /// Largest lean now, rad.
    #[must_use]
    pub fn lean(&self) -> f64 {
        let lean =
            self.state.q.iter().zip(&self.lean_inertia).filter(|(_, inertia)| **inertia > 0.0);
        lean.fold(0.0, |most, (q, _)| f64::max(most, q.abs()))
    }

    /// Largest lean since [`Self::watch_lean`], rad.
    #[must_use]
    pub const fn largest_lean(&self) -> f64 {
        self.largest_lean
    }

    /// Begins to look for the largest lean.
    pub fn watch_lean(&mut self) {
        self.largest_lean = self.lean();
    }

    /// Forces of the legs and of the feet on the floor.
    fn support(&mut self) -> SVector<f64, N> {
        let free = self.stance.free_lean * (1.0 - self.extension);
        let mut force = SVector::zeros();
        let mut touches = false;
        for i in 0..N {
            let inertia = self.lean_inertia[i];
            let over = self.state.q[i].abs() - free;
            if inertia > 0.0 && over >= 0.0 {
                touches = true;
                let Stance { stiffness, damping, .. } = self.stance;
                let side = self.state.q[i].signum();
                let push = stiffness * stiffness * over
                    + 2.0 * damping * stiffness * self.state.qd[i] * side;
                force[i] -= side * inertia * push.max(0.0);
            }
        }
        if !touches {
            return force;
        }
        let (qx, qs) = R::split(&self.state.q);
        let (qxd, qsd) = R::split(&self.state.qd);
        let along = self.robot.output_jacobian_position();
        let across = self.robot.output_jacobian_shape(&qx, &qs);
        let velocity = along * qxd + across * qsd;
        let speed = velocity.norm();
        if self.lowering && self.touchdown.is_none() {
            self.touchdown = Some(Touchdown { time: self.time, lean: self.lean(), speed });
        }
        let rub = self.stance.friction * speed;
        let scale = if rub > self.stance.grip { self.stance.grip / rub } else { 1.0 };
        let drag = velocity * (-self.stance.friction * scale);
        force + R::join(&(along.transpose() * drag), &(across.transpose() * drag))
    }

    /// The classical Runge-Kutta method of fourth order with the forces held.
    fn integrate(&mut self, h: f64) {
        while let Some((_, force)) = self.on_the_way.pop_front_if(|(from, _)| *from <= self.time) {
            self.force = force;
        }
        let force = self.force + self.support();
        let State { q, qd } = self.state;
        let acceleration = |part: f64, at: &State<f64, N>| {
            self.plant.acceleration(self.time + part * h, at, &force)
        };
        let ahead = |part: f64, rate: &SVector<f64, N>, a: &SVector<f64, N>| State {
            q: q + rate * (part * h),
            qd: qd + a * (part * h),
        };
        let a1 = acceleration(0.0, &self.state);
        let s2 = ahead(0.5, &qd, &a1);
        let a2 = acceleration(0.5, &s2);
        let s3 = ahead(0.5, &s2.qd, &a2);
        let a3 = acceleration(0.5, &s3);
        let s4 = ahead(1.0, &s3.qd, &a3);
        let a4 = acceleration(1.0, &s4);
        self.state = State {
            q: q + (qd + (s2.qd + s3.qd) * 2.0 + s4.qd) * (h / 6.0),
            qd: qd + (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0),
        };
        self.time += h;
        self.largest_lean = self.largest_lean.max(self.lean());
    }
}

impl<R, const N: usize, const NX: usize, const NS: usize> std::fmt::Debug
    for Body<'_, R, N, NX, NS>
{
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Body").field("time", &self.time).field("state", &self.state).finish()
    }
}

impl<R, const N: usize, const NX: usize, const NS: usize> Mechanism for Body<'_, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    fn coordinate(&self, index: usize) -> f64 {
        self.state.q.get(index).copied().unwrap_or_default()
    }

    fn rate(&self, index: usize) -> f64 {
        self.state.qd.get(index).copied().unwrap_or_default()
    }

    fn sensed(&self, index: usize) -> f64 {
        self.plant.sensed(self.time, &self.state).q.get(index).copied().unwrap_or_default()
    }

    fn sensed_rate(&self, index: usize) -> f64 {
        self.plant.sensed(self.time, &self.state).qd.get(index).copied().unwrap_or_default()
    }

    fn set_force(&mut self, index: usize, force: f64) {
        if let Some(entry) = self.wanted.get_mut(index) {
            *entry = force;
        }
        let delay = self.plant.scenario().actuation_delay;
        if delay > 0.0 {
            self.on_the_way.push_back((self.time + delay, self.wanted));
        } else {
            self.force = self.wanted;
        }
    }

    fn set_legs(&mut self, extension: f64) {
        let lowering = extension > self.extension;
        if lowering && !self.lowering {
            self.touchdown = None;
        }
        self.lowering = lowering || (self.lowering && extension >= self.extension);
        self.extension = extension;
    }

    fn advance(&mut self, seconds: f64) {
        self.integrate(seconds);
    }
}
