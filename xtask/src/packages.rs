//! Finds installed tools and installs missing ones: components of rustup and Debian packages.

use std::process::Command;

use crate::outcome::Outcome;
use crate::shell;

/// Debian packages that the build of the emulator needs. libclang is a library, so no program shows whether it is installed.
pub const EMULATOR: [&str; 3] = ["clang", "libclang-dev", "cmake"];

/// First line that a command prints, such as a version; `None` if the command cannot run or fails.
pub fn first_line(words: &[&str]) -> Option<String> {
    let text = shell::capture(Command::new(words[0]).args(&words[1..]))?;
    text.lines().next().map(str::to_owned)
}

/// Version of a rustup component such as `clippy`; `None` if it is not installed.
pub fn component(name: &str) -> Option<String> {
    let subcommand = if name == "rustfmt" { "fmt" } else { name };
    shell::capture(shell::cargo(subcommand).arg("--version"))
}

/// Version of valgrind; `None` if it is not installed.
pub fn valgrind() -> Option<String> {
    first_line(&["valgrind", "--version"])
}

/// Installs the rustup component if it is missing. Returns `None` if it is installed afterwards, else why the step cannot run.
pub fn missing_component(name: &'static str) -> Option<Outcome> {
    if component(name).is_some() {
        return None;
    }
    println!("{name} is missing: rustup component add {name}");
    let _ = shell::run(shell::program("rustup").args(["component", "add", name]));
    component(name)
        .is_none()
        .then(|| Outcome::NotRun(format!("{name} is missing: rustup component add {name}")))
}

/// Installs valgrind if it is missing. Returns `None` if it is installed afterwards, else why the step cannot run.
pub fn missing_valgrind() -> Option<Outcome> {
    if valgrind().is_some() {
        return None;
    }
    apt_get(&["valgrind"]);
    valgrind()
        .is_none()
        .then(|| Outcome::NotRun("valgrind is missing: apt-get install valgrind".into()))
}

/// Installs Debian packages if the user is root and apt-get exists; otherwise prints the command that would install them.
pub fn apt_get(packages: &[&str]) {
    let root = first_line(&["id", "-u"]).is_some_and(|id| id == "0");
    if !root || first_line(&["apt-get", "--version"]).is_none() {
        println!("to install: apt-get install {}", packages.join(" "));
        return;
    }
    let apt_get = |words: &[&str]| {
        let mut command = shell::program("apt-get");
        command.args(words).env("DEBIAN_FRONTEND", "noninteractive");
        shell::run(&mut command)
    };
    apt_get(&["update", "-qq"]);
    // Installs one package at a time, so that a package which this system lacks does not prevent the others.
    for package in packages {
        let options = ["install", "-y", "-qq", "--no-install-recommends"];
        apt_get(&[&options[..], &[package]].concat());
    }
}
