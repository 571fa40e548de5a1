//! How a `cargo xtask` command ended. A command that was not run never counts as passed.

use std::fmt;
use std::process::ExitCode;

/// How a `cargo xtask` command ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The command succeeded; the text is a note on its result and may be empty.
    Ok(String),
    /// The command found a fault; the text describes the fault.
    Failed(String),
    /// The command could not do its work on this machine; the text is the reason.
    NotRun(String),
    /// The command was called with wrong arguments; the text is the usage.
    Usage(String),
}

/// Exit code of a command that could not do its work on this machine. Other test runners use the same code.
const NOT_RUN: u8 = 77;
/// Exit code of a command that was called wrongly.
pub const USAGE: u8 = 2;

impl Outcome {
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Outcome::Ok(_) => ExitCode::SUCCESS,
            Outcome::Failed(_) => ExitCode::FAILURE,
            Outcome::NotRun(_) => ExitCode::from(NOT_RUN),
            Outcome::Usage(_) => ExitCode::from(USAGE),
        }
    }

    /// The constructor of the outcome that [`Self::exit_code`] turns into this code; `None` for any other code.
    pub fn of_code(code: i32) -> Option<fn(String) -> Self> {
        match u8::try_from(code).ok()? {
            0 => Some(Outcome::Ok),
            1 => Some(Outcome::Failed),
            USAGE => Some(Outcome::Usage),
            NOT_RUN => Some(Outcome::NotRun),
            _ => None,
        }
    }

    /// Turns every outcome but success into an error, for use with `?`.
    pub fn went_well(self) -> Result<(), Self> {
        match self {
            Outcome::Ok(_) => Ok(()),
            other => Err(other),
        }
    }

    /// The outcome as one word for tables.
    pub fn word(&self) -> &'static str {
        match self {
            Outcome::Ok(_) => "ok",
            Outcome::Failed(_) => "FAILED",
            Outcome::NotRun(_) => "not run",
            Outcome::Usage(_) => "usage",
        }
    }

    /// The note of a success or the reason of another outcome.
    pub fn reason(&self) -> &str {
        match self {
            Outcome::Ok(reason)
            | Outcome::Failed(reason)
            | Outcome::NotRun(reason)
            | Outcome::Usage(reason) => reason,
        }
    }

    /// Whether this outcome makes the whole run fail.
    pub fn is_failure(&self) -> bool {
        matches!(self, Outcome::Failed(_) | Outcome::Usage(_))
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())?;
        if self.reason().is_empty() {
            Ok(())
        } else {
            write!(f, ": {}", self.reason())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_survive_the_way_there_and_back() {
        for code in [0, 1, USAGE, NOT_RUN] {
            let of = Outcome::of_code(code.into()).expect("a code of the project");
            assert_eq!(of(String::new()).exit_code(), ExitCode::from(code));
        }
        assert!(Outcome::of_code(101).is_none() && Outcome::of_code(-1).is_none());
    }
}
