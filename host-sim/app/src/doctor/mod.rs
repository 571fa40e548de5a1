//! `touchstone doctor`: checks whether everything that a board or an omega.3 needs is installed and connected, and says how to get
//! what is missing.

mod usb;

use super::device::start;
use super::flash::{self, BoardName};
use super::haptic;
use super::out::{self, print};
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Arc;
use touchstone_device::haptic::HapticDevice;
use touchstone_device::{Address, Client, Omega3, ports};
use touchstone_link::guard;
use touchstone_link::words::described;
use touchstone_protocol::PROTOCOL_VERSION;
use touchstone_protocol::stored::LAYOUT_VERSION;
use touchstone_sim::error::{Error, Result};

/// Rust target of the boards' processor, a Cortex-M4 with its floating-point unit.
const TARGET: &str = "thumbv7em-none-eabihf";

/// Options of the command `touchstone doctor`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// What you want to use: exit code 1 if something is missing for it. If you name nothing, the command checks everything and
    /// ends with 0. With `--port` it checks for a board.
    #[arg(value_name = "FOR")]
    needs: Option<Needs>,
    /// Serial port or tcp:HOST:PORT; with a TCP port the command does not look for a debug probe.
    #[arg(long, value_name = "PORT")]
    port: Option<Address>,
    /// Folder in which the kernel shows USB devices; for tests.
    #[arg(long, hide = true, default_value = "/sys")]
    sysfs: PathBuf,
    /// Folder of the device nodes of USB devices; for tests.
    #[arg(long, hide = true, default_value = "/dev")]
    dev: PathBuf,
}

/// The purposes for which the installation is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Needs {
    /// A board: to flash it and to communicate with it.
    Board,
    /// An omega.3, a haptic device on USB.
    Omega3,
}

/// The finding on one requirement. It becomes a line of text for people, or an entry of `things` in the JSON for programs.
enum Requirement {
    /// The requirement is met; holds a description.
    There(String),
    /// The requirement is missing; holds the problem and the remedy.
    Missing { problem: String, fix: String },
    /// The requirement is not needed, or cannot be checked on this system; holds the reason.
    Skipped(String),
}

use Requirement::{Missing, Skipped, There};

/// The finding that a requirement is missing, and how to get it.
fn missing(problem: impl Into<String>, fix: impl Into<String>) -> Requirement {
    Missing {
        problem: problem.into(),
        fix: fix.into(),
    }
}

/// Runs the command `touchstone doctor`. Exit code 1 if something is missing for the use that the user named, else 0.
pub fn main(options: &Options) -> Result<ExitCode> {
    let needs = options
        .needs
        .or(options.port.is_some().then_some(Needs::Board));
    let mut lacks = 0;
    let mut things = Vec::new();
    // The first error of the output, such as a full disk. All is examined nevertheless.
    let mut printed = Ok(());
    let mut tell = |what: &str, found: Requirement| {
        let (state, text, fix) = match &found {
            There(text) => ("there", text, None),
            Skipped(text) => ("skipped", text, None),
            Missing { problem, fix } => ("missing", problem, Some(fix)),
        };
        lacks += usize::from(fix.is_some());
        if out::json() {
            things.push(
                serde_json::json!({ "what": what, "state": state, "text": text, "fix": fix }),
            );
            return;
        }
        let line = match (fix, out::quiet()) {
            (Some(fix), _) => {
                let fix = fix.replace('\n', &format!("\n{:24}", ""));
                print(format_args!("MISSING  {what:<14} {text}\n{:24}{fix}\n", ""))
            }
            (None, true) => Ok(()),
            (None, false) => {
                let mark = if state == "there" { "ok" } else { "-" };
                print(format_args!("{mark:<8} {what:<14} {text}\n"))
            }
        };
        if printed.is_ok() {
            printed = line;
        }
    };
    tell(
        "touchstone",
        There(format!(
            "{}, protocol {PROTOCOL_VERSION}, settings {LAYOUT_VERSION}",
            env!("CARGO_PKG_VERSION")
        )),
    );
    if needs == Some(Needs::Omega3) {
        omega3(true, &mut tell);
    } else {
        board(options, &mut tell);
        omega3(false, &mut tell);
    }
    printed?;
    match lacks {
        _ if out::json() => print(format_args!(
            "{:#}\n",
            serde_json::json!({ "all_there": lacks == 0, "things": things })
        )),
        _ if out::quiet() => Ok(()),
        0 => print(format_args!("all there\n")),
        _ if needs.is_none() => print(format_args!(
            "a simulation needs none of the missing items; `touchstone doctor board` fails without them\n"
        )),
        1 => print(format_args!("1 thing is missing\n")),
        _ => print(format_args!("{lacks} things are missing\n")),
    }?;
    Ok(ExitCode::from(u8::from(lacks > 0 && needs.is_some())))
}

/// Checks everything that a board needs, and reports each finding to `tell`.
fn board(options: &Options, tell: &mut impl FnMut(&str, Requirement)) {
    let tcp = matches!(options.port, Some(Address::Tcp(_))) && options.sysfs == Path::new("/sys");
    // A TCP port leads to a simulated knob, which cannot be flashed.
    let for_boards = |found| match found {
        Missing { problem, .. } if tcp => Skipped(format!("{problem}; not needed for a TCP port")),
        found => found,
    };
    tell("probe-rs", for_boards(probe_rs()));
    tell("Rust target", for_boards(rust_target()));
    for board in BoardName::value_variants() {
        tell("firmware", firmware(*board));
    }
    if tcp {
        tell("probe", Skipped("not needed for a TCP port".into()));
    } else {
        usb::examine(&options.sysfs, &options.dev, tell);
    }
    let address = port(options.port.as_ref(), tell);
    let (found, asked) = device(address.as_ref());
    tell("device", found);
    if let Some((start, promise)) = asked {
        tell("start", There(start));
        tell("promise", There(promise));
    }
}

/// First line of the output of another program; `None` if it cannot run.
fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let line = text.lines().next()?.trim();
    (output.status.success() && !line.is_empty()).then(|| line.to_owned())
}

fn probe_rs() -> Requirement {
    match flash::there() {
        Ok(what) => There(what),
        Err((problem, fix)) => missing(problem, fix),
    }
}

fn rust_target() -> Requirement {
    if BoardName::value_variants()
        .iter()
        .all(|board| board.shipped().is_some())
    {
        return Skipped("not needed: this program contains the firmware of every board".into());
    }
    let Some(sysroot) = first_line("rustc", &["--print", "sysroot"]) else {
        return missing("no rustc on the PATH", "install Rust: https://rustup.rs");
    };
    let version = first_line("rustc", &["--version"]).unwrap_or_default();
    if Path::new(&sysroot)
        .join("lib/rustlib")
        .join(TARGET)
        .is_dir()
    {
        There(format!("{TARGET}, {version}"))
    } else {
        missing(
            format!("{TARGET} is not installed for {version}"),
            format!("rustup target add {TARGET}"),
        )
    }
}

fn firmware(board: BoardName) -> Requirement {
    let (name, program) = (board.name(), board.program());
    if program.is_file() {
        There(format!("{name}: {}", program.display()))
    } else {
        Skipped(format!(
            "{name}: not built here yet: cargo xtask firmware --board {name}"
        ))
    }
}

/// The port on which to look for a device: the given one, or one that was detected; `None` without a port.
fn port(given: Option<&Address>, tell: &mut impl FnMut(&str, Requirement)) -> Option<Address> {
    if let Some(address) = given {
        tell("port", There(format!("{address}, as given")));
        return Some(address.clone());
    }
    let ports = ports();
    for port in &ports {
        let about = format!("{} ({})", port.name, port.about.trim());
        tell(
            "port",
            if port.st_link {
                There(about)
            } else {
                Skipped(about)
            },
        );
    }
    match Address::given_or_found(None) {
        Ok(address) => Some(address),
        Err(Error::Device { problem, fix, .. }) => {
            let fix = match ports.iter().any(|port| port.st_link) {
                true => "choose one: touchstone doctor --port PORT".to_owned(),
                false => fix.replace(", or see `touchstone doctor`", " by USB"),
            };
            tell("port", missing(problem, fix));
            None
        }
        Err(other) => {
            tell("port", missing(other.to_string(), "report this as a bug"));
            None
        }
    }
}

/// Checks the omega.3's library, and with the library the device. The library counts as missing only if the user wants an omega.3.
fn omega3(is_needed: bool, tell: &mut impl FnMut(&str, Requirement)) {
    let library = match haptic::library(None) {
        Ok(library) => library,
        Err(Error::Device { problem, fix, .. }) if is_needed => {
            return tell("omega.3", missing(problem, fix));
        }
        Err(error) => {
            return tell(
                "omega.3",
                Skipped(format!("needed for an omega.3 only: {error}")),
            );
        }
    };
    tell("omega.3", There(haptic::described(&library)));
    tell(
        "omega.3",
        match Omega3::open(Arc::new(library)) {
            Ok(omega) => There(omega.sheet().name.clone()),
            Err(fault) => missing(fault.to_string(), fault.fix()),
        },
    );
}

/// Checks the device at this address: whether it answers, how it starts, and how much energy its energy guard lets it give to a
/// hand.
fn device(address: Option<&Address>) -> (Requirement, Option<(String, String)>) {
    let Some(address) = address else {
        return (Skipped("no port on which to read it".into()), None);
    };
    match Client::connect(address) {
        Ok(mut client) => {
            let who = There(described(client.identity()));
            (who, how_it_is_set(&mut client).ok())
        }
        Err(error) => (not_there(address, error), None),
    }
}

/// Two texts on the device's settings. The first says whether its alignment is stored and whether it starts unattended; the second
/// states how much energy its energy guard lets it give to a hand.
fn how_it_is_set(client: &mut Client) -> touchstone_sim::error::Result<(String, String)> {
    let (report, settings) = (start::report(client)?, client.settings()?);
    let board = client.identity().board;
    let [alignment, autostart] = start::lines(report.as_ref(), &settings, board);
    let start = format!("alignment {alignment}; autostart {autostart}");
    Ok((start, guard::promise(&settings, board)))
}

/// The finding for a device that does not answer: the reason and the remedy.
fn not_there(address: &Address, error: Error) -> Requirement {
    match error {
        Error::Device { problem, .. } if problem.contains("ermission") => missing(
            format!("{address}: {problem}"),
            "sudo usermod -a -G dialout $USER, then log in again; or install the udev rule:\n"
                .to_owned()
                + usb::INSTALL_RULE,
        ),
        Error::Device { problem, .. } if problem.starts_with("no answer") => missing(
            format!("{address}: {problem}"),
            "flash the firmware: touchstone flash --board BOARD",
        ),
        Error::Device { problem, fix, .. } => missing(format!("{address}: {problem}"), fix),
        other => missing(other.to_string(), "report this as a bug"),
    }
}
