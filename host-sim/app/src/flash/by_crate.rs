//! Writes firmware to a board and shows its log, through the crate probe-rs, which is compiled into this program.

use super::log_printing::LogPrinting;
use super::{Job, written};
use crate::out::{note, path_line, say, tell};
use crate::progress;
use indicatif::ProgressBar;
use touchstone_probe::{
    Attached, Event, Fault, Image, LIBRARY, Line, Lister, Phase, Step, Words, attach, choose,
};
use touchstone_sim::error::{Error, Result};

/// Whether flashing works without another installed program.
pub const IS_CRATE: bool = true;

/// Names the library that writes to the board. It is compiled in, so the result is never an error.
pub fn there() -> std::result::Result<String, (String, String)> {
    Ok(format!("{LIBRARY}, in this program"))
}

/// The connected debug probes, one line for each.
pub fn probes() -> Option<Vec<String>> {
    let found = choose::found(&Lister::new());
    let line =
        |probe: &touchstone_probe::ConnectedProbe| format!("{} {}", probe.name, probe.selector);
    Some(found.iter().map(line).collect())
}

/// Prints what [`write()`] would do, without a probe.
pub fn rehearse(job: &Job<'_>) -> Result<()> {
    let image = image(job, &job.read()?)?;
    let begin = image.ranges().next().map_or(0, |(begin, _)| begin);
    let end = image.ranges().last().map_or(0, |(_, end)| end);
    say!(
        "{} bytes between {begin:#010x} and {end:#010x}, read back and started, by {LIBRARY} in this program",
        image.size_bytes()
    );
    Ok(())
}

/// Writes the firmware to the board, reads it back to compare, and starts it. With `log`, shows the firmware's log afterwards.
pub fn write(job: &Job<'_>, log: Option<&LogPrinting>) -> Result<()> {
    let elf = job.read()?;
    let image = image(job, &elf)?;
    let words = log.map(|_| words(job, &elf)).transpose()?;
    let mut attached = attached(job)?;
    let mut bar: Option<ProgressBar> = None;
    let step = |step: Step| match step {
        Step::Begins(phase, total) => {
            let words = match phase {
                Phase::Erase => "erasing",
                Phase::Program => "writing",
                Phase::Verify => "comparing",
            };
            bar = Some(progress::bar(total.unwrap_or(0), words));
        }
        Step::Done(_, bytes) => {
            if let Some(bar) = &bar {
                bar.inc(bytes);
            }
        }
        Step::Ends(_) => {
            if let Some(bar) = bar.take() {
                bar.finish_and_clear();
            }
        }
    };
    attached.write(&image, step).map_err(error)?;
    attached.start().map_err(error)?;
    written()?;
    match (log, &words) {
        (Some(log), Some(words)) => shown(&mut attached, &image, words, log),
        _ => Ok(()),
    }
}

/// Shows the log of the firmware that runs on the board.
pub fn log(job: &Job<'_>, log: &LogPrinting) -> Result<()> {
    let elf = job.read()?;
    let (image, words) = (image(job, &elf)?, words(job, &elf)?);
    let mut attached = attached(job)?;
    tell!("{}", path_line(&job.elf));
    shown(&mut attached, &image, &words, log)
}

fn image(job: &Job<'_>, elf: &[u8]) -> Result<Image> {
    Image::read(elf, job.chip()).map_err(|problem| job.wrong(problem))
}

fn words(job: &Job<'_>, elf: &[u8]) -> Result<Words> {
    Words::read(elf).map_err(|problem| job.wrong(problem))
}

fn attached(job: &Job<'_>) -> Result<Attached> {
    choose::open(&Lister::new(), job.probe)
        .and_then(|probe| attach(probe, job.chip()))
        .map_err(error)
}

fn error(fault: Fault) -> Error {
    let Fault {
        place,
        problem,
        fix,
        asked,
    } = fault;
    match asked {
        true => Error::Option {
            option: place,
            problem,
            fix,
        },
        false => Error::Device {
            place,
            problem,
            fix,
        },
    }
}

/// Prints the lines of the log until `log` says to stop.
fn shown(attached: &mut Attached, image: &Image, words: &Words, log: &LogPrinting) -> Result<()> {
    tell!("seconds since this log began, or the board's own time; Ctrl-C ends it");
    let mut printed = Ok(());
    let tell = |event| match event {
        Event::Line(line) => {
            if printed.is_ok() {
                printed = print(&line, log);
            }
        }
        Event::Damaged => note!("note: a message was damaged or lost"),
        Event::Restarted => note!("note: the board restarted"),
    };
    attached
        .log(image, words, tell, || log.goes_on())
        .map_err(error)?;
    printed
}

fn print(line: &Line, log: &LogPrinting) -> Result<()> {
    let Line {
        time,
        level,
        text,
        location,
    } = line;
    let time = match time {
        Some(time) => time.clone(),
        None => format!("{:.3}", log.begun.elapsed().as_secs_f64()),
    };
    let location = match location {
        Some(location) if log.locations => format!("  ({location})"),
        _ => String::new(),
    };
    say!("{time:>10} {:5} {text}{location}", level.unwrap_or(""));
    Ok(())
}
