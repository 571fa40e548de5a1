//! `cargo xtask firmware [--board BOARD]`: builds the firmware of all boards, or of one, and checks the compiled programs.
//!
//! The firmware of a board is written to `target/firmware/BOARD/touchstone.elf`, which the emulator runs and `touchstone flash`
//! writes to a board.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use crate::outcome::Outcome;
use crate::step::Share;
use crate::toolchain::{self, BOARD};
use crate::{inspect, shell};

/// The supported boards: the names of the binaries of `firmware/`. Each is also the name of a Cargo feature.
pub static BOARDS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let binaries = include_str!("../../firmware/Cargo.toml").split("[[bin]]");
    let name = |binary: &'static str| binary.split('"').nth(1);
    binaries.skip(1).filter_map(name).collect()
});

/// Part of the name of a board whose chip has 128 KiB of flash memory. Its firmware is compiled for small size instead of speed.
const SMALL_FLASH: &str = "g431";

/// The reference board: the one that `cargo xtask test` builds firmware for and whose fault reactions it checks.
pub const REFERENCE: &str = "nucleo-g474re-ihm16m1";
/// The part of `cargo xtask firmware` that the middle gate (`cargo xtask test`) runs: one board.
pub const ONE_BOARD: Share = Share::Part(
    &["--board", REFERENCE],
    "the programs of the other four boards",
);

/// Path of a board's firmware file once it is built.
pub fn program(board: &str) -> PathBuf {
    shell::target("firmware").join(board).join("touchstone.elf")
}

pub fn run(args: &[String]) -> Outcome {
    let boards: Vec<&str> = match args {
        [] => BOARDS.to_vec(),
        [option, name] if option == "--board" => match BOARDS.iter().find(|board| *board == name) {
            Some(board) => vec![board],
            None => return Outcome::Usage(format!("there is no board `{name}`: {}", usage())),
        },
        _ => return Outcome::Usage(usage()),
    };
    let mut words = vec![OsString::from("firmware")];
    for board in boards {
        let program = match build(board) {
            Ok(program) => program,
            Err(outcome) => return outcome,
        };
        let linted = lint(board);
        if linted.is_failure() {
            return linted;
        }
        let mut word = OsString::from(format!("{board}="));
        word.push(program);
        words.push(word);
    }
    inspect::call(words)
}

/// Usage text of `cargo xtask firmware`.
fn usage() -> String {
    format!("cargo xtask firmware [--board {}]", BOARDS.join("|"))
}

/// Builds a board's firmware with warnings as errors; returns the path of the firmware file.
pub fn build(board: &str) -> Result<PathBuf, Outcome> {
    match shell::run(&mut build_command(board)?) {
        Outcome::Ok(_) => {}
        failed => return Err(failed),
    }
    let built = built(&build_folder(), board);
    let kept = program(board);
    let copied = kept.parent().map_or(Ok(()), std::fs::create_dir_all);
    let copied = copied.and_then(|()| std::fs::copy(&built, &kept));
    copied.map_err(|error| Outcome::Failed(format!("{}: {error}", built.display())))?;
    Ok(kept)
}

/// The folder in which firmware is compiled.
fn build_folder() -> PathBuf {
    shell::target("firmware").join("build")
}

/// The command that builds a board's firmware with warnings as errors.
fn build_command(board: &str) -> Result<Command, Outcome> {
    let (mut cargo, options) = toolchain::build_board()?;
    let folder = build_folder();
    arguments(&mut cargo, board, &options, &shell::root(), &folder);
    cargo.args(["--config", "build.warnings='deny'"]);
    Ok(cargo)
}

/// The commands that build the reference board's firmware and run Clippy on it, as far as this machine has compilers for it.
pub fn builds() -> Vec<Command> {
    let build = build_command(REFERENCE).ok();
    build.into_iter().chain(lint_command(REFERENCE)).collect()
}

/// The command that builds a board's firmware from a copy of the sources, and the path of the program that it writes.
pub fn build_copy(
    board: &str,
    sources: &Path,
    folder: &Path,
) -> Result<(Command, PathBuf), Outcome> {
    let (mut cargo, options) = toolchain::build_board()?;
    arguments(&mut cargo, board, &options, sources, folder);
    Ok((cargo, built(folder, board)))
}

/// Path of a board's program below the target folder `folder`.
fn built(folder: &Path, board: &str) -> PathBuf {
    folder.join(BOARD).join("release").join(board)
}

/// Runs Clippy on a board's firmware with warnings as errors. Does nothing if no installed Clippy supports the target; the build
/// also treats the compiler's own warnings as errors.
fn lint(board: &str) -> Outcome {
    lint_command(board).map_or_else(
        || Outcome::Ok(String::new()),
        |mut clippy| shell::run(&mut clippy),
    )
}

/// The command that runs Clippy on a board's firmware; `None` if no installed Clippy supports the target.
fn lint_command(board: &str) -> Option<Command> {
    let (mut clippy, options) = toolchain::clippy_board()?;
    let folder = build_folder();
    arguments(&mut clippy, board, &options, &shell::root(), &folder);
    clippy.args(["--config", "build.warnings='deny'"]);
    clippy.args(["--", "-D", "warnings"]);
    Some(clippy)
}

/// Adds to a cargo command the arguments that the build and Clippy have in common.
fn arguments(cargo: &mut Command, board: &str, options: &[String], sources: &Path, folder: &Path) {
    cargo
        // In this folder cargo reads `firmware/.cargo/config.toml`.
        .current_dir(sources.join("firmware"))
        .args(["--release", "--target-dir"])
        .arg(folder)
        .args(options)
        .args(["--no-default-features", "--features", board])
        .args(["--bin", board]);
    if board.contains(SMALL_FLASH) {
        cargo.args(["--config", "profile.release.opt-level='z'"]);
    }
}
