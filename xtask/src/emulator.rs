//! Building and calling the emulator, for `cargo xtask fil` and `cargo xtask cycles`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::outcome::{Outcome, USAGE};
use crate::{firmware, packages, shell};

/// What Unicorn and its bindings are built with.
const TOOLS: [(&str, &str); 2] = [("clang", "clang"), ("cmake", "cmake")];

/// Builds the firmware of boards and the emulator, calls the emulator with a command and the programs; what it said last.
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

/// Runs it; the outcome says what it said last.
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

/// Builds both; where they are.
pub fn firmware_and_emulator(boards: &[&str]) -> Result<(PathBuf, Vec<PathBuf>), Outcome> {
    if let Some(outcome) = missing() {
        return Err(outcome);
    }
    let programs: Result<_, _> = boards.iter().map(|board| firmware::build(board)).collect();
    Ok((built()?, programs?))
}

/// The emulator's own tests.
pub fn test() -> Outcome {
    if let Some(outcome) = missing() {
        return outcome;
    }
    let mut cargo = shell::cargo_locked("test");
    cargo
        .args([
            "--release",
            "--lib",
            "--manifest-path",
            "emulator/Cargo.toml",
        ])
        .arg("--target-dir")
        .arg(shell::target("emulator"));
    shell::run(&mut cargo)
}

/// Builds the emulator; where it is.
pub fn built() -> Result<PathBuf, Outcome> {
    if let Some(outcome) = missing() {
        return Err(outcome);
    }
    let folder = shell::target("emulator");
    let mut cargo = shell::cargo_locked("build");
    cargo
        .args(["--release", "--manifest-path", "emulator/Cargo.toml"])
        .arg("--target-dir")
        .arg(&folder);
    match shell::run(&mut cargo) {
        Outcome::Ok(_) => Ok(folder.join("release/touchstone-emulator")),
        failed => Err(failed),
    }
}

/// Why the emulator cannot be built here, if it cannot.
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

/// The build of Unicorn calls a shell script by its path, without quotes.
fn with_space(folders: &[PathBuf]) -> Option<Outcome> {
    let has_space = |folder: &&PathBuf| folder.to_string_lossy().contains(char::is_whitespace);
    folders.iter().find(has_space).map(|folder| {
        Outcome::NotRun(format!(
            "the emulator cannot be built in a folder with a space in its name: {}; set CARGO_HOME and CARGO_TARGET_DIR to others",
            folder.display()
        ))
    })
}

/// Whether all that the build needs is there.
pub fn is_there() -> bool {
    let runs = |(program, _): &(&str, &str)| {
        shell::capture(shell::program(program).arg("--version")).is_some()
    };
    TOOLS.iter().all(runs) && has_libclang()
}

/// Whether bindgen can load libclang while it runs: from the folders of the system, of LLVM's versions, or a given
/// one.
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
