//! The number of a position, kept in a file for the next start.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;

/// Shortest time between two writings while the knob turns.
const LEAST: Duration = Duration::from_secs(1);

/// The file with the number.
#[derive(Debug)]
pub struct Kept {
    path: PathBuf,
    /// The number that is to be kept; at the beginning, that of the last time.
    pub number: Option<i64>,
    written: Option<i64>,
    at: Instant,
}

impl Kept {
    /// Reads the file, if it is there.
    ///
    /// # Errors
    /// The file has no number, or cannot be read.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |problem: String, fix: &str| Error::Io {
            path: path.to_owned(),
            problem,
            fix: fix.into(),
        };
        let number = match std::fs::read_to_string(path) {
            Ok(text) => Some(text.trim().parse().map_err(|_| {
                failed(
                    "has no number of a position".into(),
                    "give another file with --keep, or remove it",
                )
            })?),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(failed(error.to_string(), "give another file with --keep")),
        };
        Ok(Self {
            path: path.to_owned(),
            number,
            written: number,
            at: Instant::now(),
        })
    }

    /// Takes the present number, and writes it once a second at most.
    pub fn see(&mut self, number: i64) -> Result<()> {
        self.number = Some(number);
        match self.at.elapsed() >= LEAST {
            true => self.write(),
            false => Ok(()),
        }
    }

    /// Writes the number, if it is another than that in the file.
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
