//! The log of a running program, through a ring in its RAM (RTT) that the probe reads.

use std::thread::sleep;
use std::time::{Duration, Instant};

use probe_rs::rtt::{Error, Rtt, ScanRegion};

use super::fault::Fault;
use super::image::Image;
use super::session::{Attached, CORE};
use super::words::{Line, Words};

/// The ring that defmt writes to.
const CHANNEL: usize = 0;
/// Pause after an empty ring was read. It is short because the ring loses entries when it is full.
const PAUSE: Duration = Duration::from_millis(10);
/// A program that was started has set up its ring by then; a board that is being reset answers again.
const PATIENCE: Duration = Duration::from_secs(2);
/// Bytes of each part of the program that are compared with the flash before its log is decoded.
const COMPARED_BYTES: usize = 1024;

/// What there is to tell of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A message.
    Line(Line),
    /// A message that was damaged: the ring ran over before it was read, or the log was joined in the middle of one.
    Damaged,
    /// The program began anew.
    Restarted,
}

/// How reading ends for a moment.
enum Lost {
    /// The ring is not there, or is another one than before.
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
    /// Reads the log of the program that runs, which must be this image, for as long as `go_on` says.
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
                "its program keeps no log: no RTT control block in its ELF file",
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
                    // A reset in between: the ring begins anew.
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

    /// Finds the ring, with some patience; `None` if the log is no longer wanted.
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
                            "its program has set up no log: {}",
                            super::fault::chain(&error)
                        ),
                        "look with `touchstone device status` whether it runs, or write it anew",
                    ));
                }
            }
        }
        Ok(None)
    }

    /// Whether what runs is this program, whose words alone fit to its numbers: the beginning of each part is compared.
    fn is_running(&mut self, image: &Image) -> Result<(), Fault> {
        for part in &image.parts {
            let expected = &part.bytes[..part.bytes.len().min(COMPARED_BYTES)];
            let mut there = vec![0; expected.len()];
            self.bytes(part.address, &mut there)?;
            if there != expected {
                return Err(Fault::of(
                    &self.chip,
                    "has another program in its flash than the ELF file",
                    "name the file that was written, or write this one: touchstone flash --log",
                ));
            }
        }
        Ok(())
    }
}
