//! A temporary folder in which a report is prepared. It is removed when the program ends, also after an error. After a kill the
//! next [`sweep`] removes it.
//!
//! Beside the folder is a file that is locked while its process runs; the operating system unlocks the file when the process ends
//! in any way. The file is created before the folder and deleted after it. Another process can thus distinguish a folder that is
//! being written from one that was left behind, see [`sweep`]. While files are moved into an existing folder, the locked file lists
//! them, so that the next sweep can undo a move that was killed half-way.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use touchstone_sim::error::Error;
use touchstone_sim::output::{Beside, TemporaryFile, is_number_of_process, missing, remove_empty};

/// Beginning of a temporary folder's name; numbers of process and folder follow.
const PREFIX: &str = ".touchstone-report-";
/// Ending of the name of a temporary folder's locked file.
const LOCK: &str = ".lock";
/// Ending that a temporary folder's name gets before the folder is removed.
const GOING: &str = ".going";

/// A temporary folder of this process.
struct Present {
    path: PathBuf,
    /// Parent folders that were created for the temporary folder, innermost first.
    made: Vec<PathBuf>,
    lock: Beside,
}

/// The temporary folders of this process.
static PRESENT: Mutex<Vec<Present>> = Mutex::new(Vec::new());

/// Locks the list of temporary folders. A panic under the lock does no harm, because entries are added and removed as a whole.
fn present() -> MutexGuard<'static, Vec<Present>> {
    PRESENT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The temporary folder of one report.
pub struct Staging {
    /// Path of the temporary folder, to write into.
    pub path: PathBuf,
    target: PathBuf,
    /// Whether the target folder did not exist before. The temporary folder is then renamed to the target as a whole.
    whole: bool,
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
        let made = missing(beside);
        let mut present = present();
        let begun = fs::create_dir_all(beside).and_then(|()| {
            loop {
                let lock =
                    Beside::create(beside, |process| format!("{PREFIX}{process}{LOCK}").into())?;
                let path = lock.path().with_extension("");
                match fs::create_dir(&path) {
                    // The name is taken by something without a locked file. The next number is tried.
                    Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                    made => return made.map(|()| (path, lock)),
                }
            }
        });
        let (path, lock) = match begun {
            Ok(begun) => begun,
            Err(error) => {
                remove_empty(&made);
                return Err(error);
            }
        };
        present.push(Present {
            path: path.clone(),
            made,
            lock,
        });
        Ok(Staging {
            path,
            target: target.to_owned(),
            whole,
        })
    }

    /// Moves `files` to the target folder, then removes the files `stale` in it.
    pub fn publish(self, files: &[PathBuf], stale: &[PathBuf]) -> io::Result<()> {
        // The list is locked until the end. An interruption has to wait, because a report that is moved half-way would be worse
        // than a complete one.
        let mut present = present();
        if self.whole {
            fs::rename(&self.path, &self.target)?;
            present.retain(|it| it.path != self.path);
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
        if let Some(folder) = files.iter().find_map(|file| link(&self.target, file)) {
            let problem = format!(
                "{} is a symbolic link, which this program does not follow",
                folder.display()
            );
            return Err(io::Error::new(io::ErrorKind::NotADirectory, problem));
        }
        for file in files {
            fs::create_dir_all(self.target.join(file).parent().unwrap_or(&self.target))?;
        }
        let files = results_last(files);
        if let Some(it) = present.iter().find(|it| it.path == self.path) {
            it.lock.file().write_all(&listed(&files, &self.target))?;
        }
        for file in files {
            fs::rename(self.path.join(file), self.target.join(file))?;
        }
        stale.iter().for_each(|file| take_away(&self.target, file));
        Ok(())
    }
}

/// The folder of a report's file that is a symbolic link, if there is one.
fn link<'a>(target: &Path, file: &'a Path) -> Option<&'a Path> {
    let mut within = file.ancestors().skip(1);
    within.find(|it| !it.as_os_str().is_empty() && target.join(it).is_symlink())
}

/// The files in the order in which they are moved: the results, which list the others, come last.
fn results_last(files: &[PathBuf]) -> Vec<&PathBuf> {
    let is_last = |file: &&PathBuf| file.as_path() == Path::new("results.json");
    let (last, first): (Vec<&PathBuf>, Vec<&PathBuf>) = files.iter().partition(is_last);
    [first, last].concat()
}

/// Mark of a file that the target folder does not have yet, in the list of files that are moved.
const NEW: u8 = b'+';
/// Mark of a file that replaces an older one.
const REPLACES: u8 = b'=';

/// The list of files that are moved, in their order: each with its mark, and ended by a zero byte.
fn listed(files: &[&PathBuf], target: &Path) -> Vec<u8> {
    let entry = |file: &&PathBuf| {
        let mark = match target.join(file).exists() {
            true => REPLACES,
            false => NEW,
        };
        [&[mark], file.as_os_str().as_encoded_bytes(), &[0]].concat()
    };
    files.iter().flat_map(entry).collect()
}

/// Undoes a move from a temporary folder into the folder around it, if it ended half-way: removes the new files that were moved.
/// Without this, the next command would take them for another command's files.
fn undo(path: &Path, lock: &Beside) {
    let (mut list, mut file) = (Vec::new(), lock.file());
    let read = file.rewind().and_then(|()| file.read_to_end(&mut list));
    let (Ok(_), Some(target)) = (read, path.parent()) else {
        return;
    };
    let entries: Vec<(u8, &Path)> = list
        .split(|byte| *byte == 0)
        .filter_map(|entry| {
            let (mark, name) = entry.split_first()?;
            Some((*mark, Path::new(std::str::from_utf8(name).ok()?)))
        })
        // Only names within the folder are accepted.
        .filter(|(_, name)| {
            name.components()
                .all(|it| matches!(it, Component::Normal(_)))
        })
        .collect();
    let is_moved = |name: &Path| !path.join(name).exists();
    if entries.last().is_none_or(|(_, last)| is_moved(last)) {
        return;
    }
    let moved = entries
        .iter()
        .filter(|(mark, name)| *mark == NEW && is_moved(name));
    moved
        .filter(|(_, name)| link(target, name).is_none())
        .for_each(|(_, name)| take_away(target, name));
}

/// Removes a file of a report, and its folder within the report if it is then empty. A file that is already gone is no error.
fn take_away(target: &Path, file: &Path) {
    let _ = fs::remove_file(target.join(file));
    if let Some(parent) = file.parent().filter(|p| !p.as_os_str().is_empty()) {
        let _ = fs::remove_dir(target.join(parent));
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let mut present = present();
        if let Some(place) = present.iter().position(|it| it.path == self.path) {
            remove(present.swap_remove(place));
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

/// Removes a temporary folder with its locked file, and the empty parent folders that were created for it.
fn remove(Present { path, made, lock }: Present) {
    undo(&path, &lock);
    remove_folder(&path);
    drop(lock);
    remove_empty(&made);
}

/// Removes a temporary folder; returns whether it is gone. A link is not followed.
fn remove_folder(path: &Path) -> bool {
    let going = with_ending(path, GOING);
    let remove = |path: &Path| {
        if is_folder(path) {
            let _ = fs::remove_dir_all(path);
        }
        !is_folder(path)
    };
    // Completes a removal that was interrupted.
    remove(&going);
    // The folder is renamed first. A thread that still writes into it by its old name then fails, and cannot keep it from becoming
    // empty. If it cannot be renamed (open files on some systems), it is removed under its own name.
    if is_folder(path) {
        let _ = fs::rename(path, &going);
    }
    remove(path) & remove(&going)
}

/// Whether the path itself is a folder, not a link to one.
fn is_folder(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|meta| meta.is_dir())
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut named = path.as_os_str().to_owned();
    named.push(ending);
    named.into()
}

/// Removes every temporary folder before the process ends, then calls `last`, which ends the process. Other threads that want to
/// start or publish a report wait in the meantime.
pub fn abandon(last: impl FnOnce(&[PathBuf])) {
    let mut present = present();
    let removed: Vec<PathBuf> = present.iter().map(|it| it.path.clone()).collect();
    present.drain(..).for_each(remove);
    last(&removed);
}

/// A temporary folder that an ended process left behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stale {
    /// Path of the temporary folder.
    pub path: PathBuf,
    /// Whether the folder was removed. If not, it has no locked file, so that its process may still be running, or the removal
    /// failed.
    pub removed: bool,
}

/// Finds temporary folders of ended processes in and beside `target`, and removes them with their locked files. A folder in use
/// is left out. A folder without a locked file is returned but not removed, because its process may still be running.
pub fn sweep(target: &Path) -> Vec<Stale> {
    let mut found = Vec::new();
    for place in BTreeSet::from([target, parent(target)]) {
        let entries = fs::read_dir(place).into_iter().flatten().flatten();
        let names: BTreeSet<String> = entries
            .filter_map(|entry| stem(entry.file_name().to_str()?))
            .collect();
        found.extend(names.iter().filter_map(|name| swept(&place.join(name))));
    }
    found
}

/// Name of a temporary folder, from its own name, that of its locked file, or that during its removal. `None` for other names.
fn stem(name: &str) -> Option<String> {
    let stem = [LOCK, GOING]
        .iter()
        .find_map(|ending| name.strip_suffix(ending));
    let stem = stem.unwrap_or(name);
    let process = stem.strip_prefix(PREFIX)?;
    is_number_of_process(process).then(|| stem.to_owned())
}

/// Removes a temporary folder and its locked file, if its process has ended.
fn swept(path: &Path) -> Option<Stale> {
    let going = with_ending(path, GOING);
    let was_there = is_folder(path) || is_folder(&going);
    let lock = with_ending(path, LOCK);
    let said = |removed| {
        was_there.then(|| Stale {
            path: path.to_owned(),
            removed,
        })
    };
    match Beside::find(&lock) {
        TemporaryFile::Left(lock) => {
            undo(path, &lock);
            let removed = remove_folder(path);
            drop(lock);
            said(removed)
        }
        TemporaryFile::InUse => None,
        TemporaryFile::Unknown => said(false),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes a report's folder with the temporary folder of an ended process in it; returns the paths of both. The temporary
    /// folder still holds the files `left`; its locked file has the list `list`.
    fn killed(test: &str, list: &str, left: &[&str]) -> (PathBuf, PathBuf) {
        let around =
            std::env::temp_dir().join(format!("touchstone-staging-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&around);
        let target = around.join("out");
        let hidden = target.join(".touchstone-report-4194305.0");
        fs::create_dir_all(&hidden).unwrap();
        for name in left {
            fs::write(hidden.join(name), "").unwrap();
        }
        fs::write(with_ending(&hidden, LOCK), list).unwrap();
        (target, hidden)
    }

    fn names(folder: &Path) -> Vec<String> {
        let entry = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let names = fs::read_dir(folder).unwrap().map(entry);
        let mut names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// An ended process had moved a new file and a replacing file, but not yet its results.
    #[test]
    fn a_move_that_was_killed_half_way_is_undone() {
        let list = "+traces/a.csv\0=scene.toml\0+b.csv\0+results.json\0";
        let (target, hidden) = killed("half", list, &["b.csv", "results.json"]);
        fs::create_dir(target.join("traces")).unwrap();
        for name in ["traces/a.csv", "scene.toml", "b.csv", "mine.txt"] {
            fs::write(target.join(name), "").unwrap();
        }
        let found = sweep(&target);
        assert_eq!(
            found,
            [Stale {
                path: hidden,
                removed: true
            }]
        );
        // `b.csv` was not moved by the process, so it belongs to someone else.
        assert_eq!(names(&target), ["b.csv", "mine.txt", "scene.toml"]);
        fs::remove_dir_all(parent(&target)).unwrap();
    }

    #[test]
    fn a_move_that_was_complete_is_not_undone() {
        let (target, _) = killed("whole", "+a.csv\0+results.json\0", &[]);
        for name in ["a.csv", "results.json"] {
            fs::write(target.join(name), "").unwrap();
        }
        assert!(sweep(&target)[0].removed);
        assert_eq!(names(&target), ["a.csv", "results.json"]);
        fs::remove_dir_all(parent(&target)).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn nothing_outside_of_the_folder_is_removed() {
        let list = "+../mine\0+linked/mine\0+/mine\0+results.json\0";
        let (target, _) = killed("outside", list, &["results.json"]);
        let outside = target.with_file_name("outside");
        fs::create_dir(&outside).unwrap();
        fs::write(outside.join("mine"), "").unwrap();
        fs::write(target.with_file_name("mine"), "").unwrap();
        std::os::unix::fs::symlink(&outside, target.join("linked")).unwrap();
        sweep(&target);
        assert_eq!(names(&target), ["linked"]);
        assert!(outside.join("mine").is_file() && target.with_file_name("mine").is_file());
        fs::remove_dir_all(parent(&target)).unwrap();
    }

    /// A temporary folder in use, and one without a locked file, are not removed.
    #[test]
    fn what_is_in_use_or_unknown_stays() {
        let (target, hidden) = killed("used", "", &["a.csv"]);
        let lock = fs::File::open(with_ending(&hidden, LOCK)).unwrap();
        lock.lock().unwrap();
        assert_eq!(sweep(&target), []);
        assert!(hidden.join("a.csv").is_file());
        drop(lock);
        fs::remove_file(with_ending(&hidden, LOCK)).unwrap();
        assert!(!sweep(&target)[0].removed && hidden.is_dir());
        fs::remove_dir_all(parent(&target)).unwrap();
    }
}
