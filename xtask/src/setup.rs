//! `cargo xtask setup [--install [--full]]`: lists the tools that are installed or missing, their purpose and how to install them.
//!
//! Every test run needs rustfmt and Clippy, so rustup installs them without a request. Steps that count instructions install
//! valgrind in the same way, with apt-get and only for the user root. Other tools are installed only with `--install`: those of
//! `cargo xtask test`, and with `--full` also those of `cargo xtask test --full`.

use crate::outcome::Outcome;
use crate::packages::{EMULATOR, apt_get, component, first_line, missing_component, valgrind};
use crate::prove::{allocator, coq};
use crate::{emulator, toolchain};

/// Which tests need a tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    /// No test run is complete without the tool.
    Required,
    /// Without the tool a step of `cargo xtask test` is not run.
    Test,
    /// Without the tool only steps of `cargo xtask test --full` are not run.
    Full,
}

/// A tool that a command needs.
struct Tool {
    name: &'static str,
    need: Need,
    purpose: &'static str,
    /// Version of the tool; `None` if it is missing.
    version: fn() -> Option<String>,
    /// Text that says how to install the tool.
    hint: &'static str,
    /// Debian packages to install for the tool.
    packages: &'static [&'static str],
}

const TOOLS: &[Tool] = &[
    Tool {
        name: "rustc",
        need: Need::Required,
        purpose: "everything",
        version: rustc,
        hint: "rustup toolchain install stable (1.95 or newer)",
        packages: &[],
    },
    Tool {
        name: "rustfmt",
        need: Need::Required,
        purpose: "fmt",
        version: || component("rustfmt"),
        hint: "rustup component add rustfmt",
        packages: &[],
    },
    Tool {
        name: "clippy",
        need: Need::Required,
        purpose: "lint",
        version: || component("clippy"),
        hint: "rustup component add clippy",
        packages: &[],
    },
    Tool {
        name: "valgrind",
        need: Need::Full,
        purpose: "bench: counts instructions",
        version: valgrind,
        hint: "apt-get install valgrind",
        packages: &["valgrind"],
    },
    Tool {
        name: "thumb",
        need: Need::Full,
        purpose: "float-free: looks at the microcontroller's code",
        version: || toolchain::find(toolchain::SOFT_FLOAT).map(|found| found.to_string()),
        hint: "rustup target add thumbv7em-none-eabi",
        packages: &[],
    },
    Tool {
        name: "python3",
        need: Need::Test,
        purpose: "prove: the integer obligations; page: the browser's script",
        version: || first_line(&["python3", "--version"]),
        hint: "apt-get install python3",
        packages: &["python3"],
    },
    Tool {
        name: "chromium",
        need: Need::Test,
        purpose: "page: drives the live page; looking at the report",
        version: chromium,
        hint: "apt-get install chromium",
        packages: &["chromium"],
    },
    Tool {
        name: "firefox",
        need: Need::Full,
        purpose: "page: the same in another browser",
        version: firefox,
        hint: "apt-get install firefox-esr",
        packages: &["firefox-esr"],
    },
    Tool {
        name: "venv",
        need: Need::Full,
        purpose: "prove: the solvers' Python wheels",
        version: || {
            first_line(&[
                "python3",
                "-c",
                "import ensurepip; print(ensurepip.version())",
            ])
        },
        hint: "apt-get install python3-venv",
        packages: &["python3-venv"],
    },
    Tool {
        name: "clang",
        need: Need::Test,
        purpose: "fil, cycles: builds the emulator, with libclang and cmake",
        version: || {
            let version = first_line(&["clang", "--version"]);
            version.filter(|_| emulator::is_there())
        },
        hint: "apt-get install clang libclang-dev cmake",
        packages: &EMULATOR,
    },
    Tool {
        name: "arm-gcc",
        need: Need::Full,
        purpose: "chips: C programs with the C library on emulated microcontrollers",
        version: || first_line(&["arm-none-eabi-gcc", "--version"]),
        hint: "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi",
        packages: &["gcc-arm-none-eabi", "libnewlib-arm-none-eabi"],
    },
    Tool {
        name: "mdbook",
        need: Need::Full,
        purpose: "site: the book",
        version: || first_line(&["mdbook", "--version"]),
        hint: "cargo install --locked mdbook --version 0.4.52",
        packages: &[],
    },
    Tool {
        name: "coq",
        need: Need::Full,
        purpose: "prove: the theorems over traces",
        version: || first_line(&["coqc", "--version"]),
        // Coq needs a download of 250 MB and 1 GB on disk.
        hint: "apt-get install --no-install-recommends coq",
        packages: &["coq"],
    },
    Tool {
        name: "zarith",
        need: Need::Full,
        purpose: "prove: the specification beside the code's ticks",
        version: coq::integers,
        hint: "apt-get install libzarith-ocaml-dev",
        packages: &["libzarith-ocaml-dev"],
    },
    Tool {
        name: "kani",
        need: Need::Full,
        purpose: "prove: the harnesses",
        version: || first_line(&["cargo", "kani", "--version"]),
        hint: "cargo install --locked kani-verifier, then cargo kani setup",
        packages: &[],
    },
    Tool {
        name: "tcmalloc",
        need: Need::Full,
        purpose: "prove: the harnesses in less time",
        version: || allocator::found().map(|file| file.display().to_string()),
        hint: "apt-get install libtcmalloc-minimal4",
        // Empty, because the package has another name in later releases, and no step of the tests needs it.
        packages: &[],
    },
];

fn rustc() -> Option<String> {
    let version = first_line(&["rustc", "--version"])?;
    toolchain::is_new_enough(&version).then_some(version)
}

fn chromium() -> Option<String> {
    ["chromium", "chromium-browser", "google-chrome", "chrome"]
        .into_iter()
        .find_map(|name| first_line(&[name, "--version"]))
}

fn firefox() -> Option<String> {
    ["firefox", "firefox-esr"]
        .into_iter()
        .find_map(|name| first_line(&[name, "--version"]))
}

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => {}
        [install, rest @ ..]
            if install == "--install" && (rest.is_empty() || rest == ["--full"]) =>
        {
            let is_full = !rest.is_empty();
            // `cargo xtask test` looks at the source only, for which no compiler is needed.
            if is_full {
                let _ = toolchain::obtain(toolchain::SOFT_FLOAT);
            }
            let packages: Vec<_> = TOOLS
                .iter()
                .filter(|tool| is_full || tool.need != Need::Full)
                .filter(|tool| (tool.version)().is_none())
                .flat_map(|tool| tool.packages.iter().copied())
                .collect();
            if !packages.is_empty() {
                apt_get(&packages);
            }
        }
        _ => return Outcome::Usage("cargo xtask setup [--install [--full]]".into()),
    }
    let _ = missing_component("rustfmt");
    let _ = missing_component("clippy");
    let (mut missing, mut required) = (Vec::new(), Vec::new());
    for tool in TOOLS {
        match (tool.version)() {
            Some(version) => println!("{:<10}{version}", tool.name),
            None => {
                println!(
                    "{:<10}missing; for {}; {}",
                    tool.name, tool.purpose, tool.hint
                );
                missing.push(tool.name);
                if tool.need == Need::Required {
                    required.push(tool.name);
                }
            }
        }
    }
    if !required.is_empty() {
        Outcome::Failed(format!("missing: {}", required.join(", ")))
    } else if missing.is_empty() {
        Outcome::Ok("all there".into())
    } else {
        Outcome::Ok(format!("can do without: {}", missing.join(", ")))
    }
}
