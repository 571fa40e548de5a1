//! Checks for results of an earlier command in a folder. Results of the same command may be replaced, those of another command may
//! not.

use std::path::{Component, Path, PathBuf};

use serde_json::Value;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;

/// Description of the results that a folder holds.
struct Previous {
    command: Option<String>,
    files: Vec<String>,
}

/// Refuses a folder that holds the results of another command than `command`, unless `force` is set. Callers check before a long
/// run.
///
/// # Errors
/// [`Error::Io`] with the folder, the other command and the remedy.
pub fn check(folder: &Path, command: &str, force: bool) -> Result<()> {
    not_listed(folder, command, force, &[]).map(drop)
}

/// Removes what killed processes left in the folder. Returns the files of the earlier results that are not among `names`, relative
/// to `folder`; they are out of date.
///
/// # Errors
/// The errors of [`check`]; also if a file of `names` exists that no earlier report lists.
pub fn stale(folder: &Path, command: &str, force: bool, names: &[String]) -> Result<Vec<PathBuf>> {
    super::staging::sweep(folder);
    not_listed(folder, command, force, names)
}

fn not_listed(folder: &Path, command: &str, force: bool, names: &[String]) -> Result<Vec<PathBuf>> {
    let previous = read(folder);
    if !force {
        if let Some(previous) = &previous {
            let same = previous
                .command
                .as_deref()
                .is_some_and(|other| plain(other) == plain(command));
            if !same {
                let problem = match &previous.command {
                    Some(other) => format!("holds the results of `{}`", cut(other)),
                    None => {
                        "contains results that do not name the command that made them".to_owned()
                    }
                };
                return Err(refused(folder, problem));
            }
        }
        let listed = previous.as_ref().map_or(&[][..], |p| &p.files[..]);
        let foreign = names
            .iter()
            .find(|name| !listed.contains(name) && folder.join(name).is_file());
        if let Some(name) = foreign {
            return Err(refused(
                folder,
                format!("contains {name}, which is not in the list of its results"),
            ));
        }
    }
    Ok(previous
        .map(|p| p.files)
        .unwrap_or_default()
        .into_iter()
        .filter(|file| !names.contains(file))
        .map(PathBuf::from)
        // File names in an old `results.json` must not lead out of its folder.
        .filter(|file| file.components().all(|c| matches!(c, Component::Normal(_))))
        .collect())
}

fn read(folder: &Path) -> Option<Previous> {
    let text = input::bytes(&folder.join("results.json"), input::MOST_OF_RESULTS).ok()?;
    let value: Value = serde_json::from_slice(&text).unwrap_or_default();
    let files = value["files"].as_array().map_or(&[][..], Vec::as_slice);
    Some(Previous {
        command: value["command"].as_str().map(str::to_owned),
        files: files
            .iter()
            .filter_map(|file| file.as_str().map(str::to_owned))
            .collect(),
    })
}

/// The words of a command line, without the option that says whether files may be replaced.
fn plain(command: &str) -> Vec<&str> {
    let words = command.split_whitespace();
    words.filter(|word| *word != "--force").collect()
}

fn cut(command: &str) -> String {
    let mut text: String = command.chars().take(80).collect();
    if text.len() < command.len() {
        text.push('…');
    }
    text
}

fn refused(folder: &Path, problem: String) -> Error {
    Error::Io {
        path: folder.to_owned(),
        problem,
        fix: "give --out another folder, or --force to replace them".to_owned(),
    }
}
