//! Validation of the whole: each number against its range, the numbers against each other, and the wall by the control law
//! itself.

use super::{Decimal, DeviceSettings, DriveKind, EncoderKind, fields};
use crate::reply::Board;
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
    /// Its value, or the coefficient for [`Reason::OutOfFormat`].
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
    /// The board has nothing to connect it to; the value is the number of the word.
    NotOnThisBoard,
}

impl Invalid {
    /// By its path.
    #[must_use]
    pub fn new(path: &str, value: Decimal, reason: Reason) -> Self {
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
                "{path}: the coefficient {value} that is made of it does not fit its number format"
            ),
            Reason::NoFractionOf(rate) => {
                write!(
                    f,
                    "{path} = {value}{space}{unit} is no whole fraction of {rate} Hz"
                )
            }
            Reason::NotOnThisBoard => {
                write!(f, "{path}: this board has no connector for it")
            }
        }
    }
}

impl core::error::Error for Invalid {}

impl DeviceSettings {
    /// Checks everything that a board and the law decide; returns the law that the wall will follow.
    ///
    /// What the power stage adds (its largest current and voltage) is checked by `touchstone_drive::wire::checked`, which calls
    /// this first and is what firmware and desktop use.
    ///
    /// # Errors
    /// The first setting that is refused.
    pub fn validate(&self, board: Board) -> Result<Controller<Fixed32>, Invalid> {
        fields::check(self)?;
        self.check_board(board)?;
        self.check_force_limit()?;
        Controller::new(&self.law()).map_err(|error| refused(&error))
    }

    /// The smaller board has neither SPI nor a DAC on its connectors.
    fn check_board(&self, board: Board) -> Result<(), Invalid> {
        if board == Board::NucleoG474re {
            return Ok(());
        }
        let (encoder, drive) = (self.encoder.kind, self.drive.kind);
        let refused = if encoder != EncoderKind::Incremental {
            Some(("encoder.kind", encoder as u32))
        } else if drive != DriveKind::ThreePhase {
            Some(("drive.kind", drive as u32))
        } else {
            None
        };
        refused.map_or(Ok(()), |(path, number)| {
            let value = Decimal::from_num(number);
            Err(Invalid::new(path, value, Reason::NotOnThisBoard))
        })
    }

    /// A torque that the drive cannot give would be taken for given by the law's energy observer.
    fn check_force_limit(&self) -> Result<(), Invalid> {
        let most = match self.drive.kind {
            DriveKind::Analogue => self.drive.analogue_full_scale_n_m,
            DriveKind::ThreePhase => {
                let motor = &self.motor;
                let torque = motor.torque_constant_n_m_per_a.0;
                Decimal(torque.saturating_mul(motor.current_limit_a.0))
            }
        };
        let value = self.wall.force_limit_n_m;
        if value <= most {
            return Ok(());
        }
        let least = const { fields::least("wall.force_limit_n_m") };
        let reason = Reason::Outside { least, most };
        Err(Invalid::new("wall.force_limit_n_m", value, reason))
    }
}

/// The law's refusal, by the path of the setting.
#[must_use]
pub fn refused(error: &SettingsError) -> Invalid {
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
