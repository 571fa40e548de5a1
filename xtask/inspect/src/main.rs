//! Reads files that builds, emulators and the model checker write, for the steps of `cargo xtask`.
//!
//! The launcher `cargo xtask` starts programs and reads none of their files; this program reads files and starts no program. So the
//! crates for reading are built only for steps that need them. Findings go to standard output, with the [`Answer`] as the last
//! line.

mod answer;
#[allow(dead_code, reason = "each of its readers needs some")]
#[path = "../../../firmware/budgets.rs"]
mod budgets;
mod changes;
mod cortex;
mod dist;
mod firmware;
mod floats;
mod proofs;
mod thumb;
mod vectors;

use std::path::Path;
use std::process::ExitCode;

use answer::Answer;
use cortex::ProgramCode;

const USAGE: &str = "xtask-inspect firmware BOARD=ELF... | functions ELF | thumb ELF DESKTOP_LINES MICROCONTROLLER_LINES | \
                     dist FOLDER NAME SECONDS VERSION PROGRAM BOARD=ELF... metadata=FILE... | zip ZIP FOLDER FILE... | \
                     float-source FOLDER | float-code ARCHITECTURE RELEASE_FOLDER CRATE EXAMPLE | changes LIST | \
                     proofs REPORT USAGE MEMORY_KIB PART | proofs REPORT USAGE MEMORY_KIB WORDS_ON_THE_RUN WORDS_ON_THE_MACHINE [--bless] [--resume LIST] | remaining LIST MEMO | refuted REPORT HARNESS | statements LOCK; \
                     `cargo xtask` calls it from the workspace's folder";

fn answer(words: &[&str]) -> Result<Answer, String> {
    let path = Path::new;
    match words {
        ["firmware", programs @ ..] if !programs.is_empty() => firmware::inspect(programs),
        ["thumb", elf, desktop, microcontroller] => thumb::inspect(
            &ProgramCode::open(path(elf))?,
            &text(desktop)?,
            &text(microcontroller)?,
        ),
        ["functions", elf] => Ok(functions(&ProgramCode::open(path(elf))?)),
        ["float-source", folder] => floats::in_source(path(folder)),
        ["float-code", architecture, release, krate, example] => {
            floats::in_code(architecture, path(release), krate, example)
        }
        ["dist", rest @ ..] => match dist::Parts::named(rest) {
            Some(parts) => dist::pack(&parts),
            None => Ok(Answer::Usage(USAGE.into())),
        },
        ["zip", file, folder, names @ ..] => dist::zip(path(file), path(folder), names),
        ["changes", list] => changes::print(&text(list)?).map_err(|why| format!("{list}: {why}")),
        ["proofs", report, usage, memory, rest @ ..] => {
            let run = proofs::Run {
                report: &text(report)?,
                usage: &text(usage)?,
                memory_kib: memory.parse().map_err(|_| USAGE.to_owned())?,
                memo: &path(report).with_file_name("proved.tsv"),
            };
            match rest {
                [part] => proofs::some(&run, part),
                [words, machine] => proofs::whole(&run, words, machine, false, None),
                [words, machine, "--bless"] => proofs::whole(&run, words, machine, true, None),
                [words, machine, "--resume", list] => {
                    proofs::whole(&run, words, machine, false, Some(&text(list)?))
                }
                [words, machine, "--bless", "--resume", list] => {
                    proofs::whole(&run, words, machine, true, Some(&text(list)?))
                }
                _ => Ok(Answer::Usage(USAGE.into())),
            }
        }
        ["remaining", list, memo] => proofs::remaining(&text(list)?, path(memo)),
        ["statements", lock] => proofs::unchanged(&text(lock)?),
        ["refuted", report, harness] => proofs::refuted(&text(report)?, harness),
        _ => Ok(Answer::Usage(USAGE.into())),
    }
}

/// Prints the address, size in bytes and source path of every function in a program.
fn functions(program: &ProgramCode) -> Answer {
    let mut count = 0;
    for (address, name, size) in program.all_functions() {
        println!("{address:#x} {size} {:#}", rustc_demangle::demangle(name));
        count += 1;
    }
    Answer::Right(format!("{count} functions"))
}

fn text(path: &str) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|why| format!("{path}: {why}"))
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    answer(&words).unwrap_or_else(Answer::Wrong).end()
}
