//! The one error type of the desktop program.

use std::path::PathBuf;

/// A problem that the user can mend: says what, where and how. Printed on one line, exit code 2.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Something in a file: scene, recording.
    #[error("{}:{line}: {field}: {problem}; {fix}", file.display())]
    File {
        /// The file as the user named it.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Field or column, as it stands in the file.
        field: String,
        /// What is wrong.
        problem: String,
        /// How to mend it.
        fix: String,
    },
    /// Something on the command line: option or `--set` key.
    #[error("{option}: {problem}; {fix}")]
    Option {
        /// The option or key as the user wrote it.
        option: String,
        /// What is wrong.
        problem: String,
        /// How to mend it.
        fix: String,
    },
    /// A file or folder could not be read or written.
    #[error("{}: {problem}; {fix}", path.display())]
    Io {
        /// The path.
        path: PathBuf,
        /// What the system said.
        problem: String,
        /// How to mend it.
        fix: String,
    },
}

/// Result with [`enum@Error`].
pub type Result<T> = std::result::Result<T, Error>;
