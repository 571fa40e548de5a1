//! Compiles what later steps of a test run need while earlier steps leave a processor idle: when the last crate is compiled, when
//! one long test runs alone, when a test waits for a device or browser.
//!
//! The steps run the same commands again, find everything compiled, and report every error. So nothing here is shown, and a failure
//! here only means that nothing was gained. Cargo's locks make a step wait for what is still being compiled.

use std::process::{Command, Stdio};
use std::thread::JoinHandle;

use crate::{emulator, firmware, shell, thumb};

/// Starts the compiling in a thread, at the lowest priority, so that it hardly disturbs tests with deadlines. Compilers are looked
/// for and installed before, because rustup must not be called by a step at the same time.
pub fn start() -> JoinHandle<()> {
    let commands: Vec<Command> = commands().collect();
    std::thread::spawn(move || {
        for command in commands {
            let mut command = shell::behind(&command);
            let quiet = command
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null());
            let _ = quiet.status();
        }
    })
}

/// The longest first: the emulator compiles QEMU's processor.
fn commands() -> impl Iterator<Item = Command> {
    emulator::builds()
        .into_iter()
        .chain(firmware::builds())
        .chain(thumb::builds())
}
