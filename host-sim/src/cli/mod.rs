//! The command line: `touchstone [thesis | run | identify | scenes | flash | monitor | config | device | doctor]`.

mod config;
mod device;
mod doctor;
mod flash;
mod identify;
mod monitor;
mod out;
mod port;
mod run;
mod thesis;

use crate::error::{Error, Result};
use crate::run as runner;
use crate::scene::{self, Scene};
use clap::{Parser, Subcommand};
use out::say;
use std::process::ExitCode;
use touchstone_control::Warning;

/// Hard virtual walls: simulate them, compare control laws, and see what holds.
///
/// Without a command it runs the thesis' comparison.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The thesis' comparison of five laws at four stiffnesses, with an HTML report (the default).
    Thesis(thesis::Options),
    /// One run of a scene.
    Run(run::Options),
    /// Measures the damping of a simulated device with FBA (Algorithm 2.1).
    Identify(identify::Options),
    /// Lists the scenes that come with the program.
    Scenes,
    /// Writes the firmware into a board, through the program probe-rs.
    Flash(flash::Options),
    /// Shows what a device measures and does, live; keeps every control tick as CSV.
    Monitor(monitor::Options),
    /// Reads, changes and keeps a device's settings.
    Config(config::Options),
    /// Commands a device, and reads its state, its fault and the second before it.
    Device(device::Options),
    /// Looks for everything that a board needs, and says what is missing and how to get it.
    Doctor(doctor::Options),
}

/// Runs the program. Exit codes: 0 done, 1 a device or what it needs failed, 2 something to be mended by the user.
#[must_use]
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match cli
        .command
        .unwrap_or_else(|| Command::Thesis(thesis::Options::default()))
    {
        Command::Thesis(options) => thesis::main(&options),
        Command::Run(options) => run::main(&options),
        Command::Identify(options) => identify::main(&options),
        Command::Scenes => scenes(),
        Command::Flash(options) => flash::main(&options),
        Command::Monitor(options) => monitor::main(&options),
        Command::Config(options) => config::main(&options),
        Command::Device(options) => device::main(&options),
        Command::Doctor(options) => return doctor::main(&options),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn scenes() -> Result<()> {
    for name in scene::names() {
        say!("{name:24}{}", Scene::load(name)?.description);
    }
    Ok(())
}

/// Options that change a scene, the same for every command that takes one.
#[derive(Debug, Clone, Default, clap::Args)]
struct SceneOptions {
    /// Control law: spring, spring-damper, tdpa, fba, sfa, sfa-continuous, enhanced-sfa.
    #[arg(long)]
    law: Option<String>,
    /// Desired stiffness k_de, N·m/rad.
    #[arg(long, value_name = "N_M_PER_RAD")]
    k_desired: Option<String>,
    /// Changes a field of the scene, e.g. device.inertia_kg_m2=2e-4; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Moves the hand by a recording: CSV with a time and an angle column, their units in the header.
    #[arg(long, value_name = "FILE.csv")]
    operator_motion: Option<std::path::PathBuf>,
    /// Refuses settings beyond a passivity bound instead of warning of them.
    #[arg(long)]
    strict_passive: bool,
}

impl SceneOptions {
    /// The scene with the options applied and its law checked. Warnings go to standard error.
    fn load(&self, name: &str) -> Result<(Scene, Vec<String>)> {
        let mut scene = Scene::load(name)?;
        if let Some(file) = &self.operator_motion {
            scene = scene.with_recording(file)?;
        }
        scene = scene.with_overrides(&self.sets)?;
        if let Some(law) = &self.law {
            scene = scene.with_option("law.kind", law, "--law")?;
        }
        if let Some(stiffness) = &self.k_desired {
            scene = scene.with_option("wall.k_desired_n_m_per_rad", stiffness, "--k-desired")?;
        }
        let warnings = check(&scene, self.strict_passive)?;
        Ok((scene, warnings))
    }
}

/// Checks the scene's law; prints what leaves a passivity bound, or refuses it.
fn check(scene: &Scene, strict: bool) -> Result<Vec<String>> {
    runner::wall(scene)?;
    let mut said = Vec::new();
    for (warning, message) in runner::warnings(scene)? {
        if strict {
            return Err(strictly(message));
        }
        // The credit is a documented default; it is named in the results, and refused above.
        if !matches!(warning, Warning::EnergyCredit { .. }) {
            eprintln!("warning: {message}");
            said.push(message.to_string());
        }
    }
    Ok(said)
}

/// The warning as a refusal: says which option asked for it.
fn strictly(mut message: Error) -> Error {
    let (Error::File { fix, .. }
    | Error::Option { fix, .. }
    | Error::Io { fix, .. }
    | Error::Device { fix, .. }) = &mut message;
    fix.push_str(", or leave out --strict-passive");
    message
}

/// The command line as it was given, to be printed in reports.
fn command_line() -> String {
    let mut words = vec!["touchstone".to_owned()];
    words.extend(std::env::args().skip(1).map(|word| {
        if word.contains(' ') {
            format!("\"{word}\"")
        } else {
            word
        }
    }));
    words.join(" ")
}
