//! Writes files so that each is either complete or absent. The content first goes to a temporary file in the same folder, which is
//! then renamed to the final name. A symbolic link of the final name is never followed, and an older file is replaced only if the
//! caller says so. Exceptions are devices, pipes and the files of [`begun`], which are written in place.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

/// Beginning of a temporary file's name; the number of the writing process and the final file's name follow.
const PREFIX: &str = ".touchstone-";

/// A temporary file in the folder of the final file, deleted on drop unless it was renamed. The program locks the file while using
/// it; an unlocked one was left by a killed process.
struct Beside {
    path: PathBuf,
    file: File,
}

impl Drop for Beside {
    fn drop(&mut self) {
        // After the move the temporary file no longer exists, and the error is ignored.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Whether the path is a device or a pipe, also through a link such as `/dev/stdout`. Such a path is written to, not replaced.
fn is_special(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir())
}

/// Checks that writing to the path would replace no file and no link. Devices and pipes pass the check, because they are written to
/// directly.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] for a file or link, wherever the link leads; [`ErrorKind::IsADirectory`] for a folder.
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

/// Creates the temporary file for `path`, and deletes temporary files that killed processes left for the same path.
fn beside(path: &Path) -> Result<Beside> {
    let Some(name) = path.file_name() else {
        return Err(ErrorKind::InvalidFilename.into());
    };
    let mut hidden = std::ffi::OsString::from(format!("{PREFIX}{}-", std::process::id()));
    hidden.push(name);
    let hidden = path.with_file_name(hidden);
    sweep(path, &hidden);
    let file = File::create_new(&hidden)?;
    // On a file system without locks, temporary files of killed processes stay.
    let _ = file.try_lock();
    Ok(Beside { path: hidden, file })
}

fn sweep(path: &Path, own: &Path) {
    // A killed process with the same number may have left the same name.
    let _ = std::fs::remove_file(own);
    let folder = path.parent().filter(|dir| !dir.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new(".")));
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name();
        let of_this = name
            .to_str()
            .and_then(|name| name.strip_prefix(PREFIX)?.split_once('-'))
            .is_some_and(|(process, of)| {
                process.parse::<u32>().is_ok() && path.file_name() == Some(of.as_ref())
            });
        if of_this && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = std::fs::remove_file(entry.path());
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
    File::create_new(path)
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
        for name in [
            ".touchstone-1-a",
            ".touchstone-2-a",
            ".touchstone-1-b",
            ".touchstone-x-a",
        ] {
            fs::write(folder.join(name), "half").unwrap();
        }
        let at_work = File::open(folder.join(".touchstone-2-a")).unwrap();
        at_work.lock().unwrap();
        write(&folder.join("a"), "whole").unwrap();
        assert_eq!(
            names(&folder),
            [".touchstone-1-b", ".touchstone-2-a", ".touchstone-x-a", "a"]
        );
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

    /// Tests the error for a full disk, which `/dev/full` imitates on Linux.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_said() {
        let error = write(Path::new("/dev/full"), "x").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::StorageFull);
    }
}
