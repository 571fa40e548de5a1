//! `touchstone run`: one scene.

use super::SceneOptions;
use super::out::say;
use std::path::PathBuf;
use touchstone_lab::report::{self, Colour, ReportInput, json, table};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::scene::Motion;

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
    let runs = [run::run(&scene, options.out.is_some())?];
    let written = match &options.out {
        Some(folder) => {
            let input = ReportInput {
                title: &scene.name,
                intro: &scene.description,
                command: &super::command_line(),
                k_critical: Some(
                    2.0 * scene.law.device_damping_n_m_s_per_rad * f64::from(scene.timing.rate_hz),
                ),
                runs: &runs,
                notes: &warnings,
                ..ReportInput::default()
            };
            Some(report::write(&input, folder)?)
        }
        None => None,
    };
    if options.json {
        say!("{}", json::render(&runs, &[]));
    } else {
        say!("{}", table::render(&runs, Colour::detect()).trim_end());
    }
    if let Some(written) = written {
        eprintln!("report  {}", written.page.display());
    }
    Ok(())
}
