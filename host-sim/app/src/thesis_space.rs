//! `touchstone thesis --dof 3`: the thesis' comparison in three degrees of freedom (§5.2).

use super::out::{json, print, tell};
use super::report_options::{ReportOptions, program};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use touchstone_lab::scorecard::measure::Measure;
use touchstone_lab::space_report as page;
use touchstone_lab::thesis::space::held_out::{DRAWS, HeldOut};
use touchstone_lab::thesis::space::tuned_wall::TunedWall;
use touchstone_lab::thesis::space::{self, Mechanism};
use touchstone_report as report;
use touchstone_sim::error::{Error, Result};

/// Options of the comparison in three degrees of freedom.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SpaceOptions {
    /// With --dof 3: cartesian, an omega.3 as three equal axes (default), or delta, a mechanism with a Falcon's arm lengths.
    #[arg(long, value_name = "KIND", value_parser = mechanism)]
    pub mechanism: Option<Mechanism>,
    /// With --dof 3: also simulates the tuned control law on 200 walls, hands and devices drawn from this seed, which the tuning
    /// did not use.
    #[arg(long, value_name = "SEED")]
    pub held_out: Option<u64>,
}

impl SpaceOptions {
    /// Name of the first of these options that the user gave; `None` if the user gave none.
    pub fn any(&self) -> Option<&'static str> {
        let mechanism = self.mechanism.map(|_| "--mechanism");
        mechanism.or(self.held_out.map(|_| "--held-out"))
    }
}

fn mechanism(word: &str) -> std::result::Result<Mechanism, String> {
    let found = Mechanism::ALL.iter().find(|it| it.word() == word);
    found
        .copied()
        .ok_or_else(|| format!("\"{word}\" is not a mechanism; give cartesian or delta"))
}

/// Runs the comparison: prints the checked claims, and writes the report to a folder.
pub fn main(
    out: &Path,
    options: &ReportOptions,
    chosen: &SpaceOptions,
    bar: &indicatif::ProgressBar,
) -> Result<ExitCode> {
    let started = Instant::now();
    let command = super::command_line();
    let files = options.files();
    report::check_folder(out, &command, files.force)?;
    let mechanism = chosen.mechanism.unwrap_or_default();
    let cells = space::cells(mechanism);
    super::interrupt::clean_up()?;
    super::interrupt::sweep(out);
    bar.set_length(cells.len() as u64 + 2);
    bar.set_message("three axes");
    let refused = |why: touchstone_control::SettingsError| Error::Option {
        option: "--dof 3".to_owned(),
        problem: why.to_string(),
        fix: "report it, no option changes these settings".to_owned(),
    };
    let runs = space::run_all(&cells, || bar.inc(1)).map_err(refused)?;
    bar.set_message("every direction");
    let cards =
        space::tuned::cards(mechanism, space::RATE_HZ, &space::tuned::NORMALS).map_err(refused)?;
    bar.inc(1);
    bar.set_message("checking claims");
    let mut claims = space::claims::check(mechanism, &runs, &cards).map_err(refused)?;
    let held_out = match chosen.held_out {
        Some(seed) => Some(HeldOut::played(seed, DRAWS).map_err(refused)?),
        None => None,
    };
    claims.extend(held_out.as_ref().map(HeldOut::claim));
    bar.inc(1);
    bar.finish_and_clear();
    tell!("{}", page::runs_text(&runs));
    tell!(
        "What the thesis claims in three degrees of freedom ({} claims), on {}:",
        claims.len(),
        mechanism.about()
    );
    for claim in &claims {
        tell!(
            "  {:15} {:24} {}",
            claim.outcome.name(),
            claim.name,
            claim.measured
        );
    }
    tell!("");
    tell!(
        "The tuned law at {} N/mm, in each direction the worst of {} devices in three hands:",
        1e-3 * TunedWall::of(mechanism, space::RATE_HZ).k_desired_n_per_m,
        cards.first().map_or(0, |card| card.cells.len())
    );
    tell!(
        "  {:20} {:>6} {:>8} {:>8} {:>8} {:>8} {:>7} {:>8}",
        "direction",
        "peak",
        "settle s",
        "held %",
        "let go %",
        "|F/x| %",
        "phase",
        "ripple N"
    );
    for card in &cards {
        let worst = card.worst();
        let get = |measure| worst.figures.get(measure);
        tell!(
            "  {:20} {:>6.3} {:>8} {:>8.1} {:>8.1} {:>8.1} {:>7.1} {:>8.3}",
            card.at.name,
            get(Measure::PeakPenetrationRatio),
            worst
                .settle_s
                .map_or("never".to_owned(), |s| format!("{s:.3}")),
            100.0 * get(Measure::StiffnessErrorHeld),
            100.0 * get(Measure::StiffnessErrorRelease),
            100.0 * get(Measure::ModulusError),
            get(Measure::PhaseDeg),
            get(Measure::RippleRmsNM)
        );
    }
    if let Some(held_out) = &held_out {
        tell!("");
        tell!("{}", page::held_out_text(held_out).trim_end());
    }
    let input = page::Input {
        mechanism,
        held_out: held_out.as_ref(),
        command: &command,
        program: program(),
        files,
        runs: &runs,
        claims: &claims,
        cards: &cards,
    };
    let written = page::write(&input, out)?;
    tell!("");
    tell!(
        "report  {}  ({} runs, {:.1} MB, {:.1} s)",
        written.page.display(),
        runs.len(),
        written.bytes as f64 / 1e6,
        started.elapsed().as_secs_f64()
    );
    if json() {
        let mut results = page::results(&input);
        results["report"] = written.page.display().to_string().into();
        print(format_args!("{}\n", super::out::json_text(&results)))?;
    }
    Ok(ExitCode::SUCCESS)
}
