//! The gains that are looked for.

/// Gains of the law, as in [`shapebot_dynamics::control::ControlDesign`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gains {
    pub(crate) period: f64,
    /// k_p, k_d, k_i of the balancing loop per axis; empty without one.
    pub(crate) lean: Vec<[f64; 3]>,
    /// k_x, k_v of the outer loop per axis.
    pub(crate) outer: Vec<[f64; 2]>,
    /// ω, ζ, k_i of servoed shape variables.
    pub(crate) servo: [f64; 3],
    pub(crate) observer_rate: f64,
    pub(crate) offset_rate: f64,
}

impl Gains {
    /// To four digits: what is printed is what was judged.
    pub(crate) fn rounded(mut self) -> Self {
        for gain in self.lean.iter_mut().flatten().chain(self.outer.iter_mut().flatten()) {
            *gain = round(*gain);
        }
        self.servo = self.servo.map(round);
        self.observer_rate = round(self.observer_rate);
        self.offset_rate = round(self.offset_rate);
        self
    }
}

/// The nearest number of four digits.
pub(crate) fn round(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
