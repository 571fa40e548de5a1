//! Checks of the encoder's readings: bad readings, jumps, and the speed from the good readings.
//!
//! Overspeed is checked twice. The displacement of one control period (tick) shows a speed that is clearly too high, at the first
//! reading after a whole period at that speed. The mean over several periods also shows a slight excess, even if the encoder moves
//! by few counts per period.
//!
//! A bad reading is not used, and the outputs are off until the next good one. Several bad readings in a row are a fault, with the
//! code of the last. After a gap in the readings, the limits allow for the motion that the shaft may have made in each missing
//! period.

use super::Found;
use super::motion::{JITTER, Motion, MotionConfig};
use crate::current::CurrentReport;
use crate::encoder::{EncoderError, EncoderKind, EncoderReading, Unwrapped};
use crate::hardware::Hardware;
use crate::timing::periods_per_tick;
use crate::units::{clamp_i32, narrow, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::FaultCode;

/// Longest time over which the speed is averaged, in control periods.
const WINDOW_MAX: usize = 20;
/// A displacement that would need this many times the highest allowed speed counts as a jump of the reading; a smaller excess
/// counts as overspeed.
const JUMP_FACTOR: i32 = 4;
/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");

/// Coefficients of the checks of encoder readings and shaft speed.
#[derive(Debug, Clone, Copy)]
pub struct ShaftConfig {
    kind: EncoderKind,
    reversed: bool,
    bad_readings: u8,
    /// A motion of more than this many counts per control period is a jump of the reading: no real shaft moves so fast.
    jump: i32,
    /// Number of control periods over which the speed is averaged (the window): 2 ms, but 2 to 20 periods.
    window: usize,
    /// A motion of more than this many counts in a control period is overspeed.
    fastest_in_tick: i32,
    /// A motion of more than this many counts in the window over which the speed is averaged is overspeed.
    fastest: i32,
    /// Speed in rad/s for each count that the shaft moves in the window over which the speed is averaged.
    speed_per_count: I16F16,
    motion: MotionConfig,
    /// Change of the electrical angle in a PWM period for each count that the shaft moves in the speed window, in 2^-48 turns.
    advance_per_count: i64,
}

impl ShaftConfig {
    /// Computes the coefficients of the checks from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let rate = settings.timing.rate_hz.max(1);
        let counts = settings.encoder.counts_per_rev.max(1);
        let window = usize::try_from(rate / 500)
            .unwrap_or(2)
            .clamp(2, WINDOW_MAX);
        let window_ticks = Si::saturating_from_num(window);
        // Counts per control period, for each rad/s.
        let per_speed = quotient(
            quotient(Si::saturating_from_num(counts), TWO_PI),
            Si::saturating_from_num(rate),
        );
        let fastest = settings
            .limits
            .max_speed_rad_per_s
            .saturating_mul(per_speed);
        let limit = |counts: Si| {
            let whole = counts.saturating_ceil().to_num::<i64>();
            clamp_i32(whole.saturating_add(JITTER))
        };
        let speed = quotient(quotient(Si::ONE, per_speed), window_ticks);
        // Electrical turns per PWM period for each count in the window: 2^48 pole pairs/(counts per turn · PWM periods in a
        // window).
        let periods =
            (window as u64).saturating_mul(u64::from(periods_per_tick(settings, hardware)));
        let divisor = u64::from(counts).saturating_mul(periods).max(1);
        let advance = (u64::from(settings.motor.pole_pairs) << 48) / divisor;
        Self {
            kind: settings.encoder.kind,
            reversed: settings.encoder.reversed,
            bad_readings: settings.encoder.bad_readings,
            jump: limit(fastest.saturating_mul(Si::const_from_int(i64::from(JUMP_FACTOR)))),
            window,
            fastest_in_tick: limit(fastest),
            fastest: limit(fastest.saturating_mul(window_ticks)),
            motion: MotionConfig::new(settings, window),
            speed_per_count: narrow(speed),
            advance_per_count: advance.cast_signed(),
        }
    }
}

/// Result of checking an encoder reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// The reading is good.
    Good {
        /// The encoder count, continued over the encoder's wrap.
        count: i64,
        /// Counts that the shaft moved since the last good reading.
        moved: i64,
    },
    /// The reading is bad and must not be used, but is no fault yet.
    Bad,
    /// The reading is a fault; holds the fault's code and value.
    Fault(FaultCode, i32),
}

/// Memory of the shaft's motion, as the encoder measures it.
#[derive(Debug, Clone, Copy)]
pub struct Shaft {
    unwrapped: Option<Unwrapped>,
    bad: u8,
    /// Counts that the shaft moved in each of the last control periods.
    moves: [i32; WINDOW_MAX],
    at: usize,
    /// Counts that the shaft moved in the window over which the speed is averaged.
    sum: i32,
}

impl Default for Shaft {
    fn default() -> Self {
        Self::new()
    }
}

impl Shaft {
    /// The memory before the first reading.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            unwrapped: None,
            bad: 0,
            moves: [0; WINDOW_MAX],
            at: 0,
            sum: 0,
        }
    }

    /// Checks a control period's first reading. The reading counts as bad if `is_one_missing`: the second reading of the previous
    /// period is missing.
    pub fn read(
        &mut self,
        config: &ShaftConfig,
        reading: EncoderReading,
        watched: bool,
        is_one_missing: bool,
    ) -> Seen {
        let reading = if is_one_missing {
            EncoderReading::Silent
        } else {
            reading
        };
        let word = match reading.decode(config.kind) {
            Ok(word) => word,
            Err(error) => return self.bad(config, error, watched),
        };
        let Some(unwrapped) = &mut self.unwrapped else {
            *self = Self {
                unwrapped: Some(Unwrapped::new(word, config.reversed)),
                ..Self::new()
            };
            return Seen::Good { count: 0, moved: 0 };
        };
        let before = unwrapped.count();
        let count = unwrapped.update(word);
        let moved = count.saturating_sub(before);
        let ticks = i64::from(self.bad) + 1;
        self.bad = 0;
        self.remember(config, clamp_i32(moved));
        if !watched {
            return Seen::Good { count, moved };
        }
        // The product of 32 and 8 bits fits into 64 bits.
        let is_beyond = |limit: i32| moved.saturating_abs() > i64::from(limit) * ticks;
        if is_beyond(config.jump) {
            return Seen::Fault(FaultCode::EncoderJump, clamp_i32(moved));
        }
        let is_tick_fast = is_beyond(config.fastest_in_tick);
        if is_tick_fast || self.sum.saturating_abs() > config.fastest {
            let mean = if is_tick_fast {
                // Counts in a window at this speed. The divisor is never zero.
                let in_window = clamp_i32(moved.saturating_mul(config.window as i64));
                in_window.checked_div(clamp_i32(ticks)).unwrap_or(in_window)
            } else {
                self.sum
            };
            let speed = Self::speed_of(config, mean);
            return Seen::Fault(FaultCode::OverSpeed, crate::units::milli(speed));
        }
        Seen::Good { count, moved }
    }

    /// The encoder count of a reading between two control periods; `None` if the reading is bad or a jump. The stored count does
    /// not change.
    #[inline(never)]
    #[must_use]
    pub fn at(&self, config: &ShaftConfig, reading: EncoderReading) -> Option<i64> {
        let word = reading.decode(config.kind).ok()?;
        let mut unwrapped = self.unwrapped?;
        let before = unwrapped.count();
        let count = unwrapped.update(word);
        let moved = count.saturating_sub(before).saturating_abs();
        (moved <= i64::from(config.jump)).then_some(count)
    }

    /// Counts from an absolute encoder's own zero to count 0. `None` for an encoder without a zero of its own, and before the first
    /// good reading.
    #[cfg(feature = "large")]
    #[must_use]
    pub fn own_zero(&self, config: &ShaftConfig) -> Option<i64> {
        let count = self.unwrapped?.count();
        self.from_own_zero(config)
            .map(|place| place.saturating_sub(count))
    }

    /// Counts from an absolute encoder's own zero to the last good reading; `None` as in [`Shaft::own_zero`].
    #[cfg(feature = "large")]
    #[inline]
    #[must_use]
    pub fn from_own_zero(&self, config: &ShaftConfig) -> Option<i64> {
        let unwrapped = self.unwrapped.as_ref()?;
        (config.kind != EncoderKind::Incremental).then(|| unwrapped.from_own_zero())
    }

    fn bad(&mut self, config: &ShaftConfig, error: EncoderError, watched: bool) -> Seen {
        if !watched {
            // In this state the count is not used, so counting starts anew with the next good reading.
            *self = Self::new();
            return Seen::Bad;
        }
        self.bad = self.bad.saturating_add(1);
        self.remember(config, 0);
        if self.bad < config.bad_readings {
            return Seen::Bad;
        }
        match error {
            EncoderError::Silent => Seen::Fault(FaultCode::EncoderSilent, i32::from(self.bad)),
            EncoderError::Check(word) => Seen::Fault(FaultCode::EncoderCheck, word.cast_signed()),
            EncoderError::Status(word) => Seen::Fault(FaultCode::EncoderStatus, word.cast_signed()),
        }
    }

    fn remember(&mut self, config: &ShaftConfig, moved: i32) {
        if let Some(place) = self.moves.get_mut(self.at) {
            self.sum = self.sum.saturating_sub(*place).saturating_add(moved);
            *place = moved;
        }
        self.at = self.at.saturating_add(1);
        if self.at >= config.window {
            self.at = 0;
        }
    }

    /// Checks whether the shaft moves as no hand moves it. A current of positive sign drives the shaft towards rising counts, unless
    /// `against` is true. Returns the fault, if there is one.
    pub fn motion_fault(
        &self,
        config: &ShaftConfig,
        motion: &mut Motion,
        report: &CurrentReport,
        against: bool,
    ) -> Option<Found> {
        motion.update(&config.motion, self.sum, report, against)
    }

    /// Mean speed of the shaft over the window (2 ms, but 2 to 20 control periods), rad/s, saturating.
    #[must_use]
    pub fn speed(&self, config: &ShaftConfig) -> I16F16 {
        Self::speed_of(config, self.sum)
    }

    /// The speed for this number of counts in the window over which the speed is averaged, rad/s, saturating.
    fn speed_of(config: &ShaftConfig, counts: i32) -> I16F16 {
        I16F16::from_bits(clamp_i32(
            i64::from(counts) * i64::from(config.speed_per_count.to_bits()),
        ))
    }

    /// Change of the electrical angle in a PWM period at the present speed, 2^-32 turns, saturating.
    #[must_use]
    pub fn advance(&self, config: &ShaftConfig) -> i32 {
        clamp_i32(i64::from(self.sum).saturating_mul(config.advance_per_count) >> 16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardware::IHM08M1;

    /// Turns an encoder of 16,384 counts per turn by this many counts in each control period, with good readings. Returns the fault
    /// and the number of the period in which it came.
    fn turned(rate_hz: u32, counts: i64) -> Option<(u32, Seen)> {
        let mut settings = DeviceSettings::default();
        settings.encoder.kind = EncoderKind::Incremental;
        settings.encoder.counts_per_rev = 16_384;
        settings.timing.rate_hz = rate_hz;
        settings.limits.max_speed_rad_per_s = Si::lit("60");
        let config = ShaftConfig::new(&settings, &IHM08M1);
        let mut shaft = Shaft::new();
        for tick in 0..200_u32 {
            let counter = (i64::from(tick) * counts) as u32;
            let seen = shaft.read(&config, EncoderReading::Counter32(counter), true, false);
            if matches!(seen, Seen::Fault(..)) {
                return Some((tick, seen));
            }
        }
        None
    }

    #[test]
    fn what_is_clearly_too_fast_shows_in_a_tick_and_a_slight_excess_in_a_window() {
        // The limit of 60 rad/s is 156.5 counts in a control period and 313 in a window of two; 4 counts are added for jitter.
        assert_eq!(turned(1_000, 158), None);
        for (counts, tick, least, most) in [
            (161, 2, 61_000, 62_000),
            (-162, 1, -62_500, -62_000),
            (600, 1, 230_000, 230_200),
        ] {
            let Some((at, Seen::Fault(FaultCode::OverSpeed, speed))) = turned(1_000, counts) else {
                panic!("{counts} counts");
            };
            assert_eq!(at, tick, "{counts} counts");
            assert!((least..most).contains(&speed), "{counts}: {speed} mrad/s");
        }
        // At 10 kHz the limit is 15.6 counts in a control period, and the window has 20 periods.
        assert_eq!(turned(10_000, 15), None);
        assert!(matches!(turned(10_000, 16), Some((20, _))));
        assert!(matches!(turned(10_000, -21), Some((1, _))));
    }
}
