//! Meanings of the numbers that Force Dimension's library returns (`dhdc.h`).

use std::fmt;

/// The library's type numbers of an omega.3: the usual one, and that of a newer version by CHAI3D.
pub const OMEGA3_TYPES: [i32; 2] = [33, 110];

/// Number of status words that the program has room for. Versions of the library write 12 to 17 of them and do not know the room.
pub const STATUS_INTS: usize = 64;

/// A device's type, name and serial number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DhdModel {
    /// The library's number of the device's type.
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

/// The error of a failed call of the library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DhdError {
    /// Name of the failed function.
    pub call: &'static str,
    /// The library's error number, or [`DhdError::NOT_IN_LIBRARY`].
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
    /// The library is too old: it does not have this function.
    pub const NOT_IN_LIBRARY: i32 = -1;
    /// The library's error number of a communication error.
    pub const COM: i32 = 2;
    /// The library's error number if there is no device.
    pub const NO_DEVICE: i32 = 5;
    /// The library's error number if another program uses the device.
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

/// The status words of a device. Words that the library did not write are unknown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DhdStatus(pub [i32; STATUS_INTS]);

impl DhdStatus {
    /// Value of every status word before the call; a word that keeps it was not written.
    pub const NOT_WRITTEN: i32 = i32::MIN;

    fn word(&self, index: usize) -> Option<i32> {
        let word = *self.0.get(index)?;
        (word != Self::NOT_WRITTEN).then_some(word)
    }
    fn yes(&self, index: usize) -> Option<bool> {
        self.word(index).map(|word| word != 0)
    }

    /// Whether the device has its supply; `None` if unknown.
    #[must_use]
    pub fn power(&self) -> Option<bool> {
        self.yes(0)
    }
    /// Whether the device is connected; `None` if unknown.
    #[must_use]
    pub fn connected(&self) -> Option<bool> {
        self.yes(1)
    }
    /// Whether the device was reset and therefore has no position; `None` if unknown.
    #[must_use]
    pub fn reset(&self) -> Option<bool> {
        self.yes(3)
    }
    /// Whether the motors are on; `None` if unknown.
    #[must_use]
    pub fn force(&self) -> Option<bool> {
        self.yes(5)
    }
    /// Whether the motors brake; `None` if unknown.
    #[must_use]
    pub fn brake(&self) -> Option<bool> {
        self.yes(6)
    }
    /// The library's number of the cause for which the motors were switched off; 0 if they were not, `None` if unknown.
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
