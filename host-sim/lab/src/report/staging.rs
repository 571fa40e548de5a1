//! A folder in which a report is prepared aside, and moved into place at the end, so that nothing is half-written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use touchstone_sim::error::Error;

/// A folder aside in which the report is prepared; gone when dropped, whatever happened.
pub struct Staging {
    /// Where to write.
    pub path: PathBuf,
    target: PathBuf,
    /// The target did not exist: the prepared folder becomes it as a whole.
    whole: bool,
    /// Parent folders that were made for this report, innermost first; removed again if it fails.
    made: Vec<PathBuf>,
    done: bool,
}

impl Staging {
    /// Makes the folder aside.
    pub fn new(target: &Path) -> io::Result<Self> {
        let whole = match fs::metadata(target) {
            Ok(meta) if meta.is_dir() => false,
            Ok(_) => return Err(io::ErrorKind::NotADirectory.into()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => true,
            Err(error) => return Err(error),
        };
        // Inside an existing target: only there is it certain that the user may write and that a move is not a copy (the target
        // may be a mount). Beside a target that does not exist yet.
        let beside = match target.parent() {
            Some(parent) if whole && parent.as_os_str().is_empty() => Path::new("."),
            Some(parent) if whole => parent,
            _ => target,
        };
        let mut staging = Staging {
            path: beside.join(format!(".touchstone-report-{}", std::process::id())),
            target: target.to_owned(),
            whole,
            made: beside
                .ancestors()
                .take_while(|dir| !dir.as_os_str().is_empty() && !dir.exists())
                .map(Path::to_owned)
                .collect(),
            done: false,
        };
        fs::create_dir_all(beside)?;
        // Two reports of one process into one folder (tests do it) must not share what they prepare.
        for attempt in 0.. {
            match fs::create_dir(&staging.path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 1000 => {
                    staging.path = beside.join(format!(
                        ".touchstone-report-{}-{attempt}",
                        std::process::id()
                    ));
                }
                result => {
                    result?;
                    break;
                }
            }
        }
        Ok(staging)
    }

    /// Moves `files` to the target, then removes the `stale` ones there.
    pub fn publish(mut self, files: &[PathBuf], stale: &[PathBuf]) -> io::Result<()> {
        if self.whole {
            fs::rename(&self.path, &self.target)?;
        } else {
            // What could stop a move half-way is looked at before the first.
            for file in files {
                let goal = self.target.join(file);
                if goal.is_dir() {
                    return Err(io::Error::new(
                        io::ErrorKind::IsADirectory,
                        format!("{} is a folder", file.display()),
                    ));
                }
            }
            for file in files {
                fs::create_dir_all(self.target.join(file).parent().unwrap_or(&self.target))?;
            }
            for file in files {
                fs::rename(self.path.join(file), self.target.join(file))?;
            }
            for file in stale {
                // One that is gone already is what was wanted; a folder that holds other files stays.
                let _ = fs::remove_file(self.target.join(file));
                if let Some(parent) = file.parent().filter(|p| !p.as_os_str().is_empty()) {
                    let _ = fs::remove_dir(self.target.join(parent));
                }
            }
        }
        self.done = true;
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // Nothing more can be done about a failure here, and the error that led here is the one to report.
        let _ = fs::remove_dir_all(&self.path);
        if !self.done {
            for dir in &self.made {
                let _ = fs::remove_dir(dir);
            }
        }
    }
}

/// The error for the user: one line, with the remedy.
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
