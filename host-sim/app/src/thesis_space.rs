//! `touchstone thesis --dof 3`: the comparison of §5.2.

use super::out::{json, print, tell};
use super::report_options::{ReportOptions, program};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use touchstone_lab::report::{self, space as page};
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
    bar.set_length(cells.len() as u64 + 1);
    bar.set_message("three axes");
    let refused = |why: touchstone_control::SettingsError| Error::Option {
        option: "--dof 3".to_owned(),
        problem: why.to_string(),
        fix: "report it, no option changes these settings".to_owned(),
    };
    let runs = space::run_all(&cells, || bar.inc(1)).map_err(refused)?;
    bar.set_message("checking claims");
    let claims = space::claims::check(&runs).map_err(refused)?;
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
    let input = page::Input {
        command: &command,
        program: program(),
        files,
        runs: &runs,
        claims: &claims,
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
