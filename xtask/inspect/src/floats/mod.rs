//! Searches the crates with control law, guard and motor drive for floating point, in the source and in the compiled code. In the
//! compiled code it also searches for panics.

mod assembly;
mod source;

use std::path::{Path, PathBuf};

use crate::answer::Answer;

/// Number of findings that are printed; of further findings only the number is printed.
const SHOWN: usize = 20;

/// Searches the source files below a folder for floating point.
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

/// Searches the compiled code of a crate and of its example, with all functions that these call, for float operations. Searches the
/// example's code for panics too.
///
/// `name` is the architecture, `release` the folder with the assembly files, `krate` the beginning of the names of the crate's
/// files, and `wanted` the name of the example.
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
    // The crate's text formatting may contain panics that never occur. The example, which sets up and runs control periods, must
    // contain none.
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

/// The newest assembly file of each crate in a folder; older files belong to older sources.
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
