//! Validation of all settings together: each number against its range, the numbers against each other, and the wall by the control
//! law's own checks.

use super::{Decimal, DeviceSettings, DriveKind, EncoderKind, fields};
use crate::Board;
use core::fmt;
#[cfg(feature = "wire")]
use serde::{Deserialize, Serialize};
use touchstone_control as law;
use touchstone_control::{Choice, Controller, Field, Fixed32};

/// Longest path of a setting, in bytes.
#[cfg(feature = "wire")]
pub const PATH_MAX: usize = 48;

/// A setting's path as an owned text.
#[cfg(feature = "wire")]
pub type PathText = heapless::String<PATH_MAX>;

/// A refused setting with the reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SettingsError {
    /// Path of the refused setting.
    pub path: &'static str,
    /// The refused value. With [`Reason::OutOfFormat`]: the control law's coefficient that was calculated from it.
    pub value: Decimal,
    /// Reason for the refusal.
    pub reason: Reason,
}

/// A [`SettingsError`] in the form that goes over the wire.
#[cfg(feature = "wire")]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Invalid {
    /// Same as [`SettingsError::path`].
    pub path: PathText,
    /// Same as [`SettingsError::value`].
    pub value: Decimal,
    /// Same as [`SettingsError::reason`].
    pub reason: Reason,
}

/// Why a setting is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub enum Reason {
    /// The value is outside the setting's range, or outside the range that the other settings leave.
    Outside {
        /// Smallest allowed value.
        least: Decimal,
        /// Largest allowed value.
        most: Decimal,
    },
    /// The control law's coefficient for this value does not fit the number format.
    OutOfFormat,
    /// The rate is not this base rate in Hz divided by a whole number.
    NoFractionOf(u32),
    /// The board has no connection for the chosen encoder or drive. The error's value is the index of the choice in its list.
    NotOnThisBoard,
    /// The chosen setting needs the position at the moment when the force changes. The device does not measure it, or its current
    /// loop is too slow to use it. The error's value is the index of the choice in its list.
    NotMeasured,
    /// The board has no current sensors, so it cannot measure a motor.
    NoCurrentSensors,
}

#[cfg(feature = "wire")]
impl From<SettingsError> for Invalid {
    fn from(error: SettingsError) -> Self {
        Self {
            // Every path is short enough; a test checks all of them.
            path: PathText::try_from(error.path).unwrap_or_default(),
            value: error.value,
            reason: error.reason,
        }
    }
}

impl SettingsError {
    /// Writes an error as text for people.
    fn tell(
        f: &mut fmt::Formatter<'_>,
        path: &str,
        value: &Decimal,
        reason: &Reason,
    ) -> fmt::Result {
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
            Reason::NoCurrentSensors => {
                write!(
                    f,
                    "{path}: this board does not measure its currents, and can measure no motor"
                )
            }
            Reason::NotMeasured => {
                write!(
                    f,
                    "{path}: the board's current loop has to be done with a change of force within a tick, give another word, a lower timing.rate_hz or more motor.current_bandwidth_hz"
                )
            }
        }
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Self::tell(f, self.path, &self.value, &self.reason)
    }
}

impl core::error::Error for SettingsError {}

#[cfg(feature = "wire")]
impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        SettingsError::tell(f, &self.path, &self.value, &self.reason)
    }
}

#[cfg(feature = "wire")]
impl core::error::Error for Invalid {}

impl DeviceSettings {
    /// Checks every range, and all that depends on the board and on the control law. Returns the wall's control law.
    ///
    /// Firmware and desktop call `touchstone_drive::wire::checked` instead. It calls this function first and then also checks the
    /// power stage's limits of current and voltage.
    ///
    /// # Errors
    /// The first setting that is refused.
    pub fn validate(&self, board: Board) -> Result<Controller<Fixed32>, SettingsError> {
        fields::check(self)?;
        self.check_board(board)?;
        self.check_force_limit()?;
        Controller::new(&self.law()).map_err(|error| refused(&error))
    }

    /// Checks each number setting against its own range.
    ///
    /// # Errors
    /// The first setting outside its range.
    pub fn check_ranges(&self) -> Result<(), SettingsError> {
        fields::check(self)
    }

    /// Checks that the board has the encoder's bus and the analogue output that the settings need.
    fn check_board(&self, board: Board) -> Result<(), SettingsError> {
        // Boards with the smallest flash leave this check out: all of them have current sensors.
        #[cfg(feature = "large")]
        if self.calibration.measures && !board.senses_current() {
            return Err(SettingsError {
                path: "calibration.measures",
                value: Decimal::from_num(1),
                reason: Reason::NoCurrentSensors,
            });
        }
        let (encoder, drive) = (self.encoder.kind, self.drive.kind);
        let (path, number) = if encoder != EncoderKind::Incremental && !board.has_bus() {
            ("encoder.kind", encoder.number())
        } else if drive == DriveKind::Analogue && !board.has_analogue() {
            ("drive.kind", drive.number())
        } else {
            return Ok(());
        };
        Err(SettingsError {
            path,
            value: Decimal::from_num(number),
            reason: Reason::NotOnThisBoard,
        })
    }

    /// Checks that the motor's drive can give the largest torque of the control law. Otherwise the law's energy observer would
    /// count energy of a torque that was never given.
    fn check_force_limit(&self) -> Result<(), SettingsError> {
        const PATH: &str = "law.force_limit_n_m";
        let most = match self.drive.kind {
            DriveKind::Analogue => self.drive.analogue_full_scale_n_m,
            DriveKind::ThreePhase => {
                let motor = &self.motor;
                motor
                    .torque_constant_n_m_per_a
                    .saturating_mul(motor.current_limit_a)
            }
        };
        let least = const { fields::range(PATH).0 };
        fields::within(PATH, self.law.force_limit_n_m, (least, most))
    }
}

/// Converts a refusal by the control law into a [`SettingsError`] with the setting's path.
#[must_use]
pub fn refused(error: &law::SettingsError) -> SettingsError {
    let outside = |field: Field, value, min, max| SettingsError {
        path: field.path(),
        value: Decimal(value),
        reason: Reason::Outside {
            least: Decimal(min),
            most: Decimal(max),
        },
    };
    match *error {
        law::SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        } => outside(field, value, min, max),
        law::SettingsError::OutOfFormat { field, value, .. } => SettingsError {
            path: field.path(),
            value: Decimal(value),
            reason: Reason::OutOfFormat,
        },
        law::SettingsError::NoCompensation {
            k_desired,
            k_filter,
        } => outside(
            Field::KDesired,
            k_desired,
            law::Si::ZERO,
            k_filter.saturating_sub(law::Si::DELTA),
        ),
        // The law reports a resolution that is too coarse; the setting for it is the encoder's number of counts.
        law::SettingsError::TooCoarse { count, .. } => SettingsError {
            path: "encoder.counts_per_rev",
            value: Decimal(count),
            reason: Reason::OutOfFormat,
        },
        // A law that the build leaves out: only the plain spring, number 0, is in every build.
        law::SettingsError::LawLeftOut { law } => outside(
            Field::Law,
            law::Si::saturating_from_num(law.number()),
            law::Si::ZERO,
            law::Si::ZERO,
        ),
        _ => SettingsError {
            path: Field::Law.path(),
            value: Decimal(law::Si::ZERO),
            reason: Reason::OutOfFormat,
        },
    }
}
