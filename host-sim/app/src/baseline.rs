//! Runs held against those of before: no verdict may have changed, no measure may be worse by more than a margin.

use super::check::{Check, name};
use serde_json::Value;
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::record::Summary;

/// The direction in which a measure is worse.
#[derive(Clone, Copy)]
enum Worse {
    Less,
    More,
}

/// Fields of a run's results that are compared, each with a slack for values that are next to nothing.
///
/// Angles: a hundredth of a count of the finest shipped encoder. Energies: a thousandth of what a press of 0.1 N·m
/// stores at 5 N·m/rad. Torques: a tenth of a thousandth of that press. Times: one tick of 1 kHz.
const MEASURES: [(&str, Worse, f64); 10] = [
    ("k_displayed", Worse::Less, 0.0),
    ("peak_penetration_ratio", Worse::More, 0.0),
    ("penetration_max", Worse::More, 1.6e-6),
    ("settle_from_ramp_end_s", Worse::More, 1e-3),
    ("limit_cycle_peak_to_peak", Worse::More, 1.6e-6),
    ("ripple_rms_n_m", Worse::More, 1e-5),
    ("release_speed_rad_per_s", Worse::More, 1.6e-3),
    ("release_excursion_rad", Worse::More, 1.6e-6),
    ("energy_out", Worse::More, 1e-6),
    ("energy_out_worst_window_j", Worse::More, 1e-6),
];
/// Results that were written before runs had names have none.
const NAME: &str = "name";
/// What makes two runs the same run.
const SAME: [&str; 7] = [
    "scene",
    NAME,
    "law",
    "k_desired",
    "grip",
    "encoder_counts_per_rev",
    "rate_hz",
];

/// The runs of a results file.
pub fn read(file: &Path) -> Result<Vec<Value>> {
    let wrong = |problem: String| Error::Io {
        path: file.to_owned(),
        problem,
        fix: "give --baseline what --json printed, or the results.json of a report's folder"
            .to_owned(),
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

/// Compares a run with the earlier one; a run that did not exist then is refused.
pub fn on(run: &Summary, before: &[Value], margin: f64) -> Vec<Check> {
    let mut now = serde_json::to_value(run).unwrap_or_default();
    now[NAME] = run.word().into();
    let check = |what: &str, wanted: String, came: String, met: bool| Check {
        run: name(run),
        option: "--baseline",
        wanted: format!("{what} {wanted}").trim_end().to_owned(),
        came,
        met,
    };
    let Some(before) = before.iter().find(|before| {
        let same = |field: &str| before[field] == now[field];
        let unnamed = |field: &str| field == NAME && before[field].is_null();
        SAME.iter().all(|field| same(field) || unnamed(field))
    }) else {
        let came = "none of this scene, law, stiffness, grip, encoder and rate".to_owned();
        return vec![check("a run to compare with,", String::new(), came, false)];
    };
    let verdict = |value: &Value| value["verdict"].as_str().unwrap_or("none").to_owned();
    let mut checks = vec![check(
        "verdict",
        verdict(before),
        verdict(&now),
        before["verdict"] == now["verdict"],
    )];
    for (field, worse, nothing) in MEASURES {
        // What had no number before has nothing to be worse than.
        let Some(was) = before[field].as_f64() else {
            continue;
        };
        let slack = margin * was.abs() + nothing;
        let (limit, words) = match worse {
            Worse::Less => (was - slack, "at least"),
            Worse::More => (was + slack, "at most"),
        };
        let came = now[field].as_f64();
        // A number that is none, or infinite, is `null` in JSON: it meets nothing.
        let met = came.is_some_and(|came| match worse {
            Worse::Less => came >= limit,
            Worse::More => came <= limit,
        });
        let came = came.map_or_else(|| "none".to_owned(), shown);
        checks.push(check(field, format!("{words} {}", shown(limit)), came, met));
    }
    checks
}

/// Six digits, and no more than a person reads.
fn shown(value: f64) -> String {
    match value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        true => format!("{value:.6}"),
        false => format!("{value:.4e}"),
    }
}
