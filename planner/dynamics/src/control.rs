//! A balancing robot's control design: plain data that generated modules hold in a constant.
//!
//! All gains are in units of the position variables, so that no robot's name or parameter appears. With
//! n_x position variables, e = K⁰_u (q_su − q_su^d) is the error of the unactuated shape as the
//! acceleration of q_x that it causes; u_c = −k_x δx − k_v δẋ is the acceleration that the outer loop
//! asks for, δx the error of the output in units of q_x.

/// Gains and limits of the control law, with what is known about the loop they close.
///
/// Slices have one entry per position variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlDesign {
    /// Control period for which the figures hold, s.
    pub period: f64,
    /// The position variables are actuated and balance the unactuated shape; otherwise the shape is
    /// servoed and there is no balancing loop.
    pub balancing: bool,
    /// k_p of the balancing loop: acceleration of q_x per e. Empty without a balancing loop.
    pub lean: &'static [f64],
    /// k_d of the balancing loop, s. Empty without a balancing loop.
    pub lean_rate: &'static [f64],
    /// k_i of the balancing loop, 1/s. Empty without a balancing loop.
    pub lean_integral: &'static [f64],
    /// k_x of the outer loop, 1/s².
    pub position: &'static [f64],
    /// k_v of the outer loop, 1/s.
    pub velocity: &'static [f64],
    /// Computed torque and PID of the actuated shape variables.
    pub servo: Servo,
    /// Rate of the momentum observer, 1/s; zero if its conditions (position variables actuated and
    /// cyclic, G_x = 0) are not proved.
    pub observer_rate: f64,
    /// Rate of the observer of a constant offset of the measured shape, 1/s.
    pub offset_rate: f64,
    /// What is known about the closed loop.
    pub figures: LoopFigures,
}

/// Computed torque of the actuated shape variables: q̈ = q̈^d + ω² ε + 2 ζ ω ε̇ + k_i ∫ε.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// ω, rad/s.
    pub rate: f64,
    /// ζ.
    pub damping: f64,
    /// k_i, 1/s³.
    pub integral: f64,
}

/// Figures of the linearised sampled loop: zero-order hold, one period of delay, observers included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopFigures {
    /// Poles at the model's own parameter values as s = ln(z)/T, 1/s: fastest decay last. Poles of pure
    /// delay (z = 0) are left out.
    pub poles: &'static [Pole],
    /// Smallest damping ratio of those poles.
    pub damping: f64,
    /// Smallest decay rate of those poles, 1/s.
    pub decay: f64,
    /// Smallest damping ratio over the ranges.
    pub worst_damping: f64,
    /// Smallest decay rate over the ranges, 1/s.
    pub worst_decay: f64,
    /// Delay beyond the one period that the loop bears at the model's own values, s: a whole number of
    /// periods.
    pub delay_margin: f64,
    /// The same, smallest over the ranges.
    pub worst_delay_margin: f64,
    /// Ranges of the plant's parameters, each alone at its ends, over which the loop was found stable.
    pub ranges: &'static [ParameterRange],
    /// Share of all parameters' values by which they may differ together, at random corners.
    pub together: f64,
    /// Points of both kinds at which poles were computed.
    pub samples: usize,
}

/// A pole, 1/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pole {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

/// A range of a parameter of the plant; the controller keeps the model's own value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterRange {
    /// Identifier: `m_b`.
    pub name: &'static str,
    /// Smallest value.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
}
