//! `cargo xtask live`: the live page's WebAssembly, which is committed so that a user of the program needs no second
//! target.
//!
//! The same source gives the same bytes with the same compiler, in any folder: paths are removed. A file beside the
//! module records how it was made, and `cargo xtask wasm` makes it again and compares.

use std::path::PathBuf;

use crate::outcome::Outcome;
use crate::toolchain::Compiler;
use crate::{shell, toolchain};

const TARGET: &str = toolchain::WASM;
const NAME: &str = "touchstone_live.wasm";

fn folder() -> PathBuf {
    shell::root().join("host-sim/live/module")
}

/// Text of the file beside the module.
fn about(compiler: &Compiler, bytes: &[u8]) -> String {
    format!(
        "made by    cargo xtask live\ncompiler   {}, its library {}\ntarget     {TARGET}\nprofile    live (Cargo.toml)\nbytes      {}\n",
        compiler.identity,
        compiler.library(),
        bytes.len()
    )
}

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask live".into());
    }
    let compiler = match toolchain::obtain(TARGET) {
        Ok(compiler) => compiler,
        Err(outcome) => return outcome,
    };
    let bytes = match build(&compiler) {
        Ok(bytes) => bytes,
        Err(outcome) => return outcome,
    };
    let file = folder().join(NAME);
    if let Err(error) = std::fs::write(&file, &bytes) {
        return Outcome::Failed(format!("{}: {error}", file.display()));
    }
    match std::fs::write(folder().join("MADE.txt"), about(&compiler, &bytes)) {
        Ok(()) => Outcome::Ok(format!("{NAME}, {} kB", bytes.len() / 1000)),
        Err(error) => Outcome::Failed(format!("MADE.txt: {error}")),
    }
}

/// Builds the module; gives its bytes.
fn build(compiler: &Compiler) -> Result<Vec<u8>, Outcome> {
    let (mut cargo, options) = compiler.cargo_for("rustc", &["std", "panic_abort"]);
    let target = shell::target("wasm").join(&compiler.version);
    cargo.args([
        "--package",
        "touchstone-live",
        "--lib",
        "--crate-type",
        "cdylib",
    ]);
    cargo
        .args(["--profile", "live", "--target-dir"])
        .arg(&target);
    // Messages of panics name their files: what a machine calls its folders is no part of the program.
    let separator = "\u{1f}";
    let flags: Vec<String> = remapped()
        .into_iter()
        .map(|(from, to)| format!("--remap-path-prefix={}={to}", from.display()))
        .collect();
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags.join(separator));
    match shell::run(cargo.args(options)) {
        Outcome::Ok(_) => {}
        other => return Err(other),
    }
    let file = target.join(TARGET).join("live").join(NAME);
    std::fs::read(&file).map_err(|error| Outcome::Failed(format!("{}: {error}", file.display())))
}

/// Folders whose names must not enter the bytes; of several that fit, the compiler takes the last.
fn remapped() -> Vec<(PathBuf, &'static str)> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")))
        .unwrap_or_default();
    let sources = home.join("registry/src");
    let mut all = vec![(home, "cargo")];
    // A folder for each place that crates come from, named after it.
    for entry in std::fs::read_dir(sources).into_iter().flatten().flatten() {
        all.push((entry.path(), "crates"));
    }
    all.push((shell::root(), "touchstone"));
    all
}

/// The reason why this compiler cannot make the committed module again; `None` where it can.
pub fn why_not_compared(compiler: &Compiler) -> Option<String> {
    let told = std::fs::read_to_string(folder().join("MADE.txt")).unwrap_or_default();
    let made_with = told
        .lines()
        .find_map(|line| line.strip_prefix("compiler   "))
        .unwrap_or("an unknown compiler");
    let here = format!("{}, its library {}", compiler.identity, compiler.library());
    (made_with != here).then(|| {
        format!("{NAME} not compared: made with {made_with}, here is {here}; `cargo xtask live` makes it anew")
    })
}

/// Checks that the committed module is built from the present source.
pub fn check(compiler: &Compiler) -> Outcome {
    if let Some(why) = why_not_compared(compiler) {
        return Outcome::NotRun(why);
    }
    let committed = std::fs::read(folder().join(NAME)).unwrap_or_default();
    match build(compiler) {
        Err(outcome) => outcome,
        Ok(bytes) if bytes == committed => Outcome::Ok(format!(
            "{NAME} is what its source gives, {} bytes",
            bytes.len()
        )),
        Ok(bytes) => Outcome::Failed(format!(
            "{NAME} is not what its source gives ({} bytes, built {}): cargo xtask live",
            committed.len(),
            bytes.len()
        )),
    }
}
