//! `cargo xtask chips`: runs the C library's programs on emulated Cortex-M0, M4F and M33, and prints a table of sizes and
//! instruction counts.
//!
//! The test `emulated` of `bindings/c` does the work. It builds the library for each chip, links C programs with it and runs them
//! in QEMU. The digests (hashes) of their results must equal those of this machine.

use crate::outcome::Outcome;
use crate::{packages, shell, toolchain};

/// Rust's targets of the chips.
const TARGETS: [&str; 3] = [
    "thumbv6m-none-eabi",
    toolchain::BOARD,
    "thumbv8m.main-none-eabihf",
];
/// Programs that the test starts, and the Debian packages that have them.
const TOOLS: [(&str, &[&str]); 2] = [
    (
        "arm-none-eabi-gcc",
        &["gcc-arm-none-eabi", "libnewlib-arm-none-eabi"],
    ),
    ("qemu-system-arm", &["qemu-system-arm"]),
];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask chips".into());
    }
    for (tool, packages) in TOOLS {
        let is_here = || packages::first_line(&[tool, "--version"]).is_some();
        if !is_here() {
            packages::apt_get(packages);
        }
        if !is_here() {
            let packages = packages.join(" ");
            return Outcome::NotRun(format!("no {tool} (apt-get install {packages})"));
        }
    }
    // A target that cannot be installed is no error here: the test reports the chips that it leaves out.
    for target in TARGETS {
        let _ = toolchain::obtain(target);
    }
    let mut cargo = shell::cargo_locked("test");
    cargo.args(["--package", "touchstone-c", "--test", "emulated"]);
    cargo.args(["--", "--ignored", "--nocapture"]);
    let mut left_out = Vec::new();
    let ran = shell::run_reading_all(&mut cargo, |line| {
        if let Some(why) = line.strip_prefix("not run on ") {
            left_out.push(why.to_owned());
        }
    });
    match ran {
        Outcome::Ok(_) if left_out.is_empty() => Outcome::Ok("the bits of this machine".into()),
        Outcome::Ok(_) => Outcome::NotRun(format!("on {}", left_out.join("; on "))),
        other => other,
    }
}
