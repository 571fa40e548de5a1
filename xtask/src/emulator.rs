//! Builds and runs the microcontroller emulator, for `cargo xtask fil` and `cargo xtask cycles`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::outcome::{Outcome, USAGE};
use crate::{firmware, packages, shell};

/// Programs that the build of the emulator library Unicorn and of its bindings needs, each with its package.
const TOOLS: [(&str, &str); 2] = [("clang", "clang"), ("cmake", "cmake")];

/// Builds the emulator and the firmware of `boards`, then runs the emulator's `command` on the firmware. The outcome's text is the
/// last line that the emulator printed.
pub fn call(command: &str, boards: &[&str], words: &[&str]) -> Outcome {
    let all = firmware_and_emulator(boards);
    all.map_or_else(
        |outcome| outcome,
        |(emulator, programs)| {
            let mut call = shell::program(&emulator);
            call.arg(command);
            for (board, program) in boards.iter().zip(programs) {
                call.arg(format!("--{board}")).arg(program);
            }
            last_line(call.args(words))
        },
    )
}

/// Runs the emulator; the outcome's text is the last line that the emulator printed.
fn last_line(call: &mut Command) -> Outcome {
    let mut last = String::new();
    let code = shell::exit_code(call, |line| {
        if !line.trim().is_empty() {
            last = line.trim().to_owned();
        }
    });
    match code {
        Ok(Some(0)) => Outcome::Ok(last),
        Ok(code) if code == Some(USAGE.into()) => Outcome::Usage("as the emulator says".into()),
        Ok(_) => Outcome::Failed(last),
        Err(error) => Outcome::Failed(format!("the emulator: {error}")),
    }
}

/// Builds the emulator and the firmware of `boards`; returns the emulator's path and the paths of the firmware files.
pub fn firmware_and_emulator(boards: &[&str]) -> Result<(PathBuf, Vec<PathBuf>), Outcome> {
    if let Some(outcome) = missing() {
        return Err(outcome);
    }
    let programs: Result<_, _> = boards.iter().map(|board| firmware::build(board)).collect();
    Ok((built()?, programs?))
}

/// Runs the unit tests of the emulator's own crate.
pub fn test() -> Outcome {
    if let Some(outcome) = missing() {
        return outcome;
    }
    shell::run(&mut cargo("test", &["--lib"]))
}

/// A cargo command for the emulator's crate, with further options.
fn cargo(subcommand: &str, options: &[&str]) -> Command {
    let mut cargo = shell::cargo_locked(subcommand);
    cargo
        .args(["--release", "--manifest-path", "emulator/Cargo.toml"])
        .arg("--target-dir")
        .arg(shell::target("emulator"))
        .args(options);
    cargo
}

/// The commands that compile the emulator and its own tests; none where a tool for them is missing.
pub fn builds() -> Vec<Command> {
    if !is_there() {
        return Vec::new();
    }
    vec![cargo("build", &[]), cargo("test", &["--lib", "--no-run"])]
}

/// Builds the emulator and returns the path of its program.
pub fn built() -> Result<PathBuf, Outcome> {
    if let Some(outcome) = missing() {
        return Err(outcome);
    }
    match shell::run(&mut cargo("build", &[])) {
        Outcome::Ok(_) => Ok(shell::target("emulator").join("release/touchstone-emulator")),
        failed => Err(failed),
    }
}

/// Reason why the emulator cannot be built on this machine; `None` if it can. Tries to install missing packages first.
fn missing() -> Option<Outcome> {
    if !is_there() {
        packages::apt_get(&packages::EMULATOR);
    }
    if !is_there() {
        let names = packages::EMULATOR.join(" ");
        return Some(Outcome::NotRun(format!(
            "the emulator cannot be built: apt-get install {names}"
        )));
    }
    let own = || std::env::home_dir().unwrap_or_default().join(".cargo");
    let sources = std::env::var_os("CARGO_HOME").map_or_else(own, PathBuf::from);
    with_space(&[sources, shell::target("emulator")])
}

/// Reports the first folder with white space in its path. The build of the emulator library Unicorn calls a shell script by an
/// unquoted path, so white space in the path makes the build fail.
fn with_space(folders: &[PathBuf]) -> Option<Outcome> {
    let has_space = |folder: &&PathBuf| folder.to_string_lossy().contains(char::is_whitespace);
    folders.iter().find(has_space).map(|folder| {
        Outcome::NotRun(format!(
            "the emulator cannot be built in a folder with a space in its name: {}; set CARGO_HOME and CARGO_TARGET_DIR to others",
            folder.display()
        ))
    })
}

/// Whether clang, cmake and libclang, which the emulator's build needs, are installed.
pub fn is_there() -> bool {
    let runs = |(program, _): &(&str, &str)| {
        shell::capture(shell::program(program).arg("--version")).is_some()
    };
    TOOLS.iter().all(runs) && has_libclang()
}

/// Whether bindgen, which generates the library's bindings, can load libclang: from a folder of the system, a folder of an LLVM
/// version, or the one in `LIBCLANG_PATH`.
fn has_libclang() -> bool {
    let folders = [
        "/usr/lib",
        "/usr/lib64",
        "/usr/lib/x86_64-linux-gnu",
        "/usr/lib/aarch64-linux-gnu",
    ];
    let holds = |folder: &Path| {
        std::fs::read_dir(folder).is_ok_and(|entries| {
            entries
                .flatten()
                .any(|entry| entry.file_name().to_string_lossy().starts_with("libclang"))
        })
    };
    let llvm = || {
        let versions = std::fs::read_dir("/usr/lib")
            .into_iter()
            .flatten()
            .flatten();
        let mut folders =
            versions.filter(|entry| entry.file_name().to_string_lossy().starts_with("llvm-"));
        folders.any(|entry| holds(&entry.path().join("lib")))
    };
    std::env::var_os("LIBCLANG_PATH").is_some()
        || folders.iter().any(|folder| holds(Path::new(folder)))
        || llvm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_with_a_space_is_named() {
        let folders = ["/home/a", "/home/a b/target"].map(PathBuf::from);
        assert!(with_space(&folders[..1]).is_none());
        let said = with_space(&folders).map(|outcome| outcome.reason().to_owned());
        assert!(said.is_some_and(|said| said.contains("/home/a b/target")));
    }
}
