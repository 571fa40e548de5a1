//! The folder of a map while the cells are computed: a description of the sweep, and the finished cells.
//!
//! `sweep.json` has the description; it is written before the first cell. `journal.csv` receives the cells as they are finished,
//! and is removed when `cells.csv` has all of them in order. No finished cell is thus lost or computed twice.

use super::Sweep;
use super::measure::Row;
use crate::journal::{self, Journal};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::{input, output};

/// Name of the file that describes the sweep.
pub const PLAN: &str = "sweep.json";
/// Name of the file with all cells in order.
pub const CELLS: &str = "cells.csv";
const JOURNAL: &str = "journal.csv";

/// One shard (part) of a sweep: the cells whose number modulo `of` is `index - 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of this shard, from 1 to [`Shard::of`].
    pub index: u64,
    /// Number of shards into which the sweep is divided.
    pub of: u64,
}

impl Shard {
    /// The only shard of a sweep that is not divided.
    pub const WHOLE: Shard = Shard { index: 1, of: 1 };

    /// Whether a cell belongs to the shard. Neighbouring cells go to different shards, so that all shards take about the same time.
    #[must_use]
    pub fn has(self, cell: u64) -> bool {
        cell % self.of == self.index - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        text.split_once('/')
            .and_then(|(index, of)| {
                let (index, of) = (index.parse().ok()?, of.parse().ok()?);
                (1..=of).contains(&index).then_some(Shard { index, of })
            })
            .ok_or_else(|| format!("is {text}; write I/N with I from 1 to N, such as 1/8"))
    }
}

/// Finished cells by their numbers.
pub type Cells = BTreeMap<u64, Row>;

/// An open folder with the cells of a sweep.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    journal: Journal,
    header: Vec<String>,
    /// The finished cells of the map.
    pub cells: Cells,
}

impl Store {
    /// Opens the folder of a sweep and reads its finished cells. With `force`, the cells of another sweep in the folder are
    /// removed.
    ///
    /// # Errors
    /// The folder holds another sweep, another program is writing it, or it cannot be written.
    pub fn open(folder: &Path, sweep: &Sweep, force: bool) -> Result<Self> {
        let wrong = |error| unwritable(folder, &error);
        output::in_folder(folder, wrong, || Self::opened(folder, sweep, force))
    }

    fn opened(folder: &Path, sweep: &Sweep, force: bool) -> Result<Self> {
        let (plan, asked) = (folder.join(PLAN), sweep.plan());
        let mut known = plan_of(folder)?;
        if let Some(other) = &known
            && !same(other, &asked)
        {
            if !force {
                return Err(Error::Io {
                    path: folder.to_owned(),
                    problem: format!("holds another sweep: {}", difference(other, &asked)),
                    fix: "give --out another folder, or --force to start again".to_owned(),
                });
            }
            for file in [JOURNAL, CELLS] {
                let _ = std::fs::remove_file(folder.join(file));
            }
            known = None;
        }
        if known.is_none() {
            output::write(&plan, format!("{asked:#}\n"))
                .map_err(|error| unwritable(&plan, &error))?;
        }
        let (journal, rows) = Journal::open(&folder.join(JOURNAL))?;
        let mut cells = if known.is_some() {
            read_cells(folder)?
        } else {
            Cells::new()
        };
        cells.extend(rows.into_iter().map(|row: Row| (row.0, row)));
        Ok(Self {
            folder: folder.to_owned(),
            journal,
            header: sweep.header(),
            cells,
        })
    }

    /// Stores finished cells.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&mut self, rows: Vec<Row>) -> Result<()> {
        let header: Vec<&str> = self.header.iter().map(String::as_str).collect();
        self.journal.append(Some(&header), &rows)?;
        self.cells.extend(rows.into_iter().map(|row| (row.0, row)));
        Ok(())
    }

    /// Leaves the folder as it was found.
    pub fn leave(self) {
        drop(self.journal);
        let journal = self.folder.join(JOURNAL);
        // An empty one was made by opening.
        if std::fs::metadata(&journal).is_ok_and(|file| file.len() == 0) {
            let _ = std::fs::remove_file(journal);
        }
    }

    /// Removes the file of finished cells (journal) after [`CELLS`] has been written with all its rows; returns the cells.
    pub fn close(self) -> Cells {
        drop(self.journal);
        // A journal that cannot be removed does no harm, because `cells.csv` has all its rows.
        let _ = std::fs::remove_file(self.folder.join(JOURNAL));
        self.cells
    }
}

/// Reads the cells of a folder that no program is writing.
///
/// # Errors
/// The files cannot be read.
pub fn read_all(folder: &Path) -> Result<Cells> {
    let mut cells = read_cells(folder)?;
    let rows: Vec<Row> = journal::read(&folder.join(JOURNAL))?;
    cells.extend(rows.into_iter().map(|row| (row.0, row)));
    Ok(cells)
}

fn read_cells(folder: &Path) -> Result<Cells> {
    let rows: Vec<Row> = journal::read(&folder.join(CELLS))?;
    Ok(rows.into_iter().map(|row| (row.0, row)).collect())
}

/// Reads the description of the sweep in a folder; `None` if there is none.
///
/// # Errors
/// The file has another format.
pub fn plan_of(folder: &Path) -> Result<Option<Value>> {
    let path = folder.join(PLAN);
    match input::bytes(&path, input::MOST_OF_SETTINGS) {
        Ok(text) => serde_json::from_slice(&text)
            .map(Some)
            .map_err(|error| Error::Io {
                path,
                problem: format!("is not a plan of a sweep: {error}"),
                fix: "give --out another folder, or remove the file".to_owned(),
            }),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(unwritable(&path, &error)),
    }
}

/// Whether two sweeps have the same cells: their descriptions are equal except for the command.
#[must_use]
pub fn same(a: &Value, b: &Value) -> bool {
    difference(a, b).is_empty()
}

/// Describes in a few words what differs between two descriptions of sweeps.
#[must_use]
pub fn difference(a: &Value, b: &Value) -> String {
    [
        ("schema_version", "form of the files"),
        ("program", "program"),
        ("scene", "scene"),
        ("inputs", "files that the scene reads"),
        ("x", "x"),
        ("y", "y"),
        ("measures", "measures"),
    ]
    .iter()
    .filter(|(key, _)| a[*key] != b[*key])
    .map(|(_, words)| *words)
    .collect::<Vec<_>>()
    .join(", ")
}

fn unwritable(path: &Path, error: &std::io::Error) -> Error {
    Error::Io {
        path: path.to_owned(),
        problem: error.to_string(),
        fix: "give --out another folder".to_owned(),
    }
}
