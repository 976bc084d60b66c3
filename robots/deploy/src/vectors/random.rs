//! Numbers that look random and are always the same.

/// The generator xorshift64* of Vigna.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// From the beginning.
    pub(crate) const fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    /// A number in [lower, upper).
    pub(crate) fn between(&mut self, lower: f64, upper: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32) as u32;
        lower + (upper - lower) * (f64::from(bits) / 4_294_967_296.0)
    }
}
