//! Runs other programs from the workspace's folder, and prints each command first.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::outcome::Outcome;

/// The root folder of the workspace: the nearest folder above this crate that has a `Cargo.lock`.
pub fn root() -> PathBuf {
    let start = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(
        || std::env::current_dir().unwrap_or_else(|_| PathBuf::from(".")),
        PathBuf::from,
    );
    start
        .ancestors()
        .find(|folder| folder.join("Cargo.lock").is_file())
        .unwrap_or(&start)
        .to_path_buf()
}

/// A command that runs a program in the workspace's folder. The environment variables that `cargo run` sets for xtask are removed,
/// because a nested build would read them as its own.
pub fn program(name: impl AsRef<std::ffi::OsStr>) -> Command {
    let mut command = Command::new(name);
    command.current_dir(root());
    for (key, _) in std::env::vars_os() {
        let text = key.to_string_lossy();
        if text.starts_with("CARGO_PKG_")
            || text.starts_with("CARGO_MANIFEST_")
            || text.starts_with("CARGO_BIN_")
        {
            command.env_remove(key);
        }
    }
    command
}

/// A command for the cargo that runs this program.
pub fn cargo(subcommand: &str) -> Command {
    let mut command = program(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.arg(subcommand);
    command
}

/// Same as [`cargo`], for subcommands that resolve dependencies. In CI the lock file must not need a change (`--locked`).
pub fn cargo_locked(subcommand: &str) -> Command {
    let mut command = cargo(subcommand);
    // All CI services set it.
    if std::env::var_os("CI").is_some_and(|value| value != "false" && !value.is_empty()) {
        command.arg("--locked");
    }
    command
}

/// Returns a copy of the command that runs at the lowest process priority.
pub fn behind(command: &Command) -> Command {
    let mut nice = Command::new("nice");
    nice.args(["-n", "19"]);
    started_by(nice, command)
}

/// Returns a copy of the command with a limit of processor time in seconds. The limit holds for its process and for each process
/// that it starts.
pub fn within(command: &Command, seconds: u32) -> Command {
    let mut limited = Command::new("sh");
    limited.args(["-c", &format!("ulimit -t {seconds} && exec \"$0\" \"$@\"")]);
    started_by(limited, command)
}

/// Makes `other` (such as `nice`) run the command: passes it as arguments, with the command's folder and environment variables.
fn started_by(mut other: Command, command: &Command) -> Command {
    other.arg(command.get_program()).args(command.get_args());
    if let Some(folder) = command.get_current_dir() {
        other.current_dir(folder);
    }
    for (key, value) in command.get_envs() {
        match value {
            Some(value) => other.env(key, value),
            None => other.env_remove(key),
        };
    }
    other
}

/// The command as text, as a person would type it.
pub fn shown(command: &Command) -> String {
    let mut words = Vec::new();
    for (key, value) in command.get_envs() {
        if let Some(value) = value {
            words.push(format!(
                "{}={:?}",
                key.to_string_lossy(),
                value.to_string_lossy()
            ));
        }
    }
    let name = Path::new(command.get_program()).file_stem();
    words.push(name.unwrap_or_default().to_string_lossy().into_owned());
    words.extend(
        command
            .get_args()
            .map(|arg| arg.to_string_lossy().into_owned()),
    );
    words.join(" ")
}

/// Runs the command to its end and shows its output.
pub fn run(command: &mut Command) -> Outcome {
    run_reading(command, |_| {})
}

/// Runs the command to its end, shows its output, and passes every line of its standard output to `line`.
pub fn run_reading(command: &mut Command, line: impl FnMut(&str)) -> Outcome {
    match exit_code(command, line) {
        Ok(Some(0)) => Outcome::Ok(String::new()),
        Ok(_) => Outcome::Failed(format!("`{}` failed", shown(command))),
        Err(error) => Outcome::Failed(format!("`{}`: {error}", shown(command))),
    }
}

/// Same as [`run_reading`], but `line` also receives the lines of standard error, in the order of writing.
pub fn run_reading_all(command: &mut Command, mut line: impl FnMut(&str)) -> Outcome {
    println!("$ {}", shown(command));
    let words = shown(command);
    let mut read = || -> std::io::Result<bool> {
        let (output, input) = std::io::pipe()?;
        command.stdin(Stdio::null());
        command.stdout(input.try_clone()?).stderr(input);
        let mut child = command.spawn()?;
        // `command` still holds the writing end of the pipe. Without this line, `show` would not see the pipe's end when the child
        // ends.
        command.stdout(Stdio::null()).stderr(Stdio::null());
        show(output, &mut line)?;
        Ok(child.wait()?.success())
    };
    match read() {
        Ok(true) => Outcome::Ok(String::new()),
        Ok(false) => Outcome::Failed(format!("`{words}` failed")),
        Err(error) => Outcome::Failed(format!("`{words}`: {error}")),
    }
}

/// Prints every line of the output and passes it to `line`.
fn show(output: impl Read, mut line: impl FnMut(&str)) -> std::io::Result<()> {
    for read in BufReader::new(output).split(b'\n') {
        let read = read?;
        let read = String::from_utf8_lossy(&read);
        println!("{read}");
        line(&read);
    }
    std::io::stdout().flush()
}

/// Runs the command as [`run_reading`] does. Returns the exit code; `None` if a signal ended the command.
pub fn exit_code(command: &mut Command, line: impl FnMut(&str)) -> std::io::Result<Option<i32>> {
    println!("$ {}", shown(command));
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()?;
    if let Some(output) = child.stdout.take() {
        show(output, line)?;
    }
    Ok(child.wait()?.code())
}

/// Runs a command without showing its output. Returns its standard output; `None` if the command cannot run or fails.
pub fn capture(command: &mut Command) -> Option<String> {
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Runs the commands until one fails.
pub fn run_all(commands: impl IntoIterator<Item = Command>) -> Outcome {
    for mut command in commands {
        let outcome = run(&mut command);
        if outcome.is_failure() {
            return outcome;
        }
    }
    Outcome::Ok(String::new())
}

/// Path of a file or folder below the build folder `target/`, where these commands put all that they measure or generate.
pub fn target(name: &str) -> PathBuf {
    let base = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
    root().join(base).join(name)
}

/// Builds the program `touchstone` as `cargo xtask unit` does, so that no crate is compiled twice. Returns the folder of the program.
///
/// Only `cargo test` takes the features of all dependencies of tests. `cargo build` compiles two dozen crates anew without them, from
/// `num-traits` to the simulator. A test program of the package makes cargo build the package's own program as well.
pub fn built_with_tests() -> Result<PathBuf, Outcome> {
    let mut command = cargo_locked("test");
    command.args(["--workspace", "--no-run", "--test", "cli"]);
    run(&mut command).went_well()?;
    Ok(target("debug"))
}
