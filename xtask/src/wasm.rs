//! `cargo xtask wasm`: what a browser needs builds for `wasm32-unknown-unknown`, which has neither files nor threads nor a clock.

use crate::outcome::Outcome;
use crate::{shell, toolchain};

const TARGET: &str = "wasm32-unknown-unknown";
/// Crates of the workspace; one that is not there yet is named and left out.
const PACKAGES: [&str; 3] = ["touchstone-control", "touchstone-world", "touchstone-sim"];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask wasm".into());
    }
    let is_there = |package: &&str| shell::capture(shell::cargo("pkgid").arg(package)).is_some();
    let (there, missing): (Vec<&str>, Vec<&str>) = PACKAGES.into_iter().partition(is_there);
    for package in &missing {
        println!("{package} is no crate of the workspace: left out");
    }
    if toolchain::find(TARGET).is_none() {
        toolchain::add(TARGET);
    }
    let Some(compiler) = toolchain::find(TARGET) else {
        return Outcome::NotRun(format!(
            "no compiler for {TARGET} (rustup target add {TARGET}, or apt-get install rustc-web rust-web-src)"
        ));
    };
    println!("with {compiler}");
    let (mut cargo, options) = compiler.cargo(&["std", "panic_abort"]);
    cargo.args(["--lib", "--target-dir"]);
    // One folder for each compiler: what two made must not be mixed.
    cargo.arg(shell::target("wasm").join(&compiler.version));
    for package in &there {
        cargo.args(["--package", package]);
    }
    match shell::run(cargo.args(options)) {
        Outcome::Ok(_) => Outcome::Ok(sentence(&there, &missing)),
        other => other,
    }
}

fn sentence(there: &[&str], missing: &[&str]) -> String {
    let built = format!("{} built", there.join(", "));
    match missing {
        [] => built,
        missing => format!("{built}; not there: {}", missing.join(", ")),
    }
}
