//! Detects two motions of the shaft that no hand makes: a fast oscillation, and a run against the motor's torque.
//!
//! The energy guard calculates the motor's work from the measured positions and the commanded torque. If the shaft has other
//! positions, or the motor another torque, the guard cannot bound the energy that a hand gets. Then the shaft moves in one of two
//! ways.
//!
//! **Oscillation.** A hand acts on purpose at up to some 10 Hz ("Engineering Haptic Devices", 3rd edition, chapter 3). A faster
//! oscillation comes from the control loop: the wall is unstable. Either the settings do not fit the device, or a part broke: the
//! encoder's readings are late, or its magnet is loose.
//!
//! A swing is a reversal of the shaft's speed, with at least 6 rad/s in each direction; a few encoder counts are added to this
//! threshold, so that jitter is no swing. Eight swings in a row, each at most 40 ms after the one before, raise the fault: an
//! oscillation of at least 12.5 Hz, over four periods. With a peak speed of 6 rad/s, its amplitude at 12.5 Hz is 4.4 degrees. On an emulated board a knob that hits the wall at 35
//! rad/s swings for two periods at such speeds.
//!
//! An oscillation within the play of a loose magnet is not detected, because the encoder's reading hardly changes.
//!
//! **Runaway.** A current of at least a quarter of `motor.current_limit_a` flows in the direction that, by the calibrated electrical
//! angle, brakes the shaft. Yet the shaft turns at 25 rad/s or more and does not slow down for 10 ms. A knob that a hand turned fast
//! into a wall would slow down. So the motor probably drives when it should brake: the electrical angle is wrong by about half a
//! turn.

use super::Found;
use crate::current::CurrentReport;
use crate::units::{clamp_i32, milli, narrow};
use fixed::types::I16F16;
use touchstone_protocol::{DeviceSettings, FaultCode};

/// Encoder counts by which readings of a shaft at rest may differ. They are added to the limits for overspeed, jumps and swings.
pub(super) const JITTER: i64 = 4;
/// Least speed of a swing in each direction, rad/s.
const LEAST_SWING: u64 = 6;
/// Number of swings in a row that raise the fault.
const MOST_SWINGS: u8 = 8;
/// Inverse of the longest time between two swings, 1/s: 40 ms.
const SWINGS_PER_SECOND: u32 = 25;
/// Least speed of a runaway, rad/s.
const LEAST_RUN: u64 = 25;
/// Inverse of the time after which a runaway is the fault, 1/s: 10 ms.
const RUNS_PER_SECOND: u32 = 100;

/// Coefficients of the checks of the shaft's motion.
#[derive(Debug, Clone, Copy)]
pub struct MotionConfig {
    /// Counts that the shaft moves at the least speed of a swing, in the window over which its speed is averaged.
    swing: i32,
    /// Counts in the same window at the least speed of a runaway.
    run: i32,
    /// Least current that opposes a runaway, A.
    opposing: I16F16,
    rate_hz: u32,
}

impl MotionConfig {
    /// Computes the coefficients. `window` is the number of control periods over which the speed is averaged.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, window: usize) -> Self {
        let rate_hz = settings.timing.rate_hz.max(1);
        // Counts in the window for 1,000 rad/s, which are 159 turns a second. The product of 32, 5 and 8 bits fits into 64 bits.
        let turn = u64::from(settings.encoder.counts_per_rev) * window as u64;
        let per_1000 = turn * 159 / u64::from(rate_hz);
        let counts = |speed_rad_per_s: u64| {
            let whole = per_1000 * speed_rad_per_s / 1_000;
            // One more for rounding.
            clamp_i32(whole.cast_signed().saturating_add(JITTER + 1))
        };
        Self {
            swing: counts(LEAST_SWING),
            run: counts(LEAST_RUN),
            opposing: narrow(settings.motor.current_limit_a) >> 2,
            rate_hz,
        }
    }

    /// Coefficients that do not come from settings: counts in the speed's window at the least speed of a swing and of a runaway, the
    /// least current in A that opposes a runaway, and the control rate in Hz. Proofs take any.
    #[must_use]
    pub const fn from_least(swing: i32, run: i32, opposing: I16F16, rate_hz: u32) -> Self {
        Self {
            swing,
            run,
            opposing,
            rate_hz,
        }
    }
}

/// The latest swings, and the present runaway.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Motion {
    /// Sign of the speed in the last swing; 0 before the first.
    direction: i8,
    /// Swings in a row.
    swings: u8,
    /// Control periods since the last swing began.
    since: u32,
    /// Counts in the speed's window when the present runaway began.
    began: i32,
    /// Control periods of the present runaway.
    run: u32,
}

impl Motion {
    /// A shaft at rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            direction: 0,
            swings: 0,
            since: 0,
            began: 0,
            run: 0,
        }
    }

    /// The memory after `swings` swings in a row. The last has the direction `direction` (0: none yet) and began `since` control
    /// periods ago. A runaway has lasted `run` control periods and began with `began` counts in the speed's window. Proofs begin
    /// with any.
    #[must_use]
    pub const fn from_swings_and_run(
        direction: i8,
        swings: u8,
        since: u32,
        began: i32,
        run: u32,
    ) -> Self {
        Self {
            direction,
            swings,
            since,
            began,
            run,
        }
    }

    /// Number of swings in a row, and number of control periods of the present runaway.
    #[must_use]
    pub const fn swings_and_run(&self) -> (u8, u32) {
        (self.swings, self.run)
    }

    /// Takes a control period's speed, as counts in the speed's window. A current of positive sign drives the shaft towards rising
    /// counts, unless `against` is true. Returns the fault, if there is one.
    #[inline]
    pub fn update(
        &mut self,
        config: &MotionConfig,
        counts: i32,
        report: &CurrentReport,
        against: bool,
    ) -> Option<Found> {
        self.since = self.since.saturating_add(1);
        let speed = counts.saturating_abs();
        if speed < config.run {
            self.run = 0;
        }
        if speed < config.swing {
            return None;
        }
        let direction = counts.signum() as i8;
        let swing = (direction != self.direction).then(|| self.turned(config, direction));
        let run = (speed >= config.run).then(|| {
            let opposes = ((report.current.q < 0) == (counts < 0)) == against;
            let current = report.current.q.saturating_abs();
            self.ran(config, speed, if opposes { current } else { I16F16::ZERO })
        });
        swing.flatten().or(run.flatten())
    }

    /// Counts a swing.
    #[inline(never)]
    fn turned(&mut self, config: &MotionConfig, direction: i8) -> Option<Found> {
        let ticks = self.since;
        let is_fast = self.direction != 0 && ticks <= config.rate_hz / SWINGS_PER_SECOND;
        self.swings = if is_fast {
            self.swings.saturating_add(1)
        } else {
            0
        };
        self.direction = direction;
        self.since = 0;
        (self.swings >= MOST_SWINGS).then(|| {
            // Two swings are a period of the oscillation; the value is in mHz.
            let frequency = (u64::from(config.rate_hz) * 500).checked_div(u64::from(ticks));
            let frequency = frequency.and_then(|value| i64::try_from(value).ok());
            let value = clamp_i32(frequency.unwrap_or(i64::MAX));
            (FaultCode::Oscillation, value)
        })
    }

    /// Counts a control period of a runaway, or ends it. `opposing` is the current that opposes the motion, A.
    #[inline(never)]
    fn ran(&mut self, config: &MotionConfig, speed: i32, opposing: I16F16) -> Option<Found> {
        let is_run = opposing >= config.opposing;
        if !is_run || self.run == 0 || speed < self.began {
            self.run = u32::from(is_run);
            self.began = speed;
            return None;
        }
        self.run = self.run.saturating_add(1);
        let is_long = self.run > config.rate_hz / RUNS_PER_SECOND;
        is_long.then(|| (FaultCode::Runaway, milli(opposing)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(rate_hz: u32) -> MotionConfig {
        let mut settings = DeviceSettings::default();
        settings.timing.rate_hz = rate_hz;
        settings.encoder.counts_per_rev = 16_384;
        settings.motor.current_limit_a = touchstone_control::Si::lit("2");
        MotionConfig::new(&settings, rate_hz as usize / 500)
    }

    fn report(current_a: f64) -> CurrentReport {
        let mut report = CurrentReport::default();
        report.current.q = I16F16::from_num(current_a);
        report
    }

    /// Simulates a shaft that swings with the frequency `hz` at the control rate `rate_hz`. `counts` is the largest displacement in
    /// the window of 2 ms; 1 rad/s is 5.2 counts. Returns the time in ms until the fault, and the fault's value.
    fn swung(rate_hz: u32, hz: f64, counts: f64, swings: f64) -> Option<(f64, i32)> {
        let config = config(rate_hz);
        let mut motion = Motion::new();
        let rate = f64::from(rate_hz);
        (0..2 * rate_hz).find_map(|tick| {
            let time = f64::from(tick) / rate;
            let goes_on = time * 2.0 * hz < swings;
            let speed = counts * (std::f64::consts::TAU * hz * time).sin();
            let counts = if goes_on { speed as i32 } else { 0 };
            let found = motion.update(&config, counts, &report(0.0), false);
            found.map(|(code, value)| {
                assert_eq!(code, FaultCode::Oscillation);
                (1e3 * time, value)
            })
        })
    }

    #[test]
    fn eight_swings_faster_than_a_hand_are_the_fault_at_any_rate() {
        for rate in [1_000, 2_000, 5_000, 10_000] {
            for hz in [14.0, 30.0, 60.0] {
                let (ms, value) = swung(rate, hz, 80.0, 1e9).expect("a fault");
                // The first motion is no swing; the eighth reversal begins after eight half periods.
                assert!(
                    (ms - 4e3 / hz).abs() < 0.3e3 / hz + 2.0,
                    "{rate}, {hz}: {ms} ms"
                );
                let off = f64::from(value) / (1e3 * hz);
                assert!((0.9..1.1).contains(&off), "{rate}, {hz}: {value} mHz");
            }
        }
    }

    #[test]
    fn a_hand_a_bounce_and_jitter_are_no_oscillation() {
        for rate in [1_000, 2_000, 5_000, 10_000] {
            assert_eq!(swung(rate, 10.0, 400.0, 1e9), None, "a fast hand");
            assert_eq!(swung(rate, 30.0, 29.0, 1e9), None, "small swings");
            assert_eq!(swung(rate, 30.0, 400.0, 7.0), None, "a short ringing");
        }
    }

    /// Simulates a shaft whose `speed` in rad/s depends on the time in ms, with the motor current `current_a`. Returns the time of
    /// the fault in ms.
    fn ran(rate_hz: u32, speed: impl Fn(f64) -> f64, current_a: f64, against: bool) -> Option<f64> {
        let config = config(rate_hz);
        let mut motion = Motion::new();
        (0..rate_hz).find_map(|tick| {
            let ms = 1e3 * f64::from(tick) / f64::from(rate_hz);
            let counts = (5.215 * speed(ms)) as i32;
            let found = motion.update(&config, counts, &report(current_a), against);
            found.map(|(code, _)| {
                assert_eq!(code, FaultCode::Runaway);
                ms
            })
        })
    }

    #[test]
    fn a_shaft_that_runs_against_the_torque_is_found_after_10_ms_in_either_direction() {
        for rate in [1_000, 2_000, 5_000, 10_000] {
            for (sign, current, against) in [
                (1.0, -0.6, false),
                (-1.0, 0.6, false),
                (1.0, 0.6, true),
                (-1.0, -0.6, true),
            ] {
                // It reaches 25 rad/s after 25 ms.
                let ms = ran(rate, |ms| sign * ms, current, against).expect("a fault");
                assert!((34.9..36.6).contains(&ms), "{rate}: {ms} ms");
            }
        }
    }

    #[test]
    fn a_fast_hand_that_meets_a_wall_and_one_that_the_motor_helps_are_no_runaway() {
        for rate in [1_000, 2_000, 5_000, 10_000] {
            let slows = |ms: f64| 90.0 - ms;
            assert_eq!(ran(rate, slows, -2.0, false), None, "it slows down");
            assert_eq!(ran(rate, |ms| ms.min(24.0), -2.0, false), None, "slow");
            assert_eq!(ran(rate, |ms| ms, 2.0, false), None, "the motor helps");
            assert_eq!(ran(rate, |ms| ms, -0.4, false), None, "a light torque");
        }
    }
}
