//! Results for people and scripts after a run: terminal table, `index.html`, `summary.svg`, `results.json`, traces as
//! CSV and Parquet, scenes with every value.
//!
//! [`ReportInput`] goes in; [`write::write`] makes the whole folder, from which every run can be made again,
//! [`table::render`] the terminal's table, and [`json::render`] the output of `--json`. All numbers are in SI units;
//! only texts for people use prefixes.

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
mod label;
mod matrix;
pub mod measures;
pub mod origin;
pub mod pages;
#[cfg(feature = "parquet")]
pub mod parquet;
mod picture;
pub mod plain_schema;
mod previous;
pub mod quantity;
mod runs;
pub mod schema;
pub mod space;
mod space_picture;
mod space_results;
pub mod space_schema;
pub mod staging;
mod summary;
pub mod svg;
pub mod table;
mod try_cell;
mod view;
pub mod write;

// One generator of made-up runs for the tests and for the example that shows the page.
#[cfg(test)]
#[path = "../../examples/report_demo/synthetic.rs"]
mod synthetic;

pub use origin::ProgramVersion;
pub use picture::{drawn, standalone};
pub use previous::check as check_folder;
pub use table::Colour;
pub use write::{Written, write};

use std::path::PathBuf;
use touchstone_sim::run::record::Run;
use touchstone_sim::scene::Scene;

/// What a report is made of. Everything but the runs may be left empty: `ReportInput { title, command, runs, ..Default::default() }`.
///
/// Runs are sorted by their conditions (scene, grip, encoder, rate, number format) into tables of `k_de` × law, so the
/// comparison of the thesis, a single run and a sweep over grips all need no more than a list. A run without a trace appears
/// with its numbers, without plots.
#[derive(Debug, Clone, Copy, Default)]
pub struct ReportInput<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// A description of the runs, in a sentence or two.
    pub intro: &'a str,
    /// The command line that makes this report again.
    pub command: &'a str,
    /// The program that ran.
    pub program: ProgramVersion,
    /// The scene of each run, in their order; empty if no scenes are to be written.
    pub scenes: &'a [Scene],
    /// Files that the scenes were read from; recordings are found in the scenes.
    pub inputs: &'a [PathBuf],
    /// The files to write.
    pub files: FileOptions,
    /// Critical stiffness `k_c` of device and rate, N·m/rad, drawn beside the displayed stiffness.
    pub k_critical: Option<f64>,
    /// The runs.
    pub runs: &'a [Run],
    /// Warnings that a reader must know, such as settings beyond a passivity bound.
    pub notes: &'a [String],
    /// Where to read on a stiffness: `k_de` in N·m/rad, and a reference such as a figure of the thesis.
    pub row_notes: &'a [(f64, String)],
    /// Further sections, folded, between the tables and the plots.
    pub sections: &'a [Section],
    /// The live page, whatever its scene: every run whose scene is written out can then be tried in the report.
    pub live_page: Option<&'a str>,
}

/// A section of the page that the caller wrote, such as the claims that were checked.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Content, from top to bottom.
    pub body: Vec<Block>,
    /// Whether the section is folded at first, on a page of sections alone; a report of runs decides for itself.
    pub folded: bool,
}

/// A piece of a [`Section`]. Texts are plain: the page escapes them.
#[derive(Debug, Clone)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A table with a heading row.
    Table {
        /// Caption of the table.
        caption: String,
        /// Names of the columns, with units.
        header: Vec<String>,
        /// Cells, row by row.
        rows: Vec<Vec<String>>,
    },
    /// A drawing, as SVG made by this program.
    Figure(String),
}

/// Whether this program can write Parquet.
pub const PARQUET: bool = cfg!(feature = "parquet");

/// What [`write::write`] writes, and over what.
#[derive(Debug, Clone, Copy, Default)]
pub struct FileOptions {
    /// Parquet alone, where there is [`PARQUET`].
    pub no_csv: bool,
    /// Traces have one tick of this many; 0 and 1 both mean all.
    pub every: usize,
    /// Replaces what another command left in the folder.
    pub force: bool,
}
