//! Compares simulation runs with those of an earlier results file. The verdict must be the same, and no measure may be worse by
//! more than a margin.

use super::check::{Check, name};
use serde_json::Value;
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::record::Summary;
use touchstone_sim::run::summary::{MEASURES, Worse};

/// Field with a run's name. Older results files do not have the field; a run without it matches a run of any name.
const NAME: &str = "name";
/// Fields of the results that must be equal in two runs, so that these count as the same run.
const SAME: [&str; 7] = [
    "scene",
    NAME,
    "law",
    "k_desired",
    "grip",
    "encoder_counts_per_rev",
    "rate_hz",
];

/// Reads the runs of a results file. Errors: the file is not JSON, or contains no runs.
pub fn read(file: &Path) -> Result<Vec<Value>> {
    let wrong = |problem: String| {
        Error::Io {
        path: file.to_owned(),
        problem,
        fix: "give --baseline a file with the output of --json, or the results.json of a report's folder"
            .to_owned(),
    }
    };
    let text = touchstone_sim::input::text(file, touchstone_sim::input::MOST_OF_RESULTS)
        .map_err(|error| wrong(error.to_string()))?;
    let mut value: Value =
        serde_json::from_str(&text).map_err(|error| wrong(format!("no JSON: {error}")))?;
    match value["runs"].take() {
        Value::Array(runs) if !runs.is_empty() => Ok(runs),
        _ => Err(wrong("it has no \"runs\"".to_owned())),
    }
}

/// Compares a run with the same run of the baseline. A run that is missing from the baseline counts as a demand that is not met.
pub fn on(run: &Summary, before: &[Value], margin: f64) -> Vec<Check> {
    let mut now = serde_json::to_value(run).unwrap_or_default();
    now[NAME] = run.word().into();
    let check = |what: &str, wanted: String, came: String, met: bool| Check {
        run: name(run),
        option: "--baseline",
        wanted: format!("{what} {wanted}").trim_end().to_owned(),
        came,
        met,
        not_judged: run.not_judged.clone(),
    };
    let Some(before) = before.iter().find(|before| {
        let same = |field: &str| before[field] == now[field];
        let unnamed = |field: &str| field == NAME && before[field].is_null();
        SAME.iter().all(|field| same(field) || unnamed(field))
    }) else {
        let came = "none of this scene, law, stiffness, grip, encoder and rate".to_owned();
        return vec![check("a run to compare with", String::new(), came, false)];
    };
    let verdict = |value: &Value| value["verdict"].as_str().unwrap_or("none").to_owned();
    let mut checks = vec![check(
        "verdict",
        verdict(before),
        verdict(&now),
        before["verdict"] == now["verdict"],
    )];
    for measure in MEASURES {
        let field = measure.field;
        // A measure without a number in the baseline is not compared.
        let (Some(worse), Some(was)) = (measure.worse, before[field].as_f64()) else {
            continue;
        };
        let (limit, words) = match worse {
            Worse::Less(nothing) => (was - (margin * was.abs() + nothing), "at least"),
            Worse::More(nothing) => (was + (margin * was.abs() + nothing), "at most"),
        };
        let came = now[field].as_f64();
        // NaN and infinity are `null` in JSON: such a value does not meet the limit.
        let met = came.is_some_and(|came| match worse {
            Worse::Less(_) => came >= limit,
            Worse::More(_) => came <= limit,
        });
        let came = came.map_or_else(|| "none".to_owned(), shown);
        checks.push(check(field, format!("{words} {}", shown(limit)), came, met));
    }
    checks
}

/// A number as text: six decimals, or an exponent where the number is very large or very small.
fn shown(value: f64) -> String {
    match value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        true => format!("{value:.6}"),
        false => format!("{value:.4e}"),
    }
}
