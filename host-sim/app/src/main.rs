//! The command line of the program `touchstone`; the enum `Command` lists the commands.

mod accuracy;
mod baseline;
mod board_page;
mod boundary;
#[cfg(unix)]
mod bridge;
mod browser;
mod certify;
mod check;
mod compare;
mod complain;
mod config;
mod demo;
mod device;
mod doctor;
mod events;
mod expect;
mod export_fmu;
mod family;
mod feel_card;
mod feels;
mod flash;
mod haptic;
mod hard;
mod http;
mod identify;
mod interrupt;
mod json_schema;
mod law_name;
mod live;
mod log;
mod monitor;
mod number;
mod osc;
mod out;
mod plan;
mod port;
mod progress;
mod report_options;
mod run;
mod scene_options;
mod scorecard;
mod setup;
mod shell;
mod space_scene;
mod stream;
mod sweep;
mod thesis;
mod thesis_space;
mod tune;
mod wall_options;
mod websocket;
mod whole;
mod zero;

use clap::{CommandFactory, Parser, Subcommand};
use out::{say, tell};
use scene_options::SceneOptions;
use shell::command_line;
use std::io::Write as _;
use std::process::ExitCode;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{self, Scene};

/// Help text on exit codes, for the program and for every command that can end with exit code 3.
const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a device, or the connection to it, failed
  2    an invalid option, scene or file
  3    done, but a demand is not met (--expect and similar options, a hard case, a tuning, device variants)
  130  interrupted: no incomplete file is left";

/// Hard virtual walls: simulate them, compare control laws, and see which walls are stable.
///
/// Without a command, runs the comparison of the thesis.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true, after_help = EXIT_CODES)]
struct Cli {
    /// Prints the result as JSON, for programs.
    #[arg(long, global = true)]
    json: bool,
    /// Prints only errors and output that an option requests; no progress, notes, warnings or summaries.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Compares five control laws at four stiffnesses as in the thesis, and writes an HTML report (the default).
    Thesis(thesis::Options),
    /// Simulates one scene and prints its results.
    Run(run::Options),
    /// Writes a page that simulates a scene under the mouse, and opens it; with --port, shows a board in the browser.
    Live(live::Options),
    /// Simulates a knob to try without a board: in the browser, or at a port for every command that connects to a board.
    Demo(demo::Options),
    /// Measures inertia, damping and friction of a simulated device, and the damping that the control law FBA may assume (the
    /// thesis' Algorithm 2.1).
    Identify(identify::Options),
    /// Computes whether a wall is stable, for which hands, and by which margins, without a simulation run.
    Certify(certify::Options),
    /// Shows how a scene's run is built: states, eigenvalues, substeps, the computing time of each effect, and which omitted effect
    /// would matter.
    Plan(plan::Options),
    /// Shows accuracy against computing time for integrators, number formats, control rates and encoders, each compared with a
    /// reference.
    Accuracy(accuracy::Options),
    /// Runs the hard test cases, each against a known answer, and shows the smallest margin.
    Hard(hard::Options),
    /// Varies any two settings of a scene and draws measures of its runs as a map, with the stability limits of theory.
    Sweep(sweep::Options),
    /// Draws the stability limit of a tuned wall over damping and delay, from runs and from certificates.
    Boundary(boundary::Options),
    /// Compares control laws by what a hand feels of a wall: one table row per law, on the nominal device and on varied ones.
    Scorecard(scorecard::Options),
    /// Finds the settings of a control law for a device that make the worst figure of its scorecard best.
    Tune(tune::Options),
    /// Writes control law and plant of a scene as FMUs, models that Simulink, OpenModelica and FMPy run (FMI 3.0, co-simulation).
    ExportFmu(export_fmu::Options),
    /// Lists the scenes that come with the program.
    Scenes {
        /// Prints the JSON schema of a scene file instead.
        #[arg(long)]
        json_schema: bool,
    },
    /// Lists haptic effects of a knob: detents, switches, dials, each a short scene to run, to change and to send to a board.
    Feels(feels::Options),
    /// Sets up a connected board: measures motor and knob, tunes the wall, saves the settings; resumes if interrupted. THE SHAFT
    /// SPINS.
    Setup(setup::Options),
    /// Compares a recording of a device with its simulation: where they differ, and which property of the knob would explain the
    /// difference.
    Compare(compare::Options),
    /// Writes the firmware to a board, through its debug probe.
    Flash(flash::Options),
    /// Prints the log of the firmware on a board, through its debug probe, while it runs.
    Log(log::Options),
    /// Prints a line, text or JSON, whenever the position of a knob changes.
    Events(events::Options),
    /// Makes a board look like a SmartKnob, on a pseudo terminal, for programs that were written for one.
    #[cfg(unix)]
    Bridge(bridge::Options),
    /// Shows a device's measurements and commands live; with --csv, writes every control period to a file.
    Monitor(monitor::Options),
    /// Reads, changes and saves a device's settings.
    Config(config::Options),
    /// Commands a board, and reads its state, its fault and the second before the fault; renders a wall on a haptic device that has
    /// no control law of its own.
    Device(device::Options),
    /// Checks for everything that a board needs, and shows what is missing and how to get it.
    Doctor(doctor::Options),
    /// Prints the completion script for a shell.
    Completions(shell::Completions),
    /// Prints the program's manual page, or writes the pages of all commands to a folder.
    Man(shell::Man),
}

impl Command {
    /// Returns an error if `--json` is given to a command that prints nothing as JSON.
    fn as_json(&self) -> Result<()> {
        let (command, fix) = match self {
            Command::Flash(_) => (
                "flash",
                "leave it out: this command's result is its exit code",
            ),
            Command::Log(_) => ("log", "leave it out: this command prints text for people"),
            Command::Completions(_) => (
                "completions",
                "leave it out: completions are a script for a shell",
            ),
            Command::Man(_) => ("man", "leave it out: the manual is text for people"),
            Command::Config(options) if options.exports() => {
                ("config export", "use `touchstone config get --json`")
            }
            _ => return Ok(()),
        };
        Err(Error::Option {
            option: "--json".to_owned(),
            problem: format!("{command} has nothing to print as JSON"),
            fix: fix.to_owned(),
        })
    }
}

/// Runs the program; [`EXIT_CODES`] explains the exit codes.
fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            let program = Cli::command();
            let commands: Vec<&str> = program
                .get_subcommands()
                .map(clap::Command::get_name)
                .collect();
            return match complain::usage(&error, &commands) {
                Some(line) => complain(&line, 2),
                None => {
                    let printed = error.print().and_then(|()| std::io::stdout().flush());
                    match out::put_out(printed) {
                        Ok(()) => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
                        Err(full) => complain(&full.to_string(), 2),
                    }
                }
            };
        }
    };
    out::choose(cli.json, cli.quiet);
    let command = cli
        .command
        .unwrap_or_else(|| Command::Thesis(thesis::Options::default()));
    match act(&command, cli.json) {
        Ok(code) => code,
        Err(error) => complain(&complain::line(&error.to_string()), error.exit_code()),
    }
}

fn complain(line: &str, code: u8) -> ExitCode {
    eprintln!("error: {line}");
    ExitCode::from(code)
}

fn act(command: &Command, json: bool) -> Result<ExitCode> {
    if json {
        command.as_json()?;
    }
    let done = match command {
        Command::Thesis(options) => return thesis::main(options),
        Command::Run(options) => return run::main(options),
        Command::Doctor(options) => return doctor::main(options),
        Command::Hard(options) => return hard::main(options),
        Command::Compare(options) => return compare::main(options),
        Command::Live(options) => live::main(options),
        Command::Demo(options) => demo::main(options),
        Command::Identify(options) => identify::main(options),
        Command::Certify(options) => certify::main(options),
        Command::Plan(options) => plan::main(options),
        Command::Accuracy(options) => accuracy::main(options),
        Command::Sweep(options) => sweep::main(options),
        Command::Boundary(options) => boundary::main(options),
        Command::Scorecard(options) => return scorecard::main(options),
        Command::Tune(options) => return tune::main(options),
        Command::ExportFmu(options) => export_fmu::main(options),
        Command::Scenes { json_schema: true } => {
            out::print(format_args!("{:#}\n", json_schema::scene()))
        }
        Command::Scenes { json_schema: false } => scenes(),
        Command::Feels(options) => feels::main(options),
        Command::Setup(options) => setup::main(options),
        Command::Flash(options) => flash::main(options),
        Command::Log(options) => log::main(options),
        Command::Events(options) => events::main(options),
        #[cfg(unix)]
        Command::Bridge(options) => bridge::main(options),
        Command::Monitor(options) => monitor::main(options),
        Command::Config(options) => config::main(options),
        Command::Device(options) => return device::main(options),
        Command::Completions(options) => shell::completions(options),
        Command::Man(options) => shell::man(options),
    };
    done.map(|()| ExitCode::SUCCESS)
}

fn scenes() -> Result<()> {
    let mut scenes = described(scene::names())?;
    scenes.push((space_scene::SHIPPED.0, space_scene::SHIPPED.1.to_owned()));
    listed("scenes", &scenes, &[])
}

/// Names of shipped scenes, each with its description.
fn described(names: Vec<&'static str>) -> Result<Vec<(&'static str, String)>> {
    let scenes = names.into_iter();
    scenes
        .map(|name| Ok((name, Scene::load(name)?.description)))
        .collect()
}

/// Prints a list of scenes, and below it the commands that use them.
fn listed(what: &str, scenes: &[(&str, String)], ways: &[&str]) -> Result<()> {
    let entry = |(name, description): &(&str, String)| serde_json::json!({ "name": name, "description": description });
    out::result(
        || serde_json::json!({ what: scenes.iter().map(entry).collect::<Vec<_>>() }),
        || {
            for (name, description) in scenes {
                say!("{name:24}{description}");
            }
            for way in ways {
                tell!("{way}");
            }
            Ok(())
        },
    )
}
