//! Writes a report's folder: everything is prepared aside and moved into place at the end, so that nothing is half-written.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::staging::Staging;
use super::{ReportInput, TraceFiles, csv, html, json, label, parquet};
use touchstone_sim::error::{Error, Result};

/// What was written.
#[derive(Debug, Clone)]
pub struct Written {
    /// The page, as a path the user can open.
    pub page: PathBuf,
    /// All files, relative to the folder.
    pub files: Vec<PathBuf>,
    /// Their bytes.
    pub bytes: u64,
}

/// Writes `index.html`, `results.json` and `traces/*.csv`, `traces/*.parquet` for every run with a trace into `folder`.
///
/// A folder that does not exist is made and appears complete or not at all. In one that exists, files of the same names are
/// replaced, each in one step and `index.html` last; every other file there is left alone.
///
/// # Errors
/// [`Error::Io`], on one line and with the fix, if `folder` is a file or cannot be written; then no file in it has changed.
pub fn write(input: &ReportInput, folder: &Path) -> Result<Written> {
    let names = trace_files(input);
    let staging = Staging::new(folder).map_err(|error| io_error(folder, &error))?;
    let root = &staging.path.clone();
    let prepare = || -> io::Result<Vec<PathBuf>> {
        let mut files = write_traces(root, input, &names)?;
        for (name, text) in [
            ("results.json", json::render(input.runs, &names)),
            ("index.html", html::render(input, &names)),
        ] {
            fs::write(root.join(name), text)?;
            files.push(PathBuf::from(name));
        }
        Ok(files)
    };
    let moved = prepare().and_then(|files| {
        let bytes = files
            .iter()
            .map(|file| fs::metadata(root.join(file)).map(|meta| meta.len()))
            .sum::<io::Result<u64>>()?;
        staging.publish(&files)?;
        Ok((files, bytes))
    });
    let (files, bytes) = moved.map_err(|error| io_error(folder, &error))?;
    Ok(Written {
        page: folder.join("index.html"),
        files,
        bytes,
    })
}

/// Names of the trace files, one pair for each run with a trace, no two alike.
fn trace_files(input: &ReportInput) -> Vec<Option<TraceFiles>> {
    let mut taken = HashSet::new();
    let name = |run: &touchstone_sim::run::record::Run| {
        run.trace.as_ref()?;
        let stem = label::file_stem(&run.summary);
        // Compared without case: some file systems do.
        let mut unique = stem.clone();
        let mut repeat = 2;
        while !taken.insert(unique.to_lowercase()) {
            unique = format!("{stem}_{repeat}");
            repeat += 1;
        }
        Some(TraceFiles {
            csv: format!("traces/{unique}.csv"),
            parquet: format!("traces/{unique}.parquet"),
        })
    };
    input.runs.iter().map(name).collect()
}

fn write_traces(
    root: &Path,
    input: &ReportInput,
    names: &[Option<TraceFiles>],
) -> io::Result<Vec<PathBuf>> {
    let jobs: Vec<_> = input
        .runs
        .iter()
        .zip(names)
        .filter_map(|(run, names)| Some((run, run.trace.as_ref()?, names.as_ref()?)))
        .collect();
    if jobs.is_empty() {
        return Ok(Vec::new());
    }
    fs::create_dir(root.join("traces"))?;
    jobs.par_iter()
        .try_for_each(|(run, trace, names)| -> io::Result<()> {
            let mut file = BufWriter::new(File::create(root.join(&names.csv))?);
            csv::write(&mut file, trace)?;
            file.flush()?;
            let mut file = BufWriter::new(File::create(root.join(&names.parquet))?);
            parquet::write(&mut file, run, trace)?;
            file.flush()
        })?;
    Ok(jobs
        .iter()
        .flat_map(|(_, _, names)| [PathBuf::from(&names.csv), PathBuf::from(&names.parquet)])
        .collect())
}

fn io_error(folder: &Path, error: &io::Error) -> Error {
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
    use crate::report::synthetic;
    use touchstone_control::LawKind;
    use touchstone_sim::run::record::Run;

    /// A folder for one test, removed afterwards.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir()
                .join(format!("touchstone-write-{}-{name}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir(&path).unwrap();
            Scratch(path)
        }

        /// Everything below, sorted.
        fn list(&self) -> Vec<String> {
            fn walk(dir: &Path, root: &Path, out: &mut Vec<String>) {
                for entry in fs::read_dir(dir).unwrap() {
                    let path = entry.unwrap().path();
                    out.push(path.strip_prefix(root).unwrap().display().to_string());
                    if path.is_dir() {
                        walk(&path, root, out);
                    }
                }
            }
            let mut out = Vec::new();
            walk(&self.0, &self.0, &mut out);
            out.sort();
            out
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn runs() -> Vec<Run> {
        let mut runs: Vec<Run> = [LawKind::Spring, LawKind::Spring]
            .map(|law| synthetic::run(law, 1.0, 0.05))
            .into();
        runs.push(Run {
            trace: None,
            ..runs[0].clone()
        });
        runs
    }

    const FILES: [&str; 7] = [
        "index.html",
        "results.json",
        "traces",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64.csv",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64.parquet",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64_2.csv",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64_2.parquet",
    ];

    fn input(runs: &[Run]) -> ReportInput<'_> {
        ReportInput {
            title: "t",
            command: "touchstone",
            runs,
            ..Default::default()
        }
    }

    #[test]
    fn a_new_folder_with_its_parents() {
        let scratch = Scratch::new("new");
        let runs = runs();
        let written = write(&input(&runs), &scratch.0.join("a/b")).unwrap();
        let mut expected = vec!["a".to_owned(), "a/b".to_owned()];
        expected.extend(FILES.map(|file| format!("a/b/{file}")));
        assert_eq!(scratch.list(), expected);
        assert_eq!(written.files.len(), 6);
        assert!(written.bytes > 10_000);
        // What results.json and the page name exists.
        let json: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(scratch.0.join("a/b/results.json")).unwrap())
                .unwrap();
        assert!(
            scratch
                .0
                .join("a/b")
                .join(json["runs"][1]["trace_csv"].as_str().unwrap())
                .is_file()
        );
        assert!(json["runs"][2].get("trace_csv").is_none());
    }

    #[test]
    fn foreign_files_stay_and_own_files_are_replaced() {
        let scratch = Scratch::new("foreign");
        fs::create_dir(scratch.0.join("traces")).unwrap();
        fs::write(scratch.0.join("traces/mine.csv"), "keep").unwrap();
        fs::write(scratch.0.join("notes.txt"), "keep").unwrap();
        fs::write(scratch.0.join("index.html"), "old").unwrap();
        let runs = runs();
        for _ in 0..2 {
            write(&input(&runs), &scratch.0).unwrap();
        }
        let mut expected: Vec<String> = FILES.map(str::to_owned).into();
        expected.extend(["notes.txt".to_owned(), "traces/mine.csv".to_owned()]);
        expected.sort();
        assert_eq!(scratch.list(), expected);
        assert_eq!(
            fs::read_to_string(scratch.0.join("notes.txt")).unwrap(),
            "keep"
        );
        assert_ne!(
            fs::read_to_string(scratch.0.join("index.html")).unwrap(),
            "old"
        );
    }

    #[test]
    fn what_cannot_be_written_is_one_line_and_leaves_nothing() {
        let scratch = Scratch::new("bad");
        fs::write(scratch.0.join("file"), "x").unwrap();
        fs::create_dir_all(scratch.0.join("taken/index.html")).unwrap();
        let before = scratch.list();
        let runs = runs();
        for bad in ["file", "file/below", "taken"] {
            let error = write(&input(&runs), &scratch.0.join(bad)).unwrap_err();
            let text = error.to_string();
            assert!(
                text.contains(bad) && text.contains("; ") && text.contains("--out"),
                "{text}"
            );
            assert!(!text.contains('\n'), "{text}");
            assert_eq!(scratch.list(), before, "{bad}");
        }
    }
}
