//! Largest penetration of the device into the wall.

/// Measures the deepest penetration of the device during a press.
#[derive(Debug, Clone, Copy, Default)]
pub struct PeakPenetration {
    peak_rad: f64,
}

impl PeakPenetration {
    /// Adds the true penetration of a tick, rad.
    pub fn record(&mut self, penetration_rad: f64) {
        self.peak_rad = self.peak_rad.max(penetration_rad);
    }

    /// Peak penetration divided by `F/k_de`, the static penetration of a spring of the requested stiffness `k_de` under the same
    /// push `F`. It is 1 for a wall of the requested stiffness without overshoot.
    #[must_use]
    pub fn ratio(&self, push_n_m: f64, k_desired: f64) -> f64 {
        self.peak_rad * k_desired / push_n_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_press_that_is_put_suddenly_on_a_spring_overshoots_by_two() {
        // From rest, J x'' = F - k x gives x = F/k (1 - cos wt), whose maximum is 2 F/k.
        let (k, push) = (5.0, 0.1);
        let mut peak = PeakPenetration::default();
        for step in 0..10_000 {
            peak.record(push / k * (1.0 - (f64::from(step) * 1e-3).cos()));
        }
        let ratio = peak.ratio(push, k);
        // The maximum lies within half a step (0.0005) of a sample, so the sampled value is within 0.0005²/2 of it.
        assert!((ratio - 2.0).abs() < 1e-6, "{ratio}");
        // The same motion is ten times too deep for a wall that should be ten times as stiff.
        assert!((peak.ratio(push, 10.0 * k) - 20.0).abs() < 1e-5);
    }

    #[test]
    fn outside_is_no_penetration() {
        let mut peak = PeakPenetration::default();
        peak.record(-0.3);
        assert_eq!(peak.ratio(0.1, 5.0), 0.0);
    }
}
