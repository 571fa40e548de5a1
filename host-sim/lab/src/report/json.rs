//! `results.json`: every run's summary in SI units, and the unit of every number.

use std::collections::BTreeMap;

use serde::Serialize;

use super::TraceFiles;
use touchstone_sim::run::record::{Run, Summary};

/// Unit of every numeric field of a run. `1` marks a plain count.
pub const UNITS: &[(&str, &str)] = &[
    ("k_desired", "N·m/rad"),
    ("encoder_counts_per_rev", "1/rev"),
    ("rate_hz", "Hz"),
    ("k_displayed", "N·m/rad"),
    ("rate_hardness", "N·m/rad"),
    ("peak_penetration_ratio", "1"),
    ("ripple_rms_n_m", "N·m"),
    ("ripple_above_50_hz_rms_n_m", "N·m"),
    ("release_speed_rad_per_s", "rad/s"),
    ("release_excursion_rad", "rad"),
    ("energy_out_worst_window_j", "J"),
    ("energy_out_wall_worst_window_j", "J"),
    ("settle_from_ramp_end_s", "s"),
    ("limit_cycle_peak_to_peak", "rad"),
    ("energy_true_min", "J"),
    ("energy_user_min", "J"),
    ("energy_out", "J"),
    ("energy_observed_min", "J"),
    ("settle_time", "s"),
    ("penetration_max", "rad"),
    ("force_max", "N·m"),
    ("ticks", "1"),
    ("contact_ticks", "1"),
];

#[derive(Serialize)]
struct Results<'a> {
    units: BTreeMap<&'static str, &'static str>,
    runs: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace_csv: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace_parquet: Option<&'a str>,
}

/// The text of `results.json`, also what `--json` prints. `files` are the trace files of each run, if they were written.
///
/// A field that does not apply is `null`; so is a number that is not finite, for JSON has no other way to say so.
pub fn render(runs: &[Run], files: &[Option<TraceFiles>]) -> String {
    let results = Results {
        units: UNITS.iter().copied().collect(),
        runs: runs
            .iter()
            .enumerate()
            .map(|(index, run)| {
                let files = files.get(index).and_then(Option::as_ref);
                Entry {
                    summary: &run.summary,
                    trace_csv: files.map(|files| files.csv.as_str()),
                    trace_parquet: files.map(|files| files.parquet.as_str()),
                }
            })
            .collect(),
    };
    let mut text = serde_json::to_string_pretty(&results)
        .expect("a summary has only string keys and plain values");
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::report::synthetic;
    use touchstone_control::LawKind;

    /// A run in which no field is `None`.
    fn complete() -> Run {
        let mut run = synthetic::run(LawKind::EnhancedSfa, 2.5, 0.01);
        let s = &mut run.summary;
        s.encoder_counts_per_rev = Some(16_384.0);
        for field in [
            &mut s.k_displayed,
            &mut s.rate_hardness,
            &mut s.peak_penetration_ratio,
            &mut s.ripple_rms_n_m,
            &mut s.ripple_above_50_hz_rms_n_m,
            &mut s.release_speed_rad_per_s,
            &mut s.release_excursion_rad,
            &mut s.settle_from_ramp_end_s,
            &mut s.limit_cycle_peak_to_peak,
            &mut s.energy_observed_min,
            &mut s.settle_time,
        ] {
            *field = Some(1.25);
        }
        run
    }

    fn parse(text: &str) -> Value {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn every_number_has_a_unit_and_every_unit_a_number() {
        let results = parse(&render(&[complete()], &[]));
        let run = results["runs"][0].as_object().unwrap();
        let units = results["units"].as_object().unwrap();
        assert!(
            run.values().all(|value| !value.is_null()),
            "`complete` left a field out: {run:?}"
        );
        for (field, value) in run {
            assert_eq!(value.is_number(), units.contains_key(field), "{field}");
        }
        for field in units.keys() {
            assert!(run.contains_key(field), "{field}");
        }
    }

    #[test]
    fn names_are_those_of_the_interface() {
        let results = parse(&render(&[complete()], &[]));
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
        assert_eq!(run["k_desired"], 2.5);
    }

    #[test]
    fn absent_and_not_finite_are_null() {
        let mut run = complete();
        run.summary.settle_time = None;
        run.summary.energy_true_min = f64::NEG_INFINITY;
        let files = TraceFiles {
            csv: "traces/a.csv".to_owned(),
            parquet: "traces/a.parquet".to_owned(),
        };
        let results = parse(&render(&[run], &[Some(files)]));
        assert!(results["runs"][0]["settle_time"].is_null());
        assert!(results["runs"][0]["energy_true_min"].is_null());
        assert_eq!(results["runs"][0]["trace_parquet"], "traces/a.parquet");
        assert_eq!(parse(&render(&[], &[]))["runs"], Value::Array(Vec::new()));
    }
}
