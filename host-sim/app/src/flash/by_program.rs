//! Writes firmware to a board and shows its log, through the installed program probe-rs, whose progress is shown unchanged.

use super::log_printing::LogPrinting;
use super::{Job, written};
use crate::out::{path_line, say, tell};
use std::ffi::OsStr;
use std::io::{Error as IoError, ErrorKind};
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::Duration;
use touchstone_sim::error::{Error, Result};

/// Whether flashing works without another installed program.
pub const IS_CRATE: bool = false;
/// Text on how to install probe-rs.
const INSTALL: &str = "install it from https://probe.rs/docs/getting-started/installation, or with `cargo install probe-rs-tools --locked`. A program made by `cargo xtask dist` does not need it";

/// Name and version of the installed probe-rs, as it prints them. Error: the problem, and how to install probe-rs.
pub fn there() -> std::result::Result<String, (String, String)> {
    asked(&["--version"]).ok_or_else(|| ("not on the PATH".to_owned(), INSTALL.to_owned()))
}

/// The lines that probe-rs prints on the connected debug probes; empty without a probe, `None` if probe-rs cannot run.
pub fn probes() -> Option<Vec<String>> {
    let line = asked(&["list"])?;
    match line.contains("No debug probes") {
        true => Some(Vec::new()),
        false => Some(vec![line]),
    }
}

/// Runs the installed probe-rs with these arguments and returns the first line of its output; `None` if it fails.
fn asked(words: &[&str]) -> Option<String> {
    let Output { status, stdout, .. } = Command::new("probe-rs").args(words).output().ok()?;
    let line = String::from_utf8(stdout)
        .ok()?
        .lines()
        .next()?
        .trim()
        .to_owned();
    (status.success() && !line.is_empty()).then_some(line)
}

/// Prints the commands that [`write()`] would run.
pub fn rehearse(job: &Job<'_>) -> Result<()> {
    for command in [download(job), command("reset", job)] {
        let words: Vec<_> = std::iter::once(command.get_program())
            .chain(command.get_args())
            .map(OsStr::to_string_lossy)
            .collect();
        say!("{}", words.join(" "));
    }
    Ok(())
}

/// Writes the firmware to the board and starts it. With `log`, shows the firmware's log afterwards.
pub fn write(job: &Job<'_>, log: Option<&LogPrinting>) -> Result<()> {
    done(&mut download(job))?;
    done(&mut command("reset", job))?;
    written()?;
    log.map_or(Ok(()), |log| self::log(job, log))
}

/// Shows the log of the firmware that runs on the board.
pub fn log(job: &Job<'_>, log: &LogPrinting) -> Result<()> {
    tell!("{}; Ctrl-C ends it", path_line(&job.elf));
    let mut child = command("attach", job)
        .arg(&job.elf)
        .spawn()
        .map_err(|error| not_run(&error))?;
    loop {
        let ended = child.try_wait().map_err(|error| not_run(&error))?;
        if !log.goes_on() {
            // Ctrl-C reaches probe-rs, too.
            let _ = child.kill();
            let _ = child.wait();
            return Ok(());
        }
        match ended {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(failed(&status.to_string())),
            None => sleep(Duration::from_millis(20)),
        }
    }
}

fn download(job: &Job<'_>) -> Command {
    let mut command = command("download", job);
    command.arg("--verify").arg(&job.elf);
    command
}

/// A call of a command of probe-rs, with the chip of the board and the probe of the job.
fn command(what: &str, job: &Job<'_>) -> Command {
    let mut command = Command::new("probe-rs");
    command.args([what, "--chip", job.chip()]);
    if let Some(probe) = job.probe {
        command.args(["--probe", probe]);
    }
    command
}

/// Runs probe-rs to its end. Its messages go to the terminal directly.
fn done(command: &mut Command) -> Result<()> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(failed(&status.to_string())),
        Err(error) => Err(not_run(&error)),
    }
}

fn failed(status: &str) -> Error {
    Error::device(
        "probe-rs",
        format!("ended with {status}"),
        "see its message above; `touchstone doctor` shows what is missing",
    )
}

fn not_run(error: &IoError) -> Error {
    let problem = match error.kind() {
        ErrorKind::NotFound => "is not on the PATH".to_owned(),
        _ => format!("cannot be run: {error}"),
    };
    Error::device("probe-rs", problem, INSTALL)
}
