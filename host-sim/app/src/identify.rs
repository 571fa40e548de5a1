//! `touchstone identify`: measures a simulated device's inertia, damping and friction from swings. It also finds the damping that
//! the control law FBA may assume, by the thesis' Algorithm 2.1.

use super::SceneOptions;
use super::number::{self, measured};
use super::out::{json, print, quiet, say, tell};
use touchstone_lab::identify::swing::{self, NotFound, Torques};
use touchstone_lab::identify::{Bracket, Estimate, Mechanics, Search, Swings, identify};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::Scene;

/// Options of `touchstone identify`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene or path of a scene's TOML file; the motion of its hand must include a hold.
    #[arg(default_value = "identify")]
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Lower end of the searched interval of damping, N·m·s/rad.
    #[arg(long, default_value_t = 0.0, value_name = "N_M_S_PER_RAD", allow_negative_numbers = true, value_parser = number::not_negative("in N·m·s/rad"))]
    low: f64,
    /// Upper end of the searched interval of damping, N·m·s/rad.
    #[arg(long, default_value_t = 2e-3, value_name = "N_M_S_PER_RAD", allow_negative_numbers = true, value_parser = number::not_negative("in N·m·s/rad"))]
    high: f64,
    /// Number of bisections of the damping interval, 1 to 40.
    #[arg(long, default_value_t = 12, allow_negative_numbers = true, value_parser = number::within(1_u32, 40, "of steps"))]
    steps: u32,
    /// Torque that swings the free device, N·m.
    #[arg(long, default_value_t = 0.05, value_name = "N_M", allow_negative_numbers = true, value_parser = number::not_negative("in N·m"))]
    push: f64,
}

/// Heading of the rows of findings.
const HEADING: &str = "quantity          value ± one standard uncertainty";

/// Fields of the scene that the damping search overwrites, each with a description of the value that it writes. `--set` refuses
/// these fields.
const REPLACED: [(&str, &str); 3] = [
    ("law.kind", "a law"),
    ("law.device_damping_n_m_s_per_rad", "a damping"),
    ("wall.k_desired_n_m_per_rad", "a stiffness"),
];

/// Runs `touchstone identify`.
pub fn main(options: &Options) -> Result<()> {
    if options.high <= options.low {
        return Err(Error::Option {
            option: "--low/--high".to_owned(),
            problem: format!(
                "{} to {} is not a valid interval",
                options.low, options.high
            ),
            fix: "give 0 <= low < high, in N·m·s/rad".to_owned(),
        });
    }
    options.changes.refuse_replaced("identify", &REPLACED)?;
    let (scene, _) = options.changes.load(&options.scene)?;
    if scene.hold_window_s().is_none() {
        return Err(scene.error(
            "operator.motion.kind",
            "does not hold the knob still, so stability cannot be judged",
            "use ramp-and-hold, press-wiggle-release or touch-and-press",
        ));
    }
    let search = Search {
        low: options.low,
        high: options.high,
        steps: options.steps,
    };
    let mechanics = swings(&scene, options)?;
    let silent = json() || quiet();
    tell!("step  c_i (N·m·s/rad)  motion early → late in the hold (mrad)  finding");
    let mut step = 0;
    let found = identify(&scene, search, Some(&mechanics), |trial| {
        step += 1;
        if !silent {
            let word = if trial.settles() { "settles" } else { "grows" };
            // If a line of progress cannot be printed, the search continues.
            let _ = print(format_args!(
                "{step:>4}  {:<16.4e}  {:9.4} → {:9.4}  {word}\n",
                trial.damping,
                1e3 * trial.early_rad,
                1e3 * trial.late_rad
            ));
        }
    })?
    .map_err(|bracket| unchanged(bracket, options))?;
    let k_critical = 2.0 * found.damping * f64::from(scene.timing.rate_hz);
    if json() {
        let estimate = |estimate: Estimate| serde_json::json!({ "value": estimate.value, "uncertainty": estimate.uncertainty });
        let value = serde_json::json!({
            "inertia_kg_m2": estimate(mechanics.inertia_kg_m2),
            "damping_n_m_s_per_rad": estimate(mechanics.damping_n_m_s_per_rad),
            "friction_n_m": estimate(mechanics.friction_n_m),
            "residual_rms_rad": mechanics.residual_rms_rad,
            "c_i_n_m_s_per_rad": { "value": found.damping, "uncertainty": found.uncertainty },
            "c_i_from_friction_n_m_s_per_rad": found.friction_share,
            "k_critical_n_m_per_rad": k_critical,
            "plant_damping_n_m_s_per_rad": found.plant,
        });
        say!("{}", super::out::json_text(&value));
        return Ok(());
    }
    let line = |name: &str, found: Estimate, unit: &str| {
        format!(
            "{name:<18}{} ± {} {unit}",
            measured(found.value, 4),
            measured(found.uncertainty, 1)
        )
    };
    tell!("");
    tell!("free, from swings at three speeds both ways:");
    tell!("{HEADING}");
    say!("{}", line("inertia", mechanics.inertia_kg_m2, "kg·m²"));
    say!(
        "{}",
        line(
            "viscous damping",
            mechanics.damping_n_m_s_per_rad,
            "N·m·s/rad"
        )
    );
    say!("{}", line("dry friction", mechanics.friction_n_m, "N·m"));
    say!(
        "left unexplained   {} rad rms",
        measured(mechanics.residual_rms_rad, 1)
    );
    tell!("");
    tell!("held, by Algorithm 2.1, {} presses:", found.presses.len());
    tell!("{HEADING}");
    say!(
        "c_i               {:.4e} ± {:.1e} N·m·s/rad",
        found.damping,
        found.uncertainty,
    );
    say!("k_c = 2 c_i/T     {k_critical:.3} N·m/rad");
    if found.friction_share > found.resolution {
        say!(
            "of which dry friction accounts for about {:.1e} N·m·s/rad at the small amplitude of this measurement, and for less at a larger one",
            found.friction_share
        );
    }
    say!(
        "the simulated plant has {:.4e} N·m·s/rad (device and pad)",
        found.plant
    );
    Ok(())
}

/// Measures inertia, damping and friction of the simulated device from swings outside the wall. The error names `--push` if the
/// swings give no result.
fn swings(scene: &Scene, options: &Options) -> Result<Mechanics> {
    let swings = Swings {
        torque_n_m: options.push,
        ..Swings::default()
    };
    let refused = |not: NotFound| Error::Option {
        option: format!("--push {}", options.push),
        problem: not.to_string(),
        fix: "push harder (--push, N·m), or check that the device turns freely".to_owned(),
    };
    let done = swing::swing(scene, &swings)?.map_err(refused)?;
    swing::mechanics(&done, scene.timing.period_s(), Torques::Exact).map_err(refused)
}

/// Error for a damping interval whose ends both give the same verdict, so that bisection finds no limit between the ends. Names the
/// end to change.
fn unchanged(bracket: Bracket, options: &Options) -> Error {
    let (option, problem, fix) = match bracket {
        Bracket::TooHigh => (
            format!("--low {}", options.low),
            "the motion grows already at this damping, so the device's damping is lower",
            "give a lower one, 0 if need be, in N·m·s/rad",
        ),
        Bracket::TooLow | Bracket::Holds => (
            format!("--high {}", options.high),
            "the motion still settles at this damping, so the device's damping is higher",
            "give a higher one, in N·m·s/rad",
        ),
    };
    Error::Option {
        option,
        problem: problem.to_owned(),
        fix: fix.to_owned(),
    }
}
