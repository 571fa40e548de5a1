//! Meanings of the library's numbers (`dhdc.h`).

use std::fmt;

/// The numbers of an omega.3: its own, and that under which CHAI3D knows a newer one.
pub const OMEGA3_TYPES: [i32; 2] = [33, 110];

/// Room for status words. Libraries write 12 to 17 of them, by their age, and do not know how much room there is.
pub const STATUS_INTS: usize = 64;

/// A device's kind and name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DhdModel {
    /// The library's number of its kind.
    pub number: i32,
    /// The device's name, where the library has one.
    pub name: Option<String>,
    /// The device's serial number, where the library has one.
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

/// A call that failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DhdError {
    /// Name of the call.
    pub call: &'static str,
    /// The library's number, or [`DhdError::NOT_IN_LIBRARY`].
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
    /// The library is too old for the call.
    pub const NOT_IN_LIBRARY: i32 = -1;
    /// Communication.
    pub const COM: i32 = 2;
    /// No device.
    pub const NO_DEVICE: i32 = 5;
    /// The device is in use by another program.
    pub const IN_USE: i32 = 20;

    /// The error's number in words.
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

/// Status words; those that the library did not write are unknown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DhdStatus(pub [i32; STATUS_INTS]);

impl DhdStatus {
    /// Stands in every word before the call.
    pub const NOT_WRITTEN: i32 = i32::MIN;

    fn word(&self, index: usize) -> Option<i32> {
        let word = *self.0.get(index)?;
        (word != Self::NOT_WRITTEN).then_some(word)
    }
    fn yes(&self, index: usize) -> Option<bool> {
        self.word(index).map(|word| word != 0)
    }

    /// Whether the device has its supply.
    #[must_use]
    pub fn power(&self) -> Option<bool> {
        self.yes(0)
    }
    /// Whether the device is connected.
    #[must_use]
    pub fn connected(&self) -> Option<bool> {
        self.yes(1)
    }
    /// Whether the device was reset and has no position.
    #[must_use]
    pub fn reset(&self) -> Option<bool> {
        self.yes(3)
    }
    /// Whether the motors are on.
    #[must_use]
    pub fn force(&self) -> Option<bool> {
        self.yes(5)
    }
    /// Whether the motors brake.
    #[must_use]
    pub fn brake(&self) -> Option<bool> {
        self.yes(6)
    }
    /// Why its motors were switched off; 0 where they were not.
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
