//! `cargo xtask prove --certified [NAME]`: harnesses again, with a certificate of every "no" of the solver, checked by another program.
//!
//! What a harness claims is that a formula has no solution. Here kissat is asked for a DRAT certificate of that, whatever solver the
//! harness names, and drat-trim, which shares nothing with it, checks the certificate against the formula. An answer whose certificate is
//! not verified is withheld from the checker, so that the harness has none. A solution (a cover that is reached) is no claim of the
//! solver alone: the checker builds its trace from it.
//!
//! What stays trusted: that the checker makes the right formula of the code, and drat-trim. Harnesses by cvc5, whose formulas are of
//! integers, have no such certificate.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::checker::{self, How, Which};
use super::{JOBS, LOCK, PARTS};
use crate::memo::Memo;
use crate::outcome::Outcome;
use crate::{changes, inspect, shell};

/// The program that stands in the place of the solver.
const NAME: &str = "touchstone-certified";
/// Where the solver of each harness stands, as the last whole run had it.
const TABLE: &str = "proofs/README.md";
/// Processor time of each process, in seconds: to check a certificate may take longer than to find it.
const PROCESS_S: u32 = 900;
/// Harnesses of a part of a run that is taken up again.
const AT_A_TIME: usize = 12;
const INSTALL: &str = "a C compiler makes it of one file: https://github.com/marijnheule/drat-trim";

/// The command: those of the lock whose names contain `part`.
pub fn run(part: &str) -> Outcome {
    for (program, how) in [("kissat", "apt-get install kissat"), ("drat-trim", INSTALL)] {
        if on_path(program).is_none() {
            return Outcome::NotRun(format!("{program} is not on the PATH; {how}"));
        }
    }
    if !super::has_checker() {
        return Outcome::NotRun(super::INSTALL.into());
    }
    match asked(part) {
        Ok((certified, asked, log)) => {
            let text = format!(
                "{certified} of {asked} harnesses proved with every certificate verified; {log}"
            );
            match certified == asked && asked > 0 {
                true => Outcome::Ok(text),
                false => Outcome::Failed(text),
            }
        }
        Err(why) => Outcome::Failed(why),
    }
}

fn on_path(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let mut files = std::env::split_paths(&path).map(|folder| folder.join(program));
    files.find(|file| file.is_file())
}

/// How many were certified, now and before on the same sources, of how many; and what the solver was asked in this run.
fn asked(part: &str) -> Result<(usize, usize, String), String> {
    let read = |file: &str| std::fs::read_to_string(file).map_err(|why| format!("{file}: {why}"));
    let (lock, table) = (read(LOCK)?, read(TABLE)?);
    let names = by_formula(&lock, &table, part);
    if names.is_empty() {
        return Err(format!(
            "no harness by a SAT solver has `{part}` in its name"
        ));
    }
    let folder = shell::target("certified");
    std::fs::create_dir_all(&folder).map_err(|why| format!("{}: {why}", folder.display()))?;
    let folder = folder
        .canonicalize()
        .map_err(|why| format!("{}: {why}", folder.display()))?;
    let work = changes::copy(&folder, &PARTS, &[])?;
    let said = |why: std::io::Error| format!("{}: {why}", folder.display());
    let mut memo = Memo::open(folder.join("found.tsv"), &work, None).map_err(said)?;
    let log = folder.join("answers.txt");
    std::fs::write(&log, "").map_err(said)?;
    let solver = solver(&folder, &log)?;
    let left: Vec<String> = names
        .iter()
        .filter(|name| memo.get(memo.key(name)).is_none())
        .cloned()
        .collect();
    println!(
        "{} of {} certified before",
        names.len() - left.len(),
        names.len()
    );
    let how = How {
        jobs: JOBS,
        progress: true,
        process_s: PROCESS_S,
        solver: Some((&solver, NAME)),
    };
    for names in left.chunks(AT_A_TIME) {
        let left = checker::run(&work, &folder.join("kani"), Which::These(names), how)?;
        let (proved, _) = inspect::ask(["proved".as_ref(), left.report.as_os_str()]);
        let proved: BTreeSet<String> = proved.into_iter().collect();
        for name in names {
            if proved.contains(name) {
                memo.keep(memo.key(name), "certified", "").map_err(said)?;
            } else {
                println!("not certified: {name}");
            }
        }
    }
    let certified = names
        .iter()
        .filter(|name| memo.get(memo.key(name)).is_some());
    let answers = std::fs::read_to_string(&log).unwrap_or_default();
    Ok((certified.count(), names.len(), counted(&answers)))
}

/// Those of the lock that a solver of formulas answers, not one of integers.
fn by_formula(lock: &str, table: &str, part: &str) -> Vec<String> {
    let names = lock.lines().filter_map(|line| line.split(' ').next());
    let is_of_integers = |name: &str| {
        let short = name.strip_suffix("::proof").unwrap_or(name);
        let row = table
            .lines()
            .find(|row| row.contains(&format!("`{short}`")));
        row.is_some_and(|row| row.contains("| cvc5 |"))
    };
    let wanted = names.filter(|name| name.contains(part) && !is_of_integers(name));
    wanted.map(str::to_owned).collect()
}

/// What the solver answered, from its log.
fn counted(answers: &str) -> String {
    let (mut verified, mut solutions, mut without, mut bytes) = (0, 0, 0, 0_u64);
    for line in answers.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["verified", size] => {
                verified += 1;
                bytes += size.parse::<u64>().unwrap_or(0);
            }
            ["solution"] => solutions += 1,
            _ => without += 1,
        }
    }
    format!(
        "in this run {verified} certificates of {} MB verified, {solutions} solutions, {without} without an answer",
        bytes / 1_000_000
    )
}

/// Writes the program that asks for the certificate and has it checked; the folder that it is in.
fn solver(folder: &Path, log: &Path) -> Result<PathBuf, String> {
    let place = folder.join("solver");
    let said = |why: std::io::Error| format!("{}: {why}", place.display());
    std::fs::create_dir_all(&place).map_err(said)?;
    let file = place.join(NAME);
    let mut text = String::from("#!/bin/sh\n");
    let _ = writeln!(text, "log='{}'", log.display());
    text += SCRIPT;
    std::fs::write(&file, text).map_err(said)?;
    let mut chmod = std::process::Command::new("chmod");
    match chmod.arg("+x").arg(&file).status() {
        Ok(status) if status.success() => Ok(place),
        _ => Err(format!("{}: cannot be made a program", file.display())),
    }
}

/// kissat ends with 10 for a solution, with 20 for none; what it prints reaches the checker only then. drat-trim's lines begin with the
/// return that overwrites its progress.
const SCRIPT: &str = r#"if [ "$1" = --version ]; then exec kissat --version; fi
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
kissat -q "$1" "$folder/proof" > "$folder/answer"
code=$?
case $code in
  10) echo solution >> "$log" ;;
  20)
    if drat-trim "$1" "$folder/proof" -w 2>/dev/null | tr '\r' '\n' | grep -qx 's VERIFIED'; then
      echo "verified $(wc -c < "$folder/proof")" >> "$log"
    else
      echo 'no certificate' >> "$log"
      exit 1
    fi
    ;;
  *)
    echo "kissat ended with $code" >> "$log"
    exit 1
    ;;
esac
cat "$folder/answer"
exit $code
"#;

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn integers_have_no_certificate() {
        let lock = "a::w8::p1_x::proof 12\na::w32::p1_x::proof 34\nb::p2_y::proof 56\n";
        let table = "| P1 | `a::w32::p1_x` | 32 | cvc5 | 1 |\n| P1 | `a::w8::p1_x` | 8 | kissat | 1 |\n| `b::p2_y` | 8 | cadical |\n";
        assert_eq!(
            by_formula(lock, table, ""),
            ["a::w8::p1_x::proof", "b::p2_y::proof"]
        );
        assert_eq!(by_formula(lock, table, "p2"), ["b::p2_y::proof"]);
    }

    /// Of a solver that ends with `code` and a checker of certificates that says `verdict`: what comes out, how it ends, what is written
    /// down.
    fn ended(code: u8, verdict: &str) -> (String, Option<i32>, String) {
        let folder = shell::target("certified-test").join(format!("{code}{}", verdict.len()));
        let programs = folder.join("programs");
        std::fs::create_dir_all(&programs).expect("a folder");
        let log = folder.join("answers.txt");
        std::fs::write(&log, "").expect("a log");
        for (name, text) in [
            (
                "kissat",
                format!("printf 12345 > \"$3\"; echo s ANSWER; exit {code}"),
            ),
            (
                "drat-trim",
                format!("echo 'c words'; printf '\\r{verdict}\\n\\rc time\\n'"),
            ),
        ] {
            let file = programs.join(name);
            std::fs::write(&file, format!("#!/bin/sh\n{text}\n")).expect("a program");
            let chmod = Command::new("chmod").arg("+x").arg(&file).status();
            assert!(chmod.is_ok_and(|it| it.success()));
        }
        let place = solver(&folder, &log).expect("a solver");
        let path = std::env::var_os("PATH").unwrap_or_default();
        let all = std::iter::once(programs).chain(std::env::split_paths(&path));
        let done = Command::new(place.join(NAME))
            .arg("x.cnf")
            .env("PATH", std::env::join_paths(all).expect("a path"))
            .output()
            .expect("it runs");
        let log = std::fs::read_to_string(&log).expect("a log");
        let out = String::from_utf8_lossy(&done.stdout).into_owned();
        (out, done.status.code(), log)
    }

    #[test]
    fn an_answer_without_a_verified_certificate_is_withheld() {
        let (out, code, log) = ended(20, "s VERIFIED");
        assert_eq!(
            (&*out, code, &*log),
            ("s ANSWER\n", Some(20), "verified 5\n")
        );
        assert_eq!(
            counted(&log),
            "in this run 1 certificates of 0 MB verified, 0 solutions, 0 without an answer"
        );
        let (out, code, log) = ended(20, "s NOT VERIFIED");
        assert_eq!((&*out, code, &*log), ("", Some(1), "no certificate\n"));
        let (out, code, log) = ended(10, "s NOT VERIFIED");
        assert_eq!((&*out, code, &*log), ("s ANSWER\n", Some(10), "solution\n"));
        let (out, code, _) = ended(0, "s VERIFIED");
        assert_eq!((&*out, code), ("", Some(1)));
    }
}
