//! Finds an installed Rust compiler that can build for another machine. A compiler of rustup with the target installed is
//! preferred, then one with the source of Rust's core library, such as Debian's.

use std::fmt;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Mutex, Once, PoisonError};

use crate::outcome::Outcome;
use crate::{packages, shell};

/// Version of the oldest compiler that builds the workspace: `rust-version` in Cargo.toml.
const RUST: (u32, u32) = (1, 95);

/// Target for a Cortex-M4 without its float unit: code that still calculates with floats must call float functions by name.
pub const SOFT_FLOAT: &str = "thumbv7em-none-eabi";
/// Target for a Cortex-M4 with its float unit.
pub const BOARD: &str = "thumbv7em-none-eabihf";

/// Target for browsers (WebAssembly).
pub const WASM: &str = "wasm32-unknown-unknown";

/// Options of cargo that compile the compiler's runtime library (divisions, memory copies) for speed if it is built from source. An
/// installed runtime library is compiled for speed too. The control interrupt calls it.
const QUICK_BUILTINS: [&str; 2] = [
    "--config",
    "profile.release.package.compiler_builtins.opt-level=3",
];

/// Where a compiler comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Origin {
    /// The compiler of the active toolchain, with which this program was started.
    Active,
    /// A toolchain with this name that a user linked, so it is not one of rustup's releases. Its version number says nothing about
    /// its content.
    Linked(String),
    /// A toolchain of rustup other than the default, by name.
    Toolchain(String),
    /// A package of the operating system, independent of rustup.
    System,
}

/// A Rust compiler that can build for a target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Compiler {
    target: &'static str,
    origin: Origin,
    /// Version number, such as `1.95.0`.
    pub version: String,
    /// The version text with the compiler's commit: two builds of one version may produce different binaries.
    pub identity: String,
    /// Whether the target's `core` library is not installed and must be built from source.
    from_source: bool,
}

/// A Rust compiler that may or may not be able to build for the target.
#[derive(Clone)]
struct Candidate {
    origin: Origin,
    version: String,
    identity: String,
    library: PathBuf,
}

/// Path of the compiler that a system package installs.
const SYSTEM: &str = "/usr/bin/rustc";
/// Linker for the system package's compiler, which comes without Rust's own linker.
const SYSTEM_LINKER: &str = "ld.lld";

impl Origin {
    fn rustc(&self) -> Command {
        match self {
            Origin::Active | Origin::Linked(_) => shell::program("rustc"),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                rustup.args(["run", name, "rustc"]);
                rustup
            }
            Origin::System => shell::program(SYSTEM),
        }
    }

    /// Finds version and library folder of a compiler; `None` if the compiler cannot build this workspace.
    fn look(self) -> Option<Candidate> {
        // Without its linker this compiler can build nothing for a board, so it counts as missing.
        let links = |linker| shell::capture(shell::program(linker).arg("--version")).is_some();
        if matches!(self, Origin::System) && !links(SYSTEM_LINKER) {
            return None;
        }
        let version = shell::capture(self.rustc().arg("--version"))?;
        let sysroot = shell::capture(self.rustc().args(["--print", "sysroot"]))?;
        let mut identity = version.trim().to_owned();
        if let Origin::Linked(name) = &self {
            identity = format!("{identity}, linked as {name}");
        }
        is_new_enough(&version).then(|| Candidate {
            origin: self,
            version: version.split_whitespace().nth(1).unwrap_or("").to_owned(),
            identity,
            library: PathBuf::from(sysroot).join("lib/rustlib"),
        })
    }
}

impl fmt::Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.origin {
            Origin::Active | Origin::Linked(_) => write!(f, "the active toolchain")?,
            Origin::Toolchain(name) => write!(f, "{name}")?,
            Origin::System => write!(f, "{SYSTEM}")?,
        }
        let core = self.library();
        write!(f, " ({}) for {}, `core` {core}", self.identity, self.target)
    }
}

impl Compiler {
    /// Text for people: whether the target's library is installed or built from source. The two produce different binaries.
    pub const fn library(&self) -> &'static str {
        if self.from_source {
            "built from source"
        } else {
            "as installed"
        }
    }

    /// The command `cargo build` with this compiler, and its options. `libraries` names those of Rust's own libraries that are
    /// built from source if they are not installed.
    pub fn cargo(&self, libraries: &[&str]) -> (Command, Vec<String>) {
        self.cargo_for("build", libraries)
    }

    /// The command `cargo clippy` with this compiler, and its options; `None` if the compiler has no Clippy for the target.
    pub fn clippy(&self) -> Option<(Command, Vec<String>)> {
        let has_it = match &self.origin {
            _ if self.from_source => false,
            Origin::Active | Origin::Linked(_) => packages::missing_component("clippy").is_none(),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                shell::capture(rustup.args(["run", name, "cargo", "clippy", "--version"])).is_some()
            }
            Origin::System => false,
        };
        has_it.then(|| self.cargo_for("clippy", &["core"]))
    }

    /// A cargo command with this compiler for any subcommand, and its options.
    pub fn cargo_for(&self, subcommand: &str, libraries: &[&str]) -> (Command, Vec<String>) {
        let mut cargo = match &self.origin {
            Origin::Active | Origin::Linked(_) => shell::cargo_locked(subcommand),
            Origin::Toolchain(name) => {
                let mut rustup = shell::program("rustup");
                rustup.args(["run", name, "cargo", subcommand]);
                // These variables name the active toolchain's programs.
                for key in ["RUSTUP_TOOLCHAIN", "RUSTC", "CARGO", "RUSTDOC"] {
                    rustup.env_remove(key);
                }
                // If another rustc comes first in the PATH, such as a system package's, cargo would take it. So the path is given.
                let mut which = shell::program("rustup");
                if let Some(path) =
                    shell::capture(which.args(["which", "rustc", "--toolchain", name]))
                {
                    rustup.env("RUSTC", path.trim());
                }
                rustup
            }
            Origin::System => {
                let mut cargo = shell::cargo_locked(subcommand);
                cargo.env("RUSTC", SYSTEM).env_remove("RUSTDOC");
                let target = self.target.to_uppercase().replace('-', "_");
                cargo.env(format!("CARGO_TARGET_{target}_LINKER"), SYSTEM_LINKER);
                cargo
            }
        };
        // A user's flags are for this machine's own code, such as its processor, and would be wrong for the target.
        cargo
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_ENCODED_RUSTFLAGS");
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

/// Finds a compiler that has the target installed; failing that, one that has the source of Rust's core library.
pub fn find(target: &'static str) -> Option<Compiler> {
    let candidates = candidates();
    let with = |part: &str, from_source| {
        let mut having = candidates
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

/// Same as [`find`], but installs what is missing: rustup fetches the target, or apt-get installs Debian's compiler with the
/// library's source.
pub fn obtain(target: &'static str) -> Result<Compiler, Outcome> {
    let fetch: [fn(&str); 2] = [
        |target| {
            let _ = shell::run(shell::program("rustup").args(["target", "add", target]));
        },
        |_| packages::apt_get(&["rustc-web", "cargo-web", "rust-web-src", "lld"]),
    ];
    for fetch in fetch {
        if let Some(compiler) = find(target) {
            return Ok(compiler);
        }
        fetch(target);
        forget();
    }
    find(target).ok_or_else(|| {
        Outcome::NotRun(format!(
            "no compiler for {target}: rustup target add {target}, or apt-get install rustc-web cargo-web rust-web-src lld"
        ))
    })
}

/// All compilers found, cached because each search starts two processes.
static CANDIDATES: Mutex<Option<Vec<Candidate>>> = Mutex::new(None);

fn candidates() -> Vec<Candidate> {
    let mut known = CANDIDATES.lock().unwrap_or_else(PoisonError::into_inner);
    known.get_or_insert_with(ask).clone()
}

/// Clears the cache of compilers, after an installation.
fn forget() {
    *CANDIDATES.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

fn ask() -> Vec<Candidate> {
    let active = match linked() {
        None => Origin::Active,
        Some(name) => Origin::Linked(name),
    };
    let others = toolchains().into_iter().map(Origin::Toolchain);
    let mut origins: Vec<_> = others.chain([Origin::System]).collect();
    // A toolchain that a user linked comes last.
    let place = if active == Origin::Active {
        0
    } else {
        origins.len()
    };
    origins.insert(place, active);
    origins.into_iter().filter_map(Origin::look).collect()
}

/// The name of the active toolchain if it is not one of rustup's releases, because a user linked it; otherwise `None`.
fn linked() -> Option<String> {
    let shown = shell::capture(shell::program("rustup").args(["show", "active-toolchain"]))?;
    let name = shown.split_whitespace().next()?.to_owned();
    (!is_released(&name)).then_some(name)
}

/// Version of the active toolchain's compiler; empty if it cannot be found.
pub fn active_version() -> String {
    let version = shell::capture(Origin::Active.rustc().arg("--version")).unwrap_or_default();
    version.split_whitespace().nth(1).unwrap_or("").to_owned()
}

/// The machine for which the active compiler builds by default, as a target name such as `x86_64-unknown-linux-gnu`.
pub fn host() -> String {
    let all = shell::capture(Origin::Active.rustc().arg("-vV")).unwrap_or_default();
    let host = all.lines().find_map(|line| line.strip_prefix("host: "));
    host.unwrap_or_default().to_owned()
}

/// Names of the toolchains that are rustup's releases. Toolchains that a user linked are left out, because their version says
/// nothing about their content.
fn toolchains() -> Vec<String> {
    let list = shell::capture(shell::program("rustup").args(["toolchain", "list"]));
    list.unwrap_or_default()
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| is_released(name))
        .map(str::to_owned)
        .collect()
}

/// Whether a toolchain's name has the form of rustup's releases: a channel or a version, perhaps a date, and the machine. A user
/// cannot link a toolchain under such a name.
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

/// For each target for which a step builds, a line of text with the compiler that the step uses. A missing compiler is installed
/// now, as the step would do.
pub fn choices() -> Vec<String> {
    [BOARD, SOFT_FLOAT, WASM]
        .map(|target| match obtain(target) {
            Ok(compiler) => compiler.to_string(),
            Err(why) => why.reason().to_owned(),
        })
        .to_vec()
}

/// Whether a version text such as `rustc 1.95.0 (…)` names a compiler that is new enough for the workspace.
pub fn is_new_enough(version: &str) -> bool {
    let number = version.split_whitespace().nth(1).unwrap_or("");
    let mut parts = number.split('.').map(|part| part.parse().unwrap_or(0));
    (parts.next().unwrap_or(0), parts.next().unwrap_or(0)) >= RUST
}

/// The command `cargo build` for the boards with the first suitable compiler, and its options; [`Outcome::NotRun`] if there is
/// none.
pub fn build_board() -> Result<(Command, Vec<String>), Outcome> {
    let compiler = obtain(BOARD)?;
    static SAID: Once = Once::new();
    SAID.call_once(|| println!("with {compiler}"));
    Ok(compiler.cargo(&["core"]))
}

/// The command `cargo clippy` for the boards, and its options, with the first compiler that has a Clippy for the target.
pub fn clippy_board() -> Option<(Command, Vec<String>)> {
    find(BOARD)?.clippy()
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
