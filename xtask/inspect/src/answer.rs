//! How an inspection ends: one sentence, the last line of standard output, and an exit code. The launcher reads both.

use std::process::ExitCode;

/// How an inspection ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// All is as it must be; exit code 0.
    Right(String),
    /// Something is not; exit code 1.
    Wrong(String),
    /// It could not be told, and why; exit code 77.
    NotRun(String),
    /// It was called wrongly, and how to call it; exit code 2.
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
