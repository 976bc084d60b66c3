//! Pseudo-random inputs, the same on every machine.

/// The generator xorshift64* of Vigna with a fixed seed.
#[derive(Clone, Copy, Debug)]
pub struct Inputs(u64);

impl Inputs {
    /// From the beginning.
    #[must_use]
    pub const fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    /// A number in [lower, upper).
    pub fn between(&mut self, lower: f32, upper: f32) -> f32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as u32;
        // 24 bits: exact in single precision.
        lower + (upper - lower) * (bits as f32 / 16_777_216.0)
    }

    /// Several numbers in [−limit, limit).
    pub fn within<const N: usize>(&mut self, limit: f32) -> [f32; N] {
        core::array::from_fn(|_| self.between(-limit, limit))
    }
}

impl Default for Inputs {
    fn default() -> Self {
        Self::new()
    }
}
