//! Runs the C programs of random motions on emulated microcontrollers: guard, estimator, every law and feels have the bits of the
//! desktop. Prints sizes and numbers of instructions, and checks that no part of the library calculates with floats.
//!
//! Needs Rust's targets, `arm-none-eabi-gcc` and `qemu-system-arm`, and builds the library for each chip, which takes minutes.
//! `cargo xtask chips` runs it.

mod program;

use program::{Program, ROOT, file, is_here};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

/// Lock that each test holds while it runs, because the tests write library and program to the same files.
static FILES: Mutex<()> = Mutex::new(());

/// A microcontroller, and the emulator's board with this microcontroller.
struct Chip {
    name: &'static str,
    target: &'static str,
    machine: &'static str,
    flags: &'static [&'static str],
    /// Where code and data begin, and how much memory there is for data.
    memory: [&'static str; 3],
}

const CHIPS: [Chip; 4] = [
    Chip {
        name: "Cortex-M0",
        target: "thumbv6m-none-eabi",
        machine: "microbit",
        flags: &["-mcpu=cortex-m0"],
        memory: ["0", "0x20000000", "16K"],
    },
    // The emulator's only Cortex-M0 has too little memory for the stack that a feel needs, so the same code also runs on a
    // Cortex-M3.
    Chip {
        name: "Cortex-M0's code on an M3",
        target: "thumbv6m-none-eabi",
        machine: "mps2-an385",
        flags: &["-mcpu=cortex-m0"],
        memory: ["0", "0x20000000", "4M"],
    },
    Chip {
        name: "Cortex-M4F",
        target: "thumbv7em-none-eabihf",
        machine: "mps2-an386",
        flags: &["-mcpu=cortex-m4", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"],
        memory: ["0", "0x20000000", "4M"],
    },
    Chip {
        name: "Cortex-M33",
        target: "thumbv8m.main-none-eabihf",
        machine: "mps2-an505",
        flags: &["-mcpu=cortex-m33", "-mfloat-abi=hard", "-mfpu=fpv5-sp-d16"],
        memory: ["0x10000000", "0x38000000", "2M"],
    },
];

impl Chip {
    /// Builds the library for this chip with the cargo features `laws`, in a folder of its own below cargo's. `None` if Rust's
    /// target for the chip is not installed.
    fn library(&self, laws: &str) -> Option<PathBuf> {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("emulated");
        let built = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--jobs", "1", "--profile", "embedded"])
            .args(["--package", "touchstone-c", "--target", self.target])
            .args(["--no-default-features", "--features", laws])
            .arg("--target-dir")
            .arg(&folder)
            .current_dir(ROOT)
            .output()
            .expect("cargo can be started");
        let complaint = String::from_utf8_lossy(&built.stderr);
        if complaint.contains("target may not be installed") {
            eprintln!(
                "not run on {}: rustup target add {}",
                self.name, self.target
            );
            return None;
        }
        assert!(built.status.success(), "{complaint}");
        Some(folder.join(self.target).join("embedded/libtouchstone_c.a"))
    }

    /// Compiles a program for this chip.
    fn program(&self, arguments: &[&str], sources: &[&str], library: &Path) -> PathBuf {
        let program = library.with_file_name("program.elf");
        let [code, data, size] = self.memory;
        let built = Command::new("arm-none-eabi-gcc")
            .args(self.flags)
            .args(["-mthumb", "-Os", "-Wall", "-Wextra", "-Werror"])
            .args(["-nostartfiles", "-Wl,--gc-sections"])
            .args(arguments)
            .arg(format!(
                "-Wl,--defsym=code={code},--defsym=data={data},--defsym=data_size={size}"
            ))
            .arg(format!("-I{ROOT}/include"))
            .arg("-T")
            .arg(file("tests/emulated/program.ld"))
            .args(sources.iter().map(|source| file(source)))
            .arg(library)
            .arg("-o")
            .arg(&program)
            .output()
            .expect("the compiler can be started");
        let complaint = String::from_utf8_lossy(&built.stderr);
        assert!(built.status.success(), "{}: {complaint}", self.name);
        program
    }

    /// Compiles a program for this chip and runs it in the emulator. Returns what it printed.
    fn said(&self, source: &str, library: &Path) -> String {
        self.said_with(&[], source, library)
    }

    /// Same as [`Chip::said`], with further arguments for the emulator.
    fn said_with(&self, arguments: &[&str], source: &str, library: &Path) -> String {
        let sources = ["tests/emulated/start.c", source];
        let program = self.program(&["--specs=rdimon.specs"], &sources, library);
        let ran = Command::new("qemu-system-arm")
            .args(arguments)
            .args(["-M", self.machine, "-nographic", "-monitor", "none"])
            .args(["-serial", "none", "-semihosting-config"])
            .args(["enable=on,target=native", "-kernel"])
            .arg(&program)
            .output()
            .expect("the emulator can be started");
        assert!(ran.status.success(), "{}: {}", self.name, ran.status);
        String::from_utf8_lossy(&ran.stdout).into_owned()
    }
}

/// Output of one of the compiler's tools about a program.
fn tool(name: &str, program: &Path) -> String {
    let ran = Command::new(name).arg(program).output();
    let ran = ran.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(ran.status.success(), "{name}: {}", ran.status);
    String::from_utf8_lossy(&ran.stdout).into_owned()
}

/// Returns the bytes of flash and of RAM of a main loop with one part of the library. Fails if the program calculates with floats:
/// on a chip without a floating-point unit it then contains functions for them.
fn size(chip: &Chip, part: &str, library: &Path) -> [usize; 2] {
    let part_is = format!("-DPART={part}");
    let arguments = ["--specs=nosys.specs", "-Wl,-e,main", &part_is];
    let program = chip.program(&arguments, &["tests/emulated/loop.c"], library);
    let names = tool("arm-none-eabi-nm", &program);
    let is_of_float = |name: &&str| {
        let of_arm = name.starts_with("__aeabi_f") || name.starts_with("__aeabi_d");
        let is_division_of_integers = name.starts_with("__aeabi_div");
        of_arm && !is_division_of_integers || name.ends_with("sf3") || name.ends_with("df3")
    };
    let mut words = names.split_whitespace();
    assert_eq!(
        words.clone().find(is_of_float),
        None,
        "{}, {part}",
        chip.name
    );
    assert!(words.any(|name| name.starts_with("ts_")));
    let size = tool("arm-none-eabi-size", &program);
    let row = size.lines().nth(1).unwrap_or_default();
    let bytes: Vec<usize> = row
        .split_whitespace()
        .take(3)
        .map(|word| word.parse().expect("a number of bytes"))
        .collect();
    let [text, data, bss] = bytes[..] else {
        panic!("{size}");
    };
    [text + data, data + bss]
}

/// Prints a row of the table for each part of the library: bytes of flash and RAM, and instructions of a tick, mean and largest.
fn rows(chip: &Chip, library: &Path) {
    let counts = chip.said_with(&["-icount", "shift=10"], "tests/emulated/count.c", library);
    let count = |part: &str| {
        let line = counts
            .lines()
            .find_map(|line| line.strip_prefix(part)?.strip_prefix(' '));
        let numbers = line.unwrap_or_else(|| panic!("{part}: {counts}"));
        numbers.replace(' ', " | ")
    };
    for (part, law) in [
        ("GUARD", "guard"),
        ("ESTIMATOR", "estimator"),
        ("WALL", "enhanced-sfa"),
    ] {
        let [flash, ram] = size(chip, part, library);
        let name = part.to_lowercase();
        println!(
            "| {} | {name} | {flash} | {ram} | {} |",
            chip.name,
            count(law)
        );
    }
    for law in [
        "spring",
        "spring-damper",
        "tdpa",
        "fba",
        "sfa",
        "sfa-continuous",
    ] {
        println!("| {} | wall, {law} | | | {} |", chip.name, count(law));
    }
    let [flash, ram] = size(chip, "FEEL", library);
    println!("| {} | feel | {flash} | {ram} | | |", chip.name);
}

#[test]
#[ignore = "builds the library for three microcontrollers"]
fn emulated_microcontrollers_have_the_bits_of_the_desktop() {
    let _files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
    if !(is_here("arm-none-eabi-gcc") && is_here("qemu-system-arm")) {
        return;
    }
    println!("| chip | part | flash, bytes | RAM, bytes | instructions, mean | largest |");
    for chip in CHIPS {
        let Some(library) = chip.library("laws") else {
            continue;
        };
        let is_small = chip.memory.contains(&"16K");
        if !is_small {
            rows(&chip, &library);
        }
        for (name, source) in [("hostile", "examples/hostile.c"), ("feel", "tests/feel.c")] {
            if is_small && name == "feel" {
                continue;
            }
            let Some(desktop) = Program::c(name, &[source]).said(&[]) else {
                return;
            };
            assert_eq!(chip.said(source, &library), desktop, "{}", chip.name);
            println!("{}: {source} has the same bits", chip.name);
        }
    }
}

/// Cargo features of the library, each with the names of the control laws that it adds to `spring`.
const ONE_LAW: [(&str, &[&str]); 6] = [
    ("", &[]),
    ("spring-damper", &["spring-damper"]),
    ("tdpa", &["tdpa"]),
    ("fba", &["fba"]),
    ("sfa", &["sfa", "sfa-continuous"]),
    ("enhanced-sfa", &["enhanced-sfa"]),
];

#[test]
#[ignore = "builds the library for a microcontroller six times"]
fn a_library_with_one_law_has_its_bits_and_refuses_the_others_by_name() {
    let _files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
    if !(is_here("arm-none-eabi-gcc") && is_here("qemu-system-arm")) {
        return;
    }
    let chip = &CHIPS[2];
    let laws = "tests/emulated/laws.c";
    let Some(desktop) = Program::c("laws", &[laws]).said(&[]) else {
        return;
    };
    println!("| {}, laws | wall | feel |", chip.name);
    for (feature, has) in ONE_LAW {
        let Some(library) = chip.library(feature) else {
            return;
        };
        let [wall, feel] = ["WALL", "FEEL"].map(|part| size(chip, part, &library)[0]);
        let name = if feature.is_empty() {
            "spring"
        } else {
            feature
        };
        println!("| {name} | {wall} | {feel} |");
        let said = chip.said(laws, &library);
        assert_eq!(said.lines().count(), desktop.lines().count(), "{said}");
        for (here, there) in said.lines().zip(desktop.lines()) {
            let law = there.split(' ').next().unwrap_or_default();
            if law == "spring" || has.contains(&law) {
                assert_eq!(here, there, "{feature}");
            } else {
                let feature = law.trim_end_matches("-continuous");
                let words = format!(
                    "{law}: law.kind = {law}: this build has no such law: build it with the feature `{feature}`, or choose another law"
                );
                assert_eq!(here, words);
            }
        }
    }
}
