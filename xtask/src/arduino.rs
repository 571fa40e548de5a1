//! `cargo xtask arduino`: packs the C library for Arduino and PlatformIO, `target/arduino/Touchstone-VERSION.zip`. The libraries in
//! it are already compiled, so that a user needs no Rust.
//!
//! For each processor folder the step then compiles the example sketches with the options of boards with that processor, and links
//! them with the packed files.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::outcome::Outcome;
use crate::{dist, inspect, packages, shell, toolchain};

const USAGE: &str = "cargo xtask arduino";
/// Name of the library and of the folder in the archive.
const NAME: &str = "Touchstone";
const LIBRARY: &str = "libtouchstone_c.a";

/// A folder below `src` in which Arduino looks for a library. Its name is the board's `build.mcu`. A folder inside it is used if
/// its name fits the board's options: the floating-point unit, and whether floats are passed in float registers.
struct Place {
    folder: &'static str,
    /// Rust's target. It must pass floats in the same registers as the sketch.
    target: &'static str,
    /// Options with which boards of this processor compile sketches.
    flags: &'static [&'static str],
}

const fn place(
    folder: &'static str,
    target: &'static str,
    flags: &'static [&'static str],
) -> Place {
    Place {
        folder,
        target,
        flags,
    }
}

const M0: &str = "thumbv6m-none-eabi";
const M3: &str = "thumbv7m-none-eabi";
const M33: &str = "thumbv8m.main-none-eabi";
const M33F: &str = "thumbv8m.main-none-eabihf";
const HARD: &str = "-mfloat-abi=hard";
const SOFT: &str = "-mfloat-abi=softfp";
const PLACES: [Place; 12] = [
    place("cortex-m0", M0, &["-mcpu=cortex-m0"]),
    place("cortex-m0plus", M0, &["-mcpu=cortex-m0plus"]),
    place("cortex-m3", M3, &["-mcpu=cortex-m3"]),
    // This folder is also used by boards with a floating-point unit that pass floats in integer registers.
    place(
        "cortex-m4",
        toolchain::SOFT_FLOAT,
        &["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", SOFT],
    ),
    place(
        "cortex-m4/fpv4-sp-d16-hard",
        toolchain::BOARD,
        &["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", HARD],
    ),
    place(
        "cortex-m7",
        toolchain::SOFT_FLOAT,
        &["-mcpu=cortex-m7", "-mfpu=fpv5-d16", SOFT],
    ),
    place(
        "cortex-m7/fpv4-sp-d16-hard",
        toolchain::BOARD,
        &["-mcpu=cortex-m7", "-mfpu=fpv4-sp-d16", HARD],
    ),
    place(
        "cortex-m7/fpv5-d16-hard",
        toolchain::BOARD,
        &["-mcpu=cortex-m7", "-mfpu=fpv5-d16", HARD],
    ),
    // Teensy 4 has the chip's name as `build.mcu`.
    place(
        "imxrt1062/fpv5-d16-hard",
        toolchain::BOARD,
        &["-mcpu=cortex-m7", "-mfpu=fpv5-d16", HARD],
    ),
    place("cortex-m33", M33, &["-mcpu=cortex-m33", SOFT]),
    place(
        "cortex-m33/fpv4-sp-d16-hard",
        M33F,
        &["-mcpu=cortex-m33", "-mfpu=fpv4-sp-d16", HARD],
    ),
    place(
        "cortex-m33/fpv5-sp-d16-hard",
        M33F,
        &["-mcpu=cortex-m33", "-mfpu=fpv5-sp-d16", HARD],
    ),
];

/// Files of the archive: path in it, path in the workspace.
const FILES: [(&str, &str); 10] = [
    (
        "library.properties",
        "bindings/c/arduino/library.properties",
    ),
    ("library.json", "bindings/c/arduino/library.json"),
    ("choose_library.py", "bindings/c/arduino/choose_library.py"),
    ("README.md", "bindings/c/README.md"),
    ("LICENSE-APACHE", "LICENSE-APACHE"),
    ("LICENSE-MIT", "LICENSE-MIT"),
    ("src/touchstone.h", "bindings/c/include/touchstone.h"),
    ("src/no_library.c", "bindings/c/arduino/no_library.c"),
    (
        "examples/guarded_pid/guarded_pid.ino",
        "bindings/c/examples/guarded_pid/guarded_pid.ino",
    ),
    (
        "examples/simplefoc_knob/simplefoc_knob.ino",
        "bindings/c/examples/simplefoc_knob/simplefoc_knob.ino",
    ),
];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage(USAGE.into());
    }
    made().unwrap_or_else(|outcome| outcome)
}

fn made() -> Result<Outcome, Outcome> {
    const TOOLS: [&str; 3] = [
        "gcc-arm-none-eabi",
        "libnewlib-arm-none-eabi",
        "libstdc++-arm-none-eabi-newlib",
    ];
    let is_here = || packages::first_line(&["arm-none-eabi-g++", "--version"]).is_some();
    if !is_here() {
        packages::apt_get(&TOOLS);
    }
    if !is_here() {
        return Err(Outcome::NotRun(format!(
            "no arm-none-eabi-g++ (apt-get install {})",
            TOOLS.join(" ")
        )));
    }
    let out = shell::target("arduino");
    let root = out.join(NAME);
    // Removes the files of an older archive, which the new one may not contain.
    if root.exists() {
        done(std::fs::remove_dir_all(&root), &root)?;
    }
    let mut packed = Vec::new();
    for (inside, path) in FILES {
        copy(&shell::root().join(path), &root.join(inside))?;
        packed.push(inside.to_owned());
    }
    for place in &PLACES {
        let inside = format!("src/{}/{LIBRARY}", place.folder);
        let library = root.join(&inside);
        copy(&built(place.target, &out.join("build"))?, &library)?;
        // Removes what the linker does not need, the largest part of the file: the compiler's intermediate code and debug
        // information.
        let mut strip = shell::program("arm-none-eabi-strip");
        strip.args(["--strip-debug", "--enable-deterministic-archives"]);
        strip.args(["--remove-section=.llvmbc", "--remove-section=.llvmcmd"]);
        shell::run(strip.arg(&library)).went_well()?;
        packed.push(inside);
    }
    for place in &PLACES {
        tried(place, &root, &out)?;
    }
    refused(&root, &out)?;

    let archive = out.join(format!("{NAME}-{}.zip", env!("CARGO_PKG_VERSION")));
    let mut words: Vec<OsString> = vec!["zip".into(), archive.into(), out.into()];
    words.extend(
        packed
            .iter()
            .map(|inside| format!("{NAME}/{inside}").into()),
    );
    Ok(inspect::call(words))
}

/// Builds the C library for a target and returns its path. The library contains no paths of this machine's folders.
fn built(target: &'static str, folder: &Path) -> Result<PathBuf, Outcome> {
    let compiler = toolchain::obtain(target)?;
    let (mut cargo, options) = compiler.cargo(&["core"]);
    cargo
        .args(["--quiet", "--profile", "embedded"])
        .args(["--package", "touchstone-c", "--target-dir"])
        .arg(folder)
        .args(options)
        .env("CARGO_ENCODED_RUSTFLAGS", dist::without_paths());
    shell::run(&mut cargo).went_well()?;
    Ok(folder.join(target).join("embedded").join(LIBRARY))
}

/// The command that compiles a sketch as Arduino does for a board with the options `flags`, and links it with the packed library in
/// a folder of `src`.
fn sketch(example: &str, flags: &[&str], library: &str, root: &Path, out: &Path) -> Command {
    let stand_in = shell::root().join("bindings/c/tests/stand_in");
    let source = root.join("src");
    let mut compile = shell::program("arm-none-eabi-g++");
    compile
        .args(flags)
        .args(["-mthumb", "-Os", "-std=gnu++17", "-Wall", "-Wextra"])
        .args([
            "-Werror",
            "-fno-exceptions",
            "-fno-rtti",
            "-Wl,-z,noexecstack",
        ])
        .args(["-fno-threadsafe-statics", "-Wl,--gc-sections"])
        .args(["--specs=nano.specs", "--specs=nosys.specs"])
        .arg("-I")
        .arg(&source)
        .arg("-I")
        .arg(&stand_in)
        .args(["-x", "c++"])
        .arg(root.join(format!("examples/{example}/{example}.ino")))
        .arg(stand_in.join(format!("run_{example}.cpp")))
        .args(["-x", "none", "-L"])
        .arg(source.join(library))
        .args(["-ltouchstone_c", "-o"])
        .arg(out.join("sketch.elf"));
    compile
}

const SKETCHES: [&str; 2] = ["guarded_pid", "simplefoc_knob"];

fn tried(place: &Place, root: &Path, out: &Path) -> Result<(), Outcome> {
    for example in SKETCHES {
        let mut compile = sketch(example, place.flags, place.folder, root, out);
        shell::run(&mut compile).went_well()?;
    }
    Ok(())
}

/// Checks that the link test can fail: a sketch must not link with a library that passes floats in other registers. So a library in
/// a wrong folder would be found.
fn refused(root: &Path, out: &Path) -> Result<(), Outcome> {
    let flags = ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", HARD];
    let mut compile = sketch(SKETCHES[0], &flags, "cortex-m4", root, out);
    match compile.output() {
        Ok(output) if !output.status.success() => Ok(()),
        _ => Err(Outcome::Failed(
            "a sketch links with the library for other registers, so that the check of the folders finds nothing".into(),
        )),
    }
}

fn copy(from: &Path, to: &Path) -> Result<(), Outcome> {
    let folder = to.parent().unwrap_or(to);
    done(std::fs::create_dir_all(folder), folder)?;
    done(std::fs::copy(from, to).map(|_| ()), from)
}

fn done(result: std::io::Result<()>, path: &Path) -> Result<(), Outcome> {
    result.map_err(|why| Outcome::Failed(format!("{}: {why}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::{HARD, PLACES};

    /// Arduino's library specification: `{build.mcu}`, or `{build.mcu}/{build.fpu}-{build.float-abi}`.
    #[test]
    fn each_folder_is_the_one_in_which_arduino_looks_with_these_options() {
        for place in &PLACES {
            let value = |option: &str| {
                let mut values = place.flags.iter().filter_map(|it| it.strip_prefix(option));
                values.next().unwrap_or_default()
            };
            let (mcu, below) = place.folder.split_once('/').unwrap_or((place.folder, ""));
            if mcu.starts_with("cortex") {
                assert_eq!(value("-mcpu="), mcu, "{}", place.folder);
            }
            if below.is_empty() {
                assert!(!place.flags.contains(&HARD), "{}", place.folder);
                assert!(!place.target.ends_with("hf"), "{}", place.folder);
            } else {
                let options = format!("{}-{}", value("-mfpu="), value("-mfloat-abi="));
                assert_eq!(options, below, "{}", place.folder);
                assert!(place.target.ends_with("hf"), "{}", place.folder);
            }
        }
    }
}
