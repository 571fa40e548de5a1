//! `touchstone log`: prints the log messages of the firmware on a board, read through its debug probe.

use super::flash::log_printing::LogPrinting;
use super::flash::{self, BoardName, Job};
use super::{interrupt, number};
use std::path::PathBuf;
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

/// Runs `touchstone log`.
pub fn main(options: &Options) -> Result<()> {
    let job = Job::new(options.board, options.elf.clone(), options.probe.as_deref())?;
    let log = LogPrinting {
        locations: options.locations,
        seconds: options.seconds,
        ..LogPrinting::until(interrupt::noted()?)
    };
    flash::log(&job, &log)
}
