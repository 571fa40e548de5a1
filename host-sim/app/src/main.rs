//! The command line: `touchstone [thesis | run | identify | scenes | flash | monitor | config | device | doctor]`.

mod config;
mod device;
mod doctor;
mod flash;
mod identify;
mod monitor;
mod out;
mod port;
mod report_options;
mod run;
mod scene_options;
mod thesis;

use clap::{Parser, Subcommand};
use out::say;
use scene_options::SceneOptions;
use std::process::ExitCode;
use touchstone_sim::error::Result;
use touchstone_sim::scene::{self, Scene};

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
fn main() -> ExitCode {
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
