//! Writes output files that the user names. A file is written completely or not at all, and a file that another command wrote is
//! not replaced.

use std::io::ErrorKind;
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;

/// The option `--force` of a command that writes a file.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Overwrite {
    /// Replaces an existing file.
    #[arg(long)]
    pub force: bool,
}

/// A file to write, with the option that named it.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// Path of the file to write.
    pub path: &'a Path,
    /// Name of the option that named the file, for error messages.
    pub option: &'a str,
    /// Whether an existing file may be replaced.
    pub replaces: bool,
}

impl Named<'_> {
    /// Returns an error if the file exists and may not be replaced. Called before the command starts its work.
    pub fn check(&self) -> Result<()> {
        match output::is_free(self.path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && self.replaces => Ok(()),
            free => free.map_err(|error| self.error(&error)),
        }
    }

    /// Writes the content to the file.
    pub fn write(&self, content: impl AsRef<[u8]>) -> Result<()> {
        let written = match self.replaces {
            true => output::write(self.path, content),
            false => output::write_new(self.path, content),
        };
        written.map_err(|error| self.error(&error))
    }

    /// Converts an error of the operating system to an error message with a remedy.
    pub fn error(&self, error: &std::io::Error) -> Error {
        let option = self.option;
        let (problem, fix) = match error.kind() {
            ErrorKind::AlreadyExists => (
                "already exists".to_owned(),
                format!("give another file with {option}, or add --force to replace it"),
            ),
            _ => (
                error.to_string(),
                format!("give another file with {option}"),
            ),
        };
        Error::Io {
            path: self.path.to_owned(),
            problem,
            fix,
        }
    }
}

/// Whether the file exists and has `mark` in its first 1024 bytes. The mark shows that the same command wrote the file and may
/// replace it.
pub fn is_of_same_command(path: &Path, mark: &str) -> bool {
    use std::io::Read as _;
    let is_file = std::fs::symlink_metadata(path).is_ok_and(|meta| meta.is_file());
    let mut begin = Vec::new();
    is_file
        && std::fs::File::open(path)
            .and_then(|file| file.take(1 << 10).read_to_end(&mut begin))
            .is_ok()
        && String::from_utf8_lossy(&begin).contains(mark)
}

/// Checks with `tests/scripts/readers.py` that the installed CSV readers, such as pandas, read back the values of a table. Without
/// Python the check is skipped.
#[cfg(test)]
pub fn is_read_by_others(name: &str, table: &[u8]) {
    let folder = std::env::temp_dir().join(format!("touchstone-readers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join(name);
    std::fs::write(&file, table).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/readers.py");
    let ran = std::process::Command::new("python3")
        .arg(script)
        .arg(&file)
        .output();
    let _ = std::fs::remove_file(&file);
    let Ok(output) = ran else {
        println!("skipped: there is no python3");
        return;
    };
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        matches!(output.status.code(), Some(0 | 9)),
        "{said}{errors}"
    );
}
