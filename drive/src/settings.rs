//! The ranges of [`DeviceSettings`] that a board's power stage allows, and the conditions between settings.

use crate::change::ChangeConfig;
use crate::hardware::Hardware;
use touchstone_control::Si;
use touchstone_protocol::settings::fields::{range, within};
use touchstone_protocol::settings::{Reason, SettingsError};
use touchstone_protocol::{Decimal, DeviceSettings};

pub use touchstone_protocol::settings::{DriveKind, EncoderKind, MotorSettings};

/// Checks a setting against a range narrower than that of the settings' table: `narrow!(settings, motor.current_limit_a, to:
/// most)`.
macro_rules! narrow {
    ($settings:ident, $table:ident.$name:ident, to: $most:expr) => {
        narrow!(
            $settings,
            $table.$name,
            const { range(concat!(stringify!($table), ".", stringify!($name))).0 },
            $most
        )
    };
    ($settings:ident, $table:ident.$name:ident, $least:expr, $most:expr) => {{
        const PATH: &str = concat!(stringify!($table), ".", stringify!($name));
        within(PATH, $settings.$table.$name, ($least, $most))
    }};
}

/// Checks every setting against its range on this board. The settings of the control law are checked when its coefficients are
/// computed.
///
/// # Errors
/// The first setting that is out of range.
#[inline]
pub fn validate(settings: &DeviceSettings, hardware: &Hardware) -> Result<(), SettingsError> {
    settings.check_ranges()?;
    let rate_hz = settings.timing.rate_hz;
    if hardware.pwm_hz.checked_rem(rate_hz) != Some(0) {
        return Err(SettingsError {
            path: "timing.rate_hz",
            value: Decimal::from_num(rate_hz),
            reason: Reason::NoFractionOf(hardware.pwm_hz),
        });
    }
    if settings.encoder.kind != EncoderKind::Incremental {
        let counts = Si::saturating_from_num(settings.encoder.counts_per_rev);
        let only = const { Si::lit("16384") };
        within("encoder.counts_per_rev", counts, (only, only))?;
    }
    if settings.drive.kind == DriveKind::ThreePhase {
        validate_motor(settings, hardware)?;
    }
    ChangeConfig::new(settings, hardware).map(|_| ())
}

#[inline]
fn validate_motor(settings: &DeviceSettings, hardware: &Hardware) -> Result<(), SettingsError> {
    let limits = &settings.limits;
    narrow!(settings, limits.trip_current_a, to: hardware.current_max_a)?;
    narrow!(settings, motor.current_limit_a, to: limits.trip_current_a)?;
    narrow!(
        settings,
        limits.bus_max_v,
        hardware.bus_min_v,
        hardware.bus_max_v
    )?;
    narrow!(
        settings,
        limits.bus_min_v,
        hardware.bus_min_v,
        limits.bus_max_v
    )?;
    narrow!(settings, limits.fault_from_celsius, to: hardware.temperature_max_c)?;
    let below = limits.fault_from_celsius.saturating_sub(Si::ONE);
    narrow!(settings, limits.derate_from_celsius, to: below)?;
    narrow!(settings, motor.continuous_current_a, to: hardware.current_max_a)?;
    narrow!(settings, calibration.current_a, to: settings.motor.current_limit_a)
}

/// The error for the setting at `path`: a coefficient that is computed from it does not fit its fixed-point format.
pub(crate) const fn out_of_format(path: &'static str, coefficient: Si) -> SettingsError {
    SettingsError {
        path,
        value: Decimal(coefficient),
        reason: Reason::OutOfFormat,
    }
}
