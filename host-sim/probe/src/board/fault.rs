//! The error type of this crate: what the problem concerns, the problem, and advice, printed on one line.

use std::error::Error;
use std::fmt;
use std::io::{self, ErrorKind};

/// A problem with a probe or with the chip behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// What the problem concerns: the probe, the chip, or the option that names a probe.
    pub place: String,
    /// The problem in words.
    pub problem: String,
    /// Advice how to solve the problem.
    pub fix: String,
    /// True if the user gave a wrong option; false for a problem of the hardware or the system.
    pub asked: bool,
}

impl fmt::Display for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {}; {}", self.place, self.problem, self.fix)
    }
}

impl Error for Fault {}

impl Fault {
    /// Makes the error for a problem of the hardware or the system.
    pub fn of(
        place: impl Into<String>,
        problem: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Self {
            place: place.into(),
            problem: problem.into(),
            fix: fix.into(),
            asked: false,
        }
    }

    /// Makes the error for a wrong command-line option.
    pub fn asked(
        option: impl Into<String>,
        problem: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Self {
            asked: true,
            ..Self::of(option, problem, fix)
        }
    }
}

/// Advice for a user whom the operating system does not let open the probe.
pub const NO_RIGHTS: &str =
    "`touchstone doctor` prints the udev rule that gives the permission, and how to install it";

/// The text of an error and of all its causes on one line, without repeated texts.
pub fn chain(error: &(dyn Error + 'static)) -> String {
    let mut words: Vec<String> = Vec::new();
    for cause in causes(error) {
        let text = cause.to_string();
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let text = text.trim_end_matches('.');
        if !text.is_empty() && !words.iter().any(|word| word.contains(text)) {
            words.push(text.to_owned());
        }
    }
    words.join(": ")
}

/// The kind of the first operating system error among an error's causes; `None` if there is none.
pub fn system(error: &(dyn Error + 'static)) -> Option<ErrorKind> {
    causes(error).find_map(|cause| Some(cause.downcast_ref::<io::Error>()?.kind()))
}

fn causes<'e>(error: &'e (dyn Error + 'static)) -> impl Iterator<Item = &'e (dyn Error + 'static)> {
    std::iter::successors(Some(error), |&error| error.source())
}
