//! Stores the number of the knob's position in a file, for the next start of the program.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;

/// Shortest time between two writes to the file while the knob turns.
const LEAST: Duration = Duration::from_secs(1);

/// The file with the position's number.
#[derive(Debug)]
pub struct Kept {
    path: PathBuf,
    /// The number to store; at first the number from the file, `None` if there was no file.
    pub number: Option<i64>,
    written: Option<i64>,
    at: Instant,
}

impl Kept {
    /// Reads the number from the file, if the file exists.
    ///
    /// # Errors
    /// The file does not contain a number or cannot be read, or its folder does not exist.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |problem: String, fix: &str| Error::Io {
            path: path.to_owned(),
            problem,
            fix: fix.into(),
        };
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let number = match std::fs::read_to_string(path) {
            Ok(text) => Some(text.trim().parse().map_err(|_| {
                failed(
                    "contains no position number".into(),
                    "give another file with --keep, or remove it",
                )
            })?),
            // A missing folder is reported now, not when the first number is stored.
            Err(error) if error.kind() == ErrorKind::NotFound => match folder.is_dir() {
                true => None,
                false => {
                    return Err(failed(
                        format!("there is no folder {}", folder.display()),
                        "make the folder, or give another file with --keep",
                    ));
                }
            },
            Err(error) => return Err(failed(error.to_string(), "give another file with --keep")),
        };
        Ok(Self {
            path: path.to_owned(),
            number,
            written: number,
            at: Instant::now(),
        })
    }

    /// Stores the present number. Writes the file at most once per second.
    pub fn see(&mut self, number: i64) -> Result<()> {
        self.number = Some(number);
        match self.at.elapsed() >= LEAST {
            true => self.write(),
            false => Ok(()),
        }
    }

    /// Writes the number to the file, if the file has another number.
    pub fn write(&mut self) -> Result<()> {
        let Some(number) = self.number.filter(|_| self.number != self.written) else {
            return Ok(());
        };
        (self.written, self.at) = (self.number, Instant::now());
        output::write(&self.path, format!("{number}\n")).map_err(|error| Error::Io {
            path: self.path.clone(),
            problem: error.to_string(),
            fix: "give a file with --keep that you can write".into(),
        })
    }
}
