//! `touchstone plan`: prints how a scene's run is built, its computing time, and which effects the scene leaves out.

use super::SceneOptions;
use super::out::{json, say};
use super::progress;
use super::report_options::program;
use touchstone_lab::plan::{PlanOptions, plan, steps, table};
use touchstone_sim::error::{Error, Result};

/// Options of `touchstone plan`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene or path of a scene's TOML file.
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Relative change of a result, as a fraction, from which on an omitted effect is listed.
    #[arg(long, value_name = "SHARE", default_value_t = PlanOptions::default().tolerance)]
    tolerance: f64,
    /// Measures no computing times, so that the output is the same on every machine.
    #[arg(long)]
    no_times: bool,
    /// Does not list the effects that the scene leaves out.
    #[arg(long)]
    no_omitted: bool,
}

/// Runs `touchstone plan`.
pub fn main(options: &Options) -> Result<()> {
    let tolerance = options.tolerance;
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(Error::Option {
            option: "--tolerance".to_owned(),
            problem: format!("{tolerance} is not a fraction"),
            fix: "give 0 or more, e.g. 0.05".to_owned(),
        });
    }
    let (scene, _) = options.changes.load(&options.scene)?;
    let asked = PlanOptions {
        tolerance,
        times: !options.no_times,
        omitted: !options.no_omitted,
    };
    let bar = progress::bar(steps(&scene, asked), "planning");
    let found = plan(&scene, asked, program(), &mut || bar.inc(1));
    bar.finish_and_clear();
    let found = found?;
    match json() {
        true => say!("{}", super::out::json_text(&serde_json::json!(found))),
        false => say!("{}", table::render(&found).trim_end()),
    }
    Ok(())
}
