//! Roughness (ripple) of the motor's torque while the hand presses steadily or moves slowly.

use std::f64::consts::{PI, SQRT_2};

/// Frequency above which changes of torque count as vibration rather than as response to the hand's motion, Hz.
pub const HIGH_PASS_HZ: f64 = 50.0;

/// Second-order Butterworth high-pass by the bilinear transform, with its corner exactly at [`HIGH_PASS_HZ`].
#[derive(Debug, Clone, Copy)]
struct HighPass {
    gain: f64,
    feedback: [f64; 2],
    input: [f64; 2],
    output: [f64; 2],
}

impl HighPass {
    /// Builds the filter for a control rate in Hz; `None` if the rate is too low for frequencies above the corner.
    fn new(rate_hz: f64) -> Option<Self> {
        if rate_hz < 4.0 * HIGH_PASS_HZ {
            return None;
        }
        let corner = libm::tan(PI * HIGH_PASS_HZ / rate_hz);
        let gain = 1.0 / (1.0 + SQRT_2 * corner + corner * corner);
        Some(Self {
            gain,
            feedback: [
                2.0 * (corner * corner - 1.0) * gain,
                (1.0 - SQRT_2 * corner + corner * corner) * gain,
            ],
            input: [0.0; 2],
            output: [0.0; 2],
        })
    }

    fn next(&mut self, x: f64) -> f64 {
        let y = self.gain * (x - 2.0 * self.input[0] + self.input[1])
            - self.feedback[0] * self.output[0]
            - self.feedback[1] * self.output[1];
        self.input = [x, self.input[0]];
        self.output = [y, self.output[0]];
        y
    }
}

/// Mean of the squares of a signal.
#[derive(Debug, Clone, Copy, Default)]
struct Squares {
    sum: f64,
    count: u64,
}

impl Squares {
    fn add(&mut self, x: f64) {
        self.sum += x * x;
        self.count += 1;
    }

    fn rms(self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}

/// Ripple of the motor's force over a window of ticks (control periods). Only ticks in contact with the wall count.
#[derive(Debug, Clone, Copy)]
pub struct Ripple {
    window: (u64, u64),
    last_n_m: f64,
    steps: Squares,
    high_pass: Option<HighPass>,
    high: Squares,
}

impl Ripple {
    /// Starts a measurement from the first tick of `window` to the tick before its second value.
    #[must_use]
    pub fn new(window: (u64, u64), rate_hz: f64) -> Self {
        Self {
            window,
            last_n_m: 0.0,
            steps: Squares::default(),
            high_pass: HighPass::new(rate_hz),
            high: Squares::default(),
        }
    }

    /// Adds a tick: force in N·m, positive out of the wall. Call it for every tick of the run, so that the filter has settled when
    /// the window begins.
    pub fn record(&mut self, index: u64, force_n_m: f64) {
        let high = self.high_pass.as_mut().map(|filter| filter.next(force_n_m));
        let touched = force_n_m != 0.0 && self.last_n_m != 0.0;
        if touched && index >= self.window.0 && index < self.window.1 {
            self.steps.add(force_n_m - self.last_n_m);
            high.into_iter().for_each(|high| self.high.add(high));
        }
        self.last_n_m = force_n_m;
    }

    /// Root mean square of the change of force from tick to tick, N·m; `None` without contact in the window.
    #[must_use]
    pub fn tick_to_tick_rms_n_m(&self) -> Option<f64> {
        self.steps.rms()
    }

    /// Root mean square of the force above [`HIGH_PASS_HZ`], N·m. `None` without contact, or for a control rate below four times
    /// [`HIGH_PASS_HZ`].
    #[must_use]
    pub fn above_50_hz_rms_n_m(&self) -> Option<f64> {
        self.high.rms()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 1_000.0;

    /// Ripple of a mean push of 0.1 N·m with a sine, over whole periods after the filter has settled.
    fn sine(amplitude: f64, frequency_hz: f64) -> Ripple {
        let mut ripple = Ripple::new((1_000, 3_000), RATE_HZ);
        for index in 0..4_000_u64 {
            let phase = 2.0 * PI * frequency_hz * index as f64 / RATE_HZ;
            ripple.record(index, 0.1 + amplitude * phase.sin());
        }
        ripple
    }

    #[test]
    fn a_sine_steps_by_twice_its_amplitude_times_the_sine_of_half_a_tick() {
        for frequency_hz in [1.0, 10.0, 125.0] {
            let found = sine(0.01, frequency_hz).tick_to_tick_rms_n_m().unwrap();
            let expected = 0.01 * 2.0 * (PI * frequency_hz / RATE_HZ).sin() / SQRT_2;
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }

    #[test]
    fn the_filter_passes_what_a_butterworth_passes() {
        let warp = |hz: f64| (PI * hz / RATE_HZ).tan();
        for frequency_hz in [2.0, 20.0, 50.0, 125.0, 250.0] {
            let found = sine(0.01, frequency_hz).above_50_hz_rms_n_m().unwrap();
            let ratio = warp(HIGH_PASS_HZ) / warp(frequency_hz);
            let expected = 0.01 / SQRT_2 / (1.0 + ratio.powi(4)).sqrt();
            // The filter's start transient decays by e^(-222) in the second before the window.
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{frequency_hz} Hz: {found} {expected}"
            );
        }
    }

    #[test]
    fn a_steady_push_has_none_and_an_untouched_wall_no_value() {
        let mut steady = Ripple::new((10, 20), RATE_HZ);
        (0..20).for_each(|index| steady.record(index, 0.1));
        assert_eq!(steady.tick_to_tick_rms_n_m(), Some(0.0));
        let mut untouched = Ripple::new((10, 20), RATE_HZ);
        (0..20).for_each(|index| untouched.record(index, 0.0));
        assert_eq!(untouched.tick_to_tick_rms_n_m(), None);
        let mut slow = Ripple::new((0, 20), 100.0);
        (0..20).for_each(|index| slow.record(index, 0.1));
        assert_eq!(slow.above_50_hz_rms_n_m(), None);
    }
}
