//! The files that people name: whole or not at all, and no older one lost that another command made.

use std::io::ErrorKind;
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;

/// `--force` of a command that writes a file.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Overwrite {
    /// Replaces a file that is there already.
    #[arg(long)]
    pub force: bool,
}

/// A file to be written, by the option that named it.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// Where.
    pub path: &'a Path,
    /// The option.
    pub option: &'a str,
    /// What is there may go.
    pub replaces: bool,
}

impl Named<'_> {
    /// Refuses a place that is taken, before anything is done for what would come there.
    pub fn check(&self) -> Result<()> {
        match output::is_free(self.path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && self.replaces => Ok(()),
            free => free.map_err(|error| self.error(&error)),
        }
    }

    /// Writes it.
    pub fn write(&self, content: impl AsRef<[u8]>) -> Result<()> {
        let written = match self.replaces {
            true => output::write(self.path, content),
            false => output::write_new(self.path, content),
        };
        written.map_err(|error| self.error(&error))
    }

    /// What the system said of it.
    pub fn error(&self, error: &std::io::Error) -> Error {
        let option = self.option;
        let (problem, fix) = match error.kind() {
            ErrorKind::AlreadyExists => (
                "is there already".to_owned(),
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

/// Whether a file is there that begins so, or has this in its first lines: then the same command made it, and makes it again.
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

/// What `tests/scripts/readers.py` says of a table: whether every reader that is installed takes it for what was written.
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
