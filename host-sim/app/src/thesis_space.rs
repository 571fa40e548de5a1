//! `touchstone thesis --dof 3`: the comparison of §5.2.

use super::out::{json, print, tell};
use super::report_options::{ReportOptions, program};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use touchstone_lab::report::{self, space as page};
use touchstone_lab::scorecard::measure::Measure;
use touchstone_lab::thesis::space;
use touchstone_sim::error::{Error, Result};

/// Runs it: claims on the terminal, the report in a folder.
pub fn main(out: &Path, options: &ReportOptions, bar: &indicatif::ProgressBar) -> Result<ExitCode> {
    let started = Instant::now();
    let command = super::command_line();
    let files = options.files();
    report::check_folder(out, &command, files.force)?;
    let cells = space::cells();
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
    let cards = space::tuned::cards(&space::tuned::NORMALS).map_err(refused)?;
    bar.inc(1);
    bar.set_message("checking claims");
    let claims = space::claims::check(&runs, &cards).map_err(refused)?;
    bar.inc(1);
    bar.finish_and_clear();
    tell!(
        "What the thesis claims in three degrees of freedom ({} claims):",
        claims.len()
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
    tell!("The tuned law at 25 N/mm, in each direction the worst of nine devices in three hands:");
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
    let input = page::Input {
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
        print(format_args!("{results:#}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}
