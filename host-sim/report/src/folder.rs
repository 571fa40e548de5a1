//! Writes a folder of results that are not runs of scenes, and never over files of another command.

use std::fs;
use std::path::{Path, PathBuf};

use super::previous;
use super::staging::{Staging, io_error};
use touchstone_sim::error::Result;

/// Writes files into a folder. One of them is `results.json`, which names `command` and lists all files.
///
/// # Errors
/// [`touchstone_sim::error::Error::Io`], one line with the remedy: the folder holds the results of another command or cannot be
/// written. Then no new file is left in the folder. Only if moving the files failed half-way, some older ones are already
/// replaced.
pub fn publish(
    folder: &Path,
    command: &str,
    force: bool,
    files: &[(String, impl AsRef<[u8]>)],
) -> Result<Vec<PathBuf>> {
    let names: Vec<String> = files.iter().map(|(name, _)| name.clone()).collect();
    let stale = previous::stale(folder, command, force, &names)?;
    let staging = Staging::new(folder).map_err(|error| io_error(folder, &error))?;
    let paths: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
    files
        .iter()
        .try_for_each(|(name, content)| fs::write(staging.path.join(name), content))
        .and_then(|()| staging.publish(&paths, &stale))
        .map_err(|error| io_error(folder, &error))?;
    Ok(paths)
}
