//! `touchstone boundary`: draws a map of the stiffest wall that a tuned control law renders stably, over damping and delay of the
//! device.

use super::out::{self, say, tell};
use super::report_options::program;
use super::scene_options::{refuse_law, refuse_replaced};
use super::{interrupt, progress};
use std::path::PathBuf;
use touchstone_lab::boundary::{BoundaryPlan, map};
use touchstone_lab::scorecard::rivals::Rival;
use touchstone_report::{self as report, pages};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;
use touchstone_sim::scene::Scene;

/// Options of the command `touchstone boundary`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene, or path of a TOML file with a scene or only its device. Inertia, rate, encoder, friction and press
    /// come from it.
    #[arg(default_value = "thesis-knob")]
    scene: String,
    /// Changes a field of the scene, e.g. device.inertia_kg_m2=2e-4; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Control law that is tuned for every cell of the map.
    #[arg(long, value_name = "NAME", default_value = "spring-damper-estimated", value_parser = super::law_name::of_scorecard())]
    law: String,
    /// Delays in control periods, with commas between; each gets a panel of its own.
    #[arg(
        long,
        value_name = "TICKS,…",
        value_delimiter = ',',
        default_value = "0,0.5,1"
    )]
    delays: Vec<f64>,
    /// Number of columns: dampings b T/J from 0.0001 to 1 (damping b, control period T, inertia J).
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u16).range(2..=200))]
    columns: u16,
    /// Number of rows: stiffnesses T sqrt(k_de/J) from 0.1 to 2 (control period T, stiffness k_de, inertia J).
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u16).range(2..=200))]
    rows: u16,
    /// Longest search for one cell of the map, in simulated control periods.
    #[arg(long, value_name = "TICKS", default_value_t = 1e6)]
    ticks: f64,
    /// Seed of the random numbers of the searches.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the page, the drawing and the cells. If it already contains some cells, the search continues from them.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replaces the files that another command left in the folder.
    #[arg(long)]
    force: bool,
}

/// Scene fields that every cell of the map sets itself. `--set` refuses them. The second text names the values that replace the
/// field.
const REPLACED: [(&str, &str); 5] = [
    ("operator.grip", "grips"),
    ("operator.hand", "grips"),
    ("device.damping_n_m_s_per_rad", "dampings"),
    ("timing.computational_delay_s", "delays"),
    ("wall.k_desired_n_m_per_rad", "stiffnesses"),
];

/// Name of the file in which finished cells of the map are kept.
const CELLS: &str = "cells.csv";

/// Runs the command `touchstone boundary`.
pub fn main(options: &Options) -> Result<()> {
    refuse_law("boundary", &options.sets)?;
    refuse_replaced("boundary", &options.sets, &REPLACED)?;
    let scene = Scene::load(&options.scene)?.with_overrides(&options.sets)?;
    let size = [options.columns.into(), options.rows.into()];
    let mut plan = BoundaryPlan::new(scene, Rival::named(&options.law)?, size);
    if let Some(delay) = options
        .delays
        .iter()
        .find(|delay| !(0.0..=2.0).contains(*delay))
    {
        return Err(Error::Option {
            option: "--delays".to_owned(),
            problem: format!("a delay of {delay} control periods is outside 0 to 2"),
            fix: "give a delay of 0 to 2 control periods, which the estimator can predict over"
                .to_owned(),
        });
    }
    plan.delays.clone_from(&options.delays);
    plan.ticks = options.ticks;
    plan.seed = options.seed;
    let command = super::command_line();
    let folder = &options.out;
    report::check_folder(folder, &command, options.force)?;
    interrupt::clean_up_keeping(
        "interrupted: finished cells are saved; run the same command again to continue",
    )?;
    interrupt::sweep(folder);
    let unwritable = |error: std::io::Error| Error::Io {
        path: folder.clone(),
        problem: error.to_string(),
        fix: "choose another folder".to_owned(),
    };
    let file = folder.join(CELLS);
    if options.force && file.is_file() {
        std::fs::remove_file(&file).map_err(unwritable)?;
    }
    let bar = progress::bar(plan.places().len() as u64, "cells");
    let cells = output::in_folder(folder, unwritable, || {
        plan.fill(&file, |done| bar.set_position(done))
    })?;
    bar.finish_and_clear();
    let value = map::results(&plan, &cells);
    let page = pages::Page {
        title: "Where a tuned wall ends",
        intro: "Each cell's law was tuned for it, simulated in three grips, and certified. The map shows the stiffest wall over the device's damping and delay.",
        command: &command,
        program: program(),
        sections: &map::sections(&plan, &cells),
        results: ("boundary", &value),
        files: &[("boundary.svg".to_owned(), map::picture(&plan, &cells))],
        force: options.force,
    };
    let written = pages::write(&page, folder)?;
    out::result(
        || value.clone(),
        || {
            for line in map::words(&plan, &cells) {
                say!("{line}");
            }
            Ok(())
        },
    )?;
    tell!("page  {}", written.page.display());
    Ok(())
}
