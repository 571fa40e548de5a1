//! `cargo xtask dist`: packs a release archive in `target/dist/` that can be used without a compiler.
//!
//! The step builds and checks the firmware of all boards as `cargo xtask firmware` does, and builds the program for this machine.
//! It packs them with guide and licences and unpacks the archive again. The unpacked program must then find the packed firmware
//! with an empty PATH.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::outcome::Outcome;
use crate::{firmware, inspect, shell, toolchain, wheel};

const USAGE: &str = "cargo xtask dist";

/// Features of the released program: `flash` and `log` without an external program, mesh files, Parquet files, key presses.
const FEATURES: &str = "touchstone/probe,touchstone/mesh,touchstone/parquet,touchstone/keys";
/// Cargo profile of the shipped program: optimised across crates and stripped.
const PROFILE: &str = "dist";

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage(USAGE.into());
    }
    made().unwrap_or_else(|outcome| outcome)
}

fn made() -> Result<Outcome, Outcome> {
    let folder = shell::target("dist");
    done(std::fs::create_dir_all(&folder), &folder)?;
    firmware::run(&[]).went_well()?;
    let [program, library] = built(&folder.join("build"))?;
    let (name, version) = (name(), folder.join("VERSION"));
    done(std::fs::write(&version, identity()), &version)?;

    let mut words: Vec<OsString> = vec!["dist".into(), (&folder).into(), (&name).into()];
    words.push(seconds().to_string().into());
    words.extend([version.into(), program.into()]);
    words.push(paired("library", &library));
    for &board in firmware::BOARDS.iter() {
        words.push(paired(board, &firmware::program(board)));
    }
    for metadata in metadata(&folder)? {
        words.push(paired("metadata", &metadata));
    }
    // Removes the files of an older archive, which the new one may not contain.
    let unpacked = folder.join(&name);
    if unpacked.exists() {
        done(std::fs::remove_dir_all(&unpacked), &unpacked)?;
    }
    let packed = inspect::call(words);
    if !matches!(packed, Outcome::Ok(_)) {
        return Ok(packed);
    }
    tried(&unpacked)?;
    Ok(packed)
}

/// Flags of the compiler, in the form of `CARGO_ENCODED_RUSTFLAGS`, that remove paths of this machine's folders from the output.
pub fn without_paths() -> String {
    let home = std::env::var_os("CARGO_HOME").map_or_else(
        || PathBuf::from(std::env::var_os("HOME").unwrap_or_default()).join(".cargo"),
        PathBuf::from,
    );
    let remap = |from: &Path, to: &str| format!("--remap-path-prefix={}={to}", from.display());
    [remap(&home, "cargo"), remap(&shell::root(), "touchstone")].join("\x1f")
}

/// Builds the program and the shared library for FMUs for this machine, and returns their paths. Neither contains paths of this
/// machine's folders.
fn built(folder: &Path) -> Result<[PathBuf; 2], Outcome> {
    let mut cargo = shell::cargo_locked("build");
    cargo
        .args(["--profile", PROFILE, "--package", "touchstone"])
        .args(["--package", "touchstone-fmi"])
        .arg("--target-dir")
        .arg(folder)
        .args(["--features", FEATURES])
        .env_remove("RUSTFLAGS")
        .env("CARGO_ENCODED_RUSTFLAGS", without_paths());
    shell::run(&mut cargo).went_well()?;
    let name = format!("touchstone{}", std::env::consts::EXE_SUFFIX);
    Ok([name, wheel::fmu_library()].map(|name| folder.join(PROFILE).join(name)))
}

/// Writes the output of `cargo metadata` for the program and for the firmware to one file each; returns the paths of the files.
fn metadata(folder: &Path) -> Result<Vec<PathBuf>, Outcome> {
    let host = toolchain::host();
    let both = [
        ("touchstone", "Cargo.toml", host.as_str()),
        ("firmware", "firmware/Cargo.toml", toolchain::BOARD),
    ];
    let mut files = Vec::new();
    for (name, manifest, target) in both {
        let mut cargo = shell::cargo_locked("metadata");
        cargo.args(["--format-version", "1", "--manifest-path", manifest]);
        cargo.args(["--filter-platform", target]);
        if name == "touchstone" {
            cargo.args(["--features", FEATURES]);
        }
        let text = shell::capture(&mut cargo)
            .ok_or_else(|| Outcome::Failed(format!("`{}` failed", shell::shown(&cargo))))?;
        let file = folder.join(format!("{name}.json"));
        done(std::fs::write(&file, text), &file)?;
        files.push(file);
    }
    Ok(files)
}

/// Checks that the unpacked program runs with an empty PATH. It must find the boards' firmware files beside it, and need no
/// external program to flash them.
fn tried(unpacked: &Path) -> Result<(), Outcome> {
    let mut calls = vec![
        vec!["run", "thesis-knob", "--quiet"],
        vec!["export-fmu", "tap", "--out", "../../tried", "--force"],
    ];
    for &board in firmware::BOARDS.iter() {
        calls.push(vec!["flash", "--dry-run", "--board", board]);
    }
    let nowhere = unpacked.join("docs");
    for arguments in calls {
        let mut command = Command::new(unpacked.join("touchstone"));
        command.args(&arguments).env("PATH", "");
        shell::run(command.current_dir(&nowhere)).went_well()?;
    }
    Ok(())
}

/// Name of the archive, such as `touchstone-0.1.0-x86_64-linux`.
fn name() -> String {
    let (machine, system) = (std::env::consts::ARCH, std::env::consts::OS);
    format!(
        "touchstone-{}-{machine}-{system}",
        env!("CARGO_PKG_VERSION")
    )
}

/// Text of the file `VERSION` in the archive: version, commit, date of the commit, compiler.
fn identity() -> String {
    let changed = git(&["status", "--porcelain"]).is_none_or(|changes| !changes.is_empty());
    let changed = if changed {
        ", with changes that are in no commit"
    } else {
        ""
    };
    let unknown = || "unknown".to_owned();
    format!(
        "touchstone {}\ncommit {}{changed}\ndate {}\ncompiler {}\n",
        env!("CARGO_PKG_VERSION"),
        git(&["rev-parse", "HEAD"]).unwrap_or_else(unknown),
        git(&["show", "--no-patch", "--format=%cI"]).unwrap_or_else(unknown),
        toolchain::active_version(),
    )
}

/// Time stamp of all files in the archive, in seconds since 1970: `SOURCE_DATE_EPOCH` if set, else the time of the commit.
fn seconds() -> u64 {
    let number = |text: String| text.parse().ok();
    std::env::var("SOURCE_DATE_EPOCH")
        .ok()
        .and_then(number)
        .or_else(|| git(&["show", "--no-patch", "--format=%ct"]).and_then(number))
        .unwrap_or(0)
}

fn git(words: &[&str]) -> Option<String> {
    shell::capture(shell::program("git").args(words))
}

fn paired(name: &str, path: &Path) -> OsString {
    let mut word = OsString::from(format!("{name}="));
    word.push(path);
    word
}

fn done(result: std::io::Result<()>, path: &Path) -> Result<(), Outcome> {
    result.map_err(|why| Outcome::Failed(format!("{}: {why}", path.display())))
}
