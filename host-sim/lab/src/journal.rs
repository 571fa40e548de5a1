//! Rows of a long job, appended to a file as they are done, so that an interrupted job goes on.
//!
//! The file has comma-separated values below a header, or is empty. Rows are written in one piece, so an interruption
//! tears at most the last line; the next program to open the file removes that line and computes its row again.

use csv::{ReaderBuilder, WriterBuilder};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};

/// The file, open, and held against other programs where the system can do that.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    empty: bool,
}

impl Journal {
    /// Opens or makes the file, and reads the rows that are there.
    ///
    /// # Errors
    /// A file that cannot be read or written, holds other rows, or belongs to a program that is at work.
    pub fn open<R: DeserializeOwned>(path: &Path) -> Result<(Self, Vec<R>)> {
        let wrong = |error: io::Error| problem(path, error.to_string());
        if std::fs::symlink_metadata(path).is_ok_and(|meta| meta.is_symlink()) {
            return Err(problem(path, "is a link, which is not followed".to_owned()));
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
                fix: "let that one end, or give another place".to_owned(),
            });
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

    /// Appends rows, all at once; the first ones come after a header, which the rows' fields name unless it is given.
    ///
    /// # Errors
    /// A file that cannot be written.
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
        self.file
            .write_all(&text)
            .map_err(|error| wrong(error.to_string()))?;
        self.empty &= text.is_empty();
        Ok(())
    }
}

/// The rows below the header of a file that no program writes now; empty where the file does not exist.
///
/// # Errors
/// A file that cannot be read or holds other rows.
pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>> {
    match std::fs::read(path) {
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
        fix: "give another place, or remove the file".to_owned(),
    }
}

/// What does not apply is `NaN` in a table, so that a column of decimals is one from its first row on: a reader that sees nothing but empty
/// cells at first takes it for a column of texts.
pub mod or_nan {
    use serde::{Deserialize, Deserializer, Serializer};

    fn number(read: Option<f64>) -> Option<f64> {
        read.filter(|number| !number.is_nan())
    }

    /// For a field's `serialize_with`.
    ///
    /// # Errors
    /// The format's.
    pub fn serialize<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_f64(value.unwrap_or(f64::NAN))
    }

    /// For a field's `deserialize_with`; takes an empty cell as well.
    ///
    /// # Errors
    /// The format's.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Option::deserialize(from).map(number)
    }

    /// The same for a list.
    pub mod each {
        use super::{Deserialize, Deserializer, Serializer, number};

        /// As [`super::serialize`].
        ///
        /// # Errors
        /// The format's.
        pub fn serialize<S: Serializer>(values: &[Option<f64>], to: S) -> Result<S::Ok, S::Error> {
            to.collect_seq(values.iter().map(|value| value.unwrap_or(f64::NAN)))
        }

        /// As [`super::deserialize`].
        ///
        /// # Errors
        /// The format's.
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
