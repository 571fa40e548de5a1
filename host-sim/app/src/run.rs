//! `touchstone run`: one scene.

use super::SceneOptions;
use super::out::say;
use super::report_options::{ReportOptions, program};
use std::path::PathBuf;
use touchstone_lab::report::{self, Colour, ReportInput, json, table};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::scene::{self, Motion};

/// Options of `run`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene (see `touchstone scenes`) or path of a scene's TOML file.
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Prints the results as JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Writes report, results and traces to this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
    /// Prints the scene with all its values and defaults, and runs nothing.
    #[arg(long)]
    print: bool,
}

/// Runs it.
pub fn main(options: &Options) -> Result<()> {
    let (scene, warnings) = options.changes.load(&options.scene)?;
    if options.print {
        say!("{}", scene.to_toml().trim_end());
        return Ok(());
    }
    let motion = Motion::from_scene(&scene)?;
    if let Some(note) = motion.note() {
        eprintln!("note: {note}");
    }
    let command = super::command_line();
    let files = options.report.files();
    if let Some(folder) = &options.out {
        report::check_folder(folder, &command, files.force)?;
    }
    let runs = [run::run(&scene, options.out.is_some())?];
    // A shipped scene is in the program, not in a file.
    let mut inputs = vec![PathBuf::from(&options.scene)];
    inputs.retain(|_| !scene::names().contains(&options.scene.as_str()));
    let input = ReportInput {
        title: &scene.name,
        intro: &scene.description,
        command: &command,
        program: program(),
        scenes: std::slice::from_ref(&scene),
        inputs: &inputs,
        files,
        k_critical: Some(2.0 * scene.law.c_i_n_m_s_per_rad * f64::from(scene.timing.rate_hz)),
        runs: &runs,
        notes: &warnings,
        ..ReportInput::default()
    };
    let written = match &options.out {
        Some(folder) => Some(report::write(&input, folder)?),
        None => None,
    };
    if options.json {
        say!("{}", json::render(&input));
    } else {
        say!("{}", table::render(&runs, Colour::detect()).trim_end());
    }
    if let Some(written) = written {
        eprintln!("report  {}", written.page.display());
    }
    Ok(())
}
