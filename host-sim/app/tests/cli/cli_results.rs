//! Tests of the warnings for settings beyond a passivity bound, and of the files that the commands write.

use crate::common::{self, run_in};

use std::path::PathBuf;

fn folder(test: &str) -> PathBuf {
    common::folder(&format!("cli-results-{test}"))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// For each passivity bound: a setting just inside, a setting just outside, and the parts of the expected warning.
const BOUNDS: [(&str, &str, &[&str]); 3] = [
    (
        "law.k_soft_n_m_per_rad=1.0",
        "law.k_soft_n_m_per_rad=1.01",
        &[
            "k_v = 1.01",
            "k_c = 2 c_i/T = 1:",
            "unstable by itself",
            "give 1 or less",
        ],
    ),
    (
        "law.filter.stiffness_n_m_per_rad=1.0",
        "law.filter.stiffness_n_m_per_rad=1.01",
        &[
            "k_f = 1.01",
            "2 (c_i - c_f - B)/T = 1:",
            "passive only with the hand",
            "give 1 or less",
        ],
    ),
    (
        "law.filter.ground_damping_n_m_s_per_rad=4.01e-4",
        "law.filter.ground_damping_n_m_s_per_rad=3.9e-4",
        &[
            "c_env = 3.9e-4",
            "k_v T/2 = 4e-4",
            "gain energy",
            "give 4e-4 or more",
        ],
    ),
];

#[test]
fn a_setting_beyond_a_passivity_bound_runs_with_a_warning_and_is_refused_when_strict() {
    let here = folder("bounds");
    for (inside, outside, parts) in BOUNDS {
        let quiet = run_in(
            &here,
            [
                "run", "tap", "--preset", "thesis", "--json", "--set", inside,
            ],
        );
        assert_eq!(quiet.status.code(), Some(0));
        assert_eq!(text(&quiet.stderr), "", "{inside}");

        let warned = run_in(
            &here,
            [
                "run", "tap", "--preset", "thesis", "--json", "--set", outside,
            ],
        );
        let err = text(&warned.stderr);
        assert_eq!(warned.status.code(), Some(0), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
        assert!(
            err.starts_with(&format!("warning: --set {outside}")),
            "{err}"
        );
        for part in parts {
            assert!(err.contains(part), "{err:?} does not say {part:?}");
        }
        // The warning is not part of the results.
        serde_json::from_slice::<serde_json::Value>(&warned.stdout).unwrap();

        // `--strict-passive` also refuses the energy credit. With a credit of 0, only the passivity bound can cause a refusal.
        let credit = ["--set", "law.energy_credit_j=0", "--strict-passive"];
        let strict = |setting: &str| {
            let mut arguments = vec![
                "run", "tap", "--preset", "thesis", "--json", "--out", "out", "--set", setting,
            ];
            arguments.extend(credit);
            run_in(&here, &arguments)
        };
        let refused = strict(outside);
        let err = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
        assert!(
            err.contains(parts[0]) && err.contains("--strict-passive"),
            "{err}"
        );
        assert!(refused.stdout.is_empty() && !here.join("out").exists());
        let kept = strict(inside);
        assert_eq!(kept.status.code(), Some(0), "{}", text(&kept.stderr));
        std::fs::remove_dir_all(here.join("out")).unwrap();
    }
}

#[test]
fn strictly_passive_refuses_the_default_credit_and_names_it() {
    let here = folder("credit");
    for command in ["run thesis-knob --preset thesis", "thesis"] {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.extend(["--strict-passive", "--out", "out"]);
        let output = run_in(&here, &arguments);
        let err = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert!(
            err.contains("energy_credit_j") && err.contains("give 0"),
            "{err}"
        );
        assert!(!here.join("out").exists());
    }
}

/// Fields that every run has in `results.json`.
const FIELDS: [&str; 11] = [
    "law",
    "k_desired",
    "grip",
    "encoder_counts_per_rev",
    "verdict",
    "k_displayed",
    "rate_hardness",
    "limit_cycle_peak_to_peak",
    "energy_true_min",
    "energy_observed_min",
    "settle_time",
];

#[track_caller]
fn assert_documented(results: &serde_json::Value, runs: usize) {
    let listed = results["runs"].as_array().unwrap();
    assert_eq!(listed.len(), runs);
    let units = results["units"].as_object().unwrap();
    for run in listed {
        let run = run.as_object().unwrap();
        for field in FIELDS {
            assert!(run.contains_key(field), "{field} is missing");
        }
        let among = |field: &str, words: &[&str]| words.contains(&run[field].as_str().unwrap());
        assert!(among(
            "law",
            &["spring", "tdpa", "fba", "sfa", "enhanced-sfa"]
        ));
        assert!(among(
            "verdict",
            &["passive", "active", "limit-cycle", "unstable"]
        ));
        for (field, value) in run {
            assert!(
                !value.is_f64() || units.contains_key(field),
                "{field} has no unit"
            );
        }
    }
}

#[test]
fn json_on_standard_output_parses_and_has_the_documented_fields() {
    let output = run_in(&folder("json"), ["run", "thesis-knob", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output.stderr), "");
    let results: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_documented(&results, 1);
    let shown = results["runs"][0]["k_displayed"].as_f64().unwrap();
    assert!((shown / 5.0 - 1.0).abs() < 0.05, "{shown}");
}

#[test]
fn the_main_job_writes_page_results_and_traces_and_keeps_standard_output_clean() {
    let here = folder("thesis");
    let output = run_in(&here, ["thesis", "--out", "report"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let out = text(&output.stdout);
    // A progress bar would leave carriage returns, escapes or bar characters.
    assert!(!out.contains(['\r', '\u{1b}', '█', '░']), "{out:?}");
    assert!(!out.contains("runs  0s") && out.contains("Enhanced SFA"));
    // Standard error is not a terminal either, so it must stay empty.
    assert_eq!(text(&output.stderr), "");

    let report = here.join("report");
    let page = std::fs::read_to_string(report.join("index.html")).unwrap();
    assert!(page.contains("<svg") && page.ends_with("</html>\n"));
    // The comparison itself sets `law.observer` for TDPA. Page and output say so.
    for said in [&page, &out] {
        assert!(said.contains("whatever law.observer says"));
    }
    // Self-contained: nothing is fetched.
    for outside in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let results: serde_json::Value =
        serde_json::from_slice(&std::fs::read(report.join("results.json")).unwrap()).unwrap();
    // Three grips and two encoders. For each pair: four stiffnesses with the five laws and the shipped law, and one additional
    // stiffness for two laws.
    assert_documented(&results, 3 * 2 * (4 * 6 + 2));

    let mut traces = 0;
    for run in results["runs"].as_array().unwrap() {
        let (Some(csv), Some(parquet)) = (run["trace_csv"].as_str(), run["trace_parquet"].as_str())
        else {
            continue;
        };
        traces += 1;
        let csv = std::fs::read_to_string(report.join(csv)).unwrap();
        // The file has a header and one row per control tick.
        let rows = csv.lines().filter(|line| !line.starts_with('#')).count() as u64;
        assert_eq!(rows, run["ticks"].as_u64().unwrap() + 1);
        let parquet = std::fs::read(report.join(parquet)).unwrap();
        assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    }
    // The plotted comparison: one grip, one encoder.
    assert_eq!(traces, 4 * 6 + 2);
}
