//! `touchstone log`: prints the log messages of the firmware on a board, read through its debug probe.

use super::flash::{self, BoardName, Job};
use super::{interrupt, number, out};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use touchstone_sim::error::Result;

/// Options of `touchstone log`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// ELF file of the firmware on the board; without it, the one that `touchstone flash` would write.
    elf: Option<PathBuf>,
    /// Name of the board.
    #[arg(long)]
    board: BoardName,
    /// Debug probe, if several are connected: VID:PID or VID:PID:SERIAL, as `touchstone doctor` shows it.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Prints the source file and line of each message (the external program probe-rs always does).
    #[arg(long)]
    locations: bool,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    seconds: Option<f64>,
}

/// State of the log while the program prints it.
#[derive(Debug)]
pub struct Log {
    /// True after Ctrl-C; printing then ends.
    pub stop: Arc<AtomicBool>,
    /// Time at which the log was opened.
    pub begun: Instant,
    /// Whether each message is printed with its source file and line.
    #[cfg_attr(
        not(feature = "probe"),
        expect(dead_code, reason = "the program says them always")
    )]
    pub locations: bool,
    seconds: Option<f64>,
}

impl Log {
    /// Creates a log that ends when `stop` is set.
    pub fn until(stop: Arc<AtomicBool>) -> Self {
        Self {
            stop,
            begun: Instant::now(),
            locations: false,
            seconds: None,
        }
    }

    /// Whether to continue printing: the stop flag is not set, the time limit has not passed, and standard output is still open.
    pub fn goes_on(&self) -> bool {
        let elapsed_s = self.begun.elapsed().as_secs_f64();
        !self.stop.load(Ordering::Relaxed)
            && out::is_read()
            && self.seconds.is_none_or(|seconds| elapsed_s < seconds)
    }
}

/// Runs `touchstone log`.
pub fn main(options: &Options) -> Result<()> {
    let job = Job::new(options.board, options.elf.clone(), options.probe.as_deref())?;
    let log = Log {
        locations: options.locations,
        seconds: options.seconds,
        ..Log::until(interrupt::noted()?)
    };
    flash::log(&job, &log)
}
