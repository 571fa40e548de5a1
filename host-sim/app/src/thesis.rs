//! `touchstone thesis`: the thesis' comparison of control laws, and the program's default command.

use super::check::Subject;
use super::expect::{self, Expectations};
use super::out::{json, print, quiet, tell};
use super::report_options::{ReportOptions, program};
use super::thesis_space::SpaceOptions;
use super::{EXIT_CODES, interrupt};
use crate::scene_options::{check, refuse_replaced};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use touchstone_control::LawKind;
use touchstone_lab::thesis::{
    self, COUNTS, GRIPS, REPLACED, SHIPPED, STIFFNESSES, TDPA_OBSERVES, claims,
};
use touchstone_report::{self as report, Block, Colour, ReportInput, Section, table};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::record::{Run, Verdict};
use touchstone_sim::scene::{Preset, Scene};

/// Options of `touchstone thesis`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXIT_CODES)]
pub struct Options {
    /// Folder for the report.
    #[arg(long, value_name = "DIR", default_value = "touchstone-report")]
    out: PathBuf,
    #[command(flatten)]
    report: ReportOptions,
    /// Degrees of freedom: 1, a knob (the thesis' §5.1), or 3, an omega.3 (§5.2), which touches a plane, an inclined plane and a
    /// sphere of 30 mm at 5 and 25 N/mm, with settings of its own.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..))]
    dof: u8,
    #[command(flatten)]
    space: SpaceOptions,
    /// Changes a field of the scene thesis-knob in all runs, e.g. device.friction.kinetic_n_m=1e-3; not law, stiffness, grip and
    /// encoder, which the comparison itself varies. The control law TDPA always has the thesis' energy observer, also if
    /// law.observer is changed.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Rejects an enhanced law beyond its own passivity bounds instead of warning; ends with 3 if one of its runs gives energy.
    #[arg(long)]
    strict_passive: bool,
    /// Limits that the enhanced law's runs must meet; the other control laws are expected to fail.
    #[command(flatten)]
    expectations: Expectations,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            out: PathBuf::from("touchstone-report"),
            report: ReportOptions::default(),
            dof: 1,
            space: SpaceOptions::default(),
            sets: Vec::new(),
            strict_passive: false,
            expectations: Expectations::default(),
        }
    }
}

/// Runs `touchstone thesis`.
pub fn main(options: &Options) -> Result<ExitCode> {
    match options.dof {
        1 => {
            if let Some(option) = options.space.any() {
                return Err(Error::Option {
                    option: option.to_owned(),
                    problem: "does not apply to one degree of freedom".to_owned(),
                    fix: "add --dof 3, or leave it out".to_owned(),
                });
            }
        }
        3 => return space(options),
        other => {
            return Err(Error::Option {
                option: format!("--dof {other}"),
                problem: "there is no comparison with this number of degrees of freedom".to_owned(),
                fix: "give 1 or 3".to_owned(),
            });
        }
    }
    let started = Instant::now();
    options.expectations.validate(options.strict_passive)?;
    refuse_replaced("thesis", &options.sets, &REPLACED)?;
    let command = super::command_line();
    let files = options.report.files();
    report::check_folder(&options.out, &command, files.force)?;
    let shipped = Scene::load("thesis-knob")?;
    let base = shipped
        .with_preset(Preset::Thesis)?
        .with_overrides(&options.sets)?;
    let shipped = shipped.with_overrides(&options.sets)?;
    let mut notes = check(&base, options.strict_passive)?;
    notes.push(format!("{TDPA_OBSERVES}."));
    let cells = thesis::cells(&base)?;
    let shipped = thesis::shipped_cells(&shipped)?;
    interrupt::clean_up()?;
    interrupt::sweep(&options.out);
    let bar = ProgressBar::new((cells.len() + shipped.len()) as u64 + 1).with_style(style());
    if quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar.set_message("comparing laws");
    let runs = thesis::run_all(&cells, || bar.inc(1))?;
    let mut ships = thesis::run_all(&shipped, || bar.inc(1))?;
    for run in &mut ships {
        run.summary.shown_as = Some(SHIPPED);
    }
    bar.set_message("checking claims");
    let claims = claims::check(&base, &runs)?;
    bar.inc(1);
    bar.finish_and_clear();

    let enhanced = runs
        .iter()
        .map(|run| &run.summary)
        .filter(|run| run.law == LawKind::EnhancedSfa)
        .map(Subject::from);
    let mut checked = options.expectations.check(options.strict_passive, enhanced);
    let runs = [runs, ships].concat();
    let plotted: Vec<Run> = runs
        .iter()
        .filter(|run| run.trace.is_some())
        .cloned()
        .collect();
    tell!("{}", table::render(&plotted, Colour::detect()).trim_end());
    tell!("");
    tell!("{} {TDPA_OBSERVES}.", others(&runs));
    tell!("");
    tell!("{}", claims_text(&claims).trim_end());

    let k_critical = 2.0 * base.law.device_damping_n_m_s_per_rad * f64::from(base.timing.rate_hz);
    let section = claims_section(&claims);
    let row_notes = row_notes();
    let scenes: Vec<Scene> = cells
        .into_iter()
        .chain(shipped)
        .map(|cell| cell.scene)
        .collect();
    let input = ReportInput {
        title: "Stiff virtual walls on a knob: five control laws, and what ships",
        intro: "The thesis' comparison in one degree of freedom (§5.1), simulated: a light touch, then a press that is held and released. The first five columns are control laws with the thesis' settings. The last column is the wall that ships: tuned, and followed by the energy guard.",
        command: &command,
        program: program(),
        scenes: &scenes,
        inputs: &[],
        files,
        k_critical: Some(k_critical),
        runs: &runs,
        notes: &notes,
        row_notes: &row_notes,
        sections: &[section],
        live_page: Some(&super::live::page_without_scene()),
    };
    let written = report::write(&input, &options.out)?;
    tell!("");
    tell!(
        "report  {}  ({} runs, {} files, {:.1} MB, {:.1} s)",
        written.page.display(),
        runs.len(),
        written.files.len(),
        written.bytes as f64 / 1e6,
        started.elapsed().as_secs_f64()
    );
    let all = runs.iter().map(|run| &run.summary);
    options.expectations.compare(&mut checked, all)?;
    if json() {
        let mut results = expect::results(&report::json::render(&input), &checked);
        results["claims"] = claims.iter().map(claim).collect();
        results["report"] = written.page.display().to_string().into();
        print(format_args!("{}\n", super::out::json_text(&results)))?;
    }
    checked.conclude()
}

/// Runs the comparison in three degrees of freedom.
fn space(options: &Options) -> Result<ExitCode> {
    let lost = [
        ("--set", !options.sets.is_empty()),
        ("--strict-passive", options.strict_passive),
    ];
    let lost = lost.into_iter().find(|(_, given)| *given);
    let lost = lost.map(|(option, _)| option);
    if let Some(option) = lost.or(options.expectations.first_given()) {
        return Err(Error::Option {
            option: option.to_owned(),
            problem: "does not apply to --dof 3, which has its own settings".to_owned(),
            fix: "leave it out".to_owned(),
        });
    }
    let bar = ProgressBar::new(0).with_style(style());
    if quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    super::thesis_space::main(&options.out, &options.report, &options.space, &bar)
}

/// Converts a claim of the thesis, with the result of its check, to JSON.
fn claim(claim: &claims::Claim) -> serde_json::Value {
    serde_json::json!({
        "name": claim.name,
        "source": claim.source,
        "statement": claim.statement,
        "outcome": claim.outcome.name(),
        "measured": claim.measured,
    })
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template("{msg:16} [{bar:40}] {pos}/{len} runs  {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// One line of text that summarises the runs for which the report has no plot.
fn others(runs: &[Run]) -> String {
    let rest: Vec<&Run> = runs.iter().filter(|run| run.trace.is_none()).collect();
    let same = rest.iter().filter(|run| {
        let twin = runs.iter().find(|other| {
            other.trace.is_some()
                && other.summary.law == run.summary.law
                && other.summary.shown_as == run.summary.shown_as
                && other.summary.k_desired == run.summary.k_desired
        });
        let steady = |run: &Run| run.summary.verdict < Verdict::LimitCycle;
        twin.is_some_and(|twin| steady(twin) == steady(run))
    });
    format!(
        "The same for grips {} and encoders of {} and {} counts: {} of {} further runs agree on what comes to rest.",
        GRIPS.map(|grip| grip.name()).join(", "),
        COUNTS[0],
        COUNTS[1],
        same.count(),
        rest.len()
    )
}

fn claims_text(claims: &[claims::Claim]) -> String {
    let mut text = format!(
        "What the thesis claims in one degree of freedom ({} claims):\n",
        claims.len()
    );
    for claim in claims {
        text += &format!(
            "  {:15} {:24} {}\n",
            claim.outcome.name(),
            claim.name,
            claim.statement
        );
    }
    text
}

fn claims_section(claims: &[claims::Claim]) -> Section {
    Section {
        title: "What the thesis claims, and what the simulation shows".to_owned(),
        folded: true,
        body: vec![
            Block::Text("Each claim is checked against the runs of this report and a few more. A claim that the simulation does not confirm is marked.".to_owned()),
            Block::Table {
                caption: "Claims of the thesis in one degree of freedom".to_owned(),
                header: ["Claim", "Where", "Statement", "Outcome", "Measured"].map(str::to_owned).to_vec(),
                rows: claims
                    .iter()
                    .map(|claim| {
                        vec![
                            claim.name.to_owned(),
                            claim.source.to_owned(),
                            claim.statement.to_owned(),
                            claim.outcome.name().to_owned(),
                            claim.measured.clone(),
                        ]
                    })
                    .collect(),
            },
        ],
    }
}

fn row_notes() -> Vec<(f64, String)> {
    let notes =
        ["5.2", "5.3", "5.4", "5.5 to 5.7"].map(|figure| format!("In the thesis: Fig. {figure}."));
    STIFFNESSES.into_iter().zip(notes).collect()
}
