//! A refused setting, and why it is refused.

use super::Decimal;
#[cfg(feature = "wire")]
use serde::{Deserialize, Serialize};

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
