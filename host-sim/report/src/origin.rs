//! Records the origin of a report, so that it can be repeated: program, command, scenes with every value, and input files with
//! their hashes.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::{PARQUET, ReportInput, label};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{MotionSpec, Scene};

/// Version of the format of `results.json` and of the traces' metadata. It is raised when a reader of the previous format could be
/// misled.
pub const SCHEMA_VERSION: u32 = 1;

/// Version of the program that made the results.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ProgramVersion {
    /// Name of the program.
    pub name: &'static str,
    /// Version number of the program.
    pub version: &'static str,
    /// Commit that the program was built from; `None` if it was not built from a git checkout.
    pub commit: Option<&'static str>,
    /// Whether files of the checkout differed from that commit when the program was built.
    pub modified: bool,
}

impl Default for ProgramVersion {
    fn default() -> Self {
        ProgramVersion {
            name: "touchstone",
            version: env!("CARGO_PKG_VERSION"),
            commit: None,
            modified: false,
        }
    }
}

/// An input file that a report was made from.
#[derive(Debug, Clone, Serialize)]
pub struct Input {
    /// The path as the user gave it.
    pub path: PathBuf,
    /// SHA-256 hash of the file's bytes, hexadecimal.
    pub sha256: String,
    /// Length of the file, bytes.
    pub bytes: usize,
    /// Path of the file's copy, relative to the report's folder. A scene has no copy, because it is written out with every value.
    pub copy: Option<String>,
    /// The file's bytes; empty if no copy is written.
    #[serde(skip)]
    pub content: Vec<u8>,
}

/// The files that belong to one run, relative to the report's folder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunFiles {
    /// Name of the run, unique among the runs of the report and of other scenes.
    pub name: String,
    /// The scene file with every value; absent if no scenes are written.
    pub scene: Option<SceneFile>,
    /// Path of the trace as CSV.
    pub csv: Option<String>,
    /// Path of the trace as Parquet.
    pub parquet: Option<String>,
}

/// A scene file that was written out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneFile {
    /// Path of the scene file, relative to the report's folder.
    pub path: String,
    /// Text of the scene file.
    pub text: String,
    /// SHA-256 hash of the scene's text, hexadecimal.
    pub sha256: String,
}

/// Everything that a report records about its origin.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    /// Input files that were read.
    pub inputs: Vec<Input>,
    /// Names and files of each run, in the order of the report.
    pub runs: Vec<RunFiles>,
}

/// SHA-256 hash of `bytes`, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    use std::fmt::Write;
    Sha256::digest(bytes)
        .iter()
        .fold(String::with_capacity(64), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
}

impl Origin {
    /// Reads and hashes the input files, names every run, and writes out the text of its scene.
    ///
    /// # Errors
    /// [`Error::Io`]: an input file can no longer be read.
    pub fn of(input: &ReportInput) -> Result<Origin> {
        let mut inputs = Vec::new();
        for path in input.inputs {
            inputs.push(read(path, None)?);
        }
        // Recordings are copied into the folder, because a scene that names a file elsewhere could not be run again.
        let mut copies: HashMap<PathBuf, String> = HashMap::new();
        for scene in input.scenes {
            if let MotionSpec::Recorded(spec) = &scene.operator.motion
                && !copies.contains_key(&spec.file)
            {
                let name = spec.file.file_name().unwrap_or_default();
                let mut copy = format!("inputs/{}", name.to_string_lossy());
                if copies.values().any(|taken| *taken == copy) {
                    copy = format!("inputs/{}-{}", copies.len(), name.to_string_lossy());
                }
                inputs.push(read(&spec.file, Some(copy.clone()))?);
                copies.insert(spec.file.clone(), copy);
            }
        }
        let alone = |texts: &[String]| texts.windows(2).all(|pair| pair[0] == pair[1]);
        let texts = written_out(input.scenes, &copies, "");
        let one = alone(&texts);
        let texts = if one {
            texts
        } else {
            written_out(input.scenes, &copies, "../")
        };
        let stems = stems(input);
        let mut taken = HashSet::new();
        let mut scenes: HashMap<&str, String> = HashMap::new();
        let name = |(index, run): (usize, &touchstone_sim::run::record::Run)| {
            let text = texts.get(index);
            let sha256 = text.map(|text| self::sha256(text.as_bytes()));
            // The name ends in the first digits of the scene's hash, so that traces of different scenes have different names.
            let stem = match &sha256 {
                Some(sha256) => format!("{}_{}", stems[index], &sha256[..8]),
                None => stems[index].clone(),
            };
            let mut name = stem.clone();
            // Names are compared without case, because some file systems do so.
            for repeat in 2.. {
                if taken.insert(name.to_lowercase()) {
                    break;
                }
                name = format!("{stem}_{repeat}");
            }
            let scene = text.zip(sha256).map(|(text, sha256)| {
                let path = scenes.entry(text).or_insert_with(|| {
                    if one {
                        "scene.toml".to_owned()
                    } else {
                        format!("scenes/{name}.toml")
                    }
                });
                SceneFile {
                    path: path.clone(),
                    text: text.clone(),
                    sha256,
                }
            });
            let trace = run.trace.is_some();
            let csv = trace && !input.files.no_csv;
            RunFiles {
                scene,
                csv: csv.then(|| format!("traces/{name}.csv")),
                parquet: (trace && PARQUET).then(|| format!("traces/{name}.parquet")),
                name,
            }
        };
        let runs = input.runs.iter().enumerate().map(name).collect();
        Ok(Origin { inputs, runs })
    }
}

fn read(path: &Path, copy: Option<String>) -> Result<Input> {
    let content = touchstone_sim::input::bytes(path, touchstone_sim::input::MOST_OF_RECORDING)
        .map_err(|error| Error::Io {
            path: path.to_owned(),
            problem: error.to_string(),
            fix: "do not move the file before the report is written".to_owned(),
        })?;
    Ok(Input {
        path: path.to_owned(),
        sha256: sha256(&content),
        bytes: content.len(),
        content: if copy.is_some() { content } else { Vec::new() },
        copy,
    })
}

/// Texts of the scene files that are written out; `up` is the path from a scene's folder to the report's folder.
fn written_out(scenes: &[Scene], copies: &HashMap<PathBuf, String>, up: &str) -> Vec<String> {
    let text = |scene: &Scene| {
        let mut scene = scene.clone();
        if let MotionSpec::Recorded(spec) = &mut scene.operator.motion
            && let Some(copy) = copies.get(&spec.file)
        {
            spec.file = PathBuf::from(format!("{up}{copy}"));
        }
        scene.to_toml()
    };
    scenes.iter().map(text).collect()
}

/// Longest name of a trace file without its extension, bytes; file systems accept 255.
const STEM_MAX: usize = 160;

/// Makes the names of the runs from their conditions. If several runs share a name, the values in which their scenes differ are
/// added. If the name would then be too long for a file, a number is added instead.
fn stems(input: &ReportInput) -> Vec<String> {
    let mut stems: Vec<String> = input
        .runs
        .iter()
        .map(|run| label::file_stem(&run.summary))
        .collect();
    if input.scenes.len() != stems.len() {
        return stems;
    }
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, stem) in stems.iter().enumerate() {
        groups.entry(stem.clone()).or_default().push(index);
    }
    for members in groups.values().filter(|members| members.len() > 1) {
        let leaves: Vec<BTreeMap<String, String>> = members
            .iter()
            .map(|&index| {
                let mut leaves = BTreeMap::new();
                let value = serde_json::to_value(&input.scenes[index]).unwrap_or_default();
                flatten(&value, "", &mut leaves);
                leaves
            })
            .collect();
        let paths: HashSet<&String> = leaves.iter().flat_map(BTreeMap::keys).collect();
        let mut differing: Vec<&String> = paths
            .into_iter()
            .filter(|path| leaves.iter().any(|l| l.get(*path) != leaves[0].get(*path)))
            .filter(|path| *path != "description")
            .collect();
        differing.sort();
        for (place, (&index, leaves)) in members.iter().zip(&leaves).enumerate() {
            let difference: String = differing
                .iter()
                .map(|path| {
                    let name = path.rsplit('.').next().unwrap_or(path);
                    let value = leaves.get(*path).map_or("none", String::as_str);
                    format!("_{}", label::safe(&format!("{name}-{value}")))
                })
                .collect();
            if stems[index].len() + difference.len() <= STEM_MAX {
                stems[index] += &difference;
            } else {
                stems[index] += &format!("_{}", place + 1);
            }
        }
    }
    stems
}

/// Collects the values of a scene by their dotted keys.
fn flatten(value: &Value, path: &str, leaves: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(map) => {
            for (name, value) in map {
                let dot = if path.is_empty() { "" } else { "." };
                flatten(value, &format!("{path}{dot}{name}"), leaves);
            }
        }
        Value::String(text) => {
            leaves.insert(path.to_owned(), text.clone());
        }
        value => {
            leaves.insert(path.to_owned(), value.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;
    use touchstone_sim::run::record::Run;

    #[test]
    fn the_hash_is_that_of_the_standard() {
        // FIPS 180-2, appendix B.1.
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), abc);
    }

    #[test]
    fn runs_that_differ_in_many_fields_are_numbered() {
        let base = Scene::load("tap").unwrap();
        let other = Scene::load("thesis-knob").unwrap();
        let runs: Vec<Run> = [0, 1]
            .map(|_| synthetic::run(LawKind::Spring, 1.0, 0.01))
            .into();
        let other = Scene {
            name: base.name.clone(),
            ..other
        };
        let scenes = [base, other];
        let input = ReportInput {
            runs: &runs,
            scenes: &scenes,
            ..Default::default()
        };
        let names = stems(&input);
        assert!(
            names.iter().all(|name| name.len() <= STEM_MAX + 4),
            "{names:?}"
        );
        assert_ne!(names[0], names[1]);
    }

    #[test]
    fn runs_that_differ_in_one_field_have_names_that_say_so() {
        let base = Scene::load("tap").unwrap();
        let heavy = base.with_overrides(&["device.inertia_kg_m2=3e-4"]).unwrap();
        let runs: Vec<Run> = [0, 1, 2]
            .map(|_| synthetic::run(LawKind::Spring, 1.0, 0.01))
            .into();
        let scenes = [base.clone(), heavy, base];
        let input = ReportInput {
            runs: &runs,
            scenes: &scenes,
            ..Default::default()
        };
        let origin = Origin::of(&input).unwrap();
        let [a, b, c] = &origin.runs[..] else {
            panic!("three runs");
        };
        assert!(b.name.contains("inertia_kg_m2-0.0003"), "{}", b.name);
        assert!(!a.name.contains("0.0003") && c.name == format!("{}_2", a.name));
        let path = |run: &RunFiles| run.scene.as_ref().unwrap().path.clone();
        assert_eq!(path(a), path(c));
        assert_ne!(path(a), path(b));
        assert_eq!(path(a), format!("scenes/{}.toml", a.name));

        let single = ReportInput {
            runs: &runs[..1],
            scenes: &scenes[..1],
            ..Default::default()
        };
        let origin = Origin::of(&single).unwrap();
        assert_eq!(path(&origin.runs[0]), "scene.toml");
    }
}
