//! Tests of the thesis' comparison in three degrees of freedom.

use crate::common::{self, run_in};
use touchstone_report::plain_schema::misfit;

use std::path::PathBuf;

fn folder(test: &str) -> PathBuf {
    common::folder(&format!("cli-space-{test}"))
}

/// Checks that all claims of the thesis hold in the comparison, and that the report's page has the figures of every run.
#[test]
fn the_comparison_reproduces_what_the_thesis_claims() {
    let folder = folder("claims");
    let out = run_in(&folder, ["thesis", "--dof", "3", "--json"]);
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    let results: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let mut kept = results.clone();
    kept.as_object_mut().expect("object").remove("report");
    let schema = touchstone_lab::space_report::schema::comparison();
    assert_eq!(misfit(&schema, &kept, "results"), None);
    kept["directions"][0]["more"] = 1.into();
    assert!(misfit(&schema, &kept, "results").is_some());
    let claims = results["claims"].as_array().expect("claims");
    assert!(claims.len() >= 9);
    for claim in claims {
        assert_eq!(claim["outcome"], "reproduced", "{claim}");
    }
    let runs = results["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 33);
    // The shipped wall is compared with the approaches of the thesis. It must display the requested stiffness.
    let ships: Vec<_> = runs
        .iter()
        .filter(|run| run["approach"] == "shipped")
        .collect();
    assert_eq!(ships.len(), 3);
    for run in ships {
        let shown = run["displayed_at_rest_n_per_mm"]
            .as_f64()
            .expect("a number");
        assert!((shown / 25.0 - 1.0).abs() < 0.05, "{run}");
    }
    for run in runs {
        for (name, value) in run.as_object().expect("a run") {
            assert!(
                // Each run is judged, on a smooth object without a vibration at the touch.
                (["not_judged", "texture", "material"].contains(&&**name) && value.is_null())
                    || value.is_string()
                    || value == &serde_json::Value::Bool(false)
                    || value.as_f64().is_some_and(f64::is_finite),
                "{name}: {value}"
            );
        }
    }
    let page = std::fs::read_to_string(folder.join("touchstone-report/index.html")).expect("page");
    assert_eq!(page.matches("<figure class=\"plot\">").count(), 4 * 33);
    let picture = page.find("class=\"picture\"").expect("a picture");
    assert!(picture < page.find("<table").expect("a table"));
    assert!(!page.contains("NaN") && !page.contains("http"));
    // The same command replaces its own results. Another command refuses to replace them.
    let again = run_in(&folder, ["thesis", "--dof", "3", "--json"]);
    assert!(again.status.success());
    let other = run_in(&folder, ["thesis", "--dof", "3", "--quiet"]);
    assert_eq!(
        other.status.code(),
        Some(2),
        "holds the results of another command"
    );
}

#[test]
fn what_has_no_meaning_is_refused_on_one_line() {
    let folder = folder("refused");
    for arguments in [
        &["thesis", "--dof", "2"][..],
        &["thesis", "--dof", "0"],
        &["thesis", "--dof", "3", "--set", "law.k_soft_n_m_per_rad=1"],
        &["thesis", "--dof", "3", "--strict-passive"],
        &["thesis", "--dof", "3", "--max-penetration", "0.1"],
    ] {
        let out = run_in(&folder, arguments);
        assert_eq!(out.status.code(), Some(2), "{arguments:?}");
        let text = String::from_utf8_lossy(&out.stderr);
        assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
        assert!(text.contains("--dof") || text.contains("--set"), "{text}");
        assert!(!folder.join("touchstone-report").exists());
    }
}
