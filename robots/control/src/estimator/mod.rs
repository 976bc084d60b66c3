//! From sensors to the state: encoders on the position and the actuated shape variables, an inertial unit
//! on the frame that turns with the unactuated shape.

mod attitude;
mod encoder;
mod offset;
mod payload;
mod rate;

pub use payload::{Payload, PayloadEstimator, PayloadSettings};

use crate::{Error, State};
use attitude::Attitude;
use encoder::Encoders;
use nalgebra::{SMatrix, SVector};
use offset::LeanOffset;
use shapebot_dynamics::{Ordered, Robot};

/// What the estimator is told about the sensors. Start from [`Settings::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T: Ordered, const N: usize> {
    /// Time between readings, s.
    pub period: T,
    /// Unit of the coordinate per count; not used for unactuated shape variables.
    pub resolution: SVector<T, N>,
    /// Bandwidth of the filters that make rates of counts, 1/s.
    pub encoder_rate: T,
    /// The same of a balancing robot's position variables, whose rates have the fast part from the gyro,
    /// over the robot's time τ (τ² = |∂Γ/∂q̈_s K⁺|, K⁺ the inverse of K⁰_qs); [`Settings::encoder_rate`]
    /// where that is less.
    pub position_rate: T,
    /// Rate at which encoders correct what the inertial unit integrates, 1/s: all four poles of the
    /// error of path, velocity, lean and gyro bias. Lower trusts the gyro longer, higher finds its bias
    /// sooner; the path is kinematics alone, whatever masses and friction are.
    pub tilt_rate: T,
    /// Gravity, m/s².
    pub gravity: T,
    /// Axes of the inertial unit in the frame that it is mounted on, as columns.
    pub mounting: SMatrix<T, 3, 3>,
    /// Index of the point of the description at which the unit sits.
    pub point: usize,
    /// Rate at which a constant offset of the lean is estimated, 1/s; zero for not at all.
    pub offset_rate: T,
    /// Whether the state is freed of that offset. A controller that does so itself
    /// ([`Gains::offset`](crate::Gains::offset)) must not be given such a state.
    pub correct_offset: bool,
}

impl<T: Ordered, const N: usize> Settings<T, N> {
    /// Encoders of 2¹⁶ counts per unit, an inertial unit at the first point, in line with its frame.
    pub fn new(period: T) -> Self {
        let c = T::from_f64;
        Self {
            period,
            resolution: SVector::from_element(c(1.0 / 65536.0)),
            encoder_rate: c(150.0),
            position_rate: c(13.0),
            tilt_rate: c(3.0),
            gravity: c(9.81),
            mounting: SMatrix::identity(),
            point: 0,
            offset_rate: T::one(),
            correct_offset: false,
        }
    }

    fn check(&self) -> Result<(), Error> {
        let numbers = [
            ("period", self.period, true),
            ("encoder_rate", self.encoder_rate, true),
            ("position_rate", self.position_rate, true),
            ("tilt_rate", self.tilt_rate, false),
            ("gravity", self.gravity, true),
            ("offset_rate", self.offset_rate, false),
        ];
        for (what, value, positive) in numbers {
            let large = if positive { value > T::zero() } else { value >= T::zero() };
            if !(large && value.is_finite()) {
                return Err(Error::Gain { what });
            }
        }
        Ok(())
    }
}

/// What the sensors say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<T, const N: usize> {
    /// Counts of the encoders; they may wrap around. Not used for unactuated shape variables.
    pub counts: [i32; N],
    /// Turning rate in the inertial unit's axes, rad/s.
    pub gyro: SVector<T, 3>,
    /// Acceleration less gravity in the same axes, m/s²: upwards g at rest.
    pub accelerometer: SVector<T, 3>,
}

/// What the sensors mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<T: Ordered, const N: usize, const NS: usize> {
    /// Coordinates and rates of the model.
    pub state: State<T, N>,
    /// Angle about the vertical since the start, rad, positive counter-clockwise from above: the model
    /// has none, the gyro sees it.
    pub heading: T,
    /// Constant error of the gyro in its frame's axes, as far as it shows in the lean, rad/s.
    pub gyro_bias: SVector<T, 3>,
    /// Constant offset of the measured shape: of the inertial unit's tilt and of the centre of mass,
    /// which cannot be told apart. It is in the state unless [`Settings::correct_offset`].
    pub offset: SVector<T, NS>,
    /// A reading was not finite: the estimate is the last one.
    pub fault: bool,
}

/// Turns readings into states; one [`Estimator::step`] per period.
#[derive(Debug)]
pub struct Estimator<'r, R, T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    robot: &'r R,
    settings: Settings<T, N>,
    encoders: Encoders<T, N>,
    attitude: Option<Attitude<T, N, NX>>,
    offset: LeanOffset<T, N, NX, NS>,
    last: Estimate<T, N, NS>,
}

impl<'r, R, T, const N: usize, const NX: usize, const NS: usize> Estimator<'r, R, T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    /// An estimator for a robot that stands at `start` when it takes its first reading, which tells its
    /// lean more exactly.
    ///
    /// # Errors
    ///
    /// Settings out of range; roles that the law does not suit; no frame that turns with the unactuated
    /// shape variables and nothing else; a frame whose turning does not tell their rates apart.
    pub fn new(
        robot: &'r R,
        settings: &Settings<T, N>,
        start: &SVector<T, N>,
    ) -> Result<Self, Error> {
        settings.check()?;
        let offset = LeanOffset::new(robot, settings)?;
        let attitude = match offset.balancing() {
            true => Some(Attitude::new(robot, settings, start)?),
            false => None,
        };
        let state = State { q: *start, qd: SVector::from_element(T::zero()) };
        let last = Estimate {
            state,
            heading: T::zero(),
            gyro_bias: SVector::from_element(T::zero()),
            offset: SVector::from_element(T::zero()),
            fault: false,
        };
        let encoders = Encoders::new(settings, start);
        Ok(Self { robot, settings: *settings, encoders, attitude, offset, last })
    }

    /// Index of the frame that the inertial unit is mounted on: the first that turns with all unactuated
    /// shape variables and with nothing else. `None` where the whole shape is actuated.
    pub fn frame(&self) -> Option<usize> {
        self.attitude.map(|attitude| attitude.frame())
    }

    /// Takes a reading. `expected` are the accelerations of all coordinates that the plan expects now,
    /// which spares the rates the lag of their filters; zeros for none.
    pub fn step(
        &mut self,
        reading: &Reading<T, N>,
        expected: &SVector<T, N>,
    ) -> Estimate<T, N, NS> {
        let inertial = reading.gyro.iter().chain(&reading.accelerometer).chain(expected);
        if !inertial.fold(true, |all, x| all & x.is_finite()) {
            self.last.fault = true;
            return self.last;
        }
        let mut state = self.encoders.step(&self.settings, &reading.counts, expected);
        let mut estimate = Estimate { state, fault: false, ..self.last };
        if let Some(attitude) = &mut self.attitude {
            attitude.step(self.robot, &self.settings, reading, &mut state);
            estimate.heading = attitude.heading;
            estimate.gyro_bias = attitude.gyro_bias();
        }
        estimate.offset = self.offset.step(self.robot, &self.settings, &mut state, expected);
        estimate.state = state;
        if self.settings.correct_offset {
            let (qx, qs) = R::split(&state.q);
            estimate.state.q = R::join(&qx, &(qs - estimate.offset));
        }
        self.last = estimate;
        estimate
    }
}
