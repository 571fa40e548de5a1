//! Random numbers that are the same on every machine and with every compiler.

/// The random number generator SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Creates the generator from a seed; each seed has its own random-number sequence.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A random integer from `-size` to `size`, nearly uniform.
    pub fn whole(&mut self, size: i32) -> i32 {
        let values = 2 * i64::from(size) + 1;
        let value = (self.bits() >> 33) as i64 % values - i64::from(size);
        value as i32
    }

    /// A random real number from -1 up to, not including, 1.
    pub fn real(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
