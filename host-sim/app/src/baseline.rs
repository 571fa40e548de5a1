//! Compares simulation runs with those of an earlier results file. The verdict must be the same, and no measure may be worse by
//! more than a margin.

use super::check::{Check, name};
use serde_json::Value;
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::record::Summary;

/// Whether a smaller or a larger value of a measure counts as worse.
#[derive(Clone, Copy)]
enum Worse {
    Less,
    More,
}

/// Fields of a run's results that are compared, each with an absolute tolerance in the field's unit, for values near zero.
/// Stiffness and ratio have none.
///
/// Angles: a hundredth of a count of the finest encoder in the shipped scenes. Energies: a thousandth of the energy that a press of
/// 0.1 N·m stores in a wall of 5 N·m/rad. Torques: a ten-thousandth of 0.1 N·m. Times: one control period at 1 kHz. Speed: the
/// tolerance of an angle per such period.
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
    for (field, worse, nothing) in MEASURES {
        // A measure without a number in the baseline is not compared.
        let Some(was) = before[field].as_f64() else {
            continue;
        };
        let slack = margin * was.abs() + nothing;
        let (limit, words) = match worse {
            Worse::Less => (was - slack, "at least"),
            Worse::More => (was + slack, "at most"),
        };
        let came = now[field].as_f64();
        // NaN and infinity are `null` in JSON: such a value does not meet the limit.
        let met = came.is_some_and(|came| match worse {
            Worse::Less => came >= limit,
            Worse::More => came <= limit,
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
