//! Finds floats in the crates that decide: in their source, and in the compiled code, where panics are found too.

mod assembly;
mod source;

use std::path::{Path, PathBuf};

use crate::answer::Answer;

/// How many findings are printed before the rest is only counted.
const SHOWN: usize = 20;

/// Looks for floating point in the source below a folder.
pub fn in_source(folder: &Path) -> Result<Answer, String> {
    let scan = source::floats_below(folder)?;
    Ok(if scan.findings.is_empty() {
        Answer::Right(format!("source: {} files", scan.files))
    } else {
        failed("source", "floats", &scan.findings)
    })
}

fn failed(place: &str, what: &str, findings: &[String]) -> Answer {
    for finding in findings.iter().take(SHOWN) {
        println!("{finding}");
    }
    if findings.len() > SHOWN {
        println!("… and {} more", findings.len() - SHOWN);
    }
    Answer::Wrong(format!("{what} in the {place}: {}", findings.len()))
}

/// Follows every function of crate and example through all that it calls.
///
/// `release` is where a build left the assembly; `krate` is how the names of the crate's files begin.
pub fn in_code(name: &str, release: &Path, krate: &str, wanted: &str) -> Result<Answer, String> {
    let Some(is_float) = assembly::float_operation(name) else {
        let reason = format!("no list of float instructions of {name}");
        return Ok(Answer::NotRun(reason));
    };
    let files = [release.join("deps"), release.join("examples")];
    let files: Vec<PathBuf> = files.iter().flat_map(|folder| newest(folder)).collect();
    let mut code = assembly::Code::default();
    let (mut all, mut example) = (Vec::new(), Vec::new());
    for file in &files {
        let text = std::fs::read_to_string(file)
            .map_err(|_| format!("{}: cannot be read", file.display()))?;
        let labels = code.add(&text);
        let stem = file.file_name().unwrap_or_default().to_string_lossy();
        let is_example = stem.starts_with(&format!("{wanted}-"));
        if is_example {
            example.extend(labels.iter().cloned());
        }
        if is_example || stem.starts_with(krate) {
            all.extend(labels);
        }
    }
    let floats = code.scan(&all, is_float);
    // Texts for people may panic by their types, though never in fact; set-up and tick are not to have it in them at all.
    let panics = code.scan(&example, assembly::is_panic);
    if panics.instructions == 0 {
        return Err(format!("no code of {name} in {}", release.display()));
    }
    let place = format!("code for {name}");
    Ok(match (&floats.findings[..], &panics.findings[..]) {
        ([], []) => Answer::Right(format!(
            "{name}: {} functions, {} instructions",
            floats.functions, floats.instructions
        )),
        (floats @ [_, ..], _) => failed(&place, "floats", floats),
        ([], panics) => failed(&place, "panics", panics),
    })
}

/// The newest assembly of each crate in a folder: an older one is of an older source.
fn newest(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found: Vec<_> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "s"))
        .filter_map(|path| {
            let written = path.metadata().ok()?.modified().ok()?;
            let stem = path.file_stem()?.to_string_lossy().into_owned();
            let krate = stem.rsplit_once('-')?.0.to_owned();
            Some((krate, std::cmp::Reverse(written), path))
        })
        .collect();
    found.sort();
    found.dedup_by(|later, first| later.0 == first.0);
    found.into_iter().map(|(_, _, path)| path).collect()
}
