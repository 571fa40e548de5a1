//! `touchstone run`: simulates one scene.

use super::check::Subject;
use super::expect::{self, Expectations};
use super::out::{json, note, print, say, tell};
use super::report_options::{ReportOptions, program};
use super::{EXIT_CODES, SceneOptions, interrupt, progress, space_scene};
use std::path::PathBuf;
use std::process::ExitCode;
use touchstone_report::{self as report, Colour, ReportInput, table};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run;
use touchstone_sim::run::record::Run;
use touchstone_sim::run::work::Work;
use touchstone_sim::scene::{self, RestPath};

/// Options of `touchstone run`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXIT_CODES)]
pub struct Options {
    /// Name of a shipped scene (see `touchstone scenes`) or path of a scene's TOML file.
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Writes report, results and traces to this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
    /// Prints the scene with all its values and defaults, without simulating it.
    #[arg(long)]
    print: bool,
    #[command(flatten)]
    expectations: Expectations,
}

/// Runs `touchstone run`.
pub fn main(options: &Options) -> Result<ExitCode> {
    let strict = options.changes.strict_passive();
    if let Some(scene) = space_scene::read(&options.scene)? {
        let asked = space_scene::RunOfSpace {
            print: options.print,
            out: options.out.as_deref(),
            report: &options.report,
            lost: options.changes.first_given(),
            expectations: &options.expectations,
        };
        return space_scene::main(&scene, &asked);
    }
    options.expectations.validate(strict)?;
    let (scene, mut notes) = options.changes.load(&options.scene)?;
    if options.print {
        match json() {
            true => {
                let value = serde_json::to_value(&scene).map_err(|error| {
                    Error::device("JSON", error.to_string(), "report this as a bug")
                })?;
                say!("{}", super::out::json_text(&value))
            }
            false => say!("{}", scene.to_toml().trim_end()),
        }
        return Ok(ExitCode::SUCCESS);
    }
    interrupt::clean_up()?;
    if let Some(folder) = &options.out {
        interrupt::sweep(folder);
    }
    let motion = RestPath::from_scene(&scene)?;
    if let Some(note) = motion.note() {
        note!("note: {note}");
    }
    let command = super::command_line();
    let files = options.report.files();
    if let Some(folder) = &options.out {
        report::check_folder(folder, &command, files.force)?;
    }
    let runs = [played(&scene, options.out.is_some())?];
    for note in runs.iter().filter_map(|run| run.summary.note()) {
        note!("note: {note}");
        notes.push(note);
    }
    // A shipped scene is part of the program, so that it is not an input file.
    let mut inputs = vec![PathBuf::from(&options.scene)];
    inputs.retain(|_| !scene::is_shipped(&options.scene));
    let input = ReportInput {
        title: &scene.name,
        intro: &scene.description,
        command: &command,
        program: program(),
        scenes: std::slice::from_ref(&scene),
        inputs: &inputs,
        files,
        k_critical: Some(
            2.0 * scene.law.device_damping_n_m_s_per_rad * f64::from(scene.timing.rate_hz),
        ),
        runs: &runs,
        notes: &notes,
        live_page: Some(&super::live::page_without_scene()),
        ..ReportInput::default()
    };
    let written = match &options.out {
        Some(folder) => Some(report::write(&input, folder)?),
        None => None,
    };
    let summaries = || runs.iter().map(|run| &run.summary);
    let mut checked = options
        .expectations
        .check(strict, summaries().map(Subject::from));
    options.expectations.compare(&mut checked, summaries())?;
    if json() {
        let results = expect::results(&report::json::render(&input), &checked);
        print(format_args!("{results:#}\n"))?;
    } else {
        tell!("{}", table::render(&runs, Colour::detect()).trim_end());
    }
    if let Some(written) = written {
        note!("report  {}", written.page.display());
    }
    checked.conclude()
}

/// Simulates the scene; shows a progress bar if the run may take long.
fn played(scene: &scene::Scene, with_trace: bool) -> Result<Run> {
    let work = Work::of(scene);
    if !work.is_long() {
        return run::run(scene, with_trace);
    }
    let bar = progress::bar(work.ticks, "ticks");
    let run = run::run_told(scene, with_trace, &mut |done| bar.set_position(done));
    bar.finish_and_clear();
    run
}
