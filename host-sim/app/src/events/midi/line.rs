//! The file of a raw MIDI device, FIFO or pseudo terminal.

use crate::out::note;
use std::fs::File;
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};

/// Error text on what `--midi` accepts.
#[cfg(target_os = "linux")]
const GIVE: &str = "give a device as /dev/snd/midiC1D0 (`amidi -l` lists them), or a FIFO";

/// The device's file. A FIFO is only written to; it can be opened only while another program reads it.
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
            return Err(failed("this is neither a device nor a FIFO".into(), GIVE));
        }
        let mut line = Self {
            path: path.to_owned(),
            file: None,
            is_fifo,
            has_failed: false,
        };
        // Error number "no such device or address" of Linux: no program reads the FIFO yet.
        const ENXIO: i32 = 6;
        match line.file() {
            Ok(()) => {}
            Err(error) if is_fifo && error.raw_os_error() == Some(ENXIO) => {}
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                return Err(failed(
                    "you have no permission to write to it".into(),
                    "become a member of its group, on most systems by `sudo usermod -aG audio $USER`, and log in again",
                ));
            }
            Err(error) if error.kind() == ErrorKind::ResourceBusy => {
                return Err(failed("another program uses it".into(), "end that program"));
            }
            Err(error) => return Err(failed(error.to_string(), GIVE)),
        }
        Ok(line)
    }

    /// Opens the file if it is not open. Does not block.
    fn file(&mut self) -> std::io::Result<()> {
        use std::os::unix::fs::OpenOptionsExt;
        // Flags of Linux: do not block; do not become this program's controlling terminal.
        const O_NONBLOCK: i32 = 0o4000;
        const O_NOCTTY: i32 = 0o400;
        let open = |reads: bool| {
            let mut options = std::fs::OpenOptions::new();
            options.write(true).read(reads);
            options.custom_flags(O_NONBLOCK | O_NOCTTY).open(&self.path)
        };
        if self.file.is_none() {
            // A device may have only an output.
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
    /// Writes a message. A message that no program reads is lost, as on a MIDI cable.
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

    /// The bytes that have arrived since the last call; at most 256.
    pub fn read(&mut self) -> Vec<u8> {
        use std::io::Read;
        let mut bytes = [0; 256];
        // Reading gives an error if the file is open only for writing, or if no byte has arrived.
        let count = self.file.as_mut().map(|file| file.read(&mut bytes));
        let count = count.and_then(std::result::Result::ok);
        bytes.get(..count.unwrap_or(0)).unwrap_or_default().to_vec()
    }
}
