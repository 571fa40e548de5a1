//! `touchstone flash`: the firmware into a board. The work is done by probe-rs; its progress is shown as it is.

use super::out::{say, tell};
use clap::ValueEnum;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;
use touchstone_protocol::Board;
use touchstone_sim::error::{Error, Result};

/// How to get probe-rs.
pub const INSTALL: &str = "install it, without a compiler by https://probe.rs/docs/getting-started/installation, with one by cargo install probe-rs-tools --locked";

/// Options of `flash`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// The program; without it, the one that came with touchstone, else what `cargo xtask firmware` built for the board.
    elf: Option<PathBuf>,
    /// The board.
    #[arg(long)]
    board: BoardName,
    /// The probe if there are several: VID:PID or VID:PID:SERIAL, as `probe-rs list` shows it.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Looks at the program and says what would be done with it, without a probe and without a board.
    #[arg(long)]
    dry_run: bool,
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
    /// As the device calls itself.
    pub const fn board(self) -> Board {
        match self {
            Self::NucleoG474re => Board::NucleoG474re,
            Self::BG431bEsc1 => Board::BG431bEsc1,
            Self::NucleoG474reIhm16m1 => Board::NucleoG474reIhm16m1,
            Self::NucleoG474reSimplefocMini => Board::NucleoG474reSimplefocMini,
            Self::NucleoG431rbIhm16m1 => Board::NucleoG431rbIhm16m1,
        }
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.board().name()
    }

    /// Its program: the one that came with this one, else where `cargo xtask firmware` puts it.
    pub fn program(self) -> PathBuf {
        self.shipped().unwrap_or_else(|| {
            let folder = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
            self.below(Path::new(&folder))
        })
    }

    /// Its program as an archive of `cargo xtask dist` has it, beside this one: they are of one version.
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

/// Runs it.
pub fn main(options: &Options) -> Result<()> {
    let (board, elf, probe) = (options.board, options.elf.clone(), options.probe.as_deref());
    if options.dry_run {
        return rehearse(board, elf, probe);
    }
    write(board, elf, probe)
}

/// Says what [`write()`] would do.
fn rehearse(board: BoardName, elf: Option<PathBuf>, probe: Option<&str>) -> Result<()> {
    let program = checked(board, elf)?;
    say!("{} into {}", program.display(), board.board().chip());
    for command in [download(board, &program, probe), restart(board, probe)] {
        let words: Vec<_> = std::iter::once(command.get_program())
            .chain(command.get_args())
            .map(OsStr::to_string_lossy)
            .collect();
        say!("{}", words.join(" "));
    }
    say!("nothing was written");
    Ok(())
}

/// Writes a program, or what there is for the board.
pub fn write(board: BoardName, elf: Option<PathBuf>, probe: Option<&str>) -> Result<()> {
    let program = checked(board, elf)?;
    tell!("{} into {}", program.display(), board.board().chip());
    probe_rs(&mut download(board, &program, probe))?;
    probe_rs(&mut restart(board, probe))?;
    tell!("flashed, verified and started");
    Ok(())
}

/// A program that may be written.
fn checked(board: BoardName, elf: Option<PathBuf>) -> Result<PathBuf> {
    let program = elf.unwrap_or_else(|| board.program());
    let built = format!(
        "take touchstone and its folder `firmware` from one archive, or build it: cargo xtask firmware --board {}, or name an ELF file",
        board.name()
    );
    check(&program, &built)?;
    Ok(program)
}

fn download(board: BoardName, program: &Path, probe: Option<&str>) -> Command {
    let mut command = asked_of_probe("download", board, probe);
    command.arg("--verify").arg(program);
    command
}

fn restart(board: BoardName, probe: Option<&str>) -> Command {
    asked_of_probe("reset", board, probe)
}

/// One of its commands, for a board's chip and behind a probe.
fn asked_of_probe(what: &str, board: BoardName, probe: Option<&str>) -> Command {
    let mut command = Command::new("probe-rs");
    command.args([what, "--chip", board.board().chip()]);
    if let Some(probe) = probe {
        command.args(["--probe", probe]);
    }
    command
}

/// Runs probe-rs to its end; it speaks for itself.
fn probe_rs(command: &mut Command) -> Result<()> {
    let wrong = |problem: String, fix: &str| Err(Error::device("probe-rs", problem, fix));
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => wrong(
            format!("ended with {status}"),
            "its message stands above; `touchstone doctor` looks for what is missing",
        ),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            wrong("is not on the PATH".into(), INSTALL)
        }
        Err(error) => wrong(format!("cannot be run: {error}"), INSTALL),
    }
}

/// Whether a file is a program for a Cortex-M, before anything is erased.
fn check(program: &Path, built: &str) -> Result<()> {
    /// Magic, 32 bits, little-endian.
    const START: &[u8] = b"\x7fELF\x01\x01";
    /// Machine: Arm.
    const ARM: &[u8] = &[40, 0];
    let wrong = |problem: String| Error::Io {
        path: program.to_owned(),
        problem,
        fix: built.to_owned(),
    };
    let file = std::fs::read(program).map_err(|error| match error.kind() {
        ErrorKind::NotFound => wrong("there is no such program".into()),
        _ => wrong(error.to_string()),
    })?;
    if file.starts_with(START) && file.get(18..20) == Some(ARM) {
        Ok(())
    } else {
        Err(wrong("is no ELF program for a 32-bit Arm".into()))
    }
}
