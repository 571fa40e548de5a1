//! Names for the numbers that Force Dimension's library returns (header `dhdc.h`).

use std::fmt;

/// The numbers that `dhdGetSystemType` returns for an omega.3: 33 usually, 110 for a newer version (as named by CHAI3D).
pub const OMEGA3_TYPES: [i32; 2] = [33, 110];

/// Number of status words that the program reserves for `dhdGetStatus`. Versions of the library write 12 to 17 words and do not
/// know the size of the array.
pub const STATUS_INTS: usize = 64;

/// A device's type, name and serial number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DhdModel {
    /// The type number that the library returns for the device (33 for an omega.3).
    pub number: i32,
    /// The device's name, if the library returns one.
    pub name: Option<String>,
    /// The device's serial number, if the library returns one.
    pub serial: Option<u16>,
}

impl fmt::Display for DhdModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{name}")?,
            None => write!(f, "device of type {}", self.number)?,
        }
        match self.serial {
            Some(serial) => write!(f, " no. {serial}"),
            None => Ok(()),
        }
    }
}

/// The error of a failed call of Force Dimension's library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DhdError {
    /// Name of the library function that failed.
    pub call: &'static str,
    /// The library's error number, or [`DhdError::NOT_IN_LIBRARY`] for a function that the library lacks.
    pub number: i32,
}

const ERRORS: [&str; 23] = [
    "no error",
    "error",
    "communication error",
    "device controller busy",
    "no driver found",
    "no device found",
    "operation not available",
    "timeout",
    "geometric error",
    "expert mode disabled",
    "not implemented",
    "out of memory",
    "device not ready",
    "file not found",
    "configuration error",
    "invalid index",
    "deprecated",
    "null argument",
    "redundant sensors disagree",
    "not enabled",
    "device in use",
    "invalid",
    "no regulation",
];

impl DhdError {
    /// Error number of this program: the library is too old and lacks the function.
    pub const NOT_IN_LIBRARY: i32 = -1;
    /// The library's error number for a failed communication with the device.
    pub const COM: i32 = 2;
    /// The library's error number if no device is connected.
    pub const NO_DEVICE: i32 = 5;
    /// The library's error number if another program has the device open.
    pub const IN_USE: i32 = 20;

    /// The meaning of the error's number as text.
    #[must_use]
    pub fn words(&self) -> &'static str {
        match usize::try_from(self.number) {
            Ok(number) => ERRORS.get(number).copied().unwrap_or("unknown error"),
            Err(_) => "the library does not have this call",
        }
    }
}

impl fmt::Display for DhdError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.words(), self.number)
    }
}

/// The status words that `dhdGetStatus` returns. A word that the library did not write is unknown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DhdStatus(pub [i32; STATUS_INTS]);

impl DhdStatus {
    /// Value that the program puts into every status word before `dhdGetStatus`. A word that still has it was not written by the
    /// library.
    pub const NOT_WRITTEN: i32 = i32::MIN;

    fn word(&self, index: usize) -> Option<i32> {
        let word = *self.0.get(index)?;
        (word != Self::NOT_WRITTEN).then_some(word)
    }
    fn yes(&self, index: usize) -> Option<bool> {
        self.word(index).map(|word| word != 0)
    }

    /// Whether the device has its power supply; `None` if the library does not report it.
    #[must_use]
    pub fn power(&self) -> Option<bool> {
        self.yes(0)
    }
    /// Whether the device is connected; `None` if the library does not report it.
    #[must_use]
    pub fn connected(&self) -> Option<bool> {
        self.yes(1)
    }
    /// Whether the device was reset and therefore has lost its position reference; `None` if the library does not report it.
    #[must_use]
    pub fn reset(&self) -> Option<bool> {
        self.yes(3)
    }
    /// Whether the motors are on; `None` if the library does not report it.
    #[must_use]
    pub fn force(&self) -> Option<bool> {
        self.yes(5)
    }
    /// Whether the motors brake; `None` if the library does not report it.
    #[must_use]
    pub fn brake(&self) -> Option<bool> {
        self.yes(6)
    }
    /// The library's number for the cause that switched the motors off. 0 if they were not switched off, `None` if the library does
    /// not report it.
    #[must_use]
    pub fn off_cause(&self) -> Option<i32> {
        self.word(14)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_words_and_unknown_ones_do_not_panic() {
        let said = |number| DhdError { call: "x", number }.to_string();
        assert_eq!(said(20), "device in use (20)");
        assert_eq!(said(99), "unknown error (99)");
        assert!(said(-1).contains("does not have"));
    }

    #[test]
    fn what_an_old_library_does_not_write_is_unknown() {
        let mut raw = [DhdStatus::NOT_WRITTEN; STATUS_INTS];
        raw[..12].fill(1);
        let status = DhdStatus(raw);
        assert_eq!((status.force(), status.off_cause()), (Some(true), None));
    }
}
