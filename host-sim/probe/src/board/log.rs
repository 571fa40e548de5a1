//! Reads the log of a running program through the probe. The program writes its log to a ring buffer in RAM (SEGGER's RTT).

use std::thread::sleep;
use std::time::{Duration, Instant};

use probe_rs::rtt::{Error, Rtt, ScanRegion};

use super::fault::Fault;
use super::image::Image;
use super::session::{Attached, CORE};
use super::words::{Line, Words};

/// Number of the RTT channel to which the program's logger, defmt, writes.
const CHANNEL: usize = 0;
/// Pause between two readings if the ring buffer was empty. It is short because a full ring buffer loses messages.
const PAUSE: Duration = Duration::from_millis(10);
/// Longest wait for the ring buffer in RAM. A program that has started sets the buffer up sooner, and a board in reset answers
/// again sooner.
const PATIENCE: Duration = Duration::from_secs(2);
/// Number of bytes of each part of the program that are compared with the board's flash before the log is decoded.
const COMPARED_BYTES: usize = 1024;

/// What happened while the log was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A complete log message.
    Line(Line),
    /// A damaged message: the ring buffer overflowed before the message was read, or reading began in its middle.
    Damaged,
    /// Reading goes on after an interruption, mostly because the program on the board restarted.
    Restarted,
}

/// Why reading the log was interrupted.
enum Lost {
    /// The ring buffer is not at its place in RAM, or its description has changed.
    Ring(Error),
    /// The probe or the chip does not answer.
    Contact(Error),
}

impl From<Error> for Lost {
    fn from(error: Error) -> Self {
        match error {
            Error::Probe(_) | Error::Other(_) | Error::MemoryRead(_) => Lost::Contact(error),
            _ => Lost::Ring(error),
        }
    }
}

impl Attached {
    /// Reads the log of the running program until `go_on` returns false. The board's flash must hold the program `image`.
    ///
    /// # Errors
    /// `image` has no log, the flash holds another program, the program does not set up its log within two seconds, or the
    /// connection is broken.
    pub fn log(
        &mut self,
        image: &Image,
        words: &Words,
        mut tell: impl FnMut(Event),
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), Fault> {
        let Some(address) = image.control_block else {
            return Err(Fault::of(
                &self.chip,
                "the program has no log: its ELF file contains no RTT control block",
                "name the ELF file of this project's firmware",
            ));
        };
        self.is_running(image)?;
        let region = ScanRegion::Exact(address);
        let mut joined = false;
        while go_on() {
            let Some(mut rtt) = self.joined(&region, &mut go_on)? else {
                break;
            };
            if joined {
                tell(Event::Restarted);
            }
            joined = true;
            let mut stream = words.stream();
            let mut bytes = [0; 1024];
            while go_on() {
                match self.read(&mut rtt, &mut bytes) {
                    Ok(0) => sleep(PAUSE),
                    Ok(count) => {
                        for line in stream.take(&bytes[..count]) {
                            tell(line.map_or(Event::Damaged, Event::Line));
                        }
                    }
                    // After a reset the program sets the ring buffer up again.
                    Err(_) => break,
                }
            }
        }
        Ok(())
    }

    fn read(&mut self, rtt: &mut Rtt, bytes: &mut [u8]) -> Result<usize, Lost> {
        let mut core = self.session.core(CORE).map_err(Error::from)?;
        let channel = rtt
            .up_channel(CHANNEL)
            .ok_or(Error::MissingChannel(CHANNEL))?;
        Ok(channel.read(&mut core, bytes)?)
    }

    /// Finds the log's ring buffer in RAM; waits for it up to [`PATIENCE`]. Returns `None` if `go_on` returns false meanwhile.
    fn joined(
        &mut self,
        region: &ScanRegion,
        go_on: &mut impl FnMut() -> bool,
    ) -> Result<Option<Rtt>, Fault> {
        let begun = Instant::now();
        while go_on() {
            let found = self
                .session
                .core(CORE)
                .map_err(Error::from)
                .and_then(|mut core| Rtt::attach_region(&mut core, region));
            match found.map_err(Lost::from) {
                Ok(rtt) => return Ok(Some(rtt)),
                Err(_) if begun.elapsed() < PATIENCE => sleep(PAUSE),
                Err(Lost::Contact(error)) => return Err(self.broken(&error)),
                Err(Lost::Ring(error)) => {
                    return Err(Fault::of(
                        &self.chip,
                        format!(
                            "the running program has no log yet: {}",
                            super::fault::chain(&error)
                        ),
                        "check with `touchstone device status` whether it runs, or write it again",
                    ));
                }
            }
        }
        Ok(None)
    }

    /// Checks that the board's flash holds the program `image`, by comparing the beginning of each part. Only the ELF file of the
    /// running program has the texts of its log messages.
    fn is_running(&mut self, image: &Image) -> Result<(), Fault> {
        for part in &image.parts {
            let expected = &part.bytes[..part.bytes.len().min(COMPARED_BYTES)];
            let mut there = vec![0; expected.len()];
            self.bytes(part.address, &mut there)?;
            if there != expected {
                return Err(Fault::of(
                    &self.chip,
                    "the program in the flash is not that of the ELF file",
                    "name the file that was written, or write this one: touchstone flash --log",
                ));
            }
        }
        Ok(())
    }
}
