//! `touchstone log`: the log of the program on a board, through its probe.

use super::flash::{self, BoardName, Job};
use super::{interrupt, number, out};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use touchstone_sim::error::Result;

/// Options of `log`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// The program that runs there; without it, the one that `touchstone flash` would write.
    elf: Option<PathBuf>,
    /// The board.
    #[arg(long)]
    board: BoardName,
    /// The probe if there are several: VID:PID or VID:PID:SERIAL, as `touchstone doctor` shows it.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Says of each message where in the sources it stands (the program probe-rs always does).
    #[arg(long)]
    locations: bool,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    seconds: Option<f64>,
}

/// A log that is being shown.
#[derive(Debug)]
pub struct Log {
    /// Set by Ctrl-C.
    pub stop: Arc<AtomicBool>,
    /// Time at which the log was opened.
    pub begun: Instant,
    /// Whether messages come with their places in the sources.
    #[cfg_attr(
        not(feature = "probe"),
        expect(dead_code, reason = "the program says them always")
    )]
    pub locations: bool,
    seconds: Option<f64>,
}

impl Log {
    /// A log that ends when this flag is set.
    pub fn until(stop: Arc<AtomicBool>) -> Self {
        Self {
            stop,
            begun: Instant::now(),
            locations: false,
            seconds: None,
        }
    }

    /// Whether to go on: the log is still wanted, and standard output is still read.
    pub fn goes_on(&self) -> bool {
        let elapsed_s = self.begun.elapsed().as_secs_f64();
        !self.stop.load(Ordering::Relaxed)
            && out::is_read()
            && self.seconds.is_none_or(|seconds| elapsed_s < seconds)
    }
}

/// Runs the command.
pub fn main(options: &Options) -> Result<()> {
    let job = Job::new(options.board, options.elf.clone(), options.probe.as_deref())?;
    let log = Log {
        locations: options.locations,
        seconds: options.seconds,
        ..Log::until(interrupt::noted()?)
    };
    flash::log(&job, &log)
}
