//! `cargo xtask wasm`: checks that the crates for a browser compile for `wasm32-unknown-unknown`, a target without files, threads
//! or a clock. The step also compares the live page's committed module with a new build.

use crate::outcome::Outcome;
use crate::{live, shell, toolchain};

const TARGET: &str = toolchain::WASM;
const PACKAGES: [&str; 3] = ["touchstone-control", "touchstone-world", "touchstone-sim"];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask wasm".into());
    }
    let compiler = match toolchain::obtain(TARGET) {
        Ok(compiler) => compiler,
        Err(outcome) => return outcome,
    };
    println!("with {compiler}");
    // If the page's module is built again below, that build compiles these crates to code, so a check is enough here.
    let subcommand = if live::why_not_compared(&compiler).is_none() {
        "check"
    } else {
        "build"
    };
    let (mut cargo, options) = compiler.cargo_for(subcommand, &["std", "panic_abort"]);
    cargo.args(["--lib", "--target-dir"]);
    // One folder per compiler version, so that results of different compilers are never mixed.
    cargo.arg(shell::target("wasm").join(&compiler.version));
    for package in PACKAGES {
        cargo.args(["--package", package]);
    }
    let checked = shell::run(cargo.args(options));
    if !matches!(checked, Outcome::Ok(_)) {
        return checked;
    }
    let words = |module: &str| Outcome::Ok(format!("{} compile; {module}", PACKAGES.join(", ")));
    match live::check(&compiler) {
        // The crates compile, also if the module could not be compared.
        Outcome::Ok(module) | Outcome::NotRun(module) => words(&module),
        other => other,
    }
}
