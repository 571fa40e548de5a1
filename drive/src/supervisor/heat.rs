//! Temperature limit of the motor's windings, from a model of their heat: the windings have no sensor.
//!
//! The model has one thermal mass and one thermal resistance `R_th`. The windings' rise above the room's temperature follows `s`, a
//! running mean: the squared current `i²` through a first-order low-pass filter with the time constant `τ`. `R` is the windings'
//! resistance:
//!
//! ```text
//! τ ds/dt = i² - s        rise = s R_th 3/2 R        at rest: s = i²
//! ```
//!
//! A motor that can carry a current continuously can bear every `s` up to that current squared. So neither `R_th` nor the room's
//! temperature need be known. From 80 % of that square on, the largest allowed current falls in a straight line, from the motor's
//! current limit to its continuous current. So `s` approaches its limit and does not exceed it, for any requested current. The
//! model leaves out:
//!
//! - the motor's iron and frame, which warm more slowly (the shorter time constant of the windings alone is on the safe side);
//! - a room hotter than the one for which the continuous current was stated;
//! - a shaft that stands still: one phase may then have twice the mean heat of the three.
//!
//! The calibration's current is not reduced, because its force must turn the rotor. An `s` of one and a half times its limit is a
//! fault.

use super::Found;
use crate::current::CurrentReport;
use crate::settings::MotorSettings;
use crate::units::{clamp_i32, narrow, quotient};
use touchstone_control::Si;
use touchstone_protocol::{DeviceSettings, FaultCode};

/// Fractional bits of the square of a current, A².
const SQUARE_BITS: u32 = 16;
/// Fractional bits of the running mean of the squared current. They are more than those of a square, so that the small amount that
/// a control period adds is not lost.
const MEAN_BITS: u32 = 48;
/// The whole current limit, as a fraction in 1/65,536.
const ALL: u32 = 1 << 16;

/// Coefficients of the heat model; squares of currents in A² with `SQUARE_BITS` fractional bits.
#[derive(Debug, Clone, Copy)]
pub struct HeatConfig {
    /// Weight of a control period in the running mean, 2^-32: period over thermal time constant, at most 2^-7.
    share: i32,
    /// Running mean of the squared current, A², above which the current limit is reduced: 80 % of `bears`.
    warm: i32,
    /// Square, in A², of the current that the motor can carry continuously.
    bears: i32,
    /// Running mean of the squared current, A², at which the motor's heat is a fault: 1.5 times `bears`.
    hot: i32,
    /// The motor's continuous current as a fraction of its current limit, 1/65,536.
    for_ever: u32,
}

impl HeatConfig {
    /// Computes the coefficients of the heat model from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings) -> Self {
        let MotorSettings {
            continuous_current_a: continuous,
            heating_time_s,
            current_limit_a: limit,
            ..
        } = settings.motor;
        let ticks = heating_time_s.saturating_mul(Si::saturating_from_num(settings.timing.rate_hz));
        let bears = square(narrow(continuous)).max(1);
        Self {
            share: clamp_i32(quotient(Si::ONE, ticks).to_bits()),
            warm: clamp_i32(bears * 4 / 5),
            bears: clamp_i32(bears),
            hot: clamp_i32(bears + bears / 2),
            for_ever: narrow(quotient(continuous, limit))
                .to_bits()
                .clamp(0, ALL.cast_signed())
                .unsigned_abs(),
        }
    }

    /// Fraction of the current limit that is allowed at this running mean of the squared current, in 1/65,536. It falls in a
    /// straight line between `warm` and `bears`.
    fn left(&self, mean: i32) -> u32 {
        if mean <= self.warm {
            return ALL;
        }
        if mean >= self.bears {
            return self.for_ever;
        }
        // `beyond` is less than the divisor, so the quotient is below 2^16. The divisor is never zero.
        let beyond = i64::from(mean - self.warm) << 16;
        let way = beyond
            .checked_div(i64::from(self.bears - self.warm))
            .unwrap_or(0);
        let lost = (i64::from(ALL - self.for_ever) * way) >> 16;
        ALL.saturating_sub(u32::try_from(lost).unwrap_or(0))
    }
}

/// Square of a current, A² with `SQUARE_BITS` fractional bits: below 2^46.
const fn square(current: crate::Amps) -> i64 {
    let wide = current.to_bits() as i64;
    (wide * wide) >> SQUARE_BITS
}

/// The state of the heat model of the windings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heat {
    /// Running mean of the squared current, A² with [`MEAN_BITS`] fractional bits; never negative.
    mean: i64,
}

impl Default for Heat {
    fn default() -> Self {
        Self::cold()
    }
}

impl Heat {
    /// The heat model with the windings at room temperature.
    #[must_use]
    pub const fn cold() -> Self {
        Self { mean: 0 }
    }

    /// The windings assumed at their limit, because it is unknown how long the processor was off.
    #[must_use]
    pub const fn unknown(config: &HeatConfig) -> Self {
        Self {
            mean: (config.bears as i64) << (MEAN_BITS - SQUARE_BITS),
        }
    }

    /// Takes a control period's measured current. Returns the fault, if there is one, and the allowed fraction of the current
    /// limit, in 1/65,536.
    pub fn update(&mut self, config: &HeatConfig, report: &CurrentReport) -> (Option<Found>, u32) {
        let now = clamp_i32(square(report.current.d) + square(report.current.q));
        let mean = (self.mean >> (MEAN_BITS - SQUARE_BITS)) as i32;
        // Both squares are at least 0 and below 2^31. So is the new mean, because less than the whole difference is added. The
        // product has 16 + 32 fractional bits.
        self.mean += i64::from(now - mean) * i64::from(config.share);
        let fault = (mean > config.hot).then(|| {
            let permille = (i64::from(mean) * 1_000).checked_div(i64::from(config.bears));
            (FaultCode::MotorHot, clamp_i32(permille.unwrap_or(i64::MAX)))
        });
        (fault, config.left(mean))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Amps;
    use crate::transform::Dq;

    fn report(amperes: f64) -> CurrentReport {
        of_both(0.0, amperes)
    }

    fn of_both(d: f64, q: f64) -> CurrentReport {
        CurrentReport {
            current: Dq {
                d: Amps::from_num(d),
                q: Amps::from_num(q),
            },
            ..CurrentReport::default()
        }
    }

    /// Requests the same current for `seconds`, in which the motor gets as much of it as the limit allows. Returns the largest
    /// running mean of the squared current, calculated in floating point, and the current at the end.
    fn leans(settings: &DeviceSettings, asked: f64, seconds: f64) -> (f64, f64) {
        let config = HeatConfig::new(settings);
        let limit: f64 = settings.motor.current_limit_a.to_num();
        let time: f64 = settings.motor.heating_time_s.to_num();
        let rate = f64::from(settings.timing.rate_hz);
        let (mut heat, mut mean, mut worst, mut given) = (Heat::cold(), 0.0_f64, 0.0_f64, asked);
        for _ in 0..(seconds * rate) as u64 {
            mean += (given * given - mean) / (time * rate);
            worst = worst.max(mean);
            let (fault, left) = heat.update(&config, &report(given));
            assert_eq!(fault, None);
            given = asked.min(limit * f64::from(left) / 65_536.0);
        }
        (worst, given)
    }

    #[test]
    fn a_hand_that_leans_is_given_less_before_the_windings_are_too_hot() {
        for rate in [1_000, 10_000] {
            let mut settings = DeviceSettings::default();
            settings.timing.rate_hz = rate;
            settings.motor.heating_time_s = Si::lit("2");
            let (worst, given) = leans(&settings, 2.0, 12.0);
            assert!(worst <= 0.49 * 1.001, "{rate} Hz: {worst} A²");
            assert!((0.69..0.703).contains(&given), "{rate} Hz: {given} A");
            // The current that the motor can carry continuously is never reduced.
            let (worst, given) = leans(&settings, 0.62, 12.0);
            assert!((worst - 0.3844).abs() < 0.002, "{worst} A²");
            assert_eq!(given, 0.62);
        }
    }

    #[test]
    fn nothing_is_taken_from_a_motor_that_bears_its_limit() {
        let mut settings = DeviceSettings::default();
        settings.motor.heating_time_s = Si::lit("0.5");
        settings.motor.continuous_current_a = Si::lit("3");
        assert_eq!(leans(&settings, 2.0, 5.0).1, 2.0);
    }

    #[test]
    fn a_current_that_nobody_reduces_is_a_fault() {
        let settings = DeviceSettings::default();
        let config = HeatConfig::new(&settings);
        let mut heat = Heat::cold();
        let fault = (0..100_000).find_map(|tick| {
            let (fault, _) = heat.update(&config, &report(1.5));
            fault.map(|fault| (tick, fault))
        });
        let Some((tick, (FaultCode::MotorHot, value))) = fault else {
            panic!("{fault:?}");
        };
        // The expected time is 20 s times ln(2.25/(2.25 - 0.735)).
        assert!((7_890..7_930).contains(&tick), "{tick}");
        assert!((1_500..1_503).contains(&value), "{value}");
        // After a reset of unknown duration.
        let (_, left) = Heat::unknown(&config).update(&config, &report(0.0));
        assert!((22_000..23_500).contains(&left), "{left}");
    }

    /// A current that gives no torque heats the windings as well: the calibration's, or one at a wrong electrical angle.
    #[test]
    fn the_current_that_gives_no_torque_heats_as_much() {
        let config = HeatConfig::new(&DeviceSettings::default());
        let hot_after = |report: CurrentReport| {
            let mut heat = Heat::cold();
            (0..100_000).find(|_| heat.update(&config, &report).0.is_some())
        };
        let by_torque = hot_after(report(1.5)).expect("a fault");
        for (d, q) in [(1.5, 0.0), (-1.5, 0.0), (0.9, 1.2), (1.2, -0.9)] {
            let tick = hot_after(of_both(d, q)).unwrap_or(u32::MAX);
            // The currents are rounded to a step of their format.
            assert!(
                tick.abs_diff(by_torque) <= 2,
                "{d} A, {q} A: {tick}, not {by_torque}"
            );
        }
    }
}
