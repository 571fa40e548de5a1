//! Reading a user's files: of any kind, none beyond its limit; a pipe is read once, however often its content is
//! needed.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Longest scene, bytes: a hundred thousand keys, which takes a second to refuse.
pub const MOST_OF_SCENE: u64 = 1_000_000;
/// Longest file of settings, survey, bytes.
pub const MOST_OF_SETTINGS: u64 = 4_000_000;
/// Longest file of results, program of a board, bytes.
pub const MOST_OF_RESULTS: u64 = 64_000_000;
/// Longest recording, bytes.
pub const MOST_OF_RECORDING: u64 = 200_000_000;

/// Bytes that are read at a time; a text with a zero byte is refused at once.
const PART: usize = 1 << 16;

/// Contents of pipes, which can be read only once: a scene is read several times, and again for its report.
static PIPES: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());

fn too_long(most: u64) -> Error {
    let problem = format!("is longer than the {} MB that are read", most / 1_000_000);
    Error::new(ErrorKind::FileTooLarge, problem)
}

fn no_text() -> Error {
    Error::new(ErrorKind::InvalidData, "is not text in UTF-8")
}

/// Reads up to `most` bytes; with `text` no further than the first part that has a zero byte.
fn read(path: &Path, most: u64, text: bool) -> Result<Vec<u8>> {
    let mut pipes = PIPES.lock().unwrap_or_else(|broken| broken.into_inner());
    if let Some(bytes) = pipes.get(path) {
        return Ok(bytes.clone());
    }
    let mut file = File::open(path)?;
    let meta = file.metadata()?;
    // Said before anything is read, where the length is known.
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

/// A file's bytes.
///
/// # Errors
/// The system's message; [`ErrorKind::FileTooLarge`] for more than `most` bytes.
pub fn bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    read(path, most, false)
}

/// A file's text.
///
/// # Errors
/// Same as [`bytes`]; [`ErrorKind::InvalidData`] for a text that is not UTF-8 or has a zero byte.
pub fn text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read(path, most, true)?).map_err(|_| no_text())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Tests an endless input, one that is no text, one that is too long, and one of exactly the allowed length.
    #[test]
    fn nothing_is_read_beyond_its_limit() {
        let said = |path: &str, most| text(Path::new(path), most).unwrap_err().to_string();
        assert_eq!(said("/dev/zero", 200_000_000), "is not text in UTF-8");
        assert_eq!(said("/dev/urandom", 200_000_000), "is not text in UTF-8");
        let endless = bytes(Path::new("/dev/zero"), 1_000_000).unwrap_err();
        assert_eq!(endless.kind(), ErrorKind::FileTooLarge);

        let file = std::env::temp_dir().join(format!("touchstone-input-{}", std::process::id()));
        // Sparse: ten gigabytes that take no room, and no time to refuse.
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
