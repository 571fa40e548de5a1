//! `touchstone identify`: Algorithm 2.1.

use super::SceneOptions;
use super::out::{print, say};
use touchstone_lab::identify::{Search, identify};
use touchstone_sim::error::{Error, Result};

/// Options of `identify`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene or path of a scene's TOML file; its motion must have a hold.
    #[arg(default_value = "identify")]
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Lower end of the interval, N·m·s/rad.
    #[arg(long, default_value_t = 0.0, value_name = "N_M_S_PER_RAD")]
    low: f64,
    /// Upper end of the interval, N·m·s/rad.
    #[arg(long, default_value_t = 2e-3, value_name = "N_M_S_PER_RAD")]
    high: f64,
    /// Bisections, 1 to 40.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=40))]
    steps: u32,
    /// Prints the result as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs it.
pub fn main(options: &Options) -> Result<()> {
    let usable = options.low.is_finite()
        && options.high.is_finite()
        && options.low >= 0.0
        && options.high > options.low;
    if !usable {
        return Err(Error::Option {
            option: "--low/--high".to_owned(),
            problem: format!("{} to {} is no interval", options.low, options.high),
            fix: "give 0 <= low < high, in N·m·s/rad".to_owned(),
        });
    }
    let (scene, _) = options.changes.load(&options.scene)?;
    if scene.hold_window_s().is_none() {
        return Err(scene.error(
            "operator.motion.kind",
            "has no quiet hold to judge stability by",
            "use ramp-and-hold, press-wiggle-release or touch-and-press",
        ));
    }
    let search = Search {
        low: options.low,
        high: options.high,
        steps: options.steps,
    };
    let quiet = options.json;
    if !quiet {
        say!("step  c_i (N·m·s/rad)  motion early → late in the hold (mrad)");
    }
    let mut step = 0;
    let found = identify(&scene, search, |trial| {
        step += 1;
        if !quiet {
            let word = if trial.settles() { "settles" } else { "grows" };
            // A line of progress that cannot be printed is not worth stopping for.
            let _ = print(format_args!(
                "{step:>4}  {:<16.4e}  {:9.4} → {:9.4}  {word}\n",
                trial.damping,
                1e3 * trial.early_rad,
                1e3 * trial.late_rad
            ));
        }
    })?;
    let error = found.damping / found.plant - 1.0;
    if options.json {
        let value = serde_json::json!({
            "units": { "damping": "N·m·s/rad", "uncertainty": "N·m·s/rad", "plant": "N·m·s/rad", "k_critical": "N·m/rad" },
            "damping": found.damping,
            "uncertainty": found.uncertainty,
            "plant": found.plant,
            "k_critical": 2.0 * found.damping * f64::from(scene.timing.rate_hz),
        });
        say!("{value:#}");
    } else {
        say!("");
        say!(
            "c_i  {:.4e} ± {:.1e} N·m·s/rad,  k_c = 2 c_i/T  {:.3} N·m/rad",
            found.damping,
            found.uncertainty,
            2.0 * found.damping * f64::from(scene.timing.rate_hz)
        );
        say!(
            "plant (device and pad)  {:.4e} N·m·s/rad,  difference {:+.1} %",
            found.plant,
            100.0 * error
        );
    }
    Ok(())
}
