//! What a person chooses of the device, in SI, and the check of it. The wall is [`touchstone_control::Settings`], unchanged.

use crate::encoder::EncoderKind;
use crate::hardware::Hardware;
use core::fmt;
use touchstone_control::Si;

/// What the torque goes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DriveKind {
    /// A three-phase motor on this board's bridge, field-oriented.
    #[default]
    ThreePhase,
    /// A servo amplifier's analogue input.
    Analogue,
}

/// The encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EncoderSettings {
    /// Which.
    pub kind: EncoderKind,
    /// Counts a revolution, all edges counted: 4 to 1,000,000; 16,384 for the magnetic ones.
    pub counts_per_rev: u32,
    /// Turning the other way is positive.
    pub reversed: bool,
    /// Bad readings in a row that make a fault, 1 to 10; the outputs are off from the first.
    pub bad_readings: u8,
}

/// The motor. Resistance and inductance are those of one phase to the star point: half of what is measured between two wires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MotorSettings {
    /// Pole pairs, 1 to 50; calibration compares them with what it finds.
    pub pole_pairs: u8,
    /// Resistance, Ω, 0.01 to 100.
    pub resistance_ohm: Si,
    /// Inductance, H, 5 µH to 0.1 H.
    pub inductance_h: Si,
    /// Torque for a current `i_q` of 1 A, N·m/A, 0.001 to 10.
    pub torque_constant_nm_per_a: Si,
    /// Largest current, A, 0.05 to 50.
    pub current_limit_a: Si,
    /// Bandwidth of the current loop, Hz, 50 to 1,500.
    pub current_bandwidth_hz: Si,
}

/// The amplifier behind the analogue output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnalogueSettings {
    /// Torque at the upper end of the output, N·m; the lower end is its negative and the middle is zero. 0.01 to 100.
    pub full_scale_nm: Si,
}

/// What makes a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LimitSettings {
    /// Bus voltage below which there is a fault, V.
    pub bus_min_v: Si,
    /// Bus voltage above which there is a fault, V.
    pub bus_max_v: Si,
    /// Current that trips, A; above the motor's current limit.
    pub trip_current_a: Si,
    /// Temperature above which the current is derated, degrees Celsius.
    pub derate_from_c: Si,
    /// Temperature at which nothing is left of it and there is a fault, degrees Celsius.
    pub fault_from_c: Si,
    /// Speed above which there is a fault, rad/s, 1 to 1,000.
    pub max_speed_rad_per_s: Si,
    /// Time over which the torque fades in after arming, s, 0 to 10.
    pub fade_in_s: Si,
}

/// How the encoder is aligned with the motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationSettings {
    /// Current of the field that turns the shaft, A; at most the motor's limit.
    pub current_a: Si,
    /// Speed of the field, electrical turns a second, 0.2 to 20.
    pub turns_per_s: Si,
}

/// Everything that the device needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// The wall, its law, the control rate and the largest torque.
    pub wall: touchstone_control::Settings,
    /// Where the wall begins, rad from where the shaft stood at the end of the calibration.
    pub surface_rad: Si,
    /// The encoder.
    pub encoder: EncoderSettings,
    /// What the torque goes to.
    pub drive: DriveKind,
    /// The motor, for [`DriveKind::ThreePhase`].
    pub motor: MotorSettings,
    /// The amplifier, for [`DriveKind::Analogue`].
    pub analogue: AnalogueSettings,
    /// What makes a fault.
    pub limits: LimitSettings,
    /// Calibration.
    pub calibration: CalibrationSettings,
}

macro_rules! si {
    ($text:literal) => {
        const { Si::lit($text) }
    };
}

impl Default for Settings {
    /// The thesis' wall on a gimbal-type motor with a magnetic encoder, at 24 V.
    fn default() -> Self {
        Self {
            wall: touchstone_control::Settings::default(),
            // A fifth of a turn away, so that a knob that was just calibrated is outside.
            surface_rad: si!("1.0"),
            encoder: EncoderSettings {
                kind: EncoderKind::As5047p,
                counts_per_rev: 16_384,
                reversed: false,
                bad_readings: 3,
            },
            drive: DriveKind::ThreePhase,
            motor: MotorSettings {
                pole_pairs: 7,
                resistance_ohm: si!("6"),
                inductance_h: si!("0.003"),
                torque_constant_nm_per_a: si!("0.25"),
                current_limit_a: si!("2"),
                // No overshoot even with a delay of 1.5 periods of 50 µs; it is one (`current::ACTS_AFTER_PERIODS`).
                current_bandwidth_hz: si!("600"),
            },
            analogue: AnalogueSettings {
                full_scale_nm: si!("1"),
            },
            limits: LimitSettings {
                bus_min_v: si!("18"),
                bus_max_v: si!("30"),
                trip_current_a: si!("4"),
                derate_from_c: si!("70"),
                fault_from_c: si!("90"),
                max_speed_rad_per_s: si!("60"),
                fade_in_s: si!("0.2"),
            },
            calibration: CalibrationSettings {
                current_a: si!("1"),
                turns_per_s: si!("4"),
            },
        }
    }
}

/// A setting, by its path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Field {
    RateHz,
    SurfaceRad,
    CountsPerRev,
    BadReadings,
    PolePairs,
    ResistanceOhm,
    InductanceH,
    TorqueConstantNmPerA,
    CurrentLimitA,
    CurrentBandwidthHz,
    FullScaleNm,
    BusMinV,
    BusMaxV,
    TripCurrentA,
    DerateFromC,
    FaultFromC,
    MaxSpeedRadPerS,
    FadeInS,
    CalibrationCurrentA,
    CalibrationTurnsPerS,
}

impl Field {
    /// Path as in [`Settings`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RateHz => "wall.rate_hz",
            Self::SurfaceRad => "surface_rad",
            Self::CountsPerRev => "encoder.counts_per_rev",
            Self::BadReadings => "encoder.bad_readings",
            Self::PolePairs => "motor.pole_pairs",
            Self::ResistanceOhm => "motor.resistance_ohm",
            Self::InductanceH => "motor.inductance_h",
            Self::TorqueConstantNmPerA => "motor.torque_constant_nm_per_a",
            Self::CurrentLimitA => "motor.current_limit_a",
            Self::CurrentBandwidthHz => "motor.current_bandwidth_hz",
            Self::FullScaleNm => "analogue.full_scale_nm",
            Self::BusMinV => "limits.bus_min_v",
            Self::BusMaxV => "limits.bus_max_v",
            Self::TripCurrentA => "limits.trip_current_a",
            Self::DerateFromC => "limits.derate_from_c",
            Self::FaultFromC => "limits.fault_from_c",
            Self::MaxSpeedRadPerS => "limits.max_speed_rad_per_s",
            Self::FadeInS => "limits.fade_in_s",
            Self::CalibrationCurrentA => "calibration.current_a",
            Self::CalibrationTurnsPerS => "calibration.turns_per_s",
        }
    }
}

/// Why settings are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SettingsError {
    /// The wall's.
    Wall(touchstone_control::SettingsError),
    /// Outside its range on this board.
    OutOfRange {
        /// Which setting.
        field: Field,
        /// Its value.
        value: Si,
        /// Smallest allowed value.
        min: Si,
        /// Largest allowed value.
        max: Si,
    },
    /// The control rate does not divide the PWM rate.
    Rate {
        /// Control rate, Hz.
        rate_hz: u32,
        /// PWM rate, Hz.
        pwm_hz: u32,
    },
    /// A coefficient made of the setting does not fit its format.
    Coefficient {
        /// Which setting.
        field: Field,
        /// The coefficient.
        value: Si,
    },
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wall(error) => write!(f, "wall.{error}"),
            Self::OutOfRange {
                field,
                value,
                min,
                max,
            } => write!(
                f,
                "{} = {value:.6} is outside {min:.6} to {max:.6}",
                field.name()
            ),
            Self::Rate { rate_hz, pwm_hz } => write!(
                f,
                "wall.rate_hz = {rate_hz} does not divide the PWM rate of {pwm_hz} Hz; 1000, 2000, 4000, 5000 and 10000 do"
            ),
            Self::Coefficient { field, value } => write!(
                f,
                "{}: its coefficient {value:.6} does not fit; is the unit right?",
                field.name()
            ),
        }
    }
}

impl From<touchstone_control::SettingsError> for SettingsError {
    fn from(error: touchstone_control::SettingsError) -> Self {
        Self::Wall(error)
    }
}

impl Settings {
    /// Checks every setting against its range; the wall's by its own code.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn validate(&self, hardware: &Hardware) -> Result<(), SettingsError> {
        self.wall.validate()?;
        let rate_hz = self.wall.rate_hz;
        range(
            Field::RateHz,
            Si::saturating_from_num(rate_hz),
            si!("500"),
            si!("10000"),
        )?;
        if hardware.pwm_hz.checked_rem(rate_hz) != Some(0) {
            return Err(SettingsError::Rate {
                rate_hz,
                pwm_hz: hardware.pwm_hz,
            });
        }
        range(Field::SurfaceRad, self.surface_rad, si!("-100"), si!("100"))?;
        let (least, most) = match self.encoder.kind {
            EncoderKind::Incremental => (si!("4"), si!("1000000")),
            EncoderKind::As5047p | EncoderKind::Mt6701 => (si!("16384"), si!("16384")),
        };
        range(
            Field::CountsPerRev,
            Si::saturating_from_num(self.encoder.counts_per_rev),
            least,
            most,
        )?;
        range(
            Field::BadReadings,
            Si::from(self.encoder.bad_readings),
            si!("1"),
            si!("10"),
        )?;
        match self.drive {
            DriveKind::ThreePhase => self.validate_motor(hardware)?,
            DriveKind::Analogue => range(
                Field::FullScaleNm,
                self.analogue.full_scale_nm,
                si!("0.01"),
                si!("100"),
            )?,
        }
        let limits = &self.limits;
        range(
            Field::MaxSpeedRadPerS,
            limits.max_speed_rad_per_s,
            si!("1"),
            si!("1000"),
        )?;
        range(Field::FadeInS, limits.fade_in_s, Si::ZERO, si!("10"))
    }

    fn validate_motor(&self, hardware: &Hardware) -> Result<(), SettingsError> {
        let (motor, limits) = (&self.motor, &self.limits);
        range(
            Field::PolePairs,
            Si::from(motor.pole_pairs),
            si!("1"),
            si!("50"),
        )?;
        range(
            Field::ResistanceOhm,
            motor.resistance_ohm,
            si!("0.01"),
            si!("100"),
        )?;
        range(
            Field::InductanceH,
            motor.inductance_h,
            si!("0.000005"),
            si!("0.1"),
        )?;
        range(
            Field::TorqueConstantNmPerA,
            motor.torque_constant_nm_per_a,
            si!("0.001"),
            si!("10"),
        )?;
        range(
            Field::TripCurrentA,
            limits.trip_current_a,
            si!("0.05"),
            hardware.current_max_a,
        )?;
        range(
            Field::CurrentLimitA,
            motor.current_limit_a,
            si!("0.05"),
            limits.trip_current_a,
        )?;
        range(
            Field::CurrentBandwidthHz,
            motor.current_bandwidth_hz,
            si!("50"),
            si!("1500"),
        )?;
        range(
            Field::BusMaxV,
            limits.bus_max_v,
            hardware.bus_min_v,
            hardware.bus_max_v,
        )?;
        range(
            Field::BusMinV,
            limits.bus_min_v,
            hardware.bus_min_v,
            limits.bus_max_v,
        )?;
        range(
            Field::FaultFromC,
            limits.fault_from_c,
            si!("30"),
            hardware.temperature_max_c,
        )?;
        range(
            Field::DerateFromC,
            limits.derate_from_c,
            si!("20"),
            limits.fault_from_c.saturating_sub(Si::ONE),
        )?;
        range(
            Field::CalibrationCurrentA,
            self.calibration.current_a,
            si!("0.05"),
            motor.current_limit_a,
        )?;
        range(
            Field::CalibrationTurnsPerS,
            self.calibration.turns_per_s,
            si!("0.2"),
            si!("20"),
        )
    }
}

fn range(field: Field, value: Si, min: Si, max: Si) -> Result<(), SettingsError> {
    if value < min || value > max {
        Err(SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        })
    } else {
        Ok(())
    }
}

impl Settings {
    /// PWM periods in a control period.
    #[must_use]
    pub fn periods_per_tick(&self, hardware: &Hardware) -> u16 {
        let periods = hardware.pwm_hz.checked_div(self.wall.rate_hz).unwrap_or(1);
        u16::try_from(periods).unwrap_or(u16::MAX).max(1)
    }
}
