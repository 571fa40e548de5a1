//! `cargo xtask machine`: prints the installed tools with their versions, and the compiler of each type of build. Reports of
//! failures include this text.

use std::process::Command;

use crate::outcome::Outcome;
use crate::{shell, toolchain};

/// Programs that the steps start, each with the option that prints its version.
const PROGRAMS: [(&str, &str); 12] = [
    ("cargo", "--version"),
    ("cargo-kani", "--version"),
    ("cc", "--version"),
    ("python3", "--version"),
    ("git", "--version"),
    ("qemu-system-arm", "--version"),
    ("valgrind", "--version"),
    ("chromium", "--version"),
    ("chromedriver", "--version"),
    ("firefox", "--version"),
    ("firefox-esr", "--version"),
    ("geckodriver", "--version"),
];
/// Environment variables that change what cargo builds or where it puts the results.
const VARIABLES: [&str; 9] = [
    "CARGO_HOME",
    "CARGO_TARGET_DIR",
    "CARGO_BUILD_JOBS",
    "CARGO_INCREMENTAL",
    "CARGO_ENCODED_RUSTFLAGS",
    "RUSTFLAGS",
    "RUSTC_WRAPPER",
    "RUSTUP_TOOLCHAIN",
    "CI",
];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask machine".into());
    }
    let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    println!("{:<16} {system}, {processors} processors", "machine");
    for (name, option) in PROGRAMS {
        println!("{name:<16} {}", version(name, option));
    }
    for name in VARIABLES {
        if let Some(value) = std::env::var_os(name) {
            println!("{name:<16} {}", value.to_string_lossy());
        }
    }
    let choices = toolchain::choices();
    for choice in &choices {
        println!("{:<16} {choice}", "builds with");
    }
    Outcome::Ok(format!(
        "rustc {}; boards: {}",
        toolchain::active_version(),
        choices.first().map_or("", String::as_str)
    ))
}

/// First line that a program prints when called with `option`, or `not found`.
fn version(name: &str, option: &str) -> String {
    let said = shell::capture(Command::new(name).arg(option));
    let line = said.as_deref().and_then(|text| text.lines().next());
    line.unwrap_or("not found").to_owned()
}
