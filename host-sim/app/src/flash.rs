//! `touchstone flash`: writes the firmware to a board with probe-rs. With the feature `probe`, the crate probe-rs in this program
//! does the work, otherwise the installed program probe-rs.

pub mod log_printing;
mod mark;
#[cfg_attr(feature = "probe", path = "flash/by_crate.rs")]
#[cfg_attr(not(feature = "probe"), path = "flash/by_program.rs")]
mod means;

use super::interrupt;
use super::out::{path_line, say, tell};
use clap::ValueEnum;
use clap::builder::PossibleValue;
use log_printing::LogPrinting;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::Ordering;
use touchstone_protocol::Board;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;

pub use means::{log, probes, there};

/// Options of the command `touchstone flash`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// The firmware's ELF file; without it, the one shipped with touchstone, else the one that `cargo xtask firmware` built for the
    /// board.
    elf: Option<PathBuf>,
    /// The board to write to.
    #[arg(long)]
    board: BoardName,
    /// The debug probe if there are several: VID:PID or VID:PID:SERIAL, as `touchstone doctor` shows it.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Shows the firmware's log from its start on, as `touchstone log` does, until Ctrl-C.
    #[arg(long)]
    log: bool,
    /// Checks the firmware and says what would be done with it, without a probe and without a board.
    #[arg(long, conflicts_with = "log")]
    dry_run: bool,
    /// Writes firmware even if it names another board, or none.
    #[arg(long)]
    force: bool,
}

/// Firmware to write to a board, and the debug probe through which to write.
#[derive(Debug)]
pub struct Job<'a> {
    /// The board to which the firmware is written.
    pub board: BoardName,
    /// The firmware's ELF file.
    pub elf: PathBuf,
    /// The debug probe that the user named. `None` if the user named none; then the only connected probe is used.
    pub probe: Option<&'a str>,
}

impl<'a> Job<'a> {
    /// Makes a job for the named file, else for the shipped or built firmware. Errors: the file cannot be read, or is not a program
    /// for a 32-bit Arm.
    pub fn new(board: BoardName, elf: Option<PathBuf>, probe: Option<&'a str>) -> Result<Self> {
        let elf = elf.unwrap_or_else(|| board.program());
        let job = Self { board, elf, probe };
        job.check()?;
        Ok(job)
    }

    /// Name of the board's chip, as probe-rs calls it.
    pub const fn chip(&self) -> &'static str {
        self.board.0.chip()
    }

    /// An error about the firmware file of this job, with a remedy.
    pub fn wrong(&self, problem: impl Into<String>) -> Error {
        Error::Io {
            path: self.elf.clone(),
            problem: problem.into(),
            fix: format!(
                "take touchstone and its folder `firmware` from one archive, or build it: cargo xtask firmware --board {}, or name an ELF file",
                self.board.name()
            ),
        }
    }

    /// Checks that the firmware names the board of this job. Error: it names another board, or none.
    fn is_this_boards(&self) -> Result<()> {
        let file = self.read()?;
        let (board, marks) = (self.board.name(), mark::boards(&file));
        if marks.iter().any(|mark| mark == board) {
            return Ok(());
        }
        let problem = match &marks[..] {
            [] => format!("does not name its board, so it may not be for {board}"),
            marks => format!("is the program of {}, not of {board}", marks.join(", ")),
        };
        Err(Error::Io {
            path: self.elf.clone(),
            problem,
            fix: "build or name the program of this board, or write this one anyway with `touchstone flash --force`".to_owned(),
        })
    }

    /// Reads the program's file.
    pub(super) fn read(&self) -> Result<Vec<u8>> {
        input::bytes(&self.elf, input::MOST_OF_RESULTS).map_err(|error| match error.kind() {
            ErrorKind::NotFound => self.wrong("there is no such program"),
            _ => self.wrong(error.to_string()),
        })
    }

    /// Checks that the file is a program for a 32-bit Arm, before anything on the board is erased.
    fn check(&self) -> Result<()> {
        /// First bytes of an ELF file: magic number, 32-bit format, little-endian.
        const START: &[u8] = b"\x7fELF\x01\x01";
        /// Machine number of Arm in an ELF file.
        const ARM: &[u8] = &[40, 0];
        let file = self.read()?;
        if file.starts_with(START) && file.get(18..20) == Some(ARM) {
            Ok(())
        } else {
            Err(self.wrong("is not an ELF program for a 32-bit Arm"))
        }
    }
}

/// A supported board, by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardName(pub Board);

impl ValueEnum for BoardName {
    fn value_variants<'a>() -> &'a [Self] {
        static NAMES: LazyLock<[BoardName; Board::ALL.len()]> =
            LazyLock::new(|| Board::ALL.map(BoardName));
        &*NAMES
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()).help(self.0.parts()))
    }
}

impl BoardName {
    /// The board's name on the command line.
    pub const fn name(self) -> &'static str {
        self.0.name()
    }

    /// Path of the board's firmware: the file shipped with this program, else the file that `cargo xtask firmware` builds.
    pub fn program(self) -> PathBuf {
        self.shipped().unwrap_or_else(|| {
            let folder = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
            self.below(Path::new(&folder))
        })
    }

    /// Path of the firmware beside this program, as in an archive of `cargo xtask dist`, so that their versions agree; `None` if
    /// there is none.
    pub fn shipped(self) -> Option<PathBuf> {
        let beside = std::env::current_exe().ok()?.canonicalize().ok()?;
        let program = self.below(beside.parent()?);
        program.is_file().then_some(program)
    }

    fn below(self, folder: &Path) -> PathBuf {
        let firmware = folder.join("firmware");
        firmware.join(self.name()).join("touchstone.elf")
    }
}

/// Runs the command `touchstone flash`.
pub fn main(options: &Options) -> Result<()> {
    let job = Job::new(options.board, options.elf.clone(), options.probe.as_deref())?;
    if !options.force {
        job.is_this_boards()?;
    }
    if options.dry_run {
        say!("{} into {}", path_line(&job.elf), job.chip());
        means::rehearse(&job)?;
        say!("nothing was written");
        return Ok(());
    }
    if !options.log && !means::IS_CRATE {
        return into(&job, None);
    }
    // Ctrl-C waits for the end of writing: a board with half a program is worse than a delay.
    let log = LogPrinting::until(interrupt::noted()?);
    into(&job, options.log.then_some(&log))?;
    if !options.log && log.stop.load(Ordering::Relaxed) {
        eprintln!("interrupted after the program was written; it is complete and runs");
        std::process::exit(interrupt::INTERRUPTED);
    }
    Ok(())
}

/// Writes the board's shipped firmware to the board, or the built one if none is shipped.
pub fn write(board: BoardName) -> Result<()> {
    let job = Job::new(board, None, None)?;
    job.is_this_boards()?;
    into(&job, None)
}

fn into(job: &Job<'_>, log: Option<&LogPrinting>) -> Result<()> {
    tell!("{} into {}", path_line(&job.elf), job.chip());
    means::write(job, log)
}

/// Prints that the firmware was written.
fn written() -> Result<()> {
    tell!("flashed, verified and started");
    Ok(())
}
