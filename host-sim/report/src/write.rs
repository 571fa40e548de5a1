//! Writes a report's folder, from which every run in it can be repeated.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::origin::Origin;
#[cfg(feature = "parquet")]
use super::parquet;
use super::staging::{Staging, io_error};
use super::{ReportInput, csv, html, json, picture, previous};
use touchstone_sim::error::Result;

/// The files that were written for a report.
#[derive(Debug, Clone)]
pub struct Written {
    /// Path of the report's page `index.html`.
    pub page: PathBuf,
    /// Paths of all written files, relative to the report's folder.
    pub files: Vec<PathBuf>,
    /// Total size of the written files, bytes.
    pub bytes: u64,
}

/// Writes a report into `folder`. Its files are:
///
/// - `index.html`, `summary.svg` and `results.json`
/// - the scene of every run, with all its values: `scene.toml`, or `scenes/*.toml` if there are several
/// - recordings that move the hand, as `inputs/*`
/// - for every run with a trace: `traces/*.parquet`, and `traces/*.csv` with its metadata in `*.csv-metadata.json`
///
/// A folder that does not exist is created; it appears with all files or not at all. In a folder with results of the same command,
/// each file is replaced in one step, and files that only the earlier results listed are removed. Other files are never changed,
/// unless [`super::FileOptions::force`] allows it.
///
/// # Errors
/// [`touchstone_sim::error::Error::Io`], one line with the remedy: `folder` is a file, holds the results of another command or
/// cannot be written, or an input can no longer be read. After an error the folder has no file under a name that it did not have
/// before. If moving the files failed half-way, some older files may already have their new content.
pub fn write(input: &ReportInput, folder: &Path) -> Result<Written> {
    let origin = Origin::of(input)?;
    let names = names(input, &origin);
    let stale = previous::stale(folder, input.command, input.files.force, &names)?;
    let files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
    let staging = Staging::new(folder).map_err(|error| io_error(folder, &error))?;
    let root = &staging.path.clone();
    let prepare = || -> io::Result<u64> {
        for dir in files.iter().filter_map(|file| file.parent()) {
            fs::create_dir_all(root.join(dir))?;
        }
        write_traces(root, input, &origin)?;
        for scene in origin.runs.iter().filter_map(|run| run.scene.as_ref()) {
            fs::write(root.join(&scene.path), &scene.text)?;
        }
        for read in &origin.inputs {
            if let Some(copy) = &read.copy {
                fs::write(root.join(copy), &read.content)?;
            }
        }
        if let Some(picture) = picture::alone(input) {
            fs::write(root.join(PICTURE), picture)?;
        }
        fs::write(root.join(RESULTS), json::written(input, &origin, &names))?;
        fs::write(root.join(PAGE), html::render(input, &origin))?;
        files
            .iter()
            .map(|file| fs::metadata(root.join(file)).map(|meta| meta.len()))
            .sum()
    };
    let bytes = prepare()
        .and_then(|bytes| staging.publish(&files, &stale).map(|()| bytes))
        .map_err(|error| io_error(folder, &error))?;
    Ok(Written {
        page: folder.join(PAGE),
        files,
        bytes,
    })
}

const PICTURE: &str = "summary.svg";
const RESULTS: &str = "results.json";
const PAGE: &str = "index.html";

/// Name of the metadata file of a CSV file.
fn sidecar(csv: &str) -> String {
    format!("{csv}-metadata.json")
}

/// Names of all files of the report. The page comes last, because it refers to the others.
fn names(input: &ReportInput, origin: &Origin) -> Vec<String> {
    let mut names = Vec::new();
    for run in &origin.runs {
        if let Some(csv) = &run.csv {
            names.extend([csv.clone(), sidecar(csv)]);
        }
        names.extend(run.parquet.clone());
    }
    for scene in origin.runs.iter().filter_map(|run| run.scene.as_ref()) {
        if !names.contains(&scene.path) {
            names.push(scene.path.clone());
        }
    }
    names.extend(origin.inputs.iter().filter_map(|read| read.copy.clone()));
    if picture::has(input) {
        names.push(PICTURE.to_owned());
    }
    names.extend([RESULTS, PAGE].map(str::to_owned));
    names
}

fn write_traces(root: &Path, input: &ReportInput, origin: &Origin) -> io::Result<()> {
    let every = input.files.every.max(1);
    input
        .runs
        .par_iter()
        .zip(&origin.runs)
        .try_for_each(|(run, files)| -> io::Result<()> {
            let Some(trace) = &run.trace else {
                return Ok(());
            };
            let from = json::trace_origin(input, &origin.inputs, files);
            if let Some(name) = &files.csv {
                let mut file = BufWriter::new(File::create(root.join(name))?);
                csv::write(&mut file, trace, every)?;
                file.flush()?;
                fs::write(root.join(sidecar(name)), json::sidecar(name, &from))?;
            }
            #[cfg(feature = "parquet")]
            if let Some(name) = &files.parquet {
                let mut file = BufWriter::new(File::create(root.join(name))?);
                parquet::write(&mut file, run, trace, every, &from)?;
                file.flush()?;
            }
            Ok(())
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;
    use touchstone_sim::run::record::Run;

    /// A temporary folder for one test; it is removed afterwards.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir()
                .join(format!("touchstone-write-{}-{name}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir(&path).unwrap();
            Scratch(path)
        }

        /// Paths of all files below the folder, sorted.
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

    const FILES: [&str; 10] = [
        "index.html",
        "results.json",
        "summary.svg",
        "traces",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64.csv",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64.csv-metadata.json",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64.parquet",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64_2.csv",
        "traces/synthetic_spring_k1_medium_16384cpr_1000hz_f64_2.csv-metadata.json",
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
        assert_eq!(written.files.len(), 9);
        assert!(written.bytes > 10_000);
        // The trace that results.json names exists.
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
        // A page that no `results.json` lists is not replaced.
        let error = write(&input(&runs), &scratch.0).unwrap_err().to_string();
        assert!(
            error.contains("index.html") && error.contains("--force"),
            "{error}"
        );
        let mut forced = input(&runs);
        forced.files.force = true;
        write(&forced, &scratch.0).unwrap();
        write(&input(&runs), &scratch.0).unwrap();
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

    #[test]
    fn results_of_another_command_stay_and_stale_files_of_the_same_go() {
        let scratch = Scratch::new("again");
        let runs = runs();
        write(&input(&runs), &scratch.0).unwrap();
        fs::write(scratch.0.join("traces/mine.csv"), "keep").unwrap();
        let before = scratch.list();
        let other = ReportInput {
            command: "touchstone run tap",
            ..input(&runs)
        };
        let error = write(&other, &scratch.0).unwrap_err().to_string();
        assert!(
            error.contains("`touchstone`") && error.contains("--force"),
            "{error}"
        );
        assert_eq!(scratch.list(), before);
        // The same command with one run less: the three files of that run are removed, and the picture of two runs. Files of others
        // stay.
        write(&input(&runs[1..]), &scratch.0).unwrap();
        let now = scratch.list();
        assert_eq!(now.len(), before.len() - 4);
        assert!(now.contains(&"traces/mine.csv".to_owned()));
        assert!(!now.iter().any(|file| file.contains("f64_2")));
        // With `force`, the other command replaces the files.
        let mut forced = other;
        forced.files.force = true;
        forced.files.no_csv = true;
        write(&forced, &scratch.0).unwrap();
        let now = scratch.list();
        assert!(now.contains(&"traces/mine.csv".to_owned()));
        assert!(!now.iter().any(|file| file.contains("f64.csv")), "{now:?}");
        // A results.json that names files elsewhere cannot make us remove them.
        fs::create_dir(scratch.0.join("r")).unwrap();
        let evil = r#"{"command":"touchstone","files":["../notes.txt","/x"]}"#;
        fs::write(scratch.0.join("r/results.json"), evil).unwrap();
        fs::write(scratch.0.join("notes.txt"), "keep").unwrap();
        let mut forced = input(&runs);
        forced.files.force = true;
        write(&forced, &scratch.0.join("r")).unwrap();
        assert!(scratch.0.join("notes.txt").is_file());
    }
}
