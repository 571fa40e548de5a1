//! `cargo xtask thumb`: every law on a Cortex-M4F, emulated by QEMU.
//!
//! The vectors of `tests/vectors` are played by this machine and by `tests/thumb` on the emulated one; every digest of the
//! two must be the same. The second also counts its instructions per tick: exactly, but only for the ticks that were played,
//! and instructions are not cycles. Then the program is looked at: what a tick reaches must be free of floats and panics.

pub mod elf;
mod report;
pub mod stack;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::microcontroller::{self, TARGET};
use crate::outcome::Outcome;
use crate::{setup, shell};
use report::Report;

const QEMU: &str = "qemu-system-arm";
/// DESIGN's budget for one tick of the enhanced law, in instructions.
const BUDGET: u64 = 600;

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask thumb".into());
    }
    match compare() {
        Ok(outcome) | Err(outcome) => outcome,
    }
}

fn compare() -> Result<Outcome, Outcome> {
    let (build, options) = microcontroller::build()?;
    if !has_qemu() {
        setup::apt_get(&[QEMU]);
    }
    if !has_qemu() {
        return Err(Outcome::NotRun(format!("no QEMU (apt-get install {QEMU})")));
    }
    let program = self::build(build, &options)?;
    let mut report = Report::default();
    let mut golden = shell::cargo_locked("run");
    golden.args(["--quiet", "--release", "--package", "touchstone-vectors"]);
    read(golden.args(["--example", "golden"]), |line| {
        report.desktop(line)
    })?;
    read(&mut qemu(&program), |line| report.microcontroller(line))?;
    println!("\n{}", report.table());
    let mut wrong = report.differences();
    let file = std::fs::read(&program)
        .map_err(|error| Outcome::Failed(format!("{}: {error}", program.display())))?;
    let program = elf::Program::read(&file)
        .ok_or_else(|| Outcome::Failed("the program is no ELF file of 32 bits".into()))?;
    wrong.extend(look(&program));
    let worst = report.worst_of("enhanced");
    let budget = if worst > BUDGET { "OVER" } else { "within" };
    let budget =
        format!("enhanced tick at most {worst} instructions, {budget} the budget of {BUDGET}");
    println!("{budget}");
    for what in &wrong {
        println!("WRONG: {what}");
    }
    Ok(match wrong.len() {
        0 => Outcome::Ok(format!("{} digests equal; {budget}", report.equal())),
        count => Outcome::Failed(format!("{count} wrong, the first: {}", wrong[0])),
    })
}

fn has_qemu() -> bool {
    shell::capture(shell::program(QEMU).arg("--version")).is_some()
}

/// Builds the program; where it is.
fn build(mut cargo: Command, options: &[String]) -> Result<PathBuf, Outcome> {
    let folder = shell::target("thumb");
    cargo
        .args(["--quiet", "--release", "--manifest-path"])
        .args(["tests/thumb/Cargo.toml", "--target-dir"])
        .arg(&folder)
        .args(options)
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    match shell::run(&mut cargo) {
        Outcome::Ok(_) => Ok(folder.join(TARGET).join("release/touchstone-thumb")),
        failed => Err(failed),
    }
}

/// Every instruction takes 1024 ns of the emulated board's time, which is how the program counts them.
fn qemu(program: &Path) -> Command {
    let mut qemu = shell::program(QEMU);
    qemu.args(["-M", "mps2-an386", "-icount", "shift=10", "-nographic"])
        .args(["-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(program);
    qemu
}

/// Runs with the output left to `line`; shown only where something failed.
fn read(command: &mut Command, mut line: impl FnMut(&str)) -> Result<(), Outcome> {
    println!("$ {}", shell::shown(command));
    let output = command
        .stdin(std::process::Stdio::null())
        .output()
        .map_err(|error| Outcome::Failed(error.to_string()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().for_each(&mut line);
    if output.status.success() {
        return Ok(());
    }
    let last: Vec<&str> = text.lines().rev().take(3).collect();
    println!(
        "{}{}",
        String::from_utf8_lossy(&output.stderr),
        last.join("\n")
    );
    Err(Outcome::Failed(format!(
        "`{}` failed",
        shell::shown(command)
    )))
}

/// Prints what a tick reaches; what of it should not be there.
fn look(program: &elf::Program) -> Vec<String> {
    let mut wrong = Vec::new();
    println!(
        "{:<42}{:>8}{:>14}",
        "code, with all that it calls", "bytes", "instructions"
    );
    for (function, what) in [
        ("enhanced_fixed32", "enhanced law, 32 bits"),
        ("tick_fixed32", "all laws, 32 bits"),
        ("tick_fixed16", "all laws, 16 bits"),
        (
            "penetration_fixed32",
            "encoder count to penetration, 32 bits",
        ),
    ] {
        let Some(reach) = program.reach(function) else {
            wrong.push(format!("{function} is not in the program"));
            continue;
        };
        println!("{what:<42}{:>8}{:>14}", reach.bytes, reach.instructions);
        let named = |is_bad: fn(&str) -> bool| reach.functions.iter().filter(move |n| is_bad(n));
        wrong.extend(named(is_panic).map(|name| format!("{what}: a panic, {name}")));
        wrong.extend(named(is_soft_float).map(|name| format!("{what}: a float, {name}")));
        wrong.extend(
            reach
                .float_unit
                .iter()
                .map(|place| format!("{what}: the float unit, {place}")),
        );
        wrong.extend(
            reach
                .unknown
                .iter()
                .map(|place| format!("{what}: a call to where? {place}")),
        );
    }
    let anywhere: Vec<_> = program.names().filter(|name| is_soft_float(name)).collect();
    let panics = program.names().filter(|name| is_panic(name)).count();
    println!(
        "in the whole program: {} soft-float functions, {panics} of panics (its printing's)",
        anywhere.len()
    );
    wrong.extend(
        anywhere
            .iter()
            .map(|name| format!("in the program: a float, {name}")),
    );
    wrong
}

pub fn is_panic(name: &str) -> bool {
    ["panic", "unwrap_failed", "expect_failed", "slice_index"]
        .iter()
        .any(|word| name.contains(word))
}

/// The names of the Arm ABI's float functions, and of the compiler's own.
pub fn is_soft_float(name: &str) -> bool {
    const ENDINGS: [&str; 6] = ["2f", "2d", "2iz", "2uiz", "2lz", "2ulz"];
    match name.strip_prefix("__aeabi_") {
        Some(rest) => rest.starts_with(['f', 'd']) || ENDINGS.iter().any(|end| rest.ends_with(end)),
        None => name.starts_with("__") && (name.ends_with("sf3") || name.ends_with("df3")),
    }
}

#[cfg(test)]
mod tests {
    use super::{is_panic, is_soft_float};

    #[test]
    fn names_of_floats_and_panics_are_known() {
        for float in [
            "__aeabi_fadd",
            "__aeabi_dmul",
            "__aeabi_i2f",
            "__aeabi_f2iz",
            "__addsf3",
        ] {
            assert!(is_soft_float(float), "{float}");
        }
        for integer in [
            "__aeabi_uldivmod",
            "__aeabi_lmul",
            "__aeabi_memcpy4",
            "__udivmoddi4",
        ] {
            assert!(!is_soft_float(integer), "{integer}");
        }
        assert!(is_panic("_ZN4core9panicking5panic17h0E"));
        assert!(!is_panic("_ZN15touchstone_thumb12tick_fixed32E"));
    }
}
