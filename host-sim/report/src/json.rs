//! `results.json`: the summary of every run in SI units, and the unit of every number.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};

use super::ReportInput;
use super::columns::COLUMNS;
use super::measures::{MEASURES, SETTINGS};
use super::origin::{Input, Origin, ProgramVersion, RunFiles, SCHEMA_VERSION};
use touchstone_sim::run::record::Summary;

/// Unit of every numeric field of a run; `1` for a number without unit.
pub fn units() -> BTreeMap<&'static str, &'static str> {
    let settings = SETTINGS.iter().map(|(field, unit, _)| (*field, *unit));
    settings
        .chain(MEASURES.iter().map(|m| (m.field, m.unit)))
        .collect()
}

#[derive(Serialize)]
struct Results<'a> {
    schema_version: u32,
    program: ProgramVersion,
    command: &'a str,
    inputs: &'a [Input],
    /// The trace files contain every n-th tick (control period), with this n; absent if no files were written.
    #[serde(skip_serializing_if = "Option::is_none")]
    trace_every: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    files: Option<&'a [String]>,
    units: BTreeMap<&'static str, &'static str>,
    runs: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene_file: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene_sha256: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace_csv: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace_parquet: Option<&'a str>,
}

/// Output of the option `--json`: same as [`written`], without the list of files.
pub fn render(input: &ReportInput) -> String {
    text(input, &Origin::default(), None)
}

/// Text of `results.json`; `files` are all files in the report's folder.
///
/// A field that does not apply is `null`. A number that is not finite is `null` too, because JSON has no such numbers.
pub fn written(input: &ReportInput, origin: &Origin, files: &[String]) -> String {
    text(input, origin, Some(files))
}

fn text(input: &ReportInput, origin: &Origin, files: Option<&[String]>) -> String {
    let none = RunFiles::default();
    let results = Results {
        schema_version: SCHEMA_VERSION,
        program: input.program,
        command: input.command,
        inputs: &origin.inputs,
        trace_every: files.map(|_| input.files.every.max(1)),
        files,
        units: units(),
        runs: input
            .runs
            .iter()
            .enumerate()
            .map(|(index, run)| {
                let files = origin.runs.get(index).unwrap_or(&none);
                Entry {
                    summary: &run.summary,
                    name: run.summary.word(),
                    scene_file: files.scene.as_ref().map(|scene| scene.path.as_str()),
                    scene_sha256: files.scene.as_ref().map(|scene| scene.sha256.as_str()),
                    trace_csv: files.csv.as_deref(),
                    trace_parquet: files.parquet.as_deref(),
                }
            })
            .collect(),
    };
    let mut text = serde_json::to_string_pretty(&results)
        .expect("a summary has only string keys and plain values");
    text.push('\n');
    text
}

/// Metadata of a trace file about its origin (program, command, scene), as keys and values.
pub fn trace_origin(
    input: &ReportInput,
    inputs: &[Input],
    files: &RunFiles,
) -> Vec<(&'static str, String)> {
    let json = |value: Value| value.to_string();
    let mut more = vec![
        ("schema_version", SCHEMA_VERSION.to_string()),
        ("program", json(json!(input.program))),
        ("command", input.command.to_owned()),
        ("inputs", json(json!(inputs))),
        ("trace_every", input.files.every.max(1).to_string()),
    ];
    if let Some(scene) = &files.scene {
        more.push(("scene_toml", scene.text.clone()));
        more.push(("scene_sha256", scene.sha256.clone()));
    }
    more
}

/// Text of the metadata file that accompanies a trace's CSV file.
pub fn sidecar(csv: &str, origin: &[(&'static str, String)]) -> String {
    let columns: Vec<[&str; 4]> = COLUMNS
        .iter()
        .map(|c| [c.name, "number", c.meaning, c.unit])
        .collect();
    tabular(csv, &columns, origin)
}

/// Text of the metadata file that accompanies a CSV file, in the W3C's vocabulary for tabular data. It gives name, type, meaning
/// and unit of each column, and the origin of the data.
pub fn tabular(csv: &str, columns: &[[&str; 4]], origin: &[(&'static str, String)]) -> String {
    let columns: Vec<Value> = columns
        .iter()
        .map(|[name, kind, meaning, unit]| {
            json!({"name": name, "titles": name, "datatype": kind,
                   "dc:description": meaning, "schema:unitText": unit})
        })
        .collect();
    let notes: serde_json::Map<String, Value> = origin
        .iter()
        .map(|(key, value)| {
            // Values that are JSON already are not quoted again.
            let value = match *key {
                "schema_version" | "program" | "inputs" | "trace_every" | "sweep" => {
                    serde_json::from_str(value).unwrap_or_default()
                }
                _ => Value::from(value.as_str()),
            };
            ((*key).to_owned(), value)
        })
        .collect();
    let name = csv.rsplit('/').next().unwrap_or(csv);
    let sidecar = json!({
        "@context": "http://www.w3.org/ns/csvw",
        "url": name,
        "tableSchema": {"columns": columns},
        "notes": [notes],
    });
    let mut text = serde_json::to_string_pretty(&sidecar).expect("string keys only");
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;
    use touchstone_sim::run::record::Run;

    fn made_up() -> Run {
        synthetic::run(LawKind::EnhancedSfa, 2.5, 0.01)
    }

    fn input(runs: &[Run]) -> ReportInput<'_> {
        ReportInput {
            runs,
            ..Default::default()
        }
    }

    fn parse(text: &str) -> Value {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn every_number_has_a_unit_and_every_unit_a_number() {
        let results = parse(&render(&input(&[made_up()])));
        let run = results["runs"][0].as_object().unwrap();
        let units = results["units"].as_object().unwrap();
        for (field, value) in run {
            let has_unit = units.contains_key(field);
            let other = value.is_string() || value.is_array() || field == "not_judged";
            assert!(
                has_unit != other,
                "`{field}` needs a row in the table of measures, sim/src/run/summary.rs"
            );
        }
        for field in units.keys() {
            assert!(run.contains_key(field), "{field}");
        }
    }

    #[test]
    fn names_are_those_of_the_interface() {
        let results = parse(&render(&input(&[made_up()])));
        let run = results["runs"][0].as_object().unwrap();
        let promised = [
            "law",
            "k_desired",
            "grip",
            "encoder_counts_per_rev",
            "verdict",
            "k_displayed",
            "rate_hardness",
            "peak_penetration_ratio",
            "dynamic_stiffness",
            "ripple_rms_n_m",
            "release_speed_rad_per_s",
            "energy_out_worst_window_j",
            "settle_from_ramp_end_s",
            "limit_cycle_peak_to_peak",
            "energy_true_min",
            "energy_observed_min",
            "settle_time",
        ];
        for field in promised {
            assert!(run.contains_key(field), "{field}");
        }
        assert_eq!(run["law"], "enhanced-sfa");
        assert_eq!(run["name"], "enhanced-sfa");
        assert_eq!(run["k_desired"], 2.5);
    }

    #[test]
    fn what_ships_has_a_name_of_its_own_beside_its_law() {
        let mut run = made_up();
        run.summary.shown_as = Some("Shipped");
        let run = &parse(&render(&input(&[run])))["runs"][0];
        assert_eq!(run["name"], "shipped");
        assert_eq!(run["law"], "enhanced-sfa");
    }

    #[test]
    fn absent_and_not_finite_are_null() {
        let mut run = made_up();
        run.summary.settle_time = None;
        run.summary.energy_true_min = f64::NEG_INFINITY;
        let files = RunFiles {
            parquet: Some("traces/a.parquet".to_owned()),
            ..Default::default()
        };
        let origin = Origin {
            runs: vec![files],
            ..Default::default()
        };
        let results = parse(&written(&input(&[run]), &origin, &[]));
        assert!(results["runs"][0]["settle_time"].is_null());
        assert!(results["runs"][0]["energy_true_min"].is_null());
        assert_eq!(results["runs"][0]["trace_parquet"], "traces/a.parquet");
        assert!(results["runs"][0].get("trace_csv").is_none());
        assert_eq!(
            parse(&render(&input(&[])))["runs"],
            Value::Array(Vec::new())
        );
    }
}
