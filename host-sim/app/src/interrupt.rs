//! Handles Ctrl-C and SIGTERM: removes half-written files and ends the program with exit code 130.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use touchstone_report::staging;
use touchstone_sim::error::{Error, Result};

/// Exit code after an interrupt: 128 plus 2, the number of SIGINT, as in shells.
pub const INTERRUPTED: i32 = 130;

/// Installs the handler for Ctrl-C and SIGTERM, which removes half-written files and ends the program.
pub fn clean_up() -> Result<()> {
    clean_up_keeping("interrupted: no incomplete file is left")
}

/// Same as [`clean_up`], for a command that keeps its finished results; prints `words` if no half-written files had to be removed.
pub fn clean_up_keeping(words: &'static str) -> Result<()> {
    handle(move || {
        staging::abandon(|removed| {
            // Moves to the line below the progress bar.
            if std::io::stderr().is_terminal() {
                eprintln!();
            }
            match removed {
                [] => eprintln!("{words}"),
                folders => {
                    for folder in folders {
                        eprintln!("interrupted: {} was removed again", folder.display());
                    }
                }
            }
            std::process::exit(INTERRUPTED);
        });
    })
}

/// Makes Ctrl-C and SIGTERM only set the returned flag. A loop that polls the flag can then stop its device before the program
/// ends.
pub fn noted() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    handle(move || asked.store(true, Ordering::Relaxed))?;
    Ok(stop)
}

fn handle(handler: impl FnMut() + Send + 'static) -> Result<()> {
    ctrlc::set_handler(handler).map_err(|error| {
        Error::device(
            "Ctrl-C",
            error.to_string(),
            "another part of the program already handles this signal; report this",
        )
    })
}

/// Removes half-written folders that killed runs left beside this report's folder, and prints a note for each of them.
pub fn sweep(folder: &std::path::Path) {
    for stale in staging::sweep(folder) {
        let place = stale.path.display();
        if stale.removed {
            super::out::note!(
                "note: {place} was removed: its run was ended before its report was done"
            );
        } else {
            super::out::note!(
                "note: {place} may be the remainder of an interrupted run; remove it if no run is in progress"
            );
        }
    }
}
