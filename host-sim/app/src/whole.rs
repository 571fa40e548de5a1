//! Files that are written whole or not at all: first beside their place, under a unique name, then moved there.

use std::io::{ErrorKind, Result, Write};
use std::path::{Path, PathBuf};

/// Takes the file beside away again unless it was moved.
struct Beside(PathBuf);

impl Drop for Beside {
    fn drop(&mut self) {
        // After the move it is gone, which is what is wanted.
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Writes a file. A link in its place is replaced, never followed; a device or a pipe, such as `/dev/stdout`, is
/// written to directly.
///
/// # Errors
/// The system's message. The file is then unchanged.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let place = std::fs::symlink_metadata(path);
    if place.as_ref().is_ok_and(std::fs::Metadata::is_dir) {
        return Err(ErrorKind::IsADirectory.into());
    }
    // What is behind a link of the system's own, /dev/stdout, is no file to replace.
    let is_special = std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir());
    if is_special {
        return std::fs::OpenOptions::new()
            .write(true)
            .open(path)?
            .write_all(content.as_ref());
    }
    if place
        .as_ref()
        .is_ok_and(|meta| meta.permissions().readonly())
    {
        return Err(ErrorKind::PermissionDenied.into());
    }
    let Some(name) = path.file_name() else {
        return Err(ErrorKind::InvalidFilename.into());
    };
    let mut hidden = std::ffi::OsString::from(format!(".touchstone-{}-", std::process::id()));
    hidden.push(name);
    let beside = Beside(path.with_file_name(hidden));
    // Of a process with this number that was killed.
    let _ = std::fs::remove_file(&beside.0);
    let mut file = std::fs::File::create_new(&beside.0)?;
    file.write_all(content.as_ref())?;
    file.sync_all()?;
    std::fs::rename(&beside.0, path)
}

/// Opens a file that grows while it is written, such as an endless recording. A link in its place is replaced, never
/// followed.
///
/// # Errors
/// The system's message.
pub fn begun(path: &Path) -> Result<std::fs::File> {
    let is_link = std::fs::symlink_metadata(path).is_ok_and(|meta| meta.is_symlink());
    let is_special = std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir());
    if is_link && !is_special {
        std::fs::remove_file(path)?;
        return std::fs::File::create_new(path);
    }
    std::fs::File::create(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("touchstone-whole-{name}-{}", std::process::id()));
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
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let folder = folder("plain");
        let file = folder.join("a");
        write(&file, "one").unwrap();
        write(&file, "two").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"two");
        assert!(write(&folder, "x").is_err());
        assert!(write(&folder.join("none/a"), "x").is_err());
        assert_eq!(names(&folder), ["a"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_followed_and_what_is_no_file_is_written_to() {
        let folder = folder("link");
        let [other, link] = ["other", "link"].map(|name| folder.join(name));
        fs::write(&other, "mine").unwrap();
        std::os::unix::fs::symlink(&other, &link).unwrap();
        write(&link, "new").unwrap();
        assert_eq!(fs::read(&other).unwrap(), b"mine");
        assert_eq!(fs::read(&link).unwrap(), b"new");
        // One that leads nowhere, too.
        let nowhere = folder.join("nowhere");
        std::os::unix::fs::symlink(folder.join("none"), &nowhere).unwrap();
        write(&nowhere, "new").unwrap();
        assert!(!folder.join("none").exists());
        write(Path::new("/dev/null"), "x").unwrap();
        std::fs::remove_file(&link).unwrap();
        std::os::unix::fs::symlink(&other, &link).unwrap();
        begun(&link).unwrap().write_all(b"new").unwrap();
        begun(Path::new("/dev/null")).unwrap();
        assert_eq!(fs::read(&other).unwrap(), b"mine");
        assert_eq!(fs::read(&link).unwrap(), b"new");
        assert_eq!(names(&folder), ["link", "nowhere", "other"]);
        fs::remove_dir_all(folder).unwrap();
    }

    /// `/dev/full` is a full disk that every Linux has.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_said() {
        let error = write(Path::new("/dev/full"), "x").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::StorageFull);
    }
}
