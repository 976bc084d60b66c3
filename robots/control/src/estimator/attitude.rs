//! Lean and heading from gyro and accelerometer, corrected by what the encoders say about the motion.

use super::{Reading, Settings};
use crate::linear_algebra::{inverse, solve_definite};
use crate::{Error, State};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, Robot};

/// Half of the angle over which a frame's turning is measured: any value does where angles turn about
/// axes that stay, and this one leaves many digits.
const STEP: f64 = 0.1;

/// Where frames are told apart, rad or m: nothing special.
const PROBE: f64 = 0.37;

/// The accelerometer, turned into the world and freed of gravity, must integrate twice to the path that
/// the encoders see; what does not fit is lean. No steady lean hides, as it does from an accelerometer
/// alone: a robot that leans accelerates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attitude<T: Ordered, const N: usize, const NX: usize> {
    frame: usize,
    /// Unactuated shape variables, as coordinates.
    lean: [usize; NX],
    /// Whether turning about the vertical can be told from leaning.
    has_heading: bool,
    pub(crate) heading: T,
    /// Lean angles.
    angle: SVector<T, NX>,
    /// Their rates by the gyro, one period before.
    turning: SVector<T, NX>,
    /// Error of these.
    bias: SVector<T, NX>,
    position: SVector<T, 3>,
    velocity: SVector<T, 3>,
    /// Rate Jacobian of the last step, in the frame's axes.
    jacobian: SMatrix<T, 3, NX>,
    started: bool,
}

impl<T: Ordered, const N: usize, const NX: usize> Attitude<T, N, NX> {
    pub(crate) fn new<R, const NS: usize>(
        robot: &R,
        settings: &Settings<T, N>,
        start: &SVector<T, N>,
    ) -> Result<Self, Error>
    where
        R: Robot<T, N, NX, NS>,
    {
        let mut lean = [0; NX];
        let free = robot.description().coordinates.iter().enumerate().filter(|(_, c)| !c.actuated);
        for (entry, (i, _)) in lean.iter_mut().zip(free) {
            *entry = i;
        }
        let frame = find_frame(robot, &lean).ok_or(Error::NoFrame)?;
        if settings.point >= robot.description().points.len() {
            return Err(Error::NoPoint);
        }
        let zero = SVector::from_element(T::zero());
        let mut attitude = Self {
            frame,
            lean,
            has_heading: true,
            heading: T::zero(),
            angle: SVector::from_fn(|k, _| start[lean[k]]),
            turning: SVector::from_element(T::zero()),
            bias: SVector::from_element(T::zero()),
            position: zero,
            velocity: zero,
            jacobian: SMatrix::zeros(),
            started: false,
        };
        let rotation = robot.frame_rotation(start, frame);
        let jacobian = attitude.rate_jacobian(robot, start);
        let up = rotation.transpose() * vertical::<T>();
        let normal = |j: &SMatrix<T, 3, NX>| j.transpose() * j;
        if inverse(normal(&without(&jacobian, &up))).is_none() {
            attitude.has_heading = false;
            inverse(normal(&jacobian)).ok_or(Error::Singular { matrix: "frame's rates" })?;
        }
        Ok(attitude)
    }

    /// Index of the frame that the unit is mounted on.
    pub(crate) fn frame(&self) -> usize {
        self.frame
    }

    /// Puts lean and lean rates into a state that has the encoders' share.
    pub(crate) fn step<R, const NS: usize>(
        &mut self,
        robot: &R,
        settings: &Settings<T, N>,
        reading: &Reading<T, N>,
        state: &mut State<T, N>,
    ) where
        R: Robot<T, N, NX, NS>,
    {
        let Settings { period, tilt_rate, gravity, mounting, point, .. } = settings;
        let (period, up) = (*period, vertical::<T>());
        let half = T::from_f64(0.5) * period;
        let (spin, acceleration) = (mounting * reading.gyro, mounting * reading.accelerometer);
        let mut before = self.turn(robot, state);
        if !self.started {
            // Standing, what the unit feels beside gravity is lean.
            let beside = before * acceleration - up * *gravity;
            self.angle -= self.tilt_of(&before, *gravity, &beside);
            before = self.turn(robot, state);
            self.position = robot.point_position(&state.q, *point);
            self.turning = self.rates(&before, &spin).0;
            self.started = true;
            self.put(state, &(self.turning - self.bias));
            return;
        }
        // What a period did: lean, path and velocity in axes that turn with the heading as the model's do.
        let (turning, heading_rate) = self.rates(&before, &spin);
        self.angle += (self.turning + turning) * half - self.bias * period;
        self.turning = turning;
        self.heading += heading_rate * period;
        let rotation = self.turn(robot, state);
        let felt = (before * acceleration + rotation * acceleration) * T::from_f64(0.5);
        let carried = up.cross(&self.velocity) * heading_rate;
        let gained = felt - up * *gravity - carried;
        self.position += (self.velocity + gained * half) * period;
        self.velocity += gained * period;
        // What the encoders say to it.
        let innovation = robot.point_position(&state.q, *point) - self.position;
        let [one, two, three, four] = poles(*tilt_rate);
        let tilt = self.tilt_of(&rotation, *gravity, &innovation) * period;
        self.position += innovation * (one * period);
        self.velocity += innovation * (two * period);
        self.angle += tilt * three;
        self.bias -= tilt * four;
        // A corrected lean moves the place that the encoders tell.
        let jacobian = robot.point_jacobian(&state.q, *point);
        for (k, &i) in self.lean.iter().enumerate() {
            self.position += jacobian.column(i) * (tilt[k] * three);
            self.velocity += jacobian.column(i) * (tilt[k] * four);
        }
        self.put(state, &(turning - self.bias));
    }

    fn put(&self, state: &mut State<T, N>, rates: &SVector<T, NX>) {
        for (k, &i) in self.lean.iter().enumerate() {
            (state.q[i], state.qd[i]) = (self.angle[k], rates[k]);
        }
    }

    /// Puts the lean into a state, and returns the frame's rotation there.
    fn turn<R, const NS: usize>(&mut self, robot: &R, state: &mut State<T, N>) -> SMatrix<T, 3, 3>
    where
        R: Robot<T, N, NX, NS>,
    {
        for (k, &i) in self.lean.iter().enumerate() {
            state.q[i] = self.angle[k];
        }
        self.jacobian = self.rate_jacobian(robot, &state.q);
        robot.frame_rotation(&state.q, self.frame)
    }

    /// Constant error of the gyro that shows in the lean, in the frame's axes.
    pub(crate) fn gyro_bias(&self) -> SVector<T, 3> {
        self.jacobian * self.bias
    }

    /// Column k is the turning rate, in the frame's axes, of a unit rate of lean k.
    fn rate_jacobian<R, const NS: usize>(&self, robot: &R, q: &SVector<T, N>) -> SMatrix<T, 3, NX>
    where
        R: Robot<T, N, NX, NS>,
    {
        let step = T::from_f64(STEP);
        let mut jacobian = SMatrix::<T, 3, NX>::zeros();
        for (k, &i) in self.lean.iter().enumerate() {
            let (mut before, mut after) = (*q, *q);
            before[i] -= step;
            after[i] += step;
            let [before, after] = [before, after].map(|q| robot.frame_rotation(&q, self.frame));
            let turned = logarithm(&(before.transpose() * after));
            jacobian.set_column(k, &(turned / (step + step)));
        }
        jacobian
    }

    /// Rates of the lean angles, and of the heading, that make a frame turn at `turning` in its axes.
    fn rates(&self, rotation: &SMatrix<T, 3, 3>, turning: &SVector<T, 3>) -> (SVector<T, NX>, T) {
        let up = rotation.transpose() * vertical::<T>();
        let seen = if self.has_heading { without(&self.jacobian, &up) } else { self.jacobian };
        let rates = solve_definite(seen.transpose() * seen, seen.transpose() * turning);
        let rest = turning - self.jacobian * rates;
        (rates, if self.has_heading { up.dot(&rest) } else { T::zero() })
    }

    /// Lean that would account for a horizontal acceleration of this direction and size.
    fn tilt_of(
        &self,
        rotation: &SMatrix<T, 3, 3>,
        gravity: T,
        acceleration: &SVector<T, 3>,
    ) -> SVector<T, NX> {
        let up = vertical::<T>();
        let mut felt = SMatrix::<T, 3, NX>::zeros();
        for k in 0..NX {
            let axis: SVector<T, 3> = rotation * self.jacobian.column(k);
            felt.set_column(k, &(axis.cross(&up) * gravity));
        }
        // A lean that cannot be seen is left alone.
        let slight = SMatrix::<T, NX, NX>::identity() * (gravity * gravity * T::from_f64(1e-6));
        solve_definite(felt.transpose() * felt + slight, felt.transpose() * acceleration)
    }
}

/// Gains that put four poles at −`rate`.
fn poles<T: Ordered>(rate: T) -> [T; 4] {
    let [four, six] = [4.0, 6.0].map(T::from_f64);
    let square = rate * rate;
    [four * rate, six * square, four * square * rate, square * square]
}

fn vertical<T: Ordered>() -> SVector<T, 3> {
    SVector::from([T::zero(), T::zero(), T::one()])
}

/// Columns without their parts along a unit vector.
fn without<T: Ordered, const C: usize>(
    columns: &SMatrix<T, 3, C>,
    along: &SVector<T, 3>,
) -> SMatrix<T, 3, C> {
    columns - along * (along.transpose() * columns)
}

/// Axis times angle of a rotation, for angles well below π.
fn logarithm<T: Ordered>(r: &SMatrix<T, 3, 3>) -> SVector<T, 3> {
    let half = T::from_f64(0.5);
    let sine = SVector::from([
        (r[(2, 1)] - r[(1, 2)]) * half,
        (r[(0, 2)] - r[(2, 0)]) * half,
        (r[(1, 0)] - r[(0, 1)]) * half,
    ]);
    let size = sine.dot(&sine).sqrt();
    let cosine = (r[(0, 0)] + r[(1, 1)] + r[(2, 2)] - T::one()) * half;
    if size > T::zero() { sine * (size.atan2(cosine) / size) } else { sine }
}

/// The first frame that turns with all of these coordinates and with no other.
fn find_frame<R, T, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    lean: &[usize; NX],
) -> Option<usize>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let q = SVector::<T, N>::from_fn(|i, _| T::from_f64(PROBE / (1.0 + i as f64)));
    let slight = T::epsilon() * T::from_f64(64.0);
    let turns = |frame: usize, i: usize| {
        let mut other = q;
        other[i] += T::from_f64(STEP);
        let change = robot.frame_rotation(&other, frame) - robot.frame_rotation(&q, frame);
        change.iter().any(|x| x.abs() > slight)
    };
    let fits = |&frame: &usize| (0..N).all(|i| turns(frame, i) == lean.contains(&i));
    (0..robot.description().frames.len()).find(fits)
}
