//! Outward motion of the device after the hand lets go of the wall.

/// Measures the outward motion of the device from the moment at which the hand begins to let go.
#[derive(Debug, Clone, Copy)]
pub struct Release {
    from: u64,
    speed_rad_per_s: f64,
    excursion_rad: f64,
}

impl Release {
    /// Starts the measure at tick `from`.
    #[must_use]
    pub fn new(from: u64) -> Self {
        Self {
            from,
            speed_rad_per_s: 0.0,
            excursion_rad: 0.0,
        }
    }

    /// Adds a tick: true penetration in rad and true velocity in rad/s, positive into the wall.
    pub fn record(&mut self, index: u64, penetration_rad: f64, velocity_rad_per_s: f64) {
        if index >= self.from {
            self.speed_rad_per_s = self.speed_rad_per_s.max(-velocity_rad_per_s);
            self.excursion_rad = self.excursion_rad.max(-penetration_rad);
        }
    }

    /// Largest outward speed of the device, rad/s.
    #[must_use]
    pub fn speed_rad_per_s(&self) -> f64 {
        self.speed_rad_per_s
    }

    /// Largest distance of the device outside the wall's surface, rad. It includes the distance by which the hand itself withdraws.
    #[must_use]
    pub fn excursion_rad(&self) -> f64 {
        self.excursion_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_on_a_spring_that_is_let_go_swings_through_with_all_it_held() {
        // The device is held at the depth `a` and released at tick 500: x = a cos wt, v = -a w sin wt.
        let (a, w, period_s) = (0.02, 50.0, 1e-4);
        let mut release = Release::new(500);
        for index in 0..2_000_u64 {
            let phase = w * index.saturating_sub(500) as f64 * period_s;
            release.record(index, a * phase.cos(), -a * w * phase.sin());
        }
        assert!((release.speed_rad_per_s() / (a * w) - 1.0).abs() < 1e-5);
        assert!((release.excursion_rad() / a - 1.0).abs() < 1e-5);
    }

    #[test]
    fn what_was_before_does_not_count_and_inward_is_not_outward() {
        let mut release = Release::new(10);
        release.record(9, -1.0, -5.0);
        release.record(10, 0.02, 3.0);
        assert_eq!(release.speed_rad_per_s(), 0.0);
        assert_eq!(release.excursion_rad(), 0.0);
    }
}
