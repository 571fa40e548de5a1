//! Reads files that users name, up to a largest size for each purpose. The content of a pipe is kept, because a pipe can be read
//! only once.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Largest size of a scene file, bytes. A file of this size holds about a hundred thousand keys, which take one second to refuse.
pub const MOST_OF_SCENE: u64 = 1_000_000;
/// Largest size of a file of settings or of a survey of a device, bytes.
pub const MOST_OF_SETTINGS: u64 = 4_000_000;
/// Largest size of a file of results or of a board's firmware, bytes.
pub const MOST_OF_RESULTS: u64 = 64_000_000;
/// Largest size of a recording, bytes.
pub const MOST_OF_RECORDING: u64 = 200_000_000;

/// Number of bytes that are read at a time. When a text is read, a chunk with a zero byte ends the reading.
const PART: usize = 1 << 16;

/// Contents of the pipes read so far, by path. A pipe can be read only once, but a scene is read several times.
static PIPES: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());

fn too_long(most: u64) -> Error {
    let problem = format!("is longer than the {} MB that are read", most / 1_000_000);
    Error::new(ErrorKind::FileTooLarge, problem)
}

fn no_text() -> Error {
    Error::new(ErrorKind::InvalidData, "is not text in UTF-8")
}

/// Reads a file of up to `most` bytes. If `text` is true, a zero byte ends the reading with an error.
fn read(path: &Path, most: u64, text: bool) -> Result<Vec<u8>> {
    let mut pipes = PIPES.lock().unwrap_or_else(|broken| broken.into_inner());
    if let Some(bytes) = pipes.get(path) {
        return Ok(bytes.clone());
    }
    let mut file = File::open(path)?;
    let meta = file.metadata()?;
    // A regular file's length is known, so a file that is too long is refused before reading.
    if meta.is_file() && meta.len() > most {
        return Err(too_long(most));
    }
    let mut bytes = Vec::with_capacity(match meta.is_file() {
        true => meta.len() as usize + PART,
        false => 0,
    });
    loop {
        let before = bytes.len();
        let got = (&mut file).take(PART as u64).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most {
            return Err(too_long(most));
        }
        if text && bytes[before..].contains(&0) {
            return Err(no_text());
        }
        if got == 0 {
            break;
        }
    }
    if !meta.is_file() {
        pipes.insert(path.to_owned(), bytes.clone());
    }
    Ok(bytes)
}

/// Reads a file as bytes.
///
/// # Errors
/// The system's error; [`ErrorKind::FileTooLarge`] for more than `most` bytes.
pub fn bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    read(path, most, false)
}

/// Reads a file as UTF-8 text.
///
/// # Errors
/// Same as [`bytes`]; [`ErrorKind::InvalidData`] for content that is not UTF-8 or has a zero byte.
pub fn text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read(path, most, true)?).map_err(|_| no_text())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Tests four inputs: endless, not text, too long, and of exactly the allowed length.
    #[test]
    fn nothing_is_read_beyond_its_limit() {
        let said = |path: &str, most| text(Path::new(path), most).unwrap_err().to_string();
        assert_eq!(said("/dev/zero", 200_000_000), "is not text in UTF-8");
        assert_eq!(said("/dev/urandom", 200_000_000), "is not text in UTF-8");
        let endless = bytes(Path::new("/dev/zero"), 1_000_000).unwrap_err();
        assert_eq!(endless.kind(), ErrorKind::FileTooLarge);

        let file = std::env::temp_dir().join(format!("touchstone-input-{}", std::process::id()));
        // A sparse file of ten gigabytes takes no room, and is refused at once.
        File::create(&file)
            .unwrap()
            .set_len(10_000_000_000)
            .unwrap();
        let long = text(&file, MOST_OF_SETTINGS).unwrap_err().to_string();
        assert_eq!(long, "is longer than the 4 MB that are read");
        std::fs::write(&file, "a".repeat(1000)).unwrap();
        assert_eq!(text(&file, 1000).unwrap().len(), 1000);
        assert!(text(&file, 999).is_err());
        std::fs::remove_file(file).unwrap();
    }
}
