//! `cargo xtask setup [--install]`: what is installed, what is missing, what it is for and how to get it.
//!
//! rustfmt and clippy, which every test run needs, are fetched by rustup without asking, and so is valgrind, by apt-get as
//! root, when something is to be counted; the rest only with `--install`.

use std::process::Command;

use crate::float_free::thumb;
use crate::outcome::Outcome;
use crate::shell;

/// The oldest compiler that builds the workspace, `rust-version` in Cargo.toml.
const RUST: (u32, u32) = (1, 95);

/// Something that a command needs.
struct Tool {
    name: &'static str,
    /// Without it the tests say nothing.
    required: bool,
    purpose: &'static str,
    /// Its version; `None` if it is not there.
    version: fn() -> Option<String>,
    /// How to get it.
    hint: &'static str,
    /// Debian's packages, for what a step of the tests needs.
    packages: &'static [&'static str],
}

const TOOLS: &[Tool] = &[
    Tool {
        name: "rustc",
        required: true,
        purpose: "everything",
        version: rustc,
        hint: "rustup toolchain install stable (1.95 or newer)",
        packages: &[],
    },
    Tool {
        name: "rustfmt",
        required: true,
        purpose: "fmt",
        version: || component("rustfmt"),
        hint: "rustup component add rustfmt",
        packages: &[],
    },
    Tool {
        name: "clippy",
        required: true,
        purpose: "lint",
        version: || component("clippy"),
        hint: "rustup component add clippy",
        packages: &[],
    },
    Tool {
        name: "valgrind",
        required: false,
        purpose: "bench: counts instructions",
        version: valgrind,
        hint: "apt-get install valgrind",
        packages: &["valgrind"],
    },
    Tool {
        name: "thumb",
        required: false,
        purpose: "float-free: looks at the microcontroller's code",
        version: || thumb::find().map(|found| found.to_string()),
        hint: "rustup target add thumbv7em-none-eabi",
        // A compiler with its library's source, where rustup cannot fetch the target.
        packages: &["rustc-web", "rust-web-src"],
    },
    Tool {
        name: "python3",
        required: false,
        purpose: "prove: the integer obligations",
        version: || first_line(&["python3", "--version"]),
        hint: "apt-get install python3",
        packages: &["python3"],
    },
    Tool {
        name: "venv",
        required: false,
        purpose: "prove: the solvers' Python wheels",
        version: || {
            first_line(&[
                "python3",
                "-c",
                "import ensurepip; print(ensurepip.version())",
            ])
        },
        hint: "apt-get install python3-venv",
        packages: &["python3-venv"],
    },
    Tool {
        name: "clang",
        required: false,
        purpose: "fil, cycles: builds the emulator, with libclang and cmake",
        version: || {
            let version = first_line(&["clang", "--version"]);
            version.filter(|_| crate::emulator::is_there())
        },
        hint: "apt-get install clang libclang-dev cmake",
        packages: &crate::emulator::PACKAGES,
    },
    Tool {
        name: "kani",
        required: false,
        purpose: "prove: the harnesses",
        version: || first_line(&["cargo", "kani", "--version"]),
        hint: "cargo install --locked kani-verifier, then cargo kani setup",
        packages: &[],
    },
    Tool {
        name: "chromium",
        required: false,
        purpose: "looking at the report in a browser",
        version: chromium,
        hint: "apt-get install chromium",
        packages: &[],
    },
];

fn first_line(words: &[&str]) -> Option<String> {
    let text = shell::capture(Command::new(words[0]).args(&words[1..]))?;
    text.lines().next().map(str::to_owned)
}

fn rustc() -> Option<String> {
    let version = first_line(&["rustc", "--version"])?;
    is_new_enough(&version).then_some(version)
}

/// Whether `rustc 1.95.0 (…)` is at least the oldest that will do.
pub fn is_new_enough(version: &str) -> bool {
    let number = version.split_whitespace().nth(1).unwrap_or("");
    let mut parts = number.split('.').map(|part| part.parse().unwrap_or(0));
    (parts.next().unwrap_or(0), parts.next().unwrap_or(0)) >= RUST
}

fn component(name: &str) -> Option<String> {
    let subcommand = if name == "rustfmt" { "fmt" } else { name };
    shell::capture(shell::cargo(subcommand).arg("--version"))
}

fn valgrind() -> Option<String> {
    first_line(&["valgrind", "--version"])
}

fn chromium() -> Option<String> {
    ["chromium", "chromium-browser", "google-chrome", "chrome"]
        .into_iter()
        .find_map(|name| first_line(&[name, "--version"]))
}

/// `None` if the component is there or could be fetched; else why the step cannot run.
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

/// `None` if valgrind is there or could be fetched; else why the step cannot run.
pub fn missing_valgrind() -> Option<Outcome> {
    if valgrind().is_some() {
        return None;
    }
    apt_get(&["valgrind"]);
    valgrind()
        .is_none()
        .then(|| Outcome::NotRun("valgrind is missing: apt-get install valgrind".into()))
}

/// Installs Debian packages where this is root and there is apt-get; otherwise says so.
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
    // One by one: a package that this system does not have must not keep the others away.
    for package in packages {
        let options = ["install", "-y", "-qq", "--no-install-recommends"];
        apt_get(&[&options[..], &[package]].concat());
    }
}

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => {}
        [install] if install == "--install" => {
            // rustup first: it fetches the target itself where it has a network.
            if thumb::find().is_none() {
                shell::run(shell::program("rustup").args(["target", "add", thumb::TARGET]));
            }
            let packages: Vec<_> = TOOLS
                .iter()
                .filter(|tool| (tool.version)().is_none())
                .flat_map(|tool| tool.packages.iter().copied())
                .collect();
            if !packages.is_empty() {
                apt_get(&packages);
            }
        }
        _ => return Outcome::Usage("cargo xtask setup [--install]".into()),
    }
    let _ = missing_component("rustfmt");
    let _ = missing_component("clippy");
    let (mut missing, mut required) = (Vec::new(), Vec::new());
    for tool in TOOLS {
        match (tool.version)() {
            Some(version) => println!("{:<10}{version}", tool.name),
            None => {
                println!(
                    "{:<10}missing; for {}; {}",
                    tool.name, tool.purpose, tool.hint
                );
                missing.push(tool.name);
                if tool.required {
                    required.push(tool.name);
                }
            }
        }
    }
    if !required.is_empty() {
        Outcome::Failed(format!("missing: {}", required.join(", ")))
    } else if missing.is_empty() {
        Outcome::Ok("all there".into())
    } else {
        Outcome::Ok(format!("can do without: {}", missing.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::is_new_enough;

    #[test]
    fn compilers_before_the_oldest_supported_are_refused() {
        assert!(is_new_enough("rustc 1.95.0 (59807616e 2026-04-14)"));
        assert!(is_new_enough("rustc 1.101.0-nightly (abc 2027-01-01)"));
        assert!(is_new_enough("rustc 2.0.0"));
        assert!(!is_new_enough("rustc 1.94.1 (abc 2026-03-01)"));
        assert!(!is_new_enough(""));
    }

    #[test]
    fn the_oldest_compiler_is_the_workspaces() {
        let manifest = include_str!("../../Cargo.toml");
        let (major, minor) = super::RUST;
        assert!(manifest.contains(&format!("rust-version = \"{major}.{minor}\"")));
    }
}
