//! A temporary folder in which a report is prepared. It is removed when the program ends, however it ends.
//!
//! The folder holds a file that is locked while its process runs; the operating system unlocks the file when the process ends in
//! any way. Another process can thus distinguish a folder that is being written from one that was left behind, see [`sweep`].

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use touchstone_sim::error::Error;

/// Beginning of a temporary folder's name; the number of the process follows.
const PREFIX: &str = ".touchstone-report-";
/// Name of the locked file in a temporary folder.
const LOCK: &str = ".lock";
/// Ending that a temporary folder's name gets before the folder is removed.
const GOING: &str = ".going";
/// Age below which a lock file counts as in use, because its process may not have locked it yet.
const SETTLED: Duration = Duration::from_secs(10);

/// The temporary folders of this process, each with the parent folders that were created for it, innermost first.
static PRESENT: Mutex<Vec<(PathBuf, Vec<PathBuf>)>> = Mutex::new(Vec::new());

/// Locks the list of temporary folders. A panic under the lock does no harm, because entries are added and removed as a whole.
fn present() -> MutexGuard<'static, Vec<(PathBuf, Vec<PathBuf>)>> {
    PRESENT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The temporary folder of one report.
pub(super) struct Staging {
    /// Path of the temporary folder, to write into.
    pub path: PathBuf,
    target: PathBuf,
    /// Whether the target folder did not exist before. The temporary folder is then renamed to the target as a whole.
    whole: bool,
    /// The locked file; it is unlocked when it is dropped.
    lock: Option<File>,
}

impl Staging {
    /// Creates a temporary folder for a report that is to go into `target`.
    pub fn new(target: &Path) -> io::Result<Self> {
        let whole = match fs::metadata(target) {
            Ok(meta) if meta.is_dir() => false,
            Ok(_) => return Err(io::ErrorKind::NotADirectory.into()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => true,
            Err(error) => return Err(error),
        };
        let beside = if whole { parent(target) } else { target };
        let made: Vec<PathBuf> = beside
            .ancestors()
            .take_while(|dir| !dir.as_os_str().is_empty() && !dir.exists())
            .map(Path::to_owned)
            .collect();
        let mut staging = Staging {
            path: beside.join(format!("{PREFIX}{}", std::process::id())),
            target: target.to_owned(),
            whole,
            lock: None,
        };
        let mut present = present();
        let begun = fs::create_dir_all(beside).and_then(|()| {
            // Two reports of one process into one folder, as in tests, must not share a temporary folder.
            for attempt in 0.. {
                match fs::create_dir(&staging.path) {
                    Err(error)
                        if error.kind() == io::ErrorKind::AlreadyExists && attempt < 1000 =>
                    {
                        staging.path =
                            beside.join(format!("{PREFIX}{}-{attempt}", std::process::id()));
                    }
                    result => return result,
                }
            }
            Ok(())
        });
        if let Err(error) = begun {
            remove_empty(&made);
            return Err(error);
        }
        present.push((staging.path.clone(), made));
        drop(present);
        let lock = File::create(staging.path.join(LOCK))?;
        // On a file system without locks other processes report the folder as left behind, but never remove it.
        let _ = lock.try_lock();
        staging.lock = Some(lock);
        Ok(staging)
    }

    /// Moves `files` to the target folder, then removes the files `stale` in it.
    pub fn publish(mut self, files: &[PathBuf], stale: &[PathBuf]) -> io::Result<()> {
        // The lock is kept until the end. An interruption has to wait, because a report that is moved half-way would be worse than
        // a complete one.
        let mut present = present();
        self.lock = None;
        if self.whole {
            fs::remove_file(self.path.join(LOCK))?;
            fs::rename(&self.path, &self.target)?;
            present.retain(|(path, _)| *path != self.path);
            return Ok(());
        }
        // Everything that could stop the move half-way is checked before the first file is moved.
        for file in files {
            let goal = self.target.join(file);
            if goal.is_dir() {
                return Err(io::Error::new(
                    io::ErrorKind::IsADirectory,
                    format!("{} is a folder", file.display()),
                ));
            }
        }
        // If a folder of the report were a symbolic link, files would go elsewhere.
        for file in files {
            let within = file.parent().unwrap_or(file).ancestors();
            for folder in within.filter(|it| !it.as_os_str().is_empty()) {
                if self.target.join(folder).is_symlink() {
                    let problem = format!("{} is a link, which is not followed", folder.display());
                    return Err(io::Error::new(io::ErrorKind::NotADirectory, problem));
                }
            }
        }
        for file in files {
            fs::create_dir_all(self.target.join(file).parent().unwrap_or(&self.target))?;
        }
        for file in files {
            fs::rename(self.path.join(file), self.target.join(file))?;
        }
        for file in stale {
            // A file that is already gone is no error. A folder that holds other files stays.
            let _ = fs::remove_file(self.target.join(file));
            if let Some(parent) = file.parent().filter(|p| !p.as_os_str().is_empty()) {
                let _ = fs::remove_dir(self.target.join(parent));
            }
        }
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        self.lock = None;
        let mut present = present();
        if let Some(place) = present.iter().position(|(path, _)| *path == self.path) {
            let (path, made) = present.swap_remove(place);
            remove(&path, &made);
        }
    }
}

/// The folder that contains `folder`; `.` for a plain name.
fn parent(folder: &Path) -> &Path {
    match folder.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => folder,
    }
}

/// Removes a temporary folder, and the empty parent folders that were created for it.
fn remove(path: &Path, made: &[PathBuf]) {
    // The folder is renamed first. A thread that still writes into it by its old name then fails, and cannot keep it from becoming
    // empty. If it cannot be renamed (open files on some systems), it is removed under its own name. A failure is ignored.
    let going = path.with_extension(&GOING[1..]);
    let path = match fs::rename(path, &going) {
        Ok(()) => &going,
        Err(_) => path,
    };
    let _ = fs::remove_dir_all(path);
    remove_empty(made);
}

fn remove_empty(made: &[PathBuf]) {
    for dir in made {
        let _ = fs::remove_dir(dir);
    }
}

/// Removes every temporary folder before the process ends, then calls `last`, which ends the process. Other threads that want to
/// start or publish a report wait in the meantime.
pub fn abandon(last: impl FnOnce(&[PathBuf])) {
    let mut present = present();
    let folders: Vec<(PathBuf, Vec<PathBuf>)> = present.drain(..).collect();
    for (path, made) in &folders {
        remove(path, made);
    }
    let removed: Vec<PathBuf> = folders.into_iter().map(|(path, _)| path).collect();
    last(&removed);
}

/// A temporary folder that an ended process left behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stale {
    /// Path of the temporary folder.
    pub path: PathBuf,
    /// Whether the folder was removed. If not, its process may still be running.
    pub removed: bool,
}

/// Finds temporary folders of ended processes in and beside `target`, and removes them. A folder whose process may still be running
/// is returned but not removed.
#[must_use]
pub fn sweep(target: &Path) -> Vec<Stale> {
    let mut found: Vec<Stale> = Vec::new();
    for place in [target, parent(target)] {
        let Ok(entries) = fs::read_dir(place) else {
            continue;
        };
        for entry in entries.flatten() {
            let named = entry.file_name();
            let ours = named.to_str().is_some_and(|name| name.starts_with(PREFIX));
            let path = entry.path();
            if !ours || present().iter().any(|(other, _)| *other == path) {
                continue;
            }
            match ended(&path) {
                Some(true) => {
                    let removed = fs::remove_dir_all(&path).is_ok();
                    found.push(Stale { path, removed });
                }
                Some(false) => {}
                None => found.push(Stale {
                    path,
                    removed: false,
                }),
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found.dedup();
    found
}

/// Whether the process that wrote a folder has ended; `None` if that is unknown.
fn ended(path: &Path) -> Option<bool> {
    let lock = File::open(path.join(LOCK)).ok()?;
    match lock.try_lock() {
        Ok(()) => {
            let written = lock.metadata().and_then(|meta| meta.modified()).ok()?;
            // After a clock was set back the lock seems new; the folder then stays until the clock has passed that time.
            Some(written.elapsed().is_ok_and(|age| age > SETTLED))
        }
        Err(TryLockError::WouldBlock) => Some(false),
        Err(TryLockError::Error(_)) => None,
    }
}

/// Converts an I/O error to a one-line message with the remedy.
pub fn io_error(folder: &Path, error: &io::Error) -> Error {
    use io::ErrorKind::*;
    let problem = match error.kind() {
        NotADirectory => "is not a folder, or lies inside a file".to_owned(),
        // The first line only: errors are one line.
        _ => format!(
            "cannot write the report: {}",
            error.to_string().lines().next().unwrap_or_default()
        ),
    };
    let fix = match error.kind() {
        PermissionDenied | ReadOnlyFilesystem => "give --out a folder that you may write to",
        StorageFull | QuotaExceeded => "free some space or give --out a folder on another disk",
        IsADirectory => "rename that folder or give --out another one",
        _ => "give --out another folder",
    };
    Error::Io {
        path: folder.to_owned(),
        problem,
        fix: fix.to_owned(),
    }
}
