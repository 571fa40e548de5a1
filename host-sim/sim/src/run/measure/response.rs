//! Dynamic stiffness: force over penetration at the frequency at which the hand moves.

use serde::Serialize;
use std::f64::consts::TAU;

/// A rhythmic motion of the hand at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wiggle {
    /// Frequency of the hand's motion, Hz.
    pub frequency_hz: f64,
    /// First tick, and tick after the last, of the measurement: whole periods at full amplitude.
    pub window: (u64, u64),
}

/// Dynamic stiffness: ratio of force to penetration at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DynamicStiffness {
    /// Frequency of the hand's motion, Hz.
    pub frequency_hz: f64,
    /// Amplitude of the force divided by that of the penetration, N·m/rad.
    pub modulus_n_m_per_rad: f64,
    /// Phase by which the force leads the penetration, degrees. A force that lags (negative phase) acts as negative damping.
    pub phase_deg: f64,
}

/// Sums over one signal, for a least-squares fit of mean, cosine and sine.
#[derive(Debug, Clone, Copy, Default)]
struct Signal {
    sum: f64,
    cos: f64,
    sin: f64,
}

impl Signal {
    fn add(&mut self, x: f64, (sin, cos): (f64, f64)) {
        self.sum += x;
        self.cos += x * cos;
        self.sin += x * sin;
    }
}

/// Fits a mean and a sine to force and penetration by least squares. Unlike a plain correlation, the fit allows a window that does
/// not end on a tick, and the mean does not distort the sine.
#[derive(Debug, Clone, Copy)]
pub struct Response {
    wiggle: Wiggle,
    radians_per_tick: f64,
    ticks: f64,
    cos: f64,
    sin: f64,
    cos_cos: f64,
    cos_sin: f64,
    force: Signal,
    penetration: Signal,
    touched: bool,
}

impl Response {
    /// Prepares the measure for a motion and a control period in s.
    #[must_use]
    pub fn new(wiggle: Wiggle, period_s: f64) -> Self {
        Self {
            wiggle,
            radians_per_tick: TAU * wiggle.frequency_hz * period_s,
            ticks: 0.0,
            cos: 0.0,
            sin: 0.0,
            cos_cos: 0.0,
            cos_sin: 0.0,
            force: Signal::default(),
            penetration: Signal::default(),
            touched: true,
        }
    }

    /// Adds a tick: means over the tick of the true penetration in rad and of the force in N·m, positive out of the wall.
    pub fn record(&mut self, index: u64, penetration_rad: f64, force_n_m: f64) {
        let (from, to) = self.wiggle.window;
        if index < from || index >= to {
            return;
        }
        // If the device leaves the wall, the fitted sines do not describe a stiffness.
        self.touched &= penetration_rad > 0.0 && force_n_m > 0.0;
        let (sin, cos) = libm::sincos((index - from) as f64 * self.radians_per_tick);
        self.ticks += 1.0;
        self.cos += cos;
        self.sin += sin;
        self.cos_cos += cos * cos;
        self.cos_sin += cos * sin;
        self.force.add(force_n_m, (sin, cos));
        self.penetration.add(penetration_rad, (sin, cos));
    }

    /// Amplitudes of the cosine and sine components fitted to a signal.
    fn fitted(&self, signal: &Signal) -> (f64, f64) {
        let n = self.ticks;
        let cos_cos = self.cos_cos - self.cos * self.cos / n;
        let cos_sin = self.cos_sin - self.cos * self.sin / n;
        let sin_sin = (n - self.cos_cos) - self.sin * self.sin / n;
        let with_cos = signal.cos - signal.sum * self.cos / n;
        let with_sin = signal.sin - signal.sum * self.sin / n;
        let determinant = cos_cos * sin_sin - cos_sin * cos_sin;
        (
            (with_cos * sin_sin - with_sin * cos_sin) / determinant,
            (with_sin * cos_cos - with_cos * cos_sin) / determinant,
        )
    }

    /// Dynamic stiffness at the frequency of the motion. `None` if the device left the wall or the force did not push outward
    /// throughout the window, if the penetration did not vary, or if the window is too short for the fit.
    #[must_use]
    pub fn stiffness(&self) -> Option<DynamicStiffness> {
        let (force, penetration) = (self.fitted(&self.force), self.fitted(&self.penetration));
        let modulus = libm::hypot(force.0, force.1) / libm::hypot(penetration.0, penetration.1);
        // a cos wt + b sin wt lags a cosine by atan2(b, a).
        let lead = libm::atan2(penetration.1, penetration.0) - libm::atan2(force.1, force.0);
        let turns = lead / TAU;
        (self.touched && modulus.is_finite()).then(|| DynamicStiffness {
            frequency_hz: self.wiggle.frequency_hz,
            modulus_n_m_per_rad: modulus,
            phase_deg: 360.0 * (turns - turns.round()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1e-3;

    /// Measures a wall `F = F_0 + k x + B v` whose force lags by `lag_s`, for a penetration `x` of 0.02 rad ± 0.006 rad. `k` is the
    /// stiffness, `B` the damping, `v` the velocity.
    fn wall(frequency_hz: f64, k: f64, damping: f64, lag_s: f64) -> Option<DynamicStiffness> {
        let periods = (1.0 / frequency_hz / PERIOD_S).round() as u64;
        let window = (300, 300 + 3 * periods);
        let mut response = Response::new(
            Wiggle {
                frequency_hz,
                window,
            },
            PERIOD_S,
        );
        let w = TAU * frequency_hz;
        for index in 0..window.1 + 500 {
            let t = index as f64 * PERIOD_S;
            let x = |t: f64| 0.02 + 0.006 * (w * t).sin();
            let v = |t: f64| 0.006 * w * (w * t).cos();
            let force = k * x(t - lag_s) + damping * v(t - lag_s);
            response.record(index, x(t), force);
        }
        response.stiffness()
    }

    #[test]
    fn a_spring_shows_its_stiffness_without_lead_or_lag_at_every_frequency() {
        // At 3 and 7 Hz a period is not a whole number of ticks.
        for frequency_hz in [0.25, 1.0, 3.0, 7.0, 16.0] {
            let found = wall(frequency_hz, 5.0, 0.0, 0.0).unwrap();
            assert!((found.modulus_n_m_per_rad - 5.0).abs() < 1e-9, "{found:?}");
            assert!(found.phase_deg.abs() < 1e-8, "{found:?}");
        }
    }

    #[test]
    fn a_delay_shows_as_its_angle_of_lag() {
        let found = wall(4.0, 5.0, 0.0, 2e-3).unwrap();
        assert!((found.modulus_n_m_per_rad - 5.0).abs() < 1e-9, "{found:?}");
        assert!(
            (found.phase_deg + 360.0 * 4.0 * 2e-3).abs() < 1e-8,
            "{found:?}"
        );
    }

    #[test]
    fn a_spring_with_a_damper_leads_by_the_angle_of_its_impedance() {
        let (k, damping, frequency_hz) = (5.0, 0.02, 8.0);
        let found = wall(frequency_hz, k, damping, 0.0).unwrap();
        let reactance = damping * TAU * frequency_hz;
        assert!((found.modulus_n_m_per_rad - k.hypot(reactance)).abs() < 1e-9);
        assert!((found.phase_deg - reactance.atan2(k).to_degrees()).abs() < 1e-8);
    }

    #[test]
    fn a_wall_that_is_left_or_a_hand_that_is_still_has_no_value() {
        // A force that pulls inward is not a contact with the wall.
        assert!(wall(1.0, -5.0, 0.0, 0.0).is_none());
        let still = Wiggle {
            frequency_hz: 1.0,
            window: (0, 1_000),
        };
        let mut response = Response::new(still, PERIOD_S);
        assert!(response.stiffness().is_none(), "nothing recorded");
        (0..1_000).for_each(|index| response.record(index, 0.02, 0.0));
        assert!(response.stiffness().is_none());
    }
}
