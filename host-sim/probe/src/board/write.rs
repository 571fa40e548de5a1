//! Writes a program into a board's flash: erases pages, writes them, reads them back, starts the program.

use probe_rs::flashing::{
    DownloadOptions, FlashError, FlashProgress, ProgressEvent, ProgressOperation,
};

use super::fault::{Fault, chain};
use super::image::Image;
use super::session::{Attached, CORE};

/// A phase of writing the flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Erases the pages of flash that the program needs, and no others.
    Erase,
    /// Writes the program into the erased pages.
    Program,
    /// Reads the flash back and compares it with the program.
    Verify,
}

/// A report on the progress of writing the flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// A phase begins. Holds the number of bytes that the phase will process, if known.
    Begins(Phase, Option<u64>),
    /// The phase has processed this number of further bytes.
    Done(Phase, u64),
    /// The phase has ended.
    Ends(Phase),
}

impl Attached {
    /// Writes a program into the flash, reads it back and compares it; `tell` receives the progress. Other pages of the flash keep
    /// their content. The processor stays halted until [`Self::start`].
    ///
    /// # Errors
    /// The flash cannot be written, or the data read back differ. The program in the flash may then be incomplete.
    pub fn write(&mut self, image: &Image, mut tell: impl FnMut(Step)) -> Result<(), Fault> {
        let mut loader = self.session.target().flash_loader();
        for part in &image.parts {
            loader
                .add_data(part.address, &part.bytes)
                .map_err(|error| self.unwritten(&error))?;
        }
        let mut totals = Vec::new();
        let mut options = DownloadOptions::default();
        options.verify = true;
        options.progress = FlashProgress::new(|event| {
            if let Some(step) = step(event, &mut totals) {
                tell(step);
            }
        });
        let written = loader.commit(&mut self.session, options);
        written.map_err(|error| self.unwritten(&error))
    }

    /// Resets the chip and starts the program in its flash.
    ///
    /// # Errors
    /// The connection to the chip is broken.
    pub fn start(&mut self) -> Result<(), Fault> {
        let reset = self.session.core(CORE).and_then(|mut core| core.reset());
        reset.map_err(|error| self.broken(&error))
    }

    fn unwritten(&self, error: &FlashError) -> Fault {
        let problem = match error {
            FlashError::Verify => "the data read back differ from the data written".to_owned(),
            _ => format!("its flash could not be written: {}", chain(error)),
        };
        Fault::of(
            &self.chip,
            problem,
            "the board's program is incomplete now; write it again. If that fails, switch the board's supply off and on",
        )
    }
}

/// Converts a progress event of the crate probe-rs to a [`Step`]; `None` for an event that is not reported.
fn step(event: ProgressEvent, totals: &mut Vec<(Phase, u64)>) -> Option<Step> {
    match event {
        ProgressEvent::AddProgressBar { operation, total } => {
            totals.push((phase(operation)?, total?));
            None
        }
        ProgressEvent::Started(operation) => {
            let phase = phase(operation)?;
            let total = totals.iter().find(|(of, _)| *of == phase);
            Some(Step::Begins(phase, total.map(|(_, bytes)| *bytes)))
        }
        ProgressEvent::Progress {
            operation, size, ..
        } => Some(Step::Done(phase(operation)?, size)),
        ProgressEvent::Finished(operation) => Some(Step::Ends(phase(operation)?)),
        // A failure is also returned as an error, so it is not reported here.
        _ => None,
    }
}

fn phase(operation: ProgressOperation) -> Option<Phase> {
    match operation {
        ProgressOperation::Erase => Some(Phase::Erase),
        ProgressOperation::Program => Some(Phase::Program),
        ProgressOperation::Verify => Some(Phase::Verify),
        ProgressOperation::Fill => None,
    }
}
