//! How an inspection ends: one sentence, the last line of standard output, and an exit code. The launcher reads both.

use std::process::ExitCode;

/// How an inspection ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Everything is right; exit code 0.
    Right(String),
    /// A check failed; exit code 1.
    Wrong(String),
    /// The check could not run, and why; exit code 77.
    NotRun(String),
    /// The call was wrong, with the right usage; exit code 2.
    Usage(String),
}

impl Answer {
    /// Prints the sentence.
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
