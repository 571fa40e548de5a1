//! Build script. Compiles into the program the Git commit and the compiler from which it was built. Without a checkout of this
//! repository the commit is that of the package, if `cargo package` made it; else the program says that it knows no commit.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=TOUCHSTONE_COMPILER={}", compiler());
    let (commit, modified) = checkout().or_else(packaged).unwrap_or_default();
    println!("cargo::rustc-env=TOUCHSTONE_COMMIT={commit}");
    println!("cargo::rustc-env=TOUCHSTONE_MODIFIED={modified}");
}

/// Name and version of the Rust compiler, as the compiler prints them.
fn compiler() -> String {
    std::env::var_os("RUSTC")
        .and_then(|rustc| Command::new(rustc).arg("--version").output().ok())
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .map_or("unknown".to_owned(), |text| text.trim().to_owned())
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// Commit of the Git checkout, and whether the program's sources differ from that commit; `None` outside a checkout.
fn checkout() -> Option<(String, bool)> {
    // A package that was unpacked inside another checkout does not belong to that checkout.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let commit = git(&["rev-parse", "HEAD"])?;
    let root = git(&["rev-parse", "--show-toplevel"])?;
    let sources = [
        "control",
        "drive",
        "protocol",
        "host-sim",
        "scenes",
        "Cargo.toml",
        "Cargo.lock",
    ];
    let mut status = vec![
        "-C",
        &root,
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
    ];
    status.extend(sources);
    let modified = !git(&status)?.is_empty();
    // A commit or a change of branch writes HEAD or its log. A listed path that does not exist would make Cargo run this script
    // in every build, so only existing paths are listed.
    let mut watched: Vec<String> = ["HEAD", "logs/HEAD"]
        .iter()
        .filter_map(|file| git(&["rev-parse", "--git-path", file]))
        .collect();
    watched.extend(sources.iter().map(|source| format!("{root}/{source}")));
    for path in watched.iter().filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
    Some((commit, modified))
}

/// Commit that `cargo package` stored in the package, and whether the sources were modified; `None` outside a package.
fn packaged() -> Option<(String, bool)> {
    let text = std::fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let commit = text.split("\"sha1\"").nth(1)?.split('"').nth(1)?;
    Some((commit.to_owned(), text.contains("\"dirty\": true")))
}
