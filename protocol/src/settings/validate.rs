//! Validation of the whole: each number against its range, the numbers against each other, and the wall by the control law
//! itself.

use super::{Decimal, DeviceSettings, EncoderKind, PWM_RATE_HZ, fields};
use core::fmt;
use serde::{Deserialize, Serialize};
use touchstone_control as law;
use touchstone_control::{Controller, Fixed32, SettingsError};

/// Longest path of a leaf, bytes.
pub const PATH_MAX: usize = 48;

/// A path that owns its text.
pub type PathText = heapless::String<PATH_MAX>;

/// A setting that is refused, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Invalid {
    /// The path of the leaf.
    pub path: PathText,
    /// Its value; a whole number for those that are.
    pub value: Decimal,
    /// Why it is refused.
    pub reason: Reason,
}

/// Why a setting is refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// Outside the range that it has, or that the other settings leave it.
    Outside {
        /// Smallest allowed.
        least: Decimal,
        /// Largest allowed.
        most: Decimal,
    },
    /// The law's coefficient that is made of it does not fit the number format.
    OutOfFormat,
    /// No whole fraction of this rate, Hz.
    NoFractionOf(u32),
}

impl Invalid {
    pub(super) fn new(path: &str, value: Decimal, reason: Reason) -> Self {
        Self {
            // Every path fits: a test goes through all of them.
            path: PathText::try_from(path).unwrap_or_default(),
            value,
            reason,
        }
    }
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            path,
            value,
            reason,
        } = self;
        let unit = fields::field(path).map_or("", |field| field.unit);
        let space = if unit.is_empty() { "" } else { " " };
        match reason {
            Reason::Outside { least, most } => {
                write!(
                    f,
                    "{path} = {value} is outside {least} to {most}{space}{unit}"
                )
            }
            Reason::OutOfFormat => write!(
                f,
                "{path} = {value}{space}{unit} makes a coefficient that does not fit the law's number format"
            ),
            Reason::NoFractionOf(rate) => {
                write!(
                    f,
                    "{path} = {value}{space}{unit} is no whole fraction of {rate} Hz"
                )
            }
        }
    }
}

impl core::error::Error for Invalid {}

/// Refuses a setting that is above another; its least value stands in the table.
macro_rules! at_most {
    ($path:literal, $value:expr, $most:expr) => {
        if $value > $most {
            let least = const { fields::least($path) };
            let reason = Reason::Outside { least, most: $most };
            return Err(Invalid::new($path, $value, reason));
        }
    };
}

impl DeviceSettings {
    /// Checks everything; returns the law that the wall will follow.
    ///
    /// # Errors
    /// The first setting that is refused.
    pub fn validate(&self) -> Result<Controller<Fixed32>, Invalid> {
        fields::check(self)?;
        self.check_rate()?;
        self.check_encoder()?;
        self.check_against_each_other()?;
        Controller::new(&self.law()).map_err(|error| refused(&error))
    }

    fn check_rate(&self) -> Result<(), Invalid> {
        let rate = self.control.rate_hz;
        if PWM_RATE_HZ.checked_rem(rate) == Some(0) {
            return Ok(());
        }
        let reason = Reason::NoFractionOf(PWM_RATE_HZ);
        Err(Invalid::new(
            "control.rate_hz",
            Decimal::from_num(rate),
            reason,
        ))
    }

    fn check_encoder(&self) -> Result<(), Invalid> {
        /// Both magnetic encoders have 14 bits.
        const MAGNETIC: u32 = 1 << 14;
        let counts = self.encoder.counts_per_rev;
        match self.encoder.kind {
            EncoderKind::Incremental => Ok(()),
            EncoderKind::As5047p | EncoderKind::Mt6701 if counts == MAGNETIC => Ok(()),
            EncoderKind::As5047p | EncoderKind::Mt6701 => Err(Invalid::new(
                "encoder.counts_per_rev",
                Decimal::from_num(counts),
                Reason::Outside {
                    least: Decimal::from_num(MAGNETIC),
                    most: Decimal::from_num(MAGNETIC),
                },
            )),
        }
    }

    /// The ranges that settings leave to others.
    fn check_against_each_other(&self) -> Result<(), Invalid> {
        let (motor, limits) = (&self.motor, &self.limits);
        let torque = Decimal(
            motor
                .torque_constant_n_m_per_a
                .0
                .saturating_mul(motor.current_limit_a.0),
        );
        at_most!("wall.force_limit_n_m", self.wall.force_limit_n_m, torque);
        at_most!(
            "motor.calibration_current_a",
            motor.calibration_current_a,
            motor.current_limit_a
        );
        at_most!(
            "motor.current_limit_a",
            motor.current_limit_a,
            limits.over_current_a
        );
        at_most!("limits.bus_min_v", limits.bus_min_v, limits.bus_max_v);
        at_most!(
            "limits.derating_celsius",
            limits.derating_celsius,
            limits.temperature_max_celsius
        );
        Ok(())
    }
}

/// The law's refusal, by the path of the setting.
fn refused(error: &SettingsError) -> Invalid {
    match *error {
        SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        } => Invalid::new(
            path(field),
            Decimal(value),
            Reason::Outside {
                least: Decimal(min),
                most: Decimal(max),
            },
        ),
        SettingsError::OutOfFormat { field, value, .. } => {
            Invalid::new(path(field), Decimal(value), Reason::OutOfFormat)
        }
        SettingsError::NoCompensation {
            k_desired,
            k_filter,
        } => Invalid::new(
            path(law::Field::KDesired),
            Decimal(k_desired),
            Reason::Outside {
                least: Decimal::default(),
                most: Decimal(k_filter.saturating_sub(law::Si::DELTA)),
            },
        ),
    }
}

/// The path of a setting of the law.
fn path(field: law::Field) -> &'static str {
    match field {
        law::Field::RateHz => "control.rate_hz",
        law::Field::KDesired => "wall.k_desired_n_m_per_rad",
        law::Field::KSoft => "wall.k_soft_n_m_per_rad",
        law::Field::DeviceDamping => "wall.device_damping_n_m_s_per_rad",
        law::Field::VirtualDamping => "wall.virtual_damping_n_m_s_per_rad",
        law::Field::StepOfIdeal => "wall.step_of_ideal",
        law::Field::LimitOfForce => "wall.limit_of_force",
        law::Field::LimitOfPenetration => "wall.limit_of_penetration",
        law::Field::FilterMass => "wall.filter.mass_kg_m2",
        law::Field::FilterStiffness => "wall.filter.stiffness_n_m_per_rad",
        law::Field::FilterDamping => "wall.filter.damping_n_m_s_per_rad",
        law::Field::FilterGroundDamping => "wall.filter.ground_damping_n_m_s_per_rad",
        law::Field::EnergyCredit => "wall.energy_credit_j",
        law::Field::ForceLimit => "wall.force_limit_n_m",
    }
}
