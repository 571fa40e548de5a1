//! Files of rows that a campaign appends to: one that was stopped goes on where it stopped.

use serde::{Serialize, de::DeserializeOwned};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The rows that are done, and the CSV file that has them.
#[derive(Debug)]
pub struct Rows<R> {
    path: PathBuf,
    done: Vec<R>,
}

impl<R: Serialize + DeserializeOwned> Rows<R> {
    /// What a file has so far; none where there is no file.
    ///
    /// # Errors
    /// A file that cannot be read, or has other rows.
    pub fn open(path: &Path) -> Result<Self, Box<dyn Error>> {
        let mut done = Vec::new();
        if path.exists() {
            for record in csv::Reader::from_path(path)?.deserialize() {
                done.push(record?);
            }
        }
        Ok(Self {
            path: path.to_owned(),
            done,
        })
    }

    /// What is done.
    #[must_use]
    pub fn done(&self) -> &[R] {
        &self.done
    }

    /// Appends rows, in one write: they are there or they are not.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn append(&mut self, rows: Vec<R>) -> Result<(), Box<dyn Error>> {
        let mut writer = csv::WriterBuilder::new()
            .has_headers(self.done.is_empty())
            .from_writer(Vec::new());
        for row in &rows {
            writer.serialize(row)?;
        }
        let text = writer.into_inner()?;
        std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(&self.path)?
            .write_all(&text)?;
        self.done.extend(rows);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_goes_on_where_it_stopped() {
        let path = std::env::temp_dir().join(format!("touchstone-rows-{}.csv", std::process::id()));
        let _ = std::fs::remove_file(&path);
        #[derive(Debug, PartialEq, Serialize, serde::Deserialize)]
        struct Row {
            number: u64,
            cause: Option<String>,
        }
        let row = |number| Row {
            number,
            cause: (number > 1).then(|| "too, soft".to_owned()),
        };
        Rows::open(&path).unwrap().append(vec![row(0)]).unwrap();
        let mut rows = Rows::open(&path).unwrap();
        rows.append(vec![row(1), row(2)]).unwrap();
        assert_eq!(
            Rows::<Row>::open(&path).unwrap().done(),
            [row(0), row(1), row(2)]
        );
        std::fs::remove_file(&path).unwrap();
    }
}
