//! A random number generator with the same numbers on every machine.

/// Random number generator (xorshift).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Makes the generator of a seed; the same seed gives the same random numbers.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Draws a uniformly distributed number in `[-1, 1)`.
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Draws a number between two positive numbers, evenly on a logarithmic scale.
    pub fn decades(&mut self, least: f64, most: f64) -> f64 {
        let share = 0.5 * (self.uniform() + 1.0);
        least * (most / least).powf(share)
    }
}
