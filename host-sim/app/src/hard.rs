//! `touchstone hard`: simulates test cases that are numerically difficult, and compares each result with the known right answer.

use super::out;
use super::out::{json, note, quiet, say, tell};
use super::report_options::program;
use std::process::ExitCode;
use touchstone_lab::hard::{Effort, cases, run, table};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::nearest;

/// Exit code if the result of a test case is wrong.
const FAILED: u8 = 3;

/// Options of the command `touchstone hard`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Runs only the cases of this name; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Lists the cases, each with its difficulty and the source of the right answer, and runs none.
    #[arg(long)]
    list: bool,
    /// Simulates 10^9 control periods where the short form has 10^7: minutes instead of seconds.
    #[arg(long)]
    long: bool,
}

/// Runs the command `touchstone hard`.
pub fn main(options: &Options) -> Result<ExitCode> {
    let all = cases();
    let names: Vec<&str> = all.iter().map(|case| case.name).collect();
    for wanted in &options.only {
        if !names.contains(&wanted.as_str()) {
            return Err(Error::Option {
                option: format!("--only {wanted}"),
                problem: "no such case".to_owned(),
                fix: match nearest(wanted, &names) {
                    Some(near) => format!("did you mean {near}?"),
                    None => "touchstone hard --list names them".to_owned(),
                },
            });
        }
    }
    let chosen: Vec<_> = all
        .into_iter()
        .filter(|case| options.only.is_empty() || options.only.iter().any(|name| name == case.name))
        .collect();
    if options.list {
        let entry = |case: &touchstone_lab::hard::Case| serde_json::json!({"name": case.name, "about": case.about, "oracle": case.oracle, "unit": case.unit});
        out::result(
            || serde_json::json!({ "cases": chosen.iter().map(entry).collect::<Vec<_>>() }),
            || {
                for case in &chosen {
                    say!("{:24}{}", case.name, case.about);
                    say!("{:24}by: {}", "", case.oracle);
                }
                Ok(())
            },
        )?;
        return Ok(ExitCode::SUCCESS);
    }
    let effort = Effort { long: options.long };
    // Cases run in parallel and end in any order: progress goes to standard error, and the table is printed in order.
    let found = run(&chosen, effort, program(), |outcome| {
        if !json() && !quiet() {
            note!("{} {:.1} s", outcome.name, outcome.seconds);
        }
    })?;
    if json() {
        say!("{}", super::out::json_text(&serde_json::json!(found)));
    } else if quiet() {
        for outcome in found.cases.iter().filter(|outcome| !outcome.passed) {
            say!("{}", table::line(outcome));
        }
    } else {
        tell!("{}", table::render(&found).trim_end());
    }
    Ok(if found.passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(FAILED)
    })
}
