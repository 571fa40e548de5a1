//! `touchstone sweep`: varies any two settings of a scene and draws measures of its runs as a map.

use super::out::{self, note, tell};
use super::report_options::program;
use super::{SceneOptions, interrupt, progress};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchstone_lab::sweep::output::{self, Drawing};
use touchstone_lab::sweep::store::{Cells, Shard, Store};
use touchstone_lab::sweep::{Filled, Sweep, gathered};
use touchstone_sim::error::{Error, Result};

/// Message after an interrupt: finished cells of the map are kept.
const KEPT: &str = "interrupted: finished cells are saved; run the same command again to continue";

/// Options of `touchstone sweep`.
#[derive(Debug, Clone, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Options {
    #[command(subcommand)]
    merge: Option<Merge>,
    /// Name of a shipped scene or path of a scene's TOML file.
    #[arg(required = true)]
    scene: Option<String>,
    #[command(flatten)]
    changes: SceneOptions,
    /// Horizontal axis: FIELD=FROM..TO:COUNT, with :log at its end for even ratios, or FIELD=VALUE,VALUE,…; a field as in --set.
    #[arg(long, value_name = "FIELD=VALUES", required = true)]
    x: Option<String>,
    /// Vertical axis: the same format with another field.
    #[arg(long, value_name = "FIELD=VALUES", required = true)]
    y: Option<String>,
    /// Measure of each run to record and to draw beside the verdict, such as k_displayed; may be given several times.
    #[arg(long, value_name = "NAME")]
    measure: Vec<String>,
    /// Computes only the I-th of N parts of the cells, for a job array; `touchstone sweep merge` combines the parts.
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = parsed_shard)]
    shard: Shard,
    #[command(flatten)]
    drawing: DrawingOptions,
    // `None` with the subcommand `merge`, which has options of its own for the folder.
    #[command(flatten)]
    place: Option<Place>,
}

/// Options for the drawing of the maps.
#[derive(Debug, Clone, Default, clap::Args)]
struct DrawingOptions {
    /// Draws additional points on the maps: a CSV file of two columns, x and y, under a header.
    #[arg(long, value_name = "FILE.csv")]
    overlay: Option<PathBuf>,
    /// Leaves out the stability limit from `certify`, which may take minutes.
    #[arg(long)]
    no_certificate: bool,
}

/// Options for the output folder and the number of threads.
#[derive(Debug, Clone, clap::Args)]
struct Place {
    /// Folder for cells and maps. A folder with some of the cells is completed.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Number of computing threads; default: one for each core. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Replaces files that another command left in the folder.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, clap::Subcommand)]
enum Merge {
    /// Combines the parts of a sweep; the files are byte for byte those of a sweep without parts.
    Merge {
        /// Folders of the parts to combine.
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
        #[command(flatten)]
        drawing: DrawingOptions,
        #[command(flatten)]
        place: Place,
    },
}

fn parsed_shard(text: &str) -> std::result::Result<Shard, String> {
    text.parse()
}

/// Runs `touchstone sweep`.
pub fn main(options: &Options) -> Result<()> {
    match &options.merge {
        Some(Merge::Merge {
            folders,
            drawing,
            place,
        }) => merge(folders, drawing, place),
        None => compute(options),
    }
}

fn compute(options: &Options) -> Result<()> {
    // The parser of the command line has already refused a command without these four.
    let (Some(name), Some(x), Some(y), Some(place)) =
        (&options.scene, &options.x, &options.y, &options.place)
    else {
        return Ok(());
    };
    let Place {
        out: folder,
        force,
        threads,
    } = place;
    let (scene, _) = options.changes.load(name)?;
    let command = plain_command();
    let sweep = Sweep::new(&scene, [x, y], &options.measure, program(), &command)?;
    let drawing = options.drawing.read()?;
    in_threads(*threads)?;
    touchstone_report::check_folder(folder, &command, *force)?;
    interrupt::clean_up_keeping(KEPT)?;
    interrupt::sweep(folder);
    let mut store = Store::open(folder, &sweep, *force)?;
    if store.cells.keys().any(|cell| !options.shard.has(*cell)) {
        // Their files would be replaced by those of this part.
        store.leave();
        return Err(Error::Option {
            option: "--out".into(),
            problem: format!(
                "{} has cells of another part of the same map",
                folder.display()
            ),
            fix: "give each part a folder of its own, and combine them by `touchstone sweep merge`"
                .into(),
        });
    }
    let begun = Instant::now();
    let own = (0..sweep.grid.cells())
        .filter(|cell| options.shard.has(*cell))
        .count() as u64;
    let bar = progress::bar(own, "cells");
    let mut first = true;
    let filled = sweep.fill(&mut store, options.shard, |done| {
        if std::mem::take(&mut first) {
            // Cells from an earlier run do not count in the estimate of the remaining time.
            bar.set_position(done);
            bar.reset_eta();
        }
        bar.set_position(done);
    });
    bar.finish_and_clear();
    let filled = filled?;
    let cells = own_cells(&store.cells, options.shard);
    speak(&filled, begun);
    let results = draw(&sweep, options.shard, &cells, drawing, folder, *force)?;
    store.close();
    print(&results, folder)
}

fn merge(folders: &[PathBuf], drawing: &DrawingOptions, place: &Place) -> Result<()> {
    in_threads(place.threads)?;
    let drawing = drawing.read()?;
    let (sweep, cells) = gathered(folders, program())?;
    touchstone_report::check_folder(&place.out, &sweep.command, place.force)?;
    interrupt::clean_up()?;
    interrupt::sweep(&place.out);
    // The folder of the combined sweep also stores its cells, so that a later sweep can resume from it.
    let store = Store::open(&place.out, &sweep, place.force)?;
    let (shard, force) = (Shard::WHOLE, place.force);
    let results = draw(&sweep, shard, &cells, drawing, &place.out, force)?;
    store.close();
    print(&results, &place.out)
}

/// Writes cells and maps. Shows a progress bar while the stability limit is computed from certificates, the slowest step.
fn draw(
    sweep: &Sweep,
    shard: Shard,
    cells: &Cells,
    drawing: Drawing,
    folder: &Path,
    force: bool,
) -> Result<Value> {
    let bar = progress::bar(0, "certificates");
    let show = |done: u64, total: u64| {
        bar.set_length(total);
        bar.set_position(done);
    };
    let drawing = Drawing {
        progress: Some(&show),
        ..drawing
    };
    let written = output::write(sweep, shard, cells, &drawing, folder, force);
    bar.finish_and_clear();
    written.map(|(results, _)| results)
}

impl DrawingOptions {
    fn read(&self) -> Result<Drawing<'static>> {
        Ok(Drawing {
            points: self.overlay.as_deref().map(output::overlay).transpose()?,
            no_certificate: self.no_certificate,
            progress: None,
        })
    }
}

fn in_threads(threads: Option<u16>) -> Result<()> {
    let Some(threads) = threads else {
        return Ok(());
    };
    touchstone_lab::sweep::use_threads(threads.into()).map_err(|problem| Error::Option {
        option: format!("--threads {threads}"),
        problem,
        fix: "leave it out".to_owned(),
    })
}

/// Cells of the given part (shard), selected from all cells in a folder.
fn own_cells(cells: &Cells, shard: Shard) -> Cells {
    cells
        .iter()
        .filter(|(cell, _)| shard.has(**cell))
        .map(|(cell, row)| (*cell, row.clone()))
        .collect()
}

fn speak(filled: &Filled, begun: Instant) {
    if let Some((cell, error)) = &filled.refusal {
        note!("note: some cells are invalid scenes; the first is {cell}: {error}");
    }
    if filled.before > 0 {
        note!("note: {} cells were already computed", filled.before);
    }
    if filled.computed > 0 {
        let seconds = begun.elapsed().as_secs_f64();
        note!(
            "{} cells in {seconds:.1} s, {:.0} a second",
            filled.computed,
            filled.computed as f64 / seconds
        );
    }
}

fn print(results: &Value, folder: &Path) -> Result<()> {
    out::result(
        || results.clone(),
        || {
            let counts = results["verdicts"].as_object();
            for (word, count) in counts.into_iter().flatten() {
                if count != 0 {
                    tell!("{word:<14}{count:>9} cells");
                }
            }
            for measure in results["measures"].as_array().into_iter().flatten() {
                tell!(
                    "{:<32}{} to {} {}",
                    measure["name"].as_str().unwrap_or_default(),
                    measure["least"],
                    measure["most"],
                    measure["unit"].as_str().unwrap_or_default()
                );
            }
            for line in results["lines"].as_array().into_iter().flatten() {
                tell!("line          {}", line.as_str().unwrap_or_default());
            }
            tell!("cells and maps  {}", folder.display());
            Ok(())
        },
    )
}

/// This program's command line without options that do not change the results: output folder, shard, threads, `--force`, `--quiet`
/// and `--json`. So all parts of a sweep record the same command.
fn plain_command() -> String {
    let given = std::env::args_os().skip(1);
    let words: Vec<String> = given
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let mut plain = vec!["touchstone".to_owned()];
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        let (name, has_value) = match word.split_once('=') {
            Some((name, _)) => (name, true),
            None => (word.as_str(), false),
        };
        match name {
            "--out" | "--shard" | "--threads" if !has_value => {
                words.next();
            }
            "--out" | "--shard" | "--threads" | "--force" | "--quiet" | "-q" | "--json" => {}
            _ => plain.push(super::shell::word(&word)),
        }
    }
    plain.join(" ")
}
