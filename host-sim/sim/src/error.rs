//! The one error type of the desktop program.

use std::path::PathBuf;

/// A problem that the user can mend, on one line: place, problem, remedy. Exit code 1 where the outside world failed,
/// 2 where the user's request cannot be carried out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// An error in a file: scene or recording.
    #[error("{}:{line}: {field}: {problem}; {fix}", file.display())]
    File {
        /// The file as the user named it.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Field or column, as it stands in the file.
        field: String,
        /// The problem.
        problem: String,
        /// How to mend it.
        fix: String,
    },
    /// An error on the command line: option or `--set` key.
    #[error("{option}: {problem}; {fix}")]
    Option {
        /// The option or key as the user wrote it.
        option: String,
        /// The problem.
        problem: String,
        /// How to mend it.
        fix: String,
    },
    /// A file or folder could not be read or written.
    #[error("{}: {problem}; {fix}", path.display())]
    Io {
        /// The path.
        path: PathBuf,
        /// The system's message.
        problem: String,
        /// How to mend it.
        fix: String,
    },
    /// A device, its port or a program that reaches it.
    #[error("{place}: {problem}; {fix}")]
    Device {
        /// The port, the device or the program.
        place: String,
        /// The problem.
        problem: String,
        /// How to mend it.
        fix: String,
    },
}

impl Error {
    /// For the shell: 1 failed, 2 wrong usage.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Error::Device { .. } => 1,
            Error::File { .. } | Error::Option { .. } | Error::Io { .. } => 2,
        }
    }

    /// A problem with a device, its port or a program that reaches it.
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

/// Result with [`enum@Error`].
pub type Result<T> = std::result::Result<T, Error>;
