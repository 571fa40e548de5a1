//! Reads files that users name, up to a largest size for each purpose. The content of a pipe is kept, because a pipe can be read
//! only once.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Largest size of a scene file, bytes. A file of this size holds about a hundred thousand keys, which take one second to refuse.
pub const MOST_OF_SCENE: u64 = 1_000_000;
/// Largest size of a file of settings or of a survey of a device, bytes.
pub const MOST_OF_SETTINGS: u64 = 4_000_000;
/// Largest size of a file of results or of a board's firmware, bytes.
pub const MOST_OF_RESULTS: u64 = 64_000_000;
/// Largest size of a file of a sweep's cells (results), bytes: some ten million cells.
pub const MOST_OF_CELLS: u64 = 1_000_000_000;
/// Largest size of a recording, bytes.
pub const MOST_OF_RECORDING: u64 = 200_000_000;

/// Longest wait for the next bytes of a pipe. Without it, a pipe to which no program writes would be waited for without end.
const PIPE_WAIT: Duration = Duration::from_secs(60);

/// Number of bytes that are read at a time. When a text is read, a chunk with a zero byte ends the reading.
const PART: usize = 1 << 16;

/// Contents of the pipes read so far, by path. A pipe can be read only once, but a scene is read several times.
static PIPES: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());

fn too_long(most: u64) -> Error {
    let problem = format!("is larger than {} MB, the limit", most / 1_000_000);
    Error::new(ErrorKind::FileTooLarge, problem)
}

/// First bytes of files that are not UTF-8 text, each with a description of the file's type.
const KINDS: [(&[u8], &str); 5] = [
    (b"\x89PNG", "a PNG picture"),
    (
        b"PK\x03\x04",
        "a zip archive, such as a spreadsheet's file or 3MF",
    ),
    (b"\x1f\x8b", "compressed by gzip"),
    (b"\xff\xfe", "text in UTF-16"),
    (b"\xfe\xff", "text in UTF-16"),
];

/// Type of a file that is not text, by its first bytes; `None` for an unknown type.
#[must_use]
pub fn kind_of(bytes: &[u8]) -> Option<&'static str> {
    let found = KINDS.iter().find(|(begin, _)| bytes.starts_with(begin));
    found.map(|(_, kind)| *kind)
}

/// Error for content that is not UTF-8 or has a zero byte.
fn no_text(bytes: &[u8]) -> Error {
    let good = match std::str::from_utf8(bytes) {
        Ok(text) => text.len(),
        Err(error) => error.valid_up_to(),
    };
    let zero = bytes.iter().position(|byte| *byte == 0);
    let at = zero.map_or(good, |zero| zero.min(good));
    let line = 1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count();
    let what = match kind_of(bytes) {
        Some(kind) => format!("it is {kind}"),
        None => format!(
            "line {line} has the byte 0x{:02x}",
            bytes.get(at).unwrap_or(&0)
        ),
    };
    Error::new(
        ErrorKind::InvalidData,
        format!("is not text in UTF-8: {what}"),
    )
}

/// Reads a file of up to `most` bytes. If `text` is true, a zero byte ends the reading with an error.
fn read(path: &Path, most: u64, text: bool) -> Result<Vec<u8>> {
    let mut pipes = PIPES.lock().unwrap_or_else(|broken| broken.into_inner());
    if let Some(bytes) = pipes.get(path) {
        return Ok(bytes.clone());
    }
    // The file's type is read without opening the file, because opening a pipe waits for a program that writes to it.
    let meta = std::fs::metadata(path)?;
    if meta.is_file() {
        // A regular file's length is known, so a file that is too long is refused before reading.
        return match meta.len() > most {
            true => Err(too_long(most)),
            false => parts(path, most, text, meta.len() as usize + PART, || ()),
        };
    }
    let bytes = waited_for(path, most, text, PIPE_WAIT)?;
    pipes.insert(path.to_owned(), bytes.clone());
    Ok(bytes)
}

/// Reads a file part by part, and calls `came` after each part. Memory is reserved for `expected` bytes.
fn parts(path: &Path, most: u64, text: bool, expected: usize, came: impl Fn()) -> Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::with_capacity(expected);
    let mut part = [0; PART];
    loop {
        let got = match file.read(&mut part) {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            got => got?,
        };
        bytes.extend_from_slice(&part[..got]);
        if bytes.len() as u64 > most {
            return Err(too_long(most));
        }
        if text && part[..got].contains(&0) {
            return Err(no_text(&bytes));
        }
        if got == 0 {
            return Ok(bytes);
        }
        came();
    }
}

/// Reads a pipe or a device in a thread of its own. If no byte comes for the time `wait`, the thread is left waiting and the result
/// is an error.
fn waited_for(path: &Path, most: u64, text: bool, wait: Duration) -> Result<Vec<u8>> {
    let (sender, receiver) = channel();
    let path = path.to_owned();
    std::thread::spawn(move || {
        // Sending fails if the receiver has stopped waiting; the error is ignored.
        let came = || drop(sender.send(None));
        let done = parts(&path, most, text, 0, came);
        drop(sender.send(Some(done)));
    });
    loop {
        match receiver.recv_timeout(wait) {
            Ok(None) => {}
            Ok(Some(done)) => return done,
            Err(_) => {
                let problem = format!("no byte came for {} s", wait.as_secs());
                return Err(Error::new(ErrorKind::TimedOut, problem));
            }
        }
    }
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
    String::from_utf8(read(path, most, true)?).map_err(|wrong| no_text(wrong.as_bytes()))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Tests four inputs: endless, not text, too long, and of exactly the allowed length.
    #[test]
    fn nothing_is_read_beyond_its_limit() {
        let said = |path: &str, most| text(Path::new(path), most).unwrap_err().to_string();
        let zero = "is not text in UTF-8: line 1 has the byte 0x00";
        assert_eq!(said("/dev/zero", 200_000_000), zero);
        let random = said("/dev/urandom", 200_000_000);
        assert!(random.starts_with("is not text in UTF-8: "), "{random}");
        let endless = bytes(Path::new("/dev/zero"), 1_000_000).unwrap_err();
        assert_eq!(endless.kind(), ErrorKind::FileTooLarge);

        let file = std::env::temp_dir().join(format!("touchstone-input-{}", std::process::id()));
        // A sparse file of ten gigabytes takes no space on the disk, and is refused without being read.
        File::create(&file)
            .unwrap()
            .set_len(10_000_000_000)
            .unwrap();
        let long = text(&file, MOST_OF_SETTINGS).unwrap_err().to_string();
        assert_eq!(long, "is larger than 4 MB, the limit");
        std::fs::write(&file, "a".repeat(1000)).unwrap();
        assert_eq!(text(&file, 1000).unwrap().len(), 1000);
        assert!(text(&file, 999).is_err());
        std::fs::remove_file(file).unwrap();
    }

    #[test]
    fn what_is_no_text_is_named() {
        for (bytes, expected) in [
            (&b"\xff\xfea\0"[..], "it is text in UTF-16"),
            (b"\x1f\x8b\x08", "it is compressed by gzip"),
            (
                b"PK\x03\x04\0",
                "it is a zip archive, such as a spreadsheet's file or 3MF",
            ),
            (b"a\nGr\xf6\xdfe\n", "line 2 has the byte 0xf6"),
            (b"a\nb\n\0", "line 3 has the byte 0x00"),
            (b"a\xc3", "line 1 has the byte 0xc3"),
        ] {
            let said = no_text(bytes).to_string();
            assert_eq!(said, format!("is not text in UTF-8: {expected}"));
        }
    }

    /// Tests a pipe to which no program writes, and one whose program pauses for less than the wait.
    #[test]
    fn a_pipe_is_not_waited_for_without_end() {
        let pipe = std::env::temp_dir().join(format!("touchstone-pipe-{}", std::process::id()));
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if !made.is_ok_and(|ended| ended.success()) {
            println!("skipped: there is no mkfifo");
            return;
        }
        let error = waited_for(&pipe, 100, true, Duration::from_millis(50)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::TimedOut);
        // The first thread still waits for the removed pipe. A second pipe is read by only one thread.
        std::fs::remove_file(&pipe).unwrap();
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap();
        let writer = std::thread::spawn({
            let pipe = pipe.clone();
            move || {
                use std::io::Write as _;
                let mut pipe = File::options().write(true).open(pipe).unwrap();
                for _ in 0..3 {
                    pipe.write_all(b"a").unwrap();
                    std::thread::sleep(Duration::from_millis(100));
                }
            }
        });
        let read = waited_for(&pipe, 100, true, Duration::from_secs(10)).unwrap();
        assert_eq!(read, b"aaa");
        writer.join().unwrap();
        std::fs::remove_file(pipe).unwrap();
    }
}
