//! Settling time: how long a press takes until the wall displays its requested stiffness.

/// Largest relative deviation of force over penetration from the requested stiffness that counts as settled (0.05 is 5 %).
pub const TOLERANCE: f64 = 0.05;

/// Measures the settling time of a press, from the first touch to the end of its hold.
#[derive(Debug, Clone, Copy)]
pub struct Settle {
    k_desired: f64,
    ramp_end: u64,
    end: u64,
    first_touch: Option<u64>,
    /// Tick after the last one whose force was outside the tolerance.
    settled: u64,
}

/// Settling times of a press, in ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settled {
    /// Ticks from the first touch until the press had settled.
    pub from_first_touch: u64,
    /// Ticks from the end of the press' ramp until the press had settled; 0 if it had settled before.
    pub from_ramp_end: u64,
}

impl Settle {
    /// Prepares the measure for a wall of `k_desired` N·m/rad, a ramp that ends with tick `ramp_end` and a hold that ends before
    /// tick `end`.
    #[must_use]
    pub fn new(k_desired: f64, ramp_end: u64, end: u64) -> Self {
        Self {
            k_desired,
            ramp_end,
            end,
            first_touch: None,
            settled: 0,
        }
    }

    /// Adds a tick: true penetration in rad and force in N·m, positive out of the wall.
    pub fn record(&mut self, index: u64, penetration_rad: f64, force_n_m: f64) {
        if index >= self.end {
            return;
        }
        if self.first_touch.is_none() {
            if penetration_rad <= 0.0 {
                return;
            }
            self.first_touch = Some(index);
            self.settled = index;
        }
        let wanted = self.k_desired * penetration_rad;
        // A device outside the wall has not settled; neither has one with a NaN value.
        let near = (force_n_m - wanted).abs() <= TOLERANCE * wanted.abs();
        if !(near && penetration_rad > 0.0) {
            self.settled = index + 1;
        }
    }

    /// Ticks until force over penetration stays within [`TOLERANCE`] of the requested stiffness to the end of the hold. `None` if
    /// it does not settle, or the device never touches the wall.
    #[must_use]
    pub fn settled(&self) -> Option<Settled> {
        let first_touch = self.first_touch?;
        (self.settled < self.end).then(|| Settled {
            from_first_touch: self.settled - first_touch,
            from_ramp_end: self.settled.saturating_sub(self.ramp_end),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measures a wall that is touched at tick 100 and whose stiffness rises over time `t` as `k (1 - e^(-t/τ))`. `τ` is the time
    /// constant.
    fn approach(time_constant: f64, end: u64) -> Option<Settled> {
        let mut settle = Settle::new(5.0, 150, end);
        for index in 0..2_000_u64 {
            let penetration = if index < 100 { -0.01 } else { 0.02 };
            let since = index.saturating_sub(100) as f64;
            let shown = 5.0 * (1.0 - (-since / time_constant).exp());
            settle.record(index, penetration, (shown * penetration).max(0.0));
        }
        settle.settled()
    }

    #[test]
    fn an_exponential_is_within_a_twentieth_after_three_time_constants() {
        // e^(-t/τ) = 1/20 at t = τ ln 20 = 2.9957 τ.
        let settled = approach(50.0, 1_000).unwrap();
        assert_eq!(settled.from_first_touch, (50.0 * 20_f64.ln()).ceil() as u64);
        assert_eq!(settled.from_ramp_end, settled.from_first_touch - 50);
    }

    #[test]
    fn what_settles_before_the_ramp_ends_waits_for_nothing_and_what_does_not_settle_says_so() {
        assert_eq!(approach(5.0, 1_000).unwrap().from_ramp_end, 0);
        assert_eq!(approach(500.0, 1_000), None);
        // A spring that is a tenth too soft never settles; an exact spring has settled at once.
        for (shown, expected) in [(4.5, None), (5.0, Some(0))] {
            let mut settle = Settle::new(5.0, 0, 100);
            (0..100).for_each(|index| settle.record(index, 0.02, shown * 0.02));
            assert_eq!(settle.settled().map(|s| s.from_first_touch), expected);
        }
    }

    #[test]
    fn a_wall_that_throws_the_hand_out_settles_after_that() {
        let mut settle = Settle::new(5.0, 0, 100);
        for index in 0..100 {
            let penetration = if index == 40 { -0.001 } else { 0.02 };
            settle.record(index, penetration, (5.0 * penetration).max(0.0));
        }
        assert_eq!(settle.settled().unwrap().from_first_touch, 41);
        assert_eq!(Settle::new(5.0, 0, 100).settled(), None, "nothing touched");
    }
}
