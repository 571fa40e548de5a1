//! The result of an inspection of files: one sentence, printed as the last line of standard output, and an exit code. The launcher
//! `cargo xtask` reads both.

use std::process::ExitCode;

/// The result of an inspection, with its sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// All checks passed; exit code 0.
    Right(String),
    /// A check failed; exit code 1.
    Wrong(String),
    /// The check could not run, with the reason; exit code 77.
    NotRun(String),
    /// The arguments were wrong; the text is the correct usage. Exit code 2.
    Usage(String),
}

impl Answer {
    /// Prints the sentence and returns the exit code.
    pub fn end(self) -> ExitCode {
        let (sentence, code) = match self {
            Answer::Right(sentence) => (sentence, 0),
            Answer::Wrong(sentence) => (sentence, 1),
            Answer::Usage(sentence) => (sentence, 2),
            Answer::NotRun(sentence) => (sentence, 77),
        };
        println!("{sentence}");
        ExitCode::from(code)
    }
}
