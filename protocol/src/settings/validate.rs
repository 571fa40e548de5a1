//! Validation of all settings together: each number against its range, the numbers against each other, and the wall by the control
//! law's own checks.

#[cfg(feature = "wire")]
use super::refusal::Invalid;
use super::refusal::{Reason, SettingsError};
use super::{Decimal, DeviceSettings, DriveKind, EncoderKind, fields};
use crate::Board;
use core::fmt;
use touchstone_control as law;
use touchstone_control::{Choice, Controller, Field, Fixed32};

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
