//! `touchstone flash`: the firmware into a board. The work is done by probe-rs: with the feature `probe` by the crate, which is then in
//! this program, otherwise by the program of that name.

mod mark;
#[cfg_attr(feature = "probe", path = "flash/by_crate.rs")]
#[cfg_attr(not(feature = "probe"), path = "flash/by_program.rs")]
mod means;

use super::interrupt;
use super::log::Log;
use super::out::{say, tell};
use clap::ValueEnum;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use touchstone_protocol::Board;
use touchstone_sim::error::{Error, Result};

pub use means::{log, probes, there};

/// Options of `flash`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// The program; without it, the one that came with touchstone, else what `cargo xtask firmware` built for the board.
    elf: Option<PathBuf>,
    /// The board.
    #[arg(long)]
    board: BoardName,
    /// The probe if there are several: VID:PID or VID:PID:SERIAL, as `touchstone doctor` shows it.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Shows the program's log from its start on, as `touchstone log` does, until Ctrl-C.
    #[arg(long)]
    log: bool,
    /// Checks the program and says what would be done with it, without a probe and without a board.
    #[arg(long, conflicts_with = "log")]
    dry_run: bool,
    /// Writes a program that says another board's name, or none.
    #[arg(long)]
    force: bool,
}

/// A program for a board, and through which probe it is reached.
#[derive(Debug)]
pub struct Job<'a> {
    /// The board.
    pub board: BoardName,
    /// The program's ELF file.
    pub elf: PathBuf,
    /// The probe, if it is named.
    pub probe: Option<&'a str>,
}

impl<'a> Job<'a> {
    /// A job for the named file, or the board's own program, which is checked first.
    pub fn new(board: BoardName, elf: Option<PathBuf>, probe: Option<&'a str>) -> Result<Self> {
        let elf = elf.unwrap_or_else(|| board.program());
        let job = Self { board, elf, probe };
        job.check()?;
        Ok(job)
    }

    /// The chip, as probe-rs calls it.
    pub const fn chip(&self) -> &'static str {
        self.board.board().chip()
    }

    /// An error about this file.
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

    /// Whether the program says that it is this board's.
    fn is_this_boards(&self) -> Result<()> {
        let file = self.read()?;
        let (board, marks) = (self.board.name(), mark::boards(&file));
        if marks.iter().any(|mark| mark == board) {
            return Ok(());
        }
        let problem = match &marks[..] {
            [] => format!("does not say which board it is for, so not that it is {board}'s"),
            marks => format!("is the program of {}, not of {board}", marks.join(", ")),
        };
        Err(Error::Io {
            path: self.elf.clone(),
            problem,
            fix: "build or name the board's own program, or write this one nevertheless by `touchstone flash --force`".to_owned(),
        })
    }

    fn read(&self) -> Result<Vec<u8>> {
        std::fs::read(&self.elf).map_err(|error| match error.kind() {
            ErrorKind::NotFound => self.wrong("there is no such program"),
            _ => self.wrong(error.to_string()),
        })
    }

    /// Whether it is a program for a Cortex-M, before anything is erased.
    fn check(&self) -> Result<()> {
        /// Magic, 32 bits, little-endian.
        const START: &[u8] = b"\x7fELF\x01\x01";
        /// Machine number of Arm in an ELF file.
        const ARM: &[u8] = &[40, 0];
        let file = self.read()?;
        if file.starts_with(START) && file.get(18..20) == Some(ARM) {
            Ok(())
        } else {
            Err(self.wrong("is no ELF program for a 32-bit Arm"))
        }
    }
}

/// The boards by their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BoardName {
    /// NUCLEO-G474RE with an X-NUCLEO-IHM08M1.
    #[value(name = "nucleo-g474re")]
    NucleoG474re,
    /// B-G431B-ESC1.
    #[value(name = "b-g431b-esc1")]
    BG431bEsc1,
    /// NUCLEO-G474RE with an X-NUCLEO-IHM16M1.
    #[value(name = "nucleo-g474re-ihm16m1")]
    NucleoG474reIhm16m1,
    /// NUCLEO-G474RE with a SimpleFOC Mini.
    #[value(name = "nucleo-g474re-simplefoc-mini")]
    NucleoG474reSimplefocMini,
    /// NUCLEO-G431RB with an X-NUCLEO-IHM16M1.
    #[value(name = "nucleo-g431rb-ihm16m1")]
    NucleoG431rbIhm16m1,
}

impl BoardName {
    /// The board's name on the wire.
    pub const fn board(self) -> Board {
        match self {
            Self::NucleoG474re => Board::NucleoG474re,
            Self::BG431bEsc1 => Board::BG431bEsc1,
            Self::NucleoG474reIhm16m1 => Board::NucleoG474reIhm16m1,
            Self::NucleoG474reSimplefocMini => Board::NucleoG474reSimplefocMini,
            Self::NucleoG431rbIhm16m1 => Board::NucleoG431rbIhm16m1,
        }
    }

    /// The board's name on the command line.
    pub const fn name(self) -> &'static str {
        self.board().name()
    }

    /// The board's program: the one that came with this program, else where `cargo xtask firmware` puts it.
    pub fn program(self) -> PathBuf {
        self.shipped().unwrap_or_else(|| {
            let folder = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
            self.below(Path::new(&folder))
        })
    }

    /// The board's program in an archive of `cargo xtask dist`, beside this program: both are of one version.
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
        say!("{} into {}", job.elf.display(), job.chip());
        means::rehearse(&job)?;
        say!("nothing was written");
        return Ok(());
    }
    if !options.log && !means::IS_CRATE {
        return into(&job, None);
    }
    // A flash that is half written is worse than one that is written a second later.
    let log = Log::until(interrupt::noted()?);
    into(&job, options.log.then_some(&log))?;
    if !options.log && log.stop.load(Ordering::Relaxed) {
        eprintln!("interrupted, after the program was written: it is whole, and runs");
        std::process::exit(interrupt::INTERRUPTED);
    }
    Ok(())
}

/// Writes what there is for a board.
pub fn write(board: BoardName) -> Result<()> {
    let job = Job::new(board, None, None)?;
    job.is_this_boards()?;
    into(&job, None)
}

fn into(job: &Job<'_>, log: Option<&Log>) -> Result<()> {
    tell!("{} into {}", job.elf.display(), job.chip());
    means::write(job, log)
}

/// Prints that the program is written.
fn written() -> Result<()> {
    tell!("flashed, verified and started");
    Ok(())
}
