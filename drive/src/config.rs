//! The coefficients that are computed once from the settings, and how a calibration switches to the coefficients of other settings.
//!
//! The functions that compute the coefficients, here and in the crate `control`, are `#[inline]`. So each program compiles them
//! itself, the firmware for size. The code that runs in each control period is compiled with its crate, for speed. On the STM32G431
//! that saves 6 KiB of flash.

use crate::angle::ElectricalScale;
use crate::calibration::CalibrationConfig;
use crate::change::{ChangeConfig, law_settings};
use crate::command::AnyDrive;
use crate::current::CurrentConfig;
#[cfg(feature = "voltage")]
use crate::current::VoltageStage;
use crate::hardware::Hardware;
use crate::measurement::MeasurementConfig;
use crate::pi::PiGains;
use crate::settings::{DriveKind, out_of_format, validate};
use crate::supervisor::SupervisorConfig;
use crate::thermistor::Thermistor;
use crate::timing::periods_per_tick;
use crate::units::{narrow, quotient};
use fixed::types::I8F24;
use touchstone_control::{Controller, CountScale, Fixed32, Number, Si};
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::settings::{SettingsError, refused};

/// All coefficients that are computed from the settings.
#[derive(Debug, Clone, Copy)]
pub struct Config {
    /// Coefficients of the current loop.
    pub current: CurrentConfig,
    /// Limits of the supervisor, whose violation is a fault.
    pub supervisor: SupervisorConfig,
    /// Coefficients of the calibration.
    pub calibration: CalibrationConfig,
    /// Coefficients of a motor measurement that follows the calibration.
    pub measurement: MeasurementConfig,
    /// Coefficients of a cogging sweep (slow turn that measures the cogging torque) after the calibration.
    #[cfg(feature = "large")]
    pub sweep: crate::sweep::SweepConfig,
    /// Converts a torque to a current, or to a voltage for an external amplifier.
    pub drive: AnyDrive,
    /// The control law, in the state that it has at power-up.
    pub law: Controller<Fixed32>,
    /// A control period whose force reaches this value in N·m is reported as being at the force limit.
    pub force_limit: I8F24,
    /// Converts encoder counts to the penetration into the wall.
    pub scale: CountScale,
    /// Converts encoder counts to the electrical angle.
    pub electrical: ElectricalScale,
    /// Converts the analogue-to-digital converter's code to the temperature.
    pub thermistor: Thermistor,
    /// Time and use of the second encoder reading, at the change of force; `None` if no second reading is used.
    pub change: Option<ChangeConfig>,
    /// Growth per control period of the factor by which the torque is multiplied while it fades in, 2^-32.
    pub fade_step: u32,
}

impl Config {
    /// Validates the settings and computes the coefficients.
    ///
    /// # Errors
    /// Same as [`validate`]; also coefficients that do not fit their fixed-point formats.
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Result<Self, SettingsError> {
        validate(settings, hardware)?;
        let motor = &settings.motor;
        let rate = Si::saturating_from_num(settings.timing.rate_hz);
        let ticks = settings.limits.fade_in_s.saturating_mul(rate);
        // The quotient has 32 fractional bits, so its bits are the step. A time below a control period gives the whole torque at
        // once. The step is rounded up, so that the torque is complete in the last period of the fade-in.
        let fade_step = u32::try_from(quotient(Si::ONE, ticks).to_bits())
            .unwrap_or(u32::MAX)
            .saturating_add(1);
        let counts = settings.encoder.counts_per_rev;
        let (law, change) = law_settings(settings, hardware)?;
        let mut current = CurrentConfig::new(settings, hardware)?;
        current.read_at = change.map_or(0, |change| change.read_at);
        Ok(Self {
            current,
            supervisor: SupervisorConfig::new(settings, hardware),
            calibration: CalibrationConfig::new(settings, hardware),
            measurement: MeasurementConfig::new(settings, hardware),
            #[cfg(feature = "large")]
            sweep: crate::sweep::SweepConfig::new(settings),
            drive: AnyDrive::new(settings)?,
            law: Controller::new(&law).map_err(|error| refused(&error))?,
            force_limit: Fixed32::saturating_signal(settings.law.force_limit_n_m),
            scale: CountScale::new(counts, settings.wall.surface_rad)
                .ok_or_else(|| out_of_format("encoder.counts_per_rev", Si::ZERO))?,
            electrical: ElectricalScale::new(motor.pole_pairs, counts),
            thermistor: hardware.thermistor,
            change,
            fade_step,
        })
    }

    /// Whether the drive has a motor whose electrical angle must be calibrated.
    pub(crate) const fn aligns(&self) -> bool {
        matches!(self.drive, AnyDrive::ThreePhase(_))
    }
}

impl CurrentConfig {
    /// Computes the current loop's coefficients.
    ///
    /// # Errors
    /// The controller gains do not fit their fixed-point formats. For an analogue drive the gains are not used and never refused.
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Result<Self, SettingsError> {
        let motor = &settings.motor;
        let gains = match settings.drive.kind {
            DriveKind::ThreePhase if hardware.gives_voltage() => PiGains::NONE,
            DriveKind::ThreePhase => PiGains::new(
                motor.resistance_ohm,
                motor.inductance_h,
                motor.current_bandwidth_hz,
                Si::saturating_from_num(hardware.pwm_hz),
            )?,
            DriveKind::Analogue => PiGains::NONE,
        };
        Ok(Self {
            gains,
            modulator: hardware.modulator(),
            voltage_share: hardware.modulator().share(),
            amps_per_code: hardware.amps_per_code_bits(),
            volts_per_code: narrow(hardware.volts_per_code),
            limit: narrow(motor.current_limit_a),
            trip: narrow(settings.limits.trip_current_a),
            periods_per_tick: periods_per_tick(settings, hardware),
            read_at: 0,
            #[cfg(feature = "voltage")]
            voltage: VoltageStage::new(motor, hardware)?,
        })
    }
}

/// The coefficients in use, and room for those of the next settings. A calibration switches between them with a flag, because
/// copying all of them would be the longest operation of a control period.
#[derive(Debug, Clone)]
pub(crate) struct Configs {
    first: Config,
    second: Config,
    use_second: bool,
    has_next: bool,
}

impl Configs {
    #[inline]
    pub(crate) const fn new(config: Config) -> Self {
        Self {
            first: config,
            second: config,
            use_second: false,
            has_next: false,
        }
    }

    pub(crate) const fn now(&self) -> &Config {
        if self.use_second {
            &self.second
        } else {
            &self.first
        }
    }

    /// Stores a configuration to which the next calibration switches.
    pub(crate) const fn prepare(&mut self, config: Config) {
        if self.use_second {
            self.first = config;
        } else {
            self.second = config;
        }
        self.has_next = true;
    }

    /// Whether a configuration is stored to which the next calibration switches.
    pub(crate) const fn has_next(&self) -> bool {
        self.has_next
    }

    /// Switches to the prepared configuration; returns whether there was one.
    pub(crate) const fn turn(&mut self) -> bool {
        let turns = self.has_next;
        self.use_second ^= turns;
        self.has_next = false;
        turns
    }
}
