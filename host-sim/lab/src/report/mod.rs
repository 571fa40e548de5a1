//! What a person or a script reads after a run: terminal table, `index.html`, `results.json`, traces as CSV and Parquet.
//!
//! [`ReportInput`] goes in; [`write::write`] makes the whole folder, [`table::render`] what the terminal shows, and
//! [`json::render`] what `--json` prints. All numbers are in SI units; only what people read is scaled by prefixes.

mod cell;
pub mod columns;
#[cfg(test)]
mod contrast;
pub mod csv;
mod decimate;
mod figures;
pub mod html;
pub mod json;
mod label;
mod matrix;
pub mod parquet;
mod quantity;
pub mod staging;
mod svg;
pub mod table;
mod view;
pub mod write;

// One generator of made-up runs for the tests and for the example that shows the page.
#[cfg(test)]
#[path = "../../examples/report_demo/synthetic.rs"]
mod synthetic;

pub use table::Colour;
pub use write::{Written, write};

use touchstone_sim::run::record::Run;

/// What a report is made of. Everything but the runs may be left empty: `ReportInput { title, command, runs, ..Default::default() }`.
///
/// Runs are sorted by their conditions (scene, grip, encoder, rate, number format) into tables of `k_de` × law, so the
/// comparison of the thesis, a single run and a sweep over grips all need no more than a list. A run without a trace appears
/// with its numbers, without plots.
#[derive(Debug, Clone, Copy, Default)]
pub struct ReportInput<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// What was run, in a sentence or two.
    pub intro: &'a str,
    /// The command line that makes this report again.
    pub command: &'a str,
    /// Critical stiffness `k_c` of device and rate, N·m/rad, drawn beside the displayed stiffness.
    pub k_critical: Option<f64>,
    /// The runs.
    pub runs: &'a [Run],
    /// Warnings that a reader must know, such as settings beyond a passivity bound.
    pub notes: &'a [String],
    /// Text below the heading of a stiffness: `k_de` in N·m/rad, and what to look at there.
    pub row_notes: &'a [(f64, String)],
    /// Further sections, between the verdicts and the plots.
    pub sections: &'a [Section],
}

/// A section of the page that the caller wrote, such as the claims that were checked.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Content, from top to bottom.
    pub body: Vec<Block>,
}

/// A piece of a [`Section`]. Texts are plain: the page escapes them.
#[derive(Debug, Clone)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A table with a heading row.
    Table {
        /// What the table shows.
        caption: String,
        /// Names of the columns, with units.
        header: Vec<String>,
        /// Cells, row by row.
        rows: Vec<Vec<String>>,
    },
}

/// Where the trace of a run lies, relative to the report's folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TraceFiles {
    /// CSV file.
    pub csv: String,
    /// Parquet file.
    pub parquet: String,
}
