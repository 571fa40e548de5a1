//! Which of the installed compilers can make code for the microcontroller.

use std::fmt;
use std::path::PathBuf;
use std::process::Command;

use crate::{setup, shell};

/// The Cortex-M4 without its float unit: what then still calculates with floats must call for it by name.
pub const TARGET: &str = "thumbv7em-none-eabi";

/// Where a compiler comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Origin {
    /// The one that runs this program.
    Active,
    /// Another of rustup's toolchains, by name.
    Toolchain(String),
    /// A system package, beside rustup.
    System,
}

/// A compiler for a target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Compiler {
    target: &'static str,
    origin: Origin,
    /// Such as `1.95.0`.
    pub version: String,
    /// The target's `core` is not there and must be built from its source.
    from_source: bool,
}

/// A compiler that may or may not be able to do it.
struct Candidate {
    origin: Origin,
    version: String,
    library: PathBuf,
}

/// The system package's compiler.
const SYSTEM: &str = "/usr/bin/rustc";

impl Origin {
    fn rustc(&self) -> Command {
        match self {
            Origin::Active => shell::program("rustc"),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                rustup.args(["run", name, "rustc"]);
                rustup
            }
            Origin::System => shell::program(SYSTEM),
        }
    }

    /// Its version and where its libraries lie, if it can build this workspace at all.
    fn look(self) -> Option<Candidate> {
        let version = shell::capture(self.rustc().arg("--version"))?;
        let sysroot = shell::capture(self.rustc().args(["--print", "sysroot"]))?;
        setup::is_new_enough(&version).then(|| Candidate {
            origin: self,
            version: version.split_whitespace().nth(1).unwrap_or("").to_owned(),
            library: PathBuf::from(sysroot).join("lib/rustlib"),
        })
    }
}

impl fmt::Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.origin {
            Origin::Active => write!(f, "the active toolchain")?,
            Origin::Toolchain(name) => write!(f, "{name}")?,
            Origin::System => write!(f, "{SYSTEM}")?,
        }
        let core = if self.from_source {
            "built from source"
        } else {
            "as installed"
        };
        write!(f, " ({}) for {}, `core` {core}", self.version, self.target)
    }
}

impl Compiler {
    /// `cargo build` with it, and the options that belong to it.
    pub fn cargo(&self) -> (Command, Vec<String>) {
        self.cargo_for("build")
    }

    /// `cargo clippy` with it, and the options that belong to it; `None` if it has none that knows the target.
    pub fn clippy(&self) -> Option<(Command, Vec<String>)> {
        let has_it = match &self.origin {
            _ if self.from_source => false,
            Origin::Active => setup::missing_component("clippy").is_none(),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                shell::capture(rustup.args(["run", name, "cargo", "clippy", "--version"])).is_some()
            }
            Origin::System => false,
        };
        has_it.then(|| self.cargo_for("clippy"))
    }

    fn cargo_for(&self, subcommand: &str) -> (Command, Vec<String>) {
        let mut cargo = match &self.origin {
            Origin::Active => shell::cargo_locked(subcommand),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                rustup.args(["run", name, "cargo", subcommand]);
                // They name the active toolchain's programs.
                for key in ["RUSTUP_TOOLCHAIN", "RUSTC", "CARGO", "RUSTDOC"] {
                    rustup.env_remove(key);
                }
                rustup
            }
            Origin::System => {
                let mut cargo = shell::cargo_locked(subcommand);
                cargo.env("RUSTC", SYSTEM);
                // The system package comes without Rust's own linker for it.
                let target = self.target.to_uppercase().replace('-', "_");
                cargo.env(format!("CARGO_TARGET_{target}_LINKER"), "ld.lld");
                cargo
            }
        };
        let mut options = vec![format!("--target={}", self.target)];
        if self.from_source {
            cargo.env("RUSTC_BOOTSTRAP", "1");
            options.push("-Zbuild-std=core".into());
        }
        (cargo, options)
    }
}

/// A compiler for [`TARGET`].
pub fn find() -> Option<Compiler> {
    find_for(TARGET)
}

/// A compiler that has the target installed; failing that, one that has the library's source.
pub fn find_for(target: &'static str) -> Option<Compiler> {
    let mut origins = vec![Origin::Active];
    origins.extend(toolchains().into_iter().map(Origin::Toolchain));
    origins.push(Origin::System);
    let candidates: Vec<_> = origins.into_iter().filter_map(Origin::look).collect();
    let with = |part: &str, from_source| {
        let mut having = candidates
            .iter()
            .filter(|candidate| candidate.library.join(part).is_dir());
        having.next().map(|candidate| Compiler {
            target,
            origin: candidate.origin.clone(),
            version: candidate.version.clone(),
            from_source,
        })
    };
    with(&format!("{target}/lib"), false).or_else(|| with("src/rust/library/core", true))
}

/// Version of the compiler that runs this program.
pub fn active_version() -> String {
    let version = shell::capture(Origin::Active.rustc().arg("--version")).unwrap_or_default();
    version.split_whitespace().nth(1).unwrap_or("").to_owned()
}

/// Names of rustup's toolchains.
fn toolchains() -> Vec<String> {
    let list = shell::capture(shell::program("rustup").args(["toolchain", "list"]));
    list.unwrap_or_default()
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| name.chars().next().is_some_and(char::is_alphanumeric))
        .map(str::to_owned)
        .collect()
}
