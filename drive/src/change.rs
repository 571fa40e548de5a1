//! Where the device is when the force changes: one more reading of the encoder in a tick, and how the way of a tick is shared
//! between the old force and the new one.
//!
//! A command that a control tick gives is seen by the current loop a period later and acts from half a period after that on. Then
//! the current follows as the loop lets it. Let `H(t)` be the share of a change of force that is still missing a time `t` after the
//! encoder was read. Over a tick the port takes `f₁ Δx - g ∫ H dx`, with the change `g`. With one more reading, after `q` periods, the
//! way `Δx = u + w` is known in its two parts, and over all that a hand can have done within each of them
//!
//! ```text
//! g ∫ H dx <= g (H₁ u + H₂ w) + g² V/4b,      H₁, H₂ the means of H over the parts,  V = ∫ (H - its mean in the part)² dt
//! ```
//!
//! beside what the damping `b` takes of `u` and `w` themselves: Cauchy and Schwarz, as in `docs/energy-guard.md`. So the guard is
//! told the position at which all of the change would have had to come at once, and charges `V` as the lag that is left.

use crate::hardware::Hardware;
use crate::settings::periods_per_tick;
use crate::units::quotient;
use touchstone_control::settings::Settings;
use touchstone_control::{ChangeOfForce, Choice as _, Fixed32, Position, Si};
#[cfg(feature = "voltage")]
use touchstone_protocol::settings::MotorSettings;
use touchstone_protocol::settings::{DriveKind, Reason, SettingsError};
use touchstone_protocol::{Decimal, DeviceSettings};

/// The encoder is read a quarter of a PWM period after the currents are sampled, both times: the current loop's interrupt runs first.
const READ_AFTER_QUARTERS: u32 = 1;
/// Fractional bits of everything below.
const BITS: u32 = 28;
const ONE: i64 = 1 << BITS;
/// What may be missing of a change of force when the next one begins: a fiftieth.
const REST_MAX: i64 = ONE / 50;
/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");

/// The current loop's answer to a step of the wanted current, as computed and as its bridge acts: the share that is
/// still missing, quarter by quarter of a PWM period. An error that a sample finds acts half a period later, for a
/// whole period, and changes the current by `ω T` of itself.
struct Answer {
    /// `ω T/4`: share of an error by which the current changes in a quarter of a period.
    step: i64,
    /// Error found by the sample before the last, which acts in the first half of a period.
    before: i64,
    /// Error found by the last sample. The sample of the tick itself did not see the step yet.
    last: i64,
    /// Share of the change that is still missing: `H`.
    missing: i64,
    /// Quarters of periods since the tick's sample.
    quarter: u32,
    /// For a drive by voltage instead of current: the share of the missing current that the winding takes up in a
    /// quarter.
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

    /// `s/(1 + s)` with `s = R/4L T`: a backward step, which leaves at least as much missing as the exponential does.
    /// 0 for a motor whose values are not set, as it is never driven.
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

    /// `H` at the end of the next quarter.
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

/// Integrals over a part of a tick, in quarters of PWM periods.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    quarters: i64,
    area: i64,
    square: i64,
}

impl Part {
    /// Adds a quarter of a period.
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

/// Product of two values of at most some hundreds, with [`BITS`] fractional bits.
#[inline]
fn times(a: i64, b: i64) -> i64 {
    (a * b) >> BITS
}

/// The time of the encoder's second reading and the use of that reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChangeConfig {
    /// PWM periods from the reading of a control tick to the one more.
    pub read_at: u16,
    /// Share of the way before the second reading that was under the new force, beyond what the guard itself charges
    /// for it, 2^-28.
    pub before: i32,
    /// The share of the way after the second reading.
    pub after: i32,
    /// From the reading of a tick to the change of force, in the mean, without the lag below, s.
    pub delay_s: Si,
    /// The uncertainty that a second reading leaves, as a lag, s.
    pub lag_s: Si,
}

impl ChangeConfig {
    /// From settings; `None` where the guard is off or estimates the position at the change.
    ///
    /// # Errors
    /// A drive without our current loop, or one that has not finished a change of force when the next one begins.
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

    /// How far the device has moved since the force changed, as if all of the change had come at once. Given are the way from a tick's
    /// reading to the second one, and the way from there to the next tick's.
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

/// The settings for a device's law: where the position is measured when the force changes, the board's own delay is
/// added.
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
