//! `touchstone identify`: Algorithm 2.1.

use super::SceneOptions;
use super::number;
use super::out::{json, print, quiet, say, tell};
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
    #[arg(long, default_value_t = 0.0, value_name = "N_M_S_PER_RAD", allow_negative_numbers = true, value_parser = number::not_negative("in N·m·s/rad"))]
    low: f64,
    /// Upper end of the interval, N·m·s/rad.
    #[arg(long, default_value_t = 2e-3, value_name = "N_M_S_PER_RAD", allow_negative_numbers = true, value_parser = number::not_negative("in N·m·s/rad"))]
    high: f64,
    /// Bisections, 1 to 40.
    #[arg(long, default_value_t = 12, allow_negative_numbers = true, value_parser = number::within(1_u32, 40, "of steps"))]
    steps: u32,
}

/// What of the scene is replaced by the search.
const REPLACED: [(&str, &str); 3] = [
    ("law.kind", "a law"),
    ("law.c_i_n_m_s_per_rad", "a damping"),
    ("wall.k_desired_n_m_per_rad", "a stiffness"),
];

/// Runs it.
pub fn main(options: &Options) -> Result<()> {
    if options.high <= options.low {
        return Err(Error::Option {
            option: "--low/--high".to_owned(),
            problem: format!("{} to {} is no interval", options.low, options.high),
            fix: "give 0 <= low < high, in N·m·s/rad".to_owned(),
        });
    }
    options.changes.refuse_replaced("identify", &REPLACED)?;
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
    let silent = json() || quiet();
    tell!("step  c_i (N·m·s/rad)  motion early → late in the hold (mrad)");
    let mut step = 0;
    let found = identify(&scene, search, |trial| {
        step += 1;
        if !silent {
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
    if json() {
        let value = serde_json::json!({
            "units": { "damping": "N·m·s/rad", "uncertainty": "N·m·s/rad", "plant": "N·m·s/rad", "k_critical": "N·m/rad" },
            "damping": found.damping,
            "uncertainty": found.uncertainty,
            "plant": found.plant,
            "k_critical": 2.0 * found.damping * f64::from(scene.timing.rate_hz),
        });
        say!("{value:#}");
    } else {
        tell!("");
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
