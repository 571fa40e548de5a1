//! Makes the JSON schema of `results.json` from the same lists as the results; it is stored in `docs/schema/results.schema.json`.

use serde_json::{Map, Value, json};

use super::label;
use super::measures::{MEASURES, SETTINGS};
use super::origin::SCHEMA_VERSION;
use touchstone_control::{Choice as _, LawKind};
use touchstone_sim::run::record::Verdict;

/// All verdicts that a run may have.
const VERDICTS: &[Verdict] = &[
    Verdict::Passive,
    Verdict::Active,
    Verdict::LimitCycle,
    Verdict::Unstable,
    Verdict::NotJudged,
    Verdict::NoContact,
];

/// Text of the JSON schema of `results.json`.
pub fn results() -> String {
    let mut text = serde_json::to_string_pretty(&schema()).expect("string keys only");
    text.push('\n');
    text
}

fn schema() -> Value {
    let hash = json!({"type": "string", "pattern": "^[0-9a-f]{64}$"});
    let mut run = Map::new();
    let words = |meaning: &str| json!({"type": "string", "description": meaning});
    run.insert("scene".into(), words("name of the scene"));
    run.insert("number".into(), words("number format of the law"));
    run.insert("grip".into(), words("how the hand holds the device"));
    run.insert(
        "name".into(),
        words("name of the run: its law's word, or \"shipped\" for the wall that ships"),
    );
    let laws: Vec<&str> = LawKind::WORDS.to_vec();
    run.insert("law".into(), json!({"enum": laws}));
    let verdicts: Vec<Value> = VERDICTS
        .iter()
        .map(|&verdict| {
            let words = label::verdict_words(verdict);
            json!({"const": words.key, "description": words.meaning})
        })
        .collect();
    run.insert("verdict".into(), json!({"oneOf": verdicts}));
    run.insert(
        "not_judged".into(),
        json!({"type": ["string", "null"], "description": "why the verdict is not-judged; null where it is another"}),
    );
    let measures = MEASURES.iter().map(|m| (m.field, m.unit, m.meaning));
    let mut units = Map::new();
    for (field, unit, meaning) in SETTINGS.iter().copied().chain(measures) {
        // A value that is not finite or does not apply is null.
        run.insert(
            field.into(),
            json!({"type": ["number", "null"], "description": format!("{meaning}; {unit}")}),
        );
        units.insert(field.into(), json!({"const": unit}));
    }
    run.insert(
        "dynamic_stiffness".into(),
        json!({
            "type": "array",
            "description": "force over penetration of a hand that moves: modulus, and phase of the force before the penetration",
            "items": {
                "type": "object",
                "required": ["frequency_hz", "modulus_n_m_per_rad", "phase_deg"],
                "additionalProperties": false,
                "properties": {
                    "frequency_hz": {"type": "number"},
                    "modulus_n_m_per_rad": {"type": "number"},
                    "phase_deg": {"type": "number"},
                },
            },
        }),
    );
    let required: Vec<String> = run.keys().cloned().collect();
    run.insert(
        "scene_file".into(),
        words("the scene with every value; relative to the folder"),
    );
    run.insert("scene_sha256".into(), hash.clone());
    run.insert("trace_csv".into(), words("trace; relative to the folder"));
    run.insert(
        "trace_parquet".into(),
        words("trace; relative to the folder"),
    );
    let fields: Vec<String> = units.keys().cloned().collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Results of Touchstone",
        "description": "results.json of a report's folder, and what --json prints.",
        "type": "object",
        "required": ["schema_version", "program", "command", "inputs", "units", "runs"],
        "additionalProperties": false,
        "properties": {
            "schema_version": {"const": SCHEMA_VERSION},
            "program": {
                "type": "object",
                "required": ["name", "version", "commit", "modified"],
                "additionalProperties": false,
                "properties": {
                    "name": {"const": "touchstone"},
                    "version": {"type": "string"},
                    "commit": {"type": ["string", "null"], "pattern": "^[0-9a-f]{40,64}$",
                               "description": "null where the program was not built in a checkout"},
                    "modified": {"type": "boolean", "description": "the program's sources differed from the commit"},
                },
            },
            "command": words("command line that makes these results again"),
            "inputs": {
                "type": "array",
                "description": "files that were read: the scene, where it is not a shipped one, and recordings",
                "items": {
                    "type": "object",
                    "required": ["path", "sha256", "bytes", "copy"],
                    "additionalProperties": false,
                    "properties": {
                        "path": words("as it was given"),
                        "sha256": hash,
                        "bytes": {"type": "integer", "minimum": 0},
                        "copy": {"type": ["string", "null"],
                                 "description": "copy in the folder; null: a scene, which is written out with every value"},
                    },
                },
            },
            "trace_every": {"type": "integer", "minimum": 1, "description": "the traces have every Nth control period; this is N"},
            "files": {"type": "array", "items": {"type": "string"}, "uniqueItems": true,
                      "description": "all files of the report, relative to the folder"},
            "units": {"type": "object", "required": fields, "additionalProperties": false, "properties": units},
            "runs": {
                "type": "array",
                "items": {"type": "object", "required": required, "additionalProperties": false, "properties": run},
            },
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documented_schema_is_this_one() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/schema/results.schema.json"
        );
        if std::env::var_os("TOUCHSTONE_WRITE_SCHEMA").is_some() {
            std::fs::write(path, results()).unwrap();
        }
        let documented = std::fs::read_to_string(path).unwrap();
        assert!(
            documented == results(),
            "write it anew: TOUCHSTONE_WRITE_SCHEMA=1 cargo test -p touchstone-report schema"
        );
    }
}
