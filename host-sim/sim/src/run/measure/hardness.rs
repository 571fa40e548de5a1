//! Rate-hardness (thesis, equation 1.5): rate of change of the force divided by the device's velocity at the initial contact.

/// Longest time that counts as initial contact, s: shorter than a hand's reaction time, long enough for several encoder counts.
const LONGEST_S: f64 = 0.02;
/// Least number of ticks (control periods) to which a slope is fitted.
const FEWEST: f64 = 3.0;

/// Rate-hardness `Ḟ/ẋ` of the initial contact: least-squares slope of true force over true penetration. The contact lasts from the
/// first force to the first reversal of the motion, at most 20 ms.
#[derive(Debug, Clone, Copy)]
pub struct RateHardness {
    ticks_left: u64,
    deepest_rad: f64,
    over: bool,
    n: f64,
    x: f64,
    f: f64,
    xx: f64,
    xf: f64,
    /// Penetration at the first contact, rad. Sums use penetrations relative to it, to avoid cancellation.
    origin_rad: f64,
}

impl RateHardness {
    /// Prepares the measure for a control period in s.
    #[must_use]
    pub fn new(period_s: f64) -> Self {
        Self {
            ticks_left: (LONGEST_S / period_s).round().max(FEWEST) as u64,
            deepest_rad: f64::NEG_INFINITY,
            over: false,
            n: 0.0,
            x: 0.0,
            f: 0.0,
            xx: 0.0,
            xf: 0.0,
            origin_rad: 0.0,
        }
    }

    /// Adds a tick: true penetration at the sample in rad, and the force held after the sample in N·m, positive out of the wall.
    ///
    /// While a motion slows down, a lag of the force makes the slope steeper. Pairing each sample with the force held after it
    /// keeps the lag of the zero-order hold out of the measure.
    pub fn record(&mut self, penetration_rad: f64, force_n_m: f64) {
        let touched = self.n > 0.0;
        if self.over || (!touched && force_n_m <= 0.0) {
            return;
        }
        if !touched {
            self.origin_rad = penetration_rad;
        }
        if penetration_rad <= self.deepest_rad || self.ticks_left == 0 {
            self.over = true;
            return;
        }
        self.deepest_rad = penetration_rad;
        self.ticks_left -= 1;
        let x = penetration_rad - self.origin_rad;
        self.n += 1.0;
        self.x += x;
        self.f += force_n_m;
        self.xx += x * x;
        self.xf += x * force_n_m;
    }

    /// Rate-hardness, N·m/rad; `None` if the contact was shorter than three ticks.
    #[must_use]
    pub fn n_m_per_rad(&self) -> Option<f64> {
        let slope = (self.xf - self.x * self.f / self.n) / (self.xx - self.x * self.x / self.n);
        (self.n >= FEWEST && slope.is_finite()).then_some(slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1e-3;

    /// Measures the rate-hardness of a wall with force `F(x, v)` for a mass that enters at 1 rad/s and swings back after 31 ms.
    fn hardness(force: impl Fn(f64, f64) -> f64) -> Option<f64> {
        let mut hardness = RateHardness::new(PERIOD_S);
        for index in 0..200 {
            let phase = 0.05 * f64::from(index - 20);
            let (x, v) = (0.02 * phase.sin(), phase.cos());
            hardness.record(x, if x > 0.0 { force(x, v).max(0.0) } else { 0.0 });
        }
        hardness.n_m_per_rad()
    }

    #[test]
    fn a_spring_is_as_hard_as_it_is_stiff() {
        let found = hardness(|x, _| 5.0 * x).unwrap();
        assert!((found - 5.0).abs() < 1e-9, "{found}");
        // A jump at the surface is not a slope.
        let preloaded = hardness(|x, _| 0.05 + 5.0 * x).unwrap();
        assert!((preloaded - 5.0).abs() < 1e-9, "{preloaded}");
    }

    #[test]
    fn damping_that_fades_with_the_speed_takes_hardness_away() {
        // The force of the damper falls while the device slows down, thesis §1.2.6.
        let damped = hardness(|x, v| 5.0 * x + 0.02 * v).unwrap();
        assert!(damped < 4.9, "{damped}");
    }

    #[test]
    fn the_way_back_does_not_count_and_a_touch_of_two_ticks_has_no_slope() {
        // The device enters at constant velocity, then leaves without a force.
        let mut there = RateHardness::new(PERIOD_S);
        (1..=10).for_each(|i| there.record(f64::from(i) * 1e-3, f64::from(i) * 5e-3));
        (1..=9).for_each(|i| there.record(f64::from(10 - i) * 1e-3, 0.0));
        assert!((there.n_m_per_rad().unwrap() - 5.0).abs() < 1e-9);
        let mut short = RateHardness::new(PERIOD_S);
        [1e-3, 2e-3, 1e-3]
            .iter()
            .for_each(|x| short.record(*x, 5.0 * x));
        assert_eq!(short.n_m_per_rad(), None);
    }

    #[test]
    fn only_the_first_twenty_milliseconds_count() {
        let mut hardness = RateHardness::new(PERIOD_S);
        for index in 1..100 {
            let x = f64::from(index) * 1e-3;
            hardness.record(x, if index <= 20 { 5.0 * x } else { 0.1 });
        }
        assert!((hardness.n_m_per_rad().unwrap() - 5.0).abs() < 1e-9);
    }
}
