//! Writes files so that each is either complete or absent. The content first goes to a temporary file in the same folder, which is
//! then renamed to the final name. A symbolic link of the final name is never followed, and an older file is replaced only if the
//! caller says so. Exceptions are devices, pipes and the files of [`begun`], which are written in place.

use std::ffi::{OsStr, OsString};
use std::fs::{File, Metadata, OpenOptions, TryLockError};
use std::io::{ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Beginning of a temporary file's name. `PROCESS.COUNT-NAME` follows: number of the writing process, a counter, name of the final
/// file.
const PREFIX: &str = ".touchstone-";

/// A temporary file in the folder of an output; deleted on drop. The program locks the file while using it. The operating system
/// unlocks the file when the process ends in any way, so that an unlocked file was left by a killed process.
#[derive(Debug)]
pub struct Beside {
    path: PathBuf,
    file: File,
}

/// State of a temporary file that this or another process created.
#[derive(Debug)]
pub enum TemporaryFile {
    /// Its process has ended. The file is now locked by this process.
    Left(Beside),
    /// Its process is still running.
    InUse,
    /// The file is not a regular file, it cannot be opened, or the file system has no locks.
    Unknown,
}

impl Beside {
    /// Creates and locks a temporary file. `name` makes its name from a text that no other temporary file of this process has:
    /// `PROCESS.COUNT`.
    ///
    /// # Errors
    /// The operating system's error.
    pub fn create(folder: &Path, name: impl Fn(&str) -> OsString) -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(name(&format!("{}.{count}", std::process::id())));
            let file = match File::create_new(&path) {
                // A killed process with the same process number left a file of this name.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                created => created?,
            };
            // Before the lock, another process may take the file for one that was left behind, and delete it. On a file system
            // without locks, files of killed processes stay.
            let is_taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
            if !is_taken && path.symlink_metadata().is_ok() {
                return Ok(Self { path, file });
            }
        }
    }

    /// Whether the temporary file's process has ended. A link is not followed, and a pipe is not waited for.
    #[must_use]
    pub fn find(path: &Path) -> TemporaryFile {
        if !std::fs::symlink_metadata(path).is_ok_and(|meta| meta.is_file()) {
            return TemporaryFile::Unknown;
        }
        // Some file systems lock only files that are open for writing.
        let Ok(file) = OpenOptions::new().read(true).write(true).open(path) else {
            return TemporaryFile::Unknown;
        };
        match file.try_lock() {
            // Since the file was opened, the process that created it has deleted it.
            Ok(()) if path.symlink_metadata().is_err() => TemporaryFile::InUse,
            Ok(()) => TemporaryFile::Left(Self {
                path: path.to_owned(),
                file,
            }),
            Err(TryLockError::WouldBlock) => TemporaryFile::InUse,
            Err(TryLockError::Error(_)) => TemporaryFile::Unknown,
        }
    }

    /// Path of the temporary file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The locked file, to write into or to read from.
    #[must_use]
    pub fn file(&self) -> &File {
        &self.file
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // After the move the temporary file no longer exists, and the error is ignored.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Whether a text is `PROCESS.COUNT`, or `PROCESS` alone, as in the names of temporary files.
#[must_use]
pub fn is_number_of_process(text: &str) -> bool {
    let mut parts = text.split('.');
    let is_number = |part: &str| part.parse::<u32>().is_ok();
    parts.next().is_some_and(is_number)
        && parts.next().is_none_or(is_number)
        && parts.next().is_none()
}

/// Whether the path is a device or a pipe, also through a link such as `/dev/stdout`. Such a path is written to, not replaced.
fn is_special(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir())
}

/// Checks that writing to the path would replace no file and no link. Devices and pipes pass the check, because they are written to
/// directly.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] for a file, and for a link that does not lead to a device or a pipe;
/// [`ErrorKind::IsADirectory`] for a folder.
pub fn is_free(path: &Path) -> Result<()> {
    match std::fs::symlink_metadata(path) {
        Ok(meta) if meta.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(_) if !is_special(path) => Err(ErrorKind::AlreadyExists.into()),
        _ => Ok(()),
    }
}

/// Writes a file, and replaces an older file or link of the same path. A device or a pipe is written to directly.
///
/// # Errors
/// The operating system's error. An older file is then unchanged.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    put(path, content.as_ref(), true)
}

/// Writes a file only if no file or link has its path, even if another process creates one in the meantime.
///
/// # Errors
/// Same as [`write()`] and [`is_free`].
pub fn write_new(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    put(path, content.as_ref(), false)
}

fn put(path: &Path, content: &[u8], replaces: bool) -> Result<()> {
    let place = std::fs::symlink_metadata(path);
    if place.as_ref().is_ok_and(Metadata::is_dir) {
        return Err(ErrorKind::IsADirectory.into());
    }
    if is_special(path) {
        return OpenOptions::new()
            .write(true)
            .open(path)?
            .write_all(content);
    }
    if place.is_ok_and(|meta| meta.permissions().readonly()) {
        return Err(ErrorKind::PermissionDenied.into());
    }
    if !replaces {
        is_free(path)?;
    }
    let mut beside = beside(path)?;
    beside.file.write_all(content)?;
    beside.file.sync_all()?;
    if replaces {
        return std::fs::rename(&beside.path, path);
    }
    match std::fs::hard_link(&beside.path, path) {
        // The file system has no hard links. Another process may still create the file between check and move.
        Err(error) if error.kind() != ErrorKind::AlreadyExists => {
            is_free(path)?;
            std::fs::rename(&beside.path, path)
        }
        done => done,
    }
}

/// Folder of a file; `.` for a plain name.
fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|dir| !dir.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// Creates the temporary file for `path`, and deletes temporary files that killed processes left for the same path.
fn beside(path: &Path) -> Result<Beside> {
    let Some(name) = path.file_name() else {
        return Err(ErrorKind::InvalidFilename.into());
    };
    sweep(path);
    Beside::create(folder_of(path), |process| {
        let mut hidden = OsString::from(format!("{PREFIX}{process}-"));
        hidden.push(name);
        hidden
    })
}

/// Deletes temporary files that killed processes left for `path`.
fn sweep(path: &Path) {
    let entries = std::fs::read_dir(folder_of(path));
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name();
        let rest = name.as_encoded_bytes().strip_prefix(PREFIX.as_bytes());
        let of_this = rest.is_some_and(|rest| {
            let process = rest.split(|byte| *byte == b'-').next().unwrap_or_default();
            std::str::from_utf8(process).is_ok_and(is_number_of_process)
                && rest.get(process.len() + 1..) == path.file_name().map(OsStr::as_encoded_bytes)
        });
        if of_this {
            // Dropping the file deletes it.
            drop(Beside::find(&entry.path()));
        }
    }
}

/// Creates a file that grows while the program runs, such as a recording. If `replaces` is true, an older file or link of the same
/// path is deleted first.
///
/// # Errors
/// The operating system's error; [`ErrorKind::AlreadyExists`] if the path is not free and `replaces` is false.
pub fn begun(path: &Path, replaces: bool) -> Result<File> {
    if is_special(path) {
        return OpenOptions::new().write(true).open(path);
    }
    let place = std::fs::symlink_metadata(path);
    if place
        .as_ref()
        .is_ok_and(|meta| meta.permissions().readonly())
    {
        return Err(ErrorKind::PermissionDenied.into());
    }
    // A link is deleted, not the file that it leads to.
    if replaces && place.is_ok_and(|meta| !meta.is_dir()) {
        std::fs::remove_file(path)?;
    }
    sweep(path);
    File::create_new(path)
}

/// Those of a folder and its parents that do not exist, innermost first.
#[must_use]
pub fn missing(folder: &Path) -> Vec<PathBuf> {
    let missing = |dir: &&Path| !dir.as_os_str().is_empty() && !dir.exists();
    let dirs = folder.ancestors().take_while(missing);
    dirs.map(Path::to_owned).collect()
}

/// Removes those of the folders that are empty.
pub fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        let _ = std::fs::remove_dir(folder);
    }
}

/// Creates a folder with its parents, and calls `work`, which writes into the folder. If either fails, new folders that are empty
/// are removed.
///
/// # Errors
/// The operating system's error, converted by `wrong`; the error of `work`.
pub fn in_folder<T, E>(
    folder: &Path,
    wrong: impl FnOnce(std::io::Error) -> E,
    work: impl FnOnce() -> std::result::Result<T, E>,
) -> std::result::Result<T, E> {
    let made = missing(folder);
    let done = std::fs::create_dir_all(folder)
        .map_err(wrong)
        .and_then(|()| work());
    if done.is_err() {
        remove_empty(&made);
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("touchstone-output-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let entry = |entry: Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(entry).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_where_that_is_wanted_and_nothing_else_is_left() {
        let folder = folder("plain");
        let file = folder.join("a");
        write_new(&file, "one").unwrap();
        let taken = write_new(&file, "two").unwrap_err();
        assert_eq!(taken.kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&file).unwrap(), b"one");
        write(&file, "two").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"two");
        assert!(write(&folder, "x").is_err() && is_free(&folder).is_err());
        assert!(write(&folder.join("none/a"), "x").is_err());
        assert_eq!(names(&folder), ["a"]);
        fs::remove_dir_all(folder).unwrap();
    }

    /// Tests that the temporary file of a killed process is deleted, but not that of a running process or of another file.
    #[test]
    fn what_a_killed_process_left_goes_with_the_next_of_the_same_name() {
        let folder = folder("killed");
        let kept = [
            ".touchstone-2.0-a",
            ".touchstone-1-b",
            ".touchstone-1-a-a",
            ".touchstone-x-a",
            ".touchstone-1.x-a",
            ".touchstone-1.2.3-a",
            ".touchstone--a",
        ];
        let fill = || {
            for name in [".touchstone-1-a", ".touchstone-1.17-a"]
                .iter()
                .chain(&kept)
            {
                fs::write(folder.join(name), "half").unwrap();
            }
        };
        fill();
        let at_work = File::open(folder.join(kept[0])).unwrap();
        at_work.lock().unwrap();
        let mut expected = kept.to_vec();
        expected.push("a");
        expected.sort_unstable();
        write(&folder.join("a"), "whole").unwrap();
        assert_eq!(names(&folder), expected);
        // `begun` writes in place and creates no temporary file, but deletes those that killed processes left.
        fill();
        begun(&folder.join("a"), true).unwrap();
        assert_eq!(names(&folder), expected);
        fs::remove_dir_all(folder).unwrap();
    }

    /// Tests that a link, a folder or a pipe with the name of a temporary file is neither opened nor deleted.
    #[cfg(unix)]
    #[test]
    fn only_a_file_is_taken_for_what_a_killed_process_left() {
        let folder = folder("odd");
        fs::write(folder.join("mine"), "mine").unwrap();
        std::os::unix::fs::symlink("mine", folder.join(".touchstone-1-a")).unwrap();
        fs::create_dir(folder.join(".touchstone-2-a")).unwrap();
        let pipe = folder.join(".touchstone-3-a");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        let before = names(&folder);
        write(&folder.join("a"), "whole").unwrap();
        assert_eq!(names(&folder).len(), before.len() + 1);
        assert_eq!(fs::read(folder.join("mine")).unwrap(), b"mine");
        if !made.is_ok_and(|ended| ended.success()) {
            println!("the pipe was skipped: there is no mkfifo");
        }
        fs::remove_dir_all(folder).unwrap();
    }

    /// Tests that several threads can write one file at the same time. Each of them sees that the others' temporary files are in
    /// use, and deletes none of them.
    #[test]
    fn many_at_once_do_not_delete_each_others_files() {
        let folder = folder("many");
        let file = folder.join("a");
        std::thread::scope(|scope| {
            for letter in ["a", "b", "c", "d"] {
                let file = &file;
                scope.spawn(move || {
                    for _ in 0..50 {
                        write(file, letter.repeat(1000)).unwrap();
                    }
                });
            }
        });
        let whole = fs::read_to_string(&file).unwrap();
        assert_eq!(whole, whole[..1].repeat(1000));
        assert_eq!(names(&folder), ["a"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_followed_and_what_is_no_file_is_written_to() {
        let folder = folder("link");
        let [other, link] = ["other", "link"].map(|name| folder.join(name));
        fs::write(&other, "mine").unwrap();
        let linked = || {
            let _ = fs::remove_file(&link);
            std::os::unix::fs::symlink(&other, &link).unwrap();
        };
        linked();
        assert_eq!(
            write_new(&link, "x").unwrap_err().kind(),
            ErrorKind::AlreadyExists
        );
        write(&link, "new").unwrap();
        assert_eq!(fs::read(&other).unwrap(), b"mine");
        assert_eq!(fs::read(&link).unwrap(), b"new");
        // A link that leads nowhere is treated in the same way.
        let nowhere = folder.join("nowhere");
        std::os::unix::fs::symlink(folder.join("none"), &nowhere).unwrap();
        assert!(write_new(&nowhere, "x").is_err());
        write(&nowhere, "new").unwrap();
        assert!(!folder.join("none").exists());
        write(Path::new("/dev/null"), "x").unwrap();
        write_new(Path::new("/dev/null"), "x").unwrap();
        linked();
        assert_eq!(
            begun(&link, false).unwrap_err().kind(),
            ErrorKind::AlreadyExists
        );
        begun(&link, true).unwrap().write_all(b"new").unwrap();
        begun(Path::new("/dev/null"), false).unwrap();
        assert_eq!(fs::read(&other).unwrap(), b"mine");
        assert_eq!(fs::read(&link).unwrap(), b"new");
        assert_eq!(names(&folder), ["link", "nowhere", "other"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_folder_in_which_nothing_could_be_written_is_not_left() {
        let folder = folder("new");
        let new = folder.join("a/b");
        let failed: Result<()> = in_folder(&new, |error| error, || write(&new.join("none/c"), "x"));
        assert!(failed.is_err() && names(&folder).is_empty());
        // What was written stays, and so does a folder that was there before.
        let half = || {
            write(&new.join("c"), "x")?;
            write(&new.join("none/d"), "x")
        };
        assert!(in_folder(&new, |error| error, half).is_err());
        assert_eq!(names(&new), ["c"]);
        fs::remove_file(new.join("c")).unwrap();
        let failed: Result<()> = in_folder(&new, |error| error, || write(&new.join("none/c"), "x"));
        assert!(failed.is_err() && new.is_dir());
        fs::remove_dir_all(folder).unwrap();
    }

    /// Tests the error for a full disk, which `/dev/full` imitates on Linux.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_said() {
        let error = write(Path::new("/dev/full"), "x").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::StorageFull);
    }
}
