//! A results file to which a long job appends rows as they are finished, so that an interrupted job can continue.
//!
//! The file holds comma-separated values below a header, or is empty. Each batch of rows is written in one call, so an
//! interruption leaves at most the last line incomplete. The next program that opens the file removes an incomplete line and
//! computes its row again.

use csv::{ReaderBuilder, WriterBuilder};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;

/// An open results file, locked against other programs if the operating system can lock files.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    empty: bool,
}

impl Journal {
    /// Opens the file, or creates it, and returns it with the rows that it already holds.
    ///
    /// # Errors
    /// The file cannot be read or written, is a symbolic link, holds rows of another format, or is locked by a running program.
    pub fn open<R: DeserializeOwned>(path: &Path) -> Result<(Self, Vec<R>)> {
        let wrong = |error: io::Error| problem(path, error.to_string());
        if std::fs::symlink_metadata(path).is_ok_and(|meta| meta.is_symlink()) {
            return Err(problem(
                path,
                "is a symbolic link, which this program does not follow".to_owned(),
            ));
        }
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(wrong)?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(Error::Io {
                path: path.to_owned(),
                problem: "another program is writing it".to_owned(),
                fix: "wait until that program ends, or give another path".to_owned(),
            });
        }
        let meta = file.metadata().map_err(wrong)?;
        if !meta.is_file() || meta.len() > input::MOST_OF_CELLS {
            return Err(problem(path, "is not a file of cells".to_owned()));
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(wrong)?;
        let whole = text
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        text.truncate(whole);
        file.set_len(whole as u64).map_err(wrong)?;
        file.seek(SeekFrom::End(0)).map_err(wrong)?;
        let rows = rows(path, &text)?;
        let journal = Self {
            path: path.to_owned(),
            file,
            empty: whole == 0,
        };
        Ok((journal, rows))
    }

    /// Appends rows in one write. If the file is empty, a header comes before them: `header`, or else the names of the rows'
    /// fields.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn append<R: Serialize>(&mut self, header: Option<&[&str]>, rows: &[R]) -> Result<()> {
        let wrong = |error: String| problem(&self.path, error);
        let mut writer = WriterBuilder::new()
            .has_headers(self.empty && header.is_none())
            .from_writer(Vec::new());
        if let (true, Some(names)) = (self.empty, header) {
            writer
                .write_record(names)
                .map_err(|error| wrong(error.to_string()))?;
        }
        for row in rows {
            writer
                .serialize(row)
                .map_err(|error| wrong(error.to_string()))?;
        }
        let text = writer
            .into_inner()
            .map_err(|error| wrong(error.to_string()))?;
        if let Err(error) = self.file.write_all(&text) {
            if self.empty {
                // No row was written, so the new file is removed.
                let _ = std::fs::remove_file(&self.path);
            }
            return Err(wrong(error.to_string()));
        }
        self.empty &= text.is_empty();
        Ok(())
    }
}

/// Reads the rows below the header of a file that no program is writing; empty if the file does not exist.
///
/// # Errors
/// The file cannot be read or holds rows of another format.
pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>> {
    match input::bytes(path, input::MOST_OF_CELLS) {
        Ok(text) => rows(path, &text),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(problem(path, error.to_string())),
    }
}

fn rows<R: DeserializeOwned>(path: &Path, text: &[u8]) -> Result<Vec<R>> {
    ReaderBuilder::new()
        .from_reader(text)
        .into_deserialize()
        .collect::<std::result::Result<_, _>>()
        .map_err(|error| problem(path, format!("holds other rows: {error}")))
}

fn problem(path: &Path, problem: String) -> Error {
    Error::Io {
        path: path.to_owned(),
        problem,
        fix: "give another path, or remove the file".to_owned(),
    }
}

/// Writes a missing number as `NaN` instead of an empty cell. A reader that guesses a column's type from the first rows would take
/// a column that begins with empty cells for text.
pub mod or_nan {
    use serde::{Deserialize, Deserializer, Serializer};

    fn number(read: Option<f64>) -> Option<f64> {
        read.filter(|number| !number.is_nan())
    }

    /// Writes a missing number as `NaN`; for the attribute `serialize_with` of a field.
    ///
    /// # Errors
    /// The serialiser's own errors.
    pub fn serialize<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_f64(value.unwrap_or(f64::NAN))
    }

    /// Reads `NaN` or an empty cell as a missing number; for the attribute `deserialize_with` of a field.
    ///
    /// # Errors
    /// The cell holds no number.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Option::deserialize(from).map(number)
    }

    /// Writes and reads the missing numbers of a list as `NaN`, for fields that hold several numbers.
    pub mod each {
        use super::{Deserialize, Deserializer, Serializer, number};

        /// Writes each missing number of the list as `NaN`, as [`super::serialize`] does for one.
        ///
        /// # Errors
        /// The serialiser's own errors.
        pub fn serialize<S: Serializer>(values: &[Option<f64>], to: S) -> Result<S::Ok, S::Error> {
            to.collect_seq(values.iter().map(|value| value.unwrap_or(f64::NAN)))
        }

        /// Reads each `NaN` of the list as a missing number, as [`super::deserialize`] does for one.
        ///
        /// # Errors
        /// A cell holds no number.
        pub fn deserialize<'de, D: Deserializer<'de>>(
            from: D,
        ) -> Result<Vec<Option<f64>>, D::Error> {
            let read: Vec<Option<f64>> = Vec::deserialize(from)?;
            Ok(read.into_iter().map(number).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torn_line_is_made_once_more() {
        let path = std::env::temp_dir().join(format!("touchstone-journal-{}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let (mut journal, none) = Journal::open::<(u64, f64)>(&path).unwrap();
        assert!(none.is_empty());
        journal
            .append(Some(&["n", "x"]), &[(1, 0.1), (2, 0.2)])
            .unwrap();
        assert!(
            Journal::open::<(u64, f64)>(&path)
                .unwrap_err()
                .to_string()
                .contains("another program")
        );
        journal
            .append(Some(&["n", "x"]), &[(3, 1.0 / 3.0)])
            .unwrap();
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 3]).unwrap();
        let (mut journal, rows) = Journal::open::<(u64, f64)>(&path).unwrap();
        assert_eq!(rows, [(1, 0.1), (2, 0.2)]);
        journal
            .append(Some(&["n", "x"]), &[(3, 1.0 / 3.0)])
            .unwrap();
        drop(journal);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        assert_eq!(read::<(u64, f64)>(&path).unwrap().len(), 3);
        std::fs::remove_file(&path).unwrap();
    }
}
