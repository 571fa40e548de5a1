//! `touchstone accuracy`: measures how much computing time each gain in accuracy of the simulation costs.

use super::out::{json, quiet, say};
use super::report_options::program;
use super::{command_line, interrupt, out};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use touchstone_lab::accuracy::{AccuracyOptions, Machine, figures, measure, table};
use touchstone_report::{check_folder, folder};
use touchstone_sim::error::Result;

/// Options of the command `touchstone accuracy`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Folder for the diagrams as SVG and all figures as JSON; without it, the figures are only printed.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Uses fewer substeps, rates and repeats, to try the command out; such results are not fit for publication.
    #[arg(long)]
    quick: bool,
    /// Replaces the files that another command left in the folder.
    #[arg(long)]
    force: bool,
}

/// Runs the command `touchstone accuracy`.
pub fn main(options: &Options) -> Result<()> {
    let command = command_line();
    if let Some(folder) = &options.out {
        check_folder(folder, &command, options.force)?;
        interrupt::sweep(folder);
        interrupt::clean_up()?;
    }
    let asked = AccuracyOptions {
        quick: options.quick,
    };
    let bar = if quiet() || json() {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(asked.rounds())
    };
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} rounds, {elapsed}") {
        bar.set_style(style);
    }
    let machine = Machine::here(env!("TOUCHSTONE_COMPILER"));
    let found = measure(asked, program(), machine, &command, || bar.inc(1));
    bar.finish_and_clear();
    let mut found = found?;
    if let Some(folder) = &options.out {
        let mut files = figures::all(&found);
        let names = files.iter().map(|(name, _)| name.clone());
        found.files = names.chain(["results.json".to_owned()]).collect();
        let text = format!("{:#}\n", serde_json::json!(found));
        files.push(("results.json".to_owned(), text));
        folder::publish(folder, &command, options.force, &files)?;
    }
    out::result(
        || serde_json::json!(found),
        || {
            say!("{}", table::render(&found).trim_end());
            if let Some(folder) = &options.out {
                say!("");
                say!("diagrams and results.json: {}", folder.display());
            }
            Ok(())
        },
    )
}
