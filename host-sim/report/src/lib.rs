//! Writes results for readers and scripts after a run: terminal table, `index.html`, `summary.svg`, `results.json`, traces as CSV
//! and Parquet, and scene files with every value.
//!
//! [`ReportInput`] has the results. [`write::write`] writes the folder, from which every run can be repeated. [`table::render`]
//! makes the terminal's table, and [`json::render`] the output of `--json`. All numbers are in SI units; only texts for readers use
//! prefixes such as milli.

mod anchor;
pub mod columns;
mod compare;
#[cfg(test)]
mod contrast;
pub mod csv;
mod decimate;
pub mod figure;
mod figures;
pub mod folder;
pub mod html;
pub mod json;
pub mod label;
mod matrix;
pub mod measures;
pub mod origin;
pub mod pages;
#[cfg(feature = "parquet")]
pub mod parquet;
mod picture;
pub mod plain_schema;
pub mod previous;
pub mod quantity;
mod runs;
pub mod schema;
pub mod staging;
mod summary;
pub mod svg;
pub mod table;
mod try_cell;
mod view;
pub mod write;

// One generator of made-up runs for the tests and for the example that shows the page.
#[cfg(test)]
#[path = "../examples/report_demo/synthetic.rs"]
mod synthetic;

pub use origin::ProgramVersion;
pub use picture::{SIZE as PICTURE_SIZE, drawn, standalone};
pub use previous::check as check_folder;
pub use table::Colour;
pub use write::{Written, write};

use std::path::PathBuf;
use touchstone_sim::run::record::Run;
use touchstone_sim::scene::Scene;

/// Style sheet of every page, as CSS.
pub const PAGE_STYLE: &str = include_str!("page.css");

/// Contents of a report. All fields but the runs may be empty: `ReportInput { title, command, runs, ..Default::default() }`.
///
/// Runs are sorted by their conditions (scene, grip, encoder, rate, number format) into tables with one row per requested stiffness
/// and one column per control law. A list of runs is therefore enough for the thesis' comparison, a single run or a sweep over
/// grips. A run without a trace appears with its numbers, without plots.
#[derive(Debug, Clone, Copy, Default)]
pub struct ReportInput<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// A description of the runs in one or two sentences.
    pub intro: &'a str,
    /// Command line that repeats this report.
    pub command: &'a str,
    /// Version of the program that simulated the runs.
    pub program: ProgramVersion,
    /// The scene of each run, in the order of `runs`; empty if no scenes are to be written.
    pub scenes: &'a [Scene],
    /// Files from which the scenes were read. Recordings are not among them; the scenes name those.
    pub inputs: &'a [PathBuf],
    /// Options on the files that the report writes.
    pub files: FileOptions,
    /// Largest stable stiffness of a plain sampled spring for device and control rate, N·m/rad. It is drawn next to the displayed
    /// stiffness.
    pub k_critical: Option<f64>,
    /// The runs with their results.
    pub runs: &'a [Run],
    /// Warnings that a reader has to know, such as settings beyond a passivity bound.
    pub notes: &'a [String],
    /// Notes on single requested stiffnesses: the stiffness in N·m/rad, and a text such as a figure number of the thesis.
    pub row_notes: &'a [(f64, String)],
    /// Further sections between the tables and the plots. They are folded if the report has several sections or runs.
    pub sections: &'a [Section],
    /// Text of the interactive page. If given, readers can try every run whose scene is written out.
    pub live_page: Option<&'a str>,
}

/// A section of the page that the caller composes, for example the claims that were checked.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Heading of the section.
    pub title: String,
    /// Parts of the section, from top to bottom.
    pub body: Vec<Block>,
    /// Whether the section starts folded, on a page of sections alone. A report of runs folds its sections if it has several runs
    /// or sections.
    pub folded: bool,
}

/// A part of a [`Section`]. Its texts are plain; the page escapes them.
#[derive(Debug, Clone)]
pub enum Block {
    /// A paragraph of text.
    Text(String),
    /// A table with a heading row.
    Table {
        /// Caption of the table.
        caption: String,
        /// Names of the table's columns, with units.
        header: Vec<String>,
        /// Texts of the table's cells, row by row.
        rows: Vec<Vec<String>>,
    },
    /// A drawing as SVG that this program made.
    Figure(String),
}

/// Whether this program was built with support for Parquet files.
pub const PARQUET: bool = cfg!(feature = "parquet");

/// Options on the files that [`write::write`] writes.
#[derive(Debug, Clone, Copy, Default)]
pub struct FileOptions {
    /// Does not write traces as CSV, only as Parquet. Without [`PARQUET`] no traces are then written.
    pub no_csv: bool,
    /// Traces contain every n-th tick (control period), with this n; 0 and 1 mean all ticks.
    pub every: usize,
    /// Whether files of another command in the folder are replaced.
    pub force: bool,
}
