//! Which of the installed compilers can make code for the microcontroller.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell;

/// The Cortex-M4 without its float unit: what then still calculates with floats must call for it by name.
pub const TARGET: &str = "thumbv7em-none-eabi";

/// A compiler for a target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Compiler {
    target: &'static str,
    /// `None`: the one that runs this program.
    toolchain: Option<String>,
    /// The target's `core` is not there and must be built from its source.
    from_source: bool,
}

impl fmt::Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.toolchain.as_deref().unwrap_or("the active toolchain");
        let how = if self.from_source {
            "its `core` built from source"
        } else {
            "its `core` as installed"
        };
        write!(f, "{name} for {}, {how}", self.target)
    }
}

impl Compiler {
    /// `cargo build` with it, and the options that belong to it.
    pub fn cargo(&self) -> (Command, Vec<String>) {
        let mut cargo = match &self.toolchain {
            None => shell::cargo_locked("build"),
            Some(name) => {
                let mut rustup = shell::program("rustup");
                rustup.args(["run", name, "cargo", "build"]);
                // They name the active toolchain's programs.
                for key in ["RUSTUP_TOOLCHAIN", "RUSTC", "CARGO", "RUSTDOC"] {
                    rustup.env_remove(key);
                }
                rustup
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
    let mut candidates = vec![(None, sysroot(shell::program("rustc")))];
    for name in toolchains() {
        let mut rustc = shell::program("rustup");
        rustc.args(["run", &name, "rustc"]);
        candidates.push((Some(name), sysroot(rustc)));
    }
    let with = |part: &str, from_source| {
        candidates.iter().find_map(|(toolchain, sysroot)| {
            let there = sysroot.as_ref()?.join("lib/rustlib").join(part).is_dir();
            there.then(|| Compiler {
                target,
                toolchain: toolchain.clone(),
                from_source,
            })
        })
    };
    with(&format!("{target}/lib"), false).or_else(|| with("src/rust/library/core", true))
}

fn sysroot(mut rustc: Command) -> Option<PathBuf> {
    shell::capture(rustc.args(["--print", "sysroot"])).map(|path| Path::new(&path).to_path_buf())
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
