//! What an earlier report left in a folder: replaced by the same command, left alone by any other.

use std::path::{Component, Path, PathBuf};

use serde_json::Value;
use touchstone_sim::error::{Error, Result};

/// Results that lie in a folder.
struct Previous {
    command: Option<String>,
    files: Vec<String>,
}

/// Refuses a folder that holds the results of another command than `command`, unless forced. Call it before a long
/// run.
///
/// # Errors
/// [`Error::Io`] that names the folder, the other command and the remedy.
pub fn check(folder: &Path, command: &str, force: bool) -> Result<()> {
    stale(folder, command, force, &[]).map(drop)
}

/// The files of the earlier report that are none of `names`, relative to `folder`.
///
/// # Errors
/// Same as [`check`]; also where one of `names` is there and no report listed it.
pub fn stale(folder: &Path, command: &str, force: bool, names: &[String]) -> Result<Vec<PathBuf>> {
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
                    None => "holds results that do not say which command made them".to_owned(),
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
                format!("holds {name}, which no results list"),
            ));
        }
    }
    Ok(previous
        .map(|p| p.files)
        .unwrap_or_default()
        .into_iter()
        .filter(|file| !names.contains(file))
        .map(PathBuf::from)
        // What a file says must not lead out of its folder.
        .filter(|file| file.components().all(|c| matches!(c, Component::Normal(_))))
        .collect())
}

fn read(folder: &Path) -> Option<Previous> {
    let text = std::fs::read(folder.join("results.json")).ok()?;
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

/// A command without the word that only says how to treat the folder.
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
