//! The error type of the desktop program.

use std::path::PathBuf;

/// A problem that the user can solve, printed on one line: place, problem, remedy. The exit code of the program is 1 for a problem
/// with a device, else 2.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A problem at a line of a file, such as a scene or a recording.
    #[error("{}:{line}: {field}: {problem}; {fix}", file.display())]
    File {
        /// Path of the file as the user gave it.
        file: PathBuf,
        /// Line number in the file, from 1.
        line: usize,
        /// Name of the field or column, as the file writes it.
        field: String,
        /// What is wrong.
        problem: String,
        /// What the user can do about the problem.
        fix: String,
    },
    /// A problem with an option or a key of `--set` on the command line.
    #[error("{option}: {problem}; {fix}")]
    Option {
        /// The option or key as the user wrote it.
        option: String,
        /// What is wrong.
        problem: String,
        /// What the user can do about the problem.
        fix: String,
    },
    /// A file or folder could not be read or written.
    #[error("{}: {problem}; {fix}", path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// What went wrong, usually the operating system's message.
        problem: String,
        /// What the user can do about the problem.
        fix: String,
    },
    /// A problem with a device, its port, or a program that reaches the device.
    #[error("{place}: {problem}; {fix}")]
    Device {
        /// Name of the port, device or program.
        place: String,
        /// What is wrong.
        problem: String,
        /// What the user can do about the problem.
        fix: String,
    },
}

impl Error {
    /// Exit code of the program for the error: 1 for a device, 2 for wrong input or a file.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Error::Device { .. } => 1,
            Error::File { .. } | Error::Option { .. } | Error::Io { .. } => 2,
        }
    }

    /// Makes the error for a device, its port, or a program that reaches the device.
    pub fn device(
        place: impl Into<String>,
        problem: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Error::Device {
            place: place.into(),
            problem: problem.into(),
            fix: fix.into(),
        }
    }
}

/// Result whose error is [`enum@Error`].
pub type Result<T> = std::result::Result<T, Error>;
