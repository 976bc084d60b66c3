//! What the simulated nodes measure and drive.

/// Angle and rate of a motor's shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Angle, rad, counted over full turns.
    pub angle: f64,
    /// Rate, rad/s.
    pub rate: f64,
}

/// A quantity that a sensor node measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A coordinate of the model by its index in q, in rad or m.
    Coordinate(usize),
    /// Its rate.
    Rate(usize),
    /// Heading of the body against the floor, rad.
    Heading,
    /// Its rate, rad/s.
    HeadingRate,
    /// Angle of the drive unit against the body, rad.
    Yaw,
}

/// The physical world behind the nodes. Motors are numbered as the drives that turn them, from zero in
/// the order of the drive description.
pub trait Plant {
    /// Motion of a motor's shaft in the motor's own direction.
    fn motor(&self, motor: usize) -> Motion;

    /// Torque of a motor on its shaft, N·m, from now on.
    fn drive(&mut self, motor: usize, torque: f64);

    /// What an ideal sensor says.
    fn measure(&self, quantity: Quantity) -> f64;

    /// Extension of the legs from now on: 0 retracted, 1 on the floor.
    fn set_legs(&mut self, extension: f64);

    /// Lets `seconds` pass.
    fn advance(&mut self, seconds: f64);
}

/// A plant at a time: brought forward only when somebody looks at it or acts on it.
pub struct Physical<'a> {
    plant: &'a mut dyn Plant,
    time: &'a mut u64,
    now: u64,
}

impl<'a> Physical<'a> {
    /// The plant, whose state is that of `time`, at the time `now`, µs.
    pub fn new(plant: &'a mut dyn Plant, time: &'a mut u64, now: u64) -> Self {
        Self { plant, time, now }
    }

    /// The plant's state now.
    pub fn here(&mut self) -> &mut dyn Plant {
        let micros = self.now.saturating_sub(*self.time);
        if micros > 0 {
            #[expect(clippy::cast_precision_loss, reason = "2⁵³ µs are 285 years")]
            self.plant.advance(micros as f64 * 1e-6);
            *self.time = self.now;
        }
        self.plant
    }

    /// Time, µs.
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.now
    }
}

impl std::fmt::Debug for Physical<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Physical").field("now", &self.now).finish_non_exhaustive()
    }
}

/// Motors that turn free rotors, and nothing else: for tests of drives by themselves.
#[derive(Clone, Debug, Default)]
pub struct Rotors {
    /// Inertia of each rotor, kg·m².
    pub inertia: f64,
    motors: Vec<(Motion, f64)>,
    /// Extension of the legs.
    pub legs: f64,
}

impl Rotors {
    /// `count` rotors at rest.
    #[must_use]
    pub fn new(count: usize, inertia: f64) -> Self {
        Self { inertia, motors: vec![(Motion::default(), 0.0); count], legs: 1.0 }
    }

    /// Torque on a rotor, N·m.
    #[must_use]
    pub fn torque(&self, motor: usize) -> f64 {
        self.motors.get(motor).map_or(0.0, |(_, torque)| *torque)
    }
}

impl Plant for Rotors {
    fn motor(&self, motor: usize) -> Motion {
        self.motors.get(motor).map_or_else(Motion::default, |(motion, _)| *motion)
    }

    fn drive(&mut self, motor: usize, torque: f64) {
        if let Some((_, old)) = self.motors.get_mut(motor) {
            *old = torque;
        }
    }

    /// A coordinate is the angle of the motor with its number.
    fn measure(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Coordinate(index) => self.motor(index).angle,
            Quantity::Rate(index) => self.motor(index).rate,
            Quantity::Heading | Quantity::HeadingRate | Quantity::Yaw => 0.0,
        }
    }

    fn set_legs(&mut self, extension: f64) {
        self.legs = extension;
    }

    fn advance(&mut self, seconds: f64) {
        for (motion, torque) in &mut self.motors {
            let acceleration = *torque / self.inertia;
            motion.angle += (motion.rate + 0.5 * acceleration * seconds) * seconds;
            motion.rate += acceleration * seconds;
        }
    }
}
