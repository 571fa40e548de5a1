//! The file of a raw MIDI device.

use crate::out::note;
use std::fs::File;
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};

/// What can be given as `--midi`.
#[cfg(target_os = "linux")]
const GIVE: &str = "give a device as /dev/snd/midiC1D0 (`amidi -l` lists them), or a FIFO";

/// The device's file. A FIFO is written only, and is opened whenever a program reads it.
#[derive(Debug)]
pub struct Line {
    path: PathBuf,
    file: Option<File>,
    is_fifo: bool,
    has_failed: bool,
}

#[cfg(target_os = "linux")]
impl Line {
    pub fn open(path: &Path) -> Result<Self> {
        use std::io::ErrorKind;
        use std::os::unix::fs::FileTypeExt;
        let failed = |problem: String, fix: &str| Error::Option {
            option: "--midi".into(),
            problem: format!("{}: {problem}", path.display()),
            fix: fix.into(),
        };
        let kind = std::fs::metadata(path).map_err(|error| failed(error.to_string(), GIVE))?;
        let kind = kind.file_type();
        let is_fifo = kind.is_fifo();
        if !is_fifo && !kind.is_char_device() {
            return Err(failed("this is no device and no FIFO".into(), GIVE));
        }
        let mut line = Self {
            path: path.to_owned(),
            file: None,
            is_fifo,
            has_failed: false,
        };
        // The system's number for "no such device or address": nobody reads the FIFO yet.
        const ENXIO: i32 = 6;
        match line.file() {
            Ok(()) => {}
            Err(error) if is_fifo && error.raw_os_error() == Some(ENXIO) => {}
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                return Err(failed(
                    "you may not write to it".into(),
                    "join its group, on most systems by sudo usermod -aG audio $USER, and log in again",
                ));
            }
            Err(error) if error.kind() == ErrorKind::ResourceBusy => {
                return Err(failed("another program uses it".into(), "end that program"));
            }
            Err(error) => return Err(failed(error.to_string(), GIVE)),
        }
        Ok(line)
    }

    /// Opens the file, unless it is open. Never waits.
    fn file(&mut self) -> std::io::Result<()> {
        use std::os::unix::fs::OpenOptionsExt;
        // Of Linux: do not wait; do not become the terminal of this program.
        const O_NONBLOCK: i32 = 0o4000;
        const O_NOCTTY: i32 = 0o400;
        let open = |reads: bool| {
            let mut options = std::fs::OpenOptions::new();
            options.write(true).read(reads);
            options.custom_flags(O_NONBLOCK | O_NOCTTY).open(&self.path)
        };
        if self.file.is_none() {
            // A device may have an output alone.
            let both = if self.is_fifo { None } else { open(true).ok() };
            self.file = Some(both.map_or_else(|| open(false), Ok)?);
        }
        Ok(())
    }
}

#[cfg(not(target_os = "linux"))]
impl Line {
    pub fn open(_path: &Path) -> Result<Self> {
        Err(Error::Option {
            option: "--midi".into(),
            problem: "this system has no raw MIDI devices".into(),
            fix: "use --osc with a program that turns OSC into MIDI".into(),
        })
    }

    fn file(&mut self) -> std::io::Result<()> {
        Err(std::io::ErrorKind::Unsupported.into())
    }
}

impl Line {
    /// Writes a message. One that nobody reads is lost, as on a cable.
    pub fn write(&mut self, bytes: &[u8]) {
        use std::io::Write;
        if bytes.is_empty() || self.file().is_err() {
            return;
        }
        let written = self.file.as_mut().map(|file| file.write_all(bytes));
        match written {
            Some(Err(error)) => {
                if self.is_fifo {
                    self.file = None;
                } else if !self.has_failed {
                    note!("note: --midi: {}: {error}", self.path.display());
                }
                self.has_failed = true;
            }
            _ => self.has_failed = false,
        }
    }

    /// The bytes that have arrived.
    pub fn read(&mut self) -> Vec<u8> {
        use std::io::Read;
        let mut bytes = [0; 256];
        // What was opened for writing alone gives an error, as does an input without bytes.
        let count = self.file.as_mut().map(|file| file.read(&mut bytes));
        let count = count.and_then(std::result::Result::ok);
        bytes.get(..count.unwrap_or(0)).unwrap_or_default().to_vec()
    }
}
