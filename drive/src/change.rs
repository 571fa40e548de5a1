//! The second encoder reading in a tick, when the force changes, and how the displacement of a tick is divided between the old and
//! the new force.
//!
//! The current loop gets the command of a control tick one PWM period later, and the command acts from half a period after that on.
//! Then the current follows with the loop's own lag. Let `H(t)` be the fraction of a change of force that is still missing a time
//! `t` after the encoder was read. Over a tick the port takes the energy `f₁ Δx - g ∫ H dx`, with the change `g`. With a second
//! reading, after `q` periods, the two parts of the displacement `Δx = u + w` are known. For all motions of the hand within these
//! parts
//!
//! ```text
//! g ∫ H dx <= g (H₁ u + H₂ w) + g² V/4b,      H₁, H₂ the means of H over the parts,  V = ∫ (H - its mean in the part)² dt
//! ```
//!
//! The damping `b` dissipates further energy in `u` and `w` themselves (Cauchy and Schwarz, as in `docs/energy-guard.md`). So the
//! guard gets the position at which a sudden change of force would have the same effect, and charges `V` as the lag that remains.

use crate::hardware::Hardware;
use crate::settings::periods_per_tick;
use crate::units::quotient;
use touchstone_control::settings::Settings;
use touchstone_control::{ChangeOfForce, Choice as _, Fixed32, Position, Si};
#[cfg(feature = "voltage")]
use touchstone_protocol::settings::MotorSettings;
use touchstone_protocol::settings::{DriveKind, Reason, SettingsError};
use touchstone_protocol::{Decimal, DeviceSettings};

/// Quarters of a PWM period from the sampling of the currents to each encoder reading: the current loop's interrupt runs first.
const READ_AFTER_QUARTERS: u32 = 1;
/// Fractional bits of the calculations in this module.
const BITS: u32 = 28;
const ONE: i64 = 1 << BITS;
/// Largest fraction of a change of force that may be missing when the next change begins: a fiftieth.
const REST_MAX: i64 = ONE / 50;
/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");

/// The current loop's answer to a step of the requested current, as calculated and as the bridge acts. It gives the fraction that
/// is still missing, quarter by quarter of a PWM period. The loop acts on a sampled error half a period later, for a whole period,
/// and changes the current by `ω T` times the error.
struct Answer {
    /// `ω T/4`: fraction of an error by which the current changes in a quarter of a period.
    step: i64,
    /// Error at the sample before the last, on which the loop acts in the first half of a period.
    before: i64,
    /// Error at the last sample. The sample at the tick itself did not see the step yet.
    last: i64,
    /// Fraction of the change that is still missing: `H`.
    missing: i64,
    /// Quarters of a PWM period since the tick's sample.
    quarter: u32,
    /// Only for a drive by voltage instead of current: fraction of the missing current that the winding gains in a quarter of a
    /// period.
    #[cfg(feature = "voltage")]
    winding: Option<i64>,
}

impl Answer {
    #[inline]
    fn new(settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let omega = settings.motor.current_bandwidth_hz.saturating_mul(TWO_PI);
        let quarters =
            Si::saturating_from_num(hardware.pwm_hz).saturating_mul(Si::const_from_int(4));
        Self {
            step: quotient(omega, quarters).to_bits() >> (Si::FRAC_NBITS - BITS),
            before: 0,
            last: 0,
            missing: ONE,
            quarter: 0,
            #[cfg(feature = "voltage")]
            winding: hardware.gives_voltage().then(|| {
                Self::winding(&settings.motor, settings.untold_motor().is_some(), quarters)
            }),
        }
    }

    /// The winding's gain per quarter of a period, `s/(1 + s)` with `s = R/4L T`. A backward Euler step leaves at least as much
    /// current missing as the exact exponential does. 0 for a motor whose values are not set, as it is never driven.
    #[cfg(feature = "voltage")]
    #[inline]
    fn winding(motor: &MotorSettings, is_untold: bool, quarters_per_s: Si) -> i64 {
        if is_untold {
            return ONE;
        }
        let way = quotient(
            quotient(motor.resistance_ohm, motor.inductance_h),
            quarters_per_s,
        );
        quotient(way, Si::ONE.saturating_add(way)).to_bits() >> (Si::FRAC_NBITS - BITS)
    }

    /// Calculates the next quarter of a period; returns `H` at its end.
    #[inline(never)]
    fn next(&mut self) -> i64 {
        // The voltage is there from its bottom on, one and a half periods after the tick's sample, and stays.
        #[cfg(feature = "voltage")]
        if let Some(share) = self.winding {
            if self.quarter >= 6 {
                self.missing -= times(self.missing, share);
            }
            self.quarter += 1;
            return self.missing;
        }
        let acts = if self.quarter & 3 < 2 {
            self.before
        } else {
            self.last
        };
        self.missing -= times(acts, self.step);
        self.quarter += 1;
        if self.quarter & 3 == 0 {
            (self.before, self.last) = (self.last, self.missing);
        }
        self.missing
    }
}

/// Integrals over a part of a tick, with a quarter of a PWM period as the unit of time.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    quarters: i64,
    area: i64,
    square: i64,
}

impl Part {
    /// Adds a quarter of a period in which `H` goes from one value to another.
    #[inline(never)]
    fn add(&mut self, from: i64, to: i64) {
        self.quarters += 1;
        self.area += (from + to) / 2;
        // The chord of a square is above it.
        self.square += (times(from, from) + times(to, to)) / 2;
    }

    #[inline]
    fn mean(&self) -> i64 {
        self.area.checked_div(self.quarters).unwrap_or(0)
    }

    /// `∫ (H - mean)² dt`.
    #[inline]
    fn variance(&self) -> i64 {
        (self.square - times(self.mean(), self.area)).max(0)
    }
}

/// Product of two values with [`BITS`] fractional bits, each at most some hundreds.
#[inline]
fn times(a: i64, b: i64) -> i64 {
    (a * b) >> BITS
}

/// The time of the encoder's second reading and the use of that reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChangeConfig {
    /// PWM periods from the first encoder reading of a control tick to the second.
    pub read_at: u16,
    /// Fraction, in 2^-28, of the displacement before the second reading that was under the new force, beyond the delay that the
    /// guard itself charges.
    pub before: i32,
    /// Fraction, in 2^-28, of the displacement after the second reading that was under the new force.
    pub after: i32,
    /// Mean time in seconds from a tick's encoder reading to the change of force, without `lag_s`.
    pub delay_s: Si,
    /// The uncertainty that remains with a second reading, expressed as a lag in seconds.
    pub lag_s: Si,
}

impl ChangeConfig {
    /// Calculates the time and use of the second reading from settings. `None` where the guard is off, or where it estimates the
    /// position at the change.
    ///
    /// # Errors
    /// The drive does not use this crate's current loop, or the loop has not finished a change of force when the next one begins.
    #[inline]
    pub fn new(
        settings: &DeviceSettings,
        hardware: &Hardware,
    ) -> Result<Option<Self>, SettingsError> {
        let guard = &settings.law.guard;
        if !guard.on || guard.change == ChangeOfForce::Estimated {
            return Ok(None);
        }
        let change = match settings.drive.kind {
            DriveKind::ThreePhase => Self::of_loop(settings, hardware),
            DriveKind::Analogue => None,
        };
        change.map(Some).ok_or(SettingsError {
            path: "law.guard.change",
            value: Decimal::from_num(guard.change.number()),
            reason: Reason::NotMeasured,
        })
    }

    #[cold]
    #[inline]
    fn of_loop(settings: &DeviceSettings, hardware: &Hardware) -> Option<Self> {
        let mut answer = Answer::new(settings, hardware);
        let tick = 4 * u32::from(periods_per_tick(settings, hardware));
        let [mut before, mut after] = [Part::default(); 2];
        let mut read_at = None;
        for _ in 0..READ_AFTER_QUARTERS {
            answer.next();
        }
        for quarter in 0..tick {
            // As soon as half of the change is there.
            if quarter & 3 == 0 && read_at.is_none() && answer.missing <= ONE / 2 {
                read_at = u16::try_from(quarter / 4).ok();
            }
            let part = match read_at {
                None => &mut before,
                Some(_) => &mut after,
            };
            part.add(answer.missing, answer.next());
        }
        let read_at = read_at.filter(|_| answer.missing.abs() <= REST_MAX)?;
        let open = before.variance() + after.variance();
        // The guard charges `lag (span - lag)/span`: the sixteenth more is what the parenthesis takes away, and some.
        let lag = open + open / 16;
        let delay = before.area + after.area - lag;
        let span = i64::from(tick) * ONE - delay;
        // The guard puts so much of the way after the change under the old force by itself.
        let own = (lag << BITS).checked_div(span)?;
        if lag - times(lag, own) < open {
            return None;
        }
        let new = |part: Part| {
            let share = ((ONE - part.mean()) << BITS).checked_div(ONE - own)?;
            i32::try_from(share).ok()
        };
        let seconds = |quarters: i64| {
            let divisor = i64::from(hardware.pwm_hz) * 4;
            Some(Si::from_bits(
                (quarters << (Si::FRAC_NBITS - BITS)).checked_div(divisor)?,
            ))
        };
        Some(Self {
            read_at,
            before: new(before)?,
            after: new(after)?,
            delay_s: seconds(delay)?,
            lag_s: seconds(lag)?,
        })
    }

    /// Displacement since the force changed, as if the whole change had come at one instant. Takes the displacement from a tick's
    /// first reading to its second, and that from the second to the next tick's first.
    #[inline(always)]
    #[must_use]
    pub fn since_change(
        &self,
        until_read: Position<Fixed32>,
        from_read: Position<Fixed32>,
    ) -> Position<Fixed32> {
        let under_new =
            |share: i32, way: Position<Fixed32>| i64::from(share) * i64::from(way.0.to_bits());
        // Shares are some 1 at most: 29 bits and 32, and the sum of both fits.
        let sum = under_new(self.before, until_read) + under_new(self.after, from_read);
        Position(fixed::types::I8F24::from_bits(crate::units::clamp_i32(
            sum >> BITS,
        )))
    }
}

/// The settings for a device's law. If the position is measured when the force changes, the board's own delay is added to the
/// guard's settings.
///
/// # Errors
/// Same as [`ChangeConfig::new`].
#[inline]
pub fn law_settings(
    settings: &DeviceSettings,
    hardware: &Hardware,
) -> Result<(Settings, Option<ChangeConfig>), SettingsError> {
    let mut law = settings.law();
    let change = ChangeConfig::new(settings, hardware)?;
    if let Some(change) = &change {
        law.guard.delay = change.delay_s;
        law.guard.lag = change.lag_s;
    }
    Ok((law, change))
}
