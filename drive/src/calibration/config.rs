//! Coefficients of a calibration, calculated from settings and hardware.

use crate::Amps;
use crate::angle::ElectricalScale;
use crate::hardware::Hardware;
use crate::timing::periods_per_tick;
use crate::units::narrow;
use touchstone_protocol::DeviceSettings;

/// Coefficients of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationConfig {
    pub(super) current: Amps,
    /// Rise per control period of the current that makes the calibration's field, A.
    pub(super) current_step: Amps,
    /// Speed of the calibration's rotating field, 2^-32 electrical turns per control period.
    pub(super) speed: u32,
    /// Change of the field's speed per control period while it speeds up, 2^-32 electrical turns per period.
    pub(super) speed_step: u32,
    /// Factor from an angle per control period to an angle per PWM period, with 16 fractional bits.
    pub(super) per_period: u32,
    /// Control periods for which the rotor settles in the field. The measurement of the current sensors' offsets may take as long.
    pub(super) settle: u32,
    /// Encoder counts within which a rotor at rest may move: a 64th of an electrical turn, at least 3.
    pub(super) rest: i64,
    /// Angle in each direction in which samples are taken, 2^-32 electrical turns: one turn for each pole pair.
    pub(super) turns: i64,
    pub(super) pole_pairs: u8,
    pub(super) counts_per_rev: u32,
    pub(super) scale: ElectricalScale,
    pub(super) offset_code: u16,
    pub(super) offset_tolerance: u16,
    pub(super) offset_spread: u16,
    /// Whether the board measures the motor's currents.
    #[cfg(feature = "voltage")]
    pub(super) senses: bool,
    /// Whether the board measures no currents, and the settings lack motor values that are needed to convert a current to a
    /// voltage.
    #[cfg(feature = "voltage")]
    pub(super) is_untold: bool,
}

impl CalibrationConfig {
    /// Computes the coefficients of a calibration from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let rate = settings.timing.rate_hz.max(1);
        let pole_pairs = settings.motor.pole_pairs.max(1);
        let counts_per_rev = settings.encoder.counts_per_rev.max(1);
        // Electrical turns per second over the control rate; the quotient's 32 fractional bits are units of 2^-32 turns.
        let speed = settings
            .calibration
            .electrical_turns_per_s
            .to_bits()
            .unsigned_abs()
            / u64::from(rate);
        let speed = u32::try_from(speed).unwrap_or(u32::MAX);
        let current = narrow(settings.calibration.current_a);
        // The current rises in half a second, the speed in a quarter of a second.
        let (half, quarter) = ((rate / 2).max(1), (rate / 4).max(1));
        let step = current.to_bits() / i32::try_from(half).unwrap_or(i32::MAX);
        Self {
            current,
            current_step: Amps::from_bits(step.max(1)),
            speed,
            speed_step: (speed / quarter).max(1),
            per_period: (1 << 16) / u32::from(periods_per_tick(settings, hardware)),
            settle: half,
            rest: (i64::from(counts_per_rev) / (i64::from(pole_pairs) << 6)).max(3),
            turns: i64::from(pole_pairs) << 32,
            pole_pairs,
            counts_per_rev,
            scale: ElectricalScale::new(pole_pairs, counts_per_rev),
            offset_code: hardware.offset_code,
            offset_tolerance: hardware.offset_tolerance,
            offset_spread: hardware.offset_spread,
            #[cfg(feature = "voltage")]
            senses: !hardware.gives_voltage(),
            #[cfg(feature = "voltage")]
            is_untold: hardware.gives_voltage() && settings.untold_motor().is_some(),
        }
    }
}
