//! Hardness of a contact: how fast the torque rises when the device enters the wall.

use std::collections::VecDeque;

/// Time over which a change of the torque is measured, s, or one tick if a tick is longer. A fixed time makes different control
/// rates comparable.
const CHANGE_S: f64 = 1e-3;
/// Time after the device enters the wall within which the largest torque is measured, s. A hand perceives a tap by the torque in
/// this time.
pub const RISE_S: f64 = 5e-3;
/// Longest time that counts as initial contact, s; the same as for rate-hardness.
const LONGEST_S: f64 = 0.02;

/// Extended rate-hardness (Han and Choi 2010): largest rate of change of the force, divided by the largest speed, in the first
/// contact. Also measures the largest torque in the first 5 ms of the contact.
#[derive(Debug, Clone)]
pub struct ContactRise {
    period_s: f64,
    /// Forces of the last [`CHANGE_S`] seconds, N·m, the latest at the end.
    past: VecDeque<f64>,
    /// Number of ticks since the device entered the wall; `None` before.
    inside: Option<u64>,
    over: bool,
    steepest_n_m_per_s: f64,
    fastest_rad_per_s: f64,
    torque_n_m: f64,
}

impl ContactRise {
    /// Prepares the measure for a control period in s.
    #[must_use]
    pub fn new(period_s: f64) -> Self {
        let change = (CHANGE_S / period_s).round().max(1.0) as usize;
        Self {
            period_s,
            past: VecDeque::from(vec![0.0; change]),
            inside: None,
            over: false,
            steepest_n_m_per_s: 0.0,
            fastest_rad_per_s: 0.0,
            torque_n_m: 0.0,
        }
    }

    /// Adds a tick: whether the wall is touched, and the inward speed in rad/s at the tick's sample. The force in N·m is held over
    /// the tick, positive out of the wall.
    pub fn record(&mut self, touches: bool, speed_rad_per_s: f64, force_n_m: f64) {
        if self.over || (self.inside.is_none() && !touches) {
            return;
        }
        let ticks = self.inside.map_or(0, |ticks| ticks + 1);
        let ended = ticks as f64 * self.period_s > LONGEST_S - 0.5 * self.period_s;
        if ended || !touches {
            self.over = true;
            return;
        }
        self.inside = Some(ticks);
        let before = self.past.pop_front().unwrap_or_default();
        self.past.push_back(force_n_m);
        let per_s = (force_n_m - before) / (self.past.len() as f64 * self.period_s);
        self.steepest_n_m_per_s = self.steepest_n_m_per_s.max(per_s);
        self.fastest_rad_per_s = self.fastest_rad_per_s.max(speed_rad_per_s.abs());
        if (ticks as f64 + 0.5) * self.period_s < RISE_S {
            self.torque_n_m = self.torque_n_m.max(force_n_m);
        }
    }

    /// Extended rate-hardness, N·m/rad; `None` without a contact in which the device moved.
    #[must_use]
    pub fn n_m_per_rad(&self) -> Option<f64> {
        let hardness = self.steepest_n_m_per_s / self.fastest_rad_per_s;
        (self.inside.is_some() && hardness.is_finite()).then_some(hardness)
    }

    /// Largest torque in the first 5 ms of the contact, N·m; `None` without a contact.
    #[must_use]
    pub fn torque_n_m(&self) -> Option<f64> {
        self.inside.map(|_| self.torque_n_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measures a wall with force `F(x, v)`, for a device that enters at 2 rad/s and slows down evenly to rest in 10 ms.
    fn entered(period_s: f64, force: impl Fn(f64, f64) -> f64) -> ContactRise {
        let mut rise = ContactRise::new(period_s);
        let ticks = (0.012 / period_s) as i32;
        rise.record(false, 2.0, 0.0);
        for tick in 0..ticks {
            let t = (f64::from(tick) + 1e-6) * period_s;
            let (x, v) = (2.0 * t - 100.0 * t * t, 2.0 - 200.0 * t);
            rise.record(true, v, force(x, v));
        }
        rise
    }

    #[test]
    fn a_spring_is_as_hard_as_it_is_stiff_and_damping_adds_what_it_has_at_once() {
        for period_s in [1e-3, 1e-4, 2e-5] {
            let spring = entered(period_s, |x, _| 5.0 * x);
            // The slope is taken over one millisecond, in which the speed falls by a tenth.
            let found = spring.n_m_per_rad().unwrap();
            assert!((4.4..=5.0).contains(&found), "{period_s}: {found}");
            let torque = spring.torque_n_m().unwrap();
            let last = 5e-3 - period_s;
            let expected = 5.0 * (2.0 * last - 100.0 * last * last);
            assert!(
                (torque / expected - 1.0).abs() < 1e-2,
                "{torque} {expected}"
            );
            let damped = entered(period_s, |x, v| 5.0 * x + 0.01 * v);
            // The damper's jump of 0.02 N·m counts as 20 N·m/s over one millisecond.
            let found = damped.n_m_per_rad().unwrap();
            assert!((9.5..=14.5).contains(&found), "{period_s}: {found}");
            assert!(damped.torque_n_m().unwrap() > torque);
        }
    }

    #[test]
    fn only_the_first_contact_counts() {
        let mut rise = ContactRise::new(1e-3);
        assert_eq!((rise.n_m_per_rad(), rise.torque_n_m()), (None, None));
        rise.record(false, 1.0, 0.0);
        assert_eq!((rise.n_m_per_rad(), rise.torque_n_m()), (None, None));
        rise.record(true, 1.0, 5e-3);
        rise.record(true, 1.0, 10e-3);
        // A rise later than 5 ms after the touch counts for the hardness, not for the touch torque.
        (3..=10).for_each(|i| rise.record(true, 1.0, f64::from(i) * 5e-3));
        assert_eq!(rise.torque_n_m(), Some(25e-3));
        assert!((rise.n_m_per_rad().unwrap() - 5.0).abs() < 1e-9);
        // A second contact, with a larger force, does not count.
        rise.record(false, -1.0, 0.0);
        rise.record(true, 9.0, 1.0);
        assert!((rise.n_m_per_rad().unwrap() - 5.0).abs() < 1e-9);
    }
}
