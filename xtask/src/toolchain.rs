//! Which of the installed compilers can make code for another machine: rustup's with the target installed; failing that, one that
//! has the library as source, such as Debian's.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Once, OnceLock};

use crate::outcome::Outcome;
use crate::{packages, shell};

/// The oldest compiler that builds the workspace, `rust-version` in Cargo.toml.
const RUST: (u32, u32) = (1, 95);

/// The Cortex-M4 without its float unit: what then still calculates with floats must call for it by name.
pub const SOFT_FLOAT: &str = "thumbv7em-none-eabi";
/// The Cortex-M4 with its float unit.
pub const BOARD: &str = "thumbv7em-none-eabihf";

/// What a browser runs.
pub const WASM: &str = "wasm32-unknown-unknown";

/// The control interrupt calls divisions and copies of the compiler's library: as installed they are made for speed, and so they are
/// from source, whatever the program's own profile says.
const QUICK_BUILTINS: [&str; 2] = [
    "--config",
    "profile.release.package.compiler_builtins.opt-level=3",
];

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
    /// What it says of itself, with its commit: two builds of one version give other bytes.
    pub identity: String,
    /// The target's `core` is not there and must be built from its source.
    from_source: bool,
}

/// A compiler that may or may not be able to do it.
struct Candidate {
    origin: Origin,
    version: String,
    identity: String,
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
        is_new_enough(&version).then(|| Candidate {
            origin: self,
            version: version.split_whitespace().nth(1).unwrap_or("").to_owned(),
            identity: version.trim().to_owned(),
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
        let core = self.library();
        write!(f, " ({}) for {}, `core` {core}", self.identity, self.target)
    }
}

impl Compiler {
    /// How it has the target's library: the same source gives other bytes with one and with the other.
    pub const fn library(&self) -> &'static str {
        if self.from_source {
            "built from source"
        } else {
            "as installed"
        }
    }

    /// `cargo build` with it, and the options that belong to it. `libraries`: of Rust's own, where they are not installed.
    pub fn cargo(&self, libraries: &[&str]) -> (Command, Vec<String>) {
        self.cargo_for("build", libraries)
    }

    /// `cargo clippy` with it, and the options that belong to it; `None` if it has none that knows the target.
    pub fn clippy(&self) -> Option<(Command, Vec<String>)> {
        let has_it = match &self.origin {
            _ if self.from_source => false,
            Origin::Active => packages::missing_component("clippy").is_none(),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                shell::capture(rustup.args(["run", name, "cargo", "clippy", "--version"])).is_some()
            }
            Origin::System => false,
        };
        has_it.then(|| self.cargo_for("clippy", &["core"]))
    }

    /// Any other command of cargo with it, and the options that belong to it.
    pub fn cargo_for(&self, subcommand: &str, libraries: &[&str]) -> (Command, Vec<String>) {
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
            options.push(format!("-Zbuild-std={}", libraries.join(",")));
            if self.target.starts_with("thumb") {
                options.extend(QUICK_BUILTINS.map(str::to_owned));
            }
        }
        (cargo, options)
    }
}

/// A compiler that has the target installed; failing that, one that has the library's source.
pub fn find(target: &'static str) -> Option<Compiler> {
    let with = |part: &str, from_source| {
        let mut having = candidates()
            .iter()
            .filter(|candidate| candidate.library.join(part).is_dir());
        having.next().map(|candidate| Compiler {
            target,
            origin: candidate.origin.clone(),
            version: candidate.version.clone(),
            identity: candidate.identity.clone(),
            from_source,
        })
    };
    with(&format!("{target}/lib"), false).or_else(|| with("src/rust/library/core", true))
}

/// Has rustup fetch a target for the active toolchain, where it can.
pub fn add(target: &str) {
    let _ = shell::run(shell::program("rustup").args(["target", "add", target]));
}

/// All compilers, asked once.
fn candidates() -> &'static [Candidate] {
    static ALL: OnceLock<Vec<Candidate>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut origins = vec![Origin::Active];
        origins.extend(toolchains().into_iter().map(Origin::Toolchain));
        origins.push(Origin::System);
        origins.into_iter().filter_map(Origin::look).collect()
    })
}

/// Version of the compiler that runs this program.
pub fn active_version() -> String {
    let version = shell::capture(Origin::Active.rustc().arg("--version")).unwrap_or_default();
    version.split_whitespace().nth(1).unwrap_or("").to_owned()
}

/// The machine that the compiler which runs this program makes code for, as it calls it.
pub fn host() -> String {
    let all = shell::capture(Origin::Active.rustc().arg("-vV")).unwrap_or_default();
    let host = all.lines().find_map(|line| line.strip_prefix("host: "));
    host.unwrap_or_default().to_owned()
}

/// Names of rustup's own toolchains. One that somebody linked may be anything, whatever version it calls itself: it is left alone.
fn toolchains() -> Vec<String> {
    let list = shell::capture(shell::program("rustup").args(["toolchain", "list"]));
    list.unwrap_or_default()
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| is_released(name))
        .map(str::to_owned)
        .collect()
}

/// Whether rustup gives a toolchain of this name: a channel or a version, a date, and the machine. It lets nobody link one by such a name.
fn is_released(name: &str) -> bool {
    let Some((channel, rest)) = name.split_once('-') else {
        return false;
    };
    let is_version = || {
        channel.contains('.')
            && channel
                .split('.')
                .all(|part| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit()))
    };
    // At least architecture, vendor and system.
    rest.split('-').count() >= 3
        && (matches!(channel, "stable" | "beta" | "nightly") || is_version())
}

/// Each target that a step builds for, and with what, for people.
pub fn choices() -> Vec<String> {
    [BOARD, SOFT_FLOAT, WASM]
        .map(|target| match find(target) {
            Some(compiler) => compiler.to_string(),
            None => format!("no compiler for {target} (rustup target add {target})"),
        })
        .to_vec()
}

/// Whether `rustc 1.95.0 (…)` is at least the oldest that will do.
pub fn is_new_enough(version: &str) -> bool {
    let number = version.split_whitespace().nth(1).unwrap_or("");
    let mut parts = number.split('.').map(|part| part.parse().unwrap_or(0));
    (parts.next().unwrap_or(0), parts.next().unwrap_or(0)) >= RUST
}

/// `cargo build` of the first compiler that can, and its options; [`Outcome::NotRun`] where there is none.
pub fn build_board() -> Result<(Command, Vec<String>), Outcome> {
    find_board().ok_or_else(|| {
        Outcome::NotRun(format!(
            "no compiler for {BOARD} (rustup target add {BOARD})"
        ))
    })
}

/// `cargo clippy` of the first compiler that has one for the target, and its options.
pub fn clippy_board() -> Option<(Command, Vec<String>)> {
    find(BOARD)?.clippy()
}

fn find_board() -> Option<(Command, Vec<String>)> {
    let chosen = |compiler: Compiler| {
        static SAID: Once = Once::new();
        SAID.call_once(|| println!("with {compiler}"));
        compiler.cargo(&["core"])
    };
    if let Some(compiler) = find(BOARD) {
        return Some(chosen(compiler));
    }
    add(BOARD);
    if let Some(compiler) = find(BOARD) {
        return Some(chosen(compiler));
    }
    debian()
}

/// Debian's newer Rust, which has the library as source only.
fn debian() -> Option<(Command, Vec<String>)> {
    const CARGO: &str = "/usr/bin/cargo";
    const CORE: &str = "/usr/lib/rustlib/src/rust/library/core";
    if !Path::new(CORE).is_dir() {
        packages::apt_get(&["rustc-web", "cargo-web", "rust-web-src", "lld"]);
    }
    if !Path::new(CORE).is_dir() {
        return None;
    }
    let version = shell::capture(shell::program("/usr/bin/rustc").arg("--version"));
    let version = version.unwrap_or_default();
    println!("with Debian's compiler ({version}) for {BOARD}, its `core` built from source");
    let mut cargo = shell::program(CARGO);
    cargo
        .arg("build")
        .env("RUSTC", "/usr/bin/rustc")
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld")
        .env_remove("RUSTUP_TOOLCHAIN");
    let options = [&format!("--target={BOARD}"), "-Zbuild-std=core"];
    let options = options.into_iter().chain(QUICK_BUILTINS);
    Some((cargo, options.map(str::to_owned).collect()))
}

#[cfg(test)]
mod tests {
    use super::{is_new_enough, is_released};

    #[test]
    fn compilers_before_the_oldest_supported_are_refused() {
        assert!(is_new_enough("rustc 1.95.0 (59807616e 2026-04-14)"));
        assert!(is_new_enough("rustc 1.101.0-nightly (abc 2027-01-01)"));
        assert!(is_new_enough("rustc 2.0.0"));
        assert!(!is_new_enough("rustc 1.94.1 (abc 2026-03-01)"));
        assert!(!is_new_enough(""));
    }

    #[test]
    fn a_toolchain_that_somebody_linked_is_told_from_rustups() {
        for name in [
            "stable-x86_64-unknown-linux-gnu",
            "1.95.0-aarch64-apple-darwin",
            "1.95-x86_64-pc-windows-msvc",
            "nightly-2026-05-01-x86_64-unknown-linux-gnu",
        ] {
            assert!(is_released(name), "{name}");
        }
        for name in [
            "1.95-dev",
            "stage1",
            "stage-1-of-x86_64",
            "dev.1-a-b-c",
            "",
            "1..0-a-b-c",
        ] {
            assert!(!is_released(name), "{name}");
        }
    }

    #[test]
    fn the_oldest_compiler_is_the_workspaces() {
        let manifest = include_str!("../../Cargo.toml");
        let (major, minor) = super::RUST;
        assert!(manifest.contains(&format!("rust-version = \"{major}.{minor}\"")));
    }
}
