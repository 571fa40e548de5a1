//! `cargo xtask live`: builds the WebAssembly module of the live page. The module is committed, so that a user of the program needs
//! no WebAssembly compiler.
//!
//! The same source and compiler give the same bytes in any folder, since paths are removed. The file `MADE.txt` beside the module
//! records the compiler. `cargo xtask wasm` builds the module again and compares it with the committed one.

use std::path::PathBuf;

use crate::outcome::Outcome;
use crate::toolchain::Compiler;
use crate::{shell, toolchain};

const TARGET: &str = toolchain::WASM;
const NAME: &str = "touchstone_live.wasm";

fn folder() -> PathBuf {
    shell::root().join("host-sim/live/module")
}

/// Text of the file `MADE.txt`, which records the compiler of the module.
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

/// Builds the WebAssembly module of the live page and returns its bytes.
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
    // Panic messages contain paths of source files. The flags keep this machine's folders out of the module.
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

/// Folders whose paths must not get into the module, with the text that replaces each. If several match a path, the compiler uses
/// the last.
fn remapped() -> Vec<(PathBuf, &'static str)> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")))
        .unwrap_or_default();
    let sources = home.join("registry/src");
    let mut all = vec![(home, "cargo")];
    // Each registry has its own folder below the sources.
    for entry in std::fs::read_dir(sources).into_iter().flatten().flatten() {
        all.push((entry.path(), "crates"));
    }
    all.push((shell::root(), "touchstone"));
    all
}

/// The reason why this compiler cannot reproduce the committed module; `None` if it can.
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

/// Checks that the committed module equals a new build of the present source.
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
