//! When the encoder is read a second time in a control period (tick), and how the displacement in that period is divided between
//! the old and the new force.
//!
//! The current loop gets the command of a control period one PWM period later. The command begins to act half a PWM period after
//! that. Then the current follows with the loop's own lag. Let `H(t)` be the fraction of a change of force that is still missing a
//! time `t` after the encoder was read. When the force changes by `g` to `f₁`, the hand gives the energy `f₁ Δx - g ∫ H dx` in a
//! control period with displacement `Δx`. A second reading after `q` PWM periods divides the displacement into two known parts,
//! `Δx = u + w`. For all motions of the hand within these parts
//!
//! ```text
//! g ∫ H dx <= g (H₁ u + H₂ w) + g² V/4b,      H₁, H₂ the means of H over the parts,  V = ∫ (H - its mean in the part)² dt
//! ```
//!
//! The device's damping `b` dissipates further energy in `u` and `w` themselves (Cauchy and Schwarz, as in `docs/energy-guard.md`).
//! So the energy guard gets the position at which a sudden change of force would have the same effect, and charges `V` as the lag
//! that remains.

use crate::hardware::Hardware;
use crate::timing::periods_per_tick;
use crate::units::quotient;
use touchstone_control::settings::Settings;
use touchstone_control::{ChangeOfForce, Choice as _, Fixed32, Position, Si};
#[cfg(feature = "voltage")]
use touchstone_protocol::settings::MotorSettings;
use touchstone_protocol::settings::{DriveKind, Reason, SettingsError};
use touchstone_protocol::{Decimal, DeviceSettings};

/// Time from the sampling of the currents to each encoder reading, in quarters of a PWM period. The current loop's interrupt runs
/// in between.
const READ_AFTER_QUARTERS: u32 = 1;
/// Number of fractional bits of the fixed-point numbers in this module.
const BITS: u32 = 28;
const ONE: i64 = 1 << BITS;
/// Largest fraction (a fiftieth) of a change of force that may still be missing when the next change begins.
const REST_MAX: i64 = ONE / 50;
/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");

/// The calculated response of the current to a step of the commanded current, as controller and bridge produce it. The response
/// is the fraction of the step that is still missing after each quarter of a PWM period. The loop's answer to a sampled error
/// begins half a PWM period later and lasts one PWM period `T`. This answer changes the current by `ω T` times the error, with
/// the loop's bandwidth `ω`.
struct Answer {
    /// Fraction of an error by which the loop changes the current in a quarter of a PWM period: bandwidth times period, `ω T/4`.
    step: i64,
    /// Current error at the sample before the last, on which the loop acts in the first half of a PWM period.
    before: i64,
    /// Current error at the last sample. The error is zero at first, because the sample at the start of the control period was
    /// taken before the step of the command.
    last: i64,
    /// Fraction of the commanded change of force that is still missing; the module's text calls it `H`.
    missing: i64,
    /// Quarters of a PWM period since the currents were sampled at the start of the control period.
    quarter: u32,
    /// Only for a drive by voltage instead of current: fraction of the missing current that the winding gains in a quarter of a
    /// PWM period.
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

    /// Fraction of the missing current that the winding gains in a quarter of a PWM period: `s/(1 + s)` with `s = R T/(4 L)`, for
    /// resistance `R`, inductance `L` and PWM period `T`. This backward Euler step leaves at least as much current missing as the
    /// exact exponential does. 1 for a motor whose values are not set, which is never driven.
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

    /// Calculates the next quarter of a PWM period; returns the fraction of the change of force that is still missing at its end.
    #[inline(never)]
    fn next(&mut self) -> i64 {
        // The new voltage begins to act at the counter's bottom, one and a half PWM periods after the control period's sample, and
        // stays.
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

/// Integrals of the missing fraction `H` over one part of a control period (before or after the second encoder reading). The unit
/// of time is a quarter of a PWM period.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    quarters: i64,
    area: i64,
    square: i64,
}

impl Part {
    /// Adds a quarter of a PWM period, in which the missing fraction of the force goes from `from` to `to`.
    #[inline(never)]
    fn add(&mut self, from: i64, to: i64) {
        self.quarters += 1;
        self.area += (from + to) / 2;
        // The mean of both ends is an upper bound, because the square is convex.
        self.square += (times(from, from) + times(to, to)) / 2;
    }

    #[inline]
    fn mean(&self) -> i64 {
        self.area.checked_div(self.quarters).unwrap_or(0)
    }

    /// The integral `∫ (H - mean)² dt` of the missing fraction `H` of the force, over this part of the control period.
    #[inline]
    fn variance(&self) -> i64 {
        (self.square - times(self.mean(), self.area)).max(0)
    }
}

/// Product of two fixed-point values with [`BITS`] fractional bits. Each value is at most some hundreds.
#[inline]
fn times(a: i64, b: i64) -> i64 {
    (a * b) >> BITS
}

/// Time of the second encoder reading in a control period, and the factors with which the guard uses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChangeConfig {
    /// PWM periods from the first encoder reading of a control period to the second.
    pub read_at: u16,
    /// Fraction (in 2^-28) of the displacement before the second reading that the guard multiplies by the new force. The delay that
    /// the energy guard itself charges is not included.
    pub before: i32,
    /// Fraction (in 2^-28) of the displacement after the second reading that the guard multiplies by the new force.
    pub after: i32,
    /// Mean time in seconds from the encoder reading at the start of a control period to the change of force, without `lag_s`.
    pub delay_s: Si,
    /// Lag in seconds that the energy guard charges, because the position at the change of force is uncertain even with a second
    /// reading.
    pub lag_s: Si,
}

impl ChangeConfig {
    /// Calculates when the second encoder reading is made and how it is used. `None` if the settings switch the energy guard off or
    /// let it estimate the position at the change of force.
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
            // The encoder is read at the first PWM period in which half of the change of force has acted.
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
        // The energy guard charges `lag (span - lag)/span`. The sixteenth added to the lag is more than that factor takes away.
        let lag = open + open / 16;
        let delay = before.area + after.area - lag;
        let span = i64::from(tick) * ONE - delay;
        // Fraction of the displacement after the change that the energy guard itself counts as made under the old force.
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

    /// Displacement since the force changed, as if the whole change had come at one instant. The arguments are the displacement
    /// from the first encoder reading of a control period to the second, and from the second to the first reading of the next
    /// period.
    #[inline(always)]
    #[must_use]
    pub fn since_change(
        &self,
        until_read: Position<Fixed32>,
        from_read: Position<Fixed32>,
    ) -> Position<Fixed32> {
        let under_new =
            |share: i32, way: Position<Fixed32>| i64::from(share) * i64::from(way.0.to_bits());
        // The fractions are about 1 at most: products of 29 and 32 bits, whose sum fits into 64 bits.
        let sum = under_new(self.before, until_read) + under_new(self.after, from_read);
        Position(fixed::types::I8F24::from_bits(crate::units::clamp_i32(
            sum >> BITS,
        )))
    }
}

/// The settings from which a device's control law is computed. If the position is measured when the force changes, the energy
/// guard's delay and lag are those that are calculated for the board, not the configured ones.
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
