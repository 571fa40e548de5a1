//! `touchstone sweep`: any two settings of a scene against any measure of its run, as a map.

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

/// Message on an interrupt: finished cells stay.
const KEPT: &str = "interrupted: what is done is kept; the same command goes on";

/// Options of `sweep`.
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
    /// Across: FIELD=FROM..TO:COUNT, with :log at its end for even ratios, or FIELD=VALUE,VALUE,…; a field as in --set.
    #[arg(long, value_name = "FIELD=VALUES", required = true)]
    x: Option<String>,
    /// Upwards: the same with another field.
    #[arg(long, value_name = "FIELD=VALUES", required = true)]
    y: Option<String>,
    /// A measure of each run to keep and to draw beside the verdict, such as k_displayed; may be given several times.
    #[arg(long, value_name = "NAME")]
    measure: Vec<String>,
    /// Computes only the I-th of N parts of the cells, for a job array; `touchstone sweep merge` puts them together.
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = parsed_shard)]
    shard: Shard,
    #[command(flatten)]
    drawing: DrawingOptions,
    // Not there where `merge` has its own.
    #[command(flatten)]
    place: Option<Place>,
}

/// How the maps are drawn.
#[derive(Debug, Clone, Default, clap::Args)]
struct DrawingOptions {
    /// Draws these places over the maps: a CSV file of two columns, x and y, under a header.
    #[arg(long, value_name = "FILE.csv")]
    overlay: Option<PathBuf>,
    /// Leaves out the boundary of `certify`, which may take minutes.
    #[arg(long)]
    no_certificate: bool,
}

/// Where it is written.
#[derive(Debug, Clone, clap::Args)]
struct Place {
    /// Folder for cells and maps. One with a part of the cells goes on where it was ended.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How many threads compute; default: one for each core. The results are the same.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Replaces what another command left in the folder.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, clap::Subcommand)]
enum Merge {
    /// Puts the parts of a sweep together, to the same bytes as without parts.
    Merge {
        /// Folders of the parts.
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

/// Runs the command.
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
    // The command's own reader refuses it without these four.
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
    touchstone_lab::report::check_folder(folder, &command, *force)?;
    interrupt::clean_up_keeping(KEPT)?;
    interrupt::sweep(folder);
    let mut store = Store::open(folder, &sweep, *force)?;
    let begun = Instant::now();
    let own = (0..sweep.grid.cells())
        .filter(|cell| options.shard.has(*cell))
        .count() as u64;
    let bar = progress::bar(own, "cells");
    let mut first = true;
    let filled = sweep.fill(&mut store, options.shard, |done| {
        if std::mem::take(&mut first) {
            // What was there says nothing of the time that is left.
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
    touchstone_lab::report::check_folder(&place.out, &sweep.command, place.force)?;
    interrupt::clean_up()?;
    interrupt::sweep(&place.out);
    // The whole's folder is one that can be gone on with, too.
    let store = Store::open(&place.out, &sweep, place.force)?;
    let (shard, force) = (Shard::WHOLE, place.force);
    let results = draw(&sweep, shard, &cells, drawing, &place.out, force)?;
    store.close();
    print(&results, &place.out)
}

/// Writes cells and maps, with a bar while the certificates of the boundary are computed, which takes longest.
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

/// The cells of a shard out of all that a folder has.
fn own_cells(cells: &Cells, shard: Shard) -> Cells {
    cells
        .iter()
        .filter(|(cell, _)| shard.has(**cell))
        .map(|(cell, row)| (*cell, row.clone()))
        .collect()
}

fn speak(filled: &Filled, begun: Instant) {
    if let Some((cell, error)) = &filled.refusal {
        note!("note: cells are refused; the first is {cell}: {error}");
    }
    if filled.before > 0 {
        note!("note: {} cells were there already", filled.before);
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

/// The command without what does not change the whole's bytes: where to, which part, how fast, how loud.
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
