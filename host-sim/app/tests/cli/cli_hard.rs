//! Tests of `touchstone hard` and `touchstone accuracy`: what they print, write and refuse, and their exit codes.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common;

fn folder(test: &str) -> PathBuf {
    common::folder(&format!("cli-hard-{test}"))
}

fn run_in(folder: &Path, arguments: &str) -> Output {
    common::run_in(folder, arguments.split_whitespace())
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn hard_cases_are_listed_chosen_and_refused_by_name() {
    let here = folder("cases");
    let listed = run_in(&here, "hard --list");
    assert_eq!(listed.status.code(), Some(0));
    for name in ["stick", "denormals", "virtual-mass", "hundred-k_c", "guard"] {
        assert!(text(&listed.stdout).contains(name), "{name}");
    }
    let chosen = run_in(&here, "hard --only stick --only half-steps");
    assert_eq!(chosen.status.code(), Some(0));
    assert!(text(&chosen.stdout).contains("2 of 2 cases passed"));
    let json = run_in(&here, "hard --only stick --json");
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["cases"][0]["name"], "stick");
    assert_eq!(json["passed"], true);
    let wrong = run_in(&here, "hard --only stik");
    assert_eq!(wrong.status.code(), Some(2));
    let err = text(&wrong.stderr);
    assert!(
        err.lines().count() == 1 && err.contains("did you mean stick?"),
        "{err}"
    );
}

#[test]
fn accuracy_writes_its_folder_and_leaves_that_of_another_command_alone() {
    let here = folder("accuracy");
    let done = run_in(&here, "accuracy --quick --out out --json");
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let printed: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let written = std::fs::read(here.join("out/results.json")).unwrap();
    let written: serde_json::Value = serde_json::from_slice(&written).unwrap();
    assert_eq!(printed, written);
    for file in written["files"].as_array().unwrap() {
        assert!(
            here.join("out").join(file.as_str().unwrap()).is_file(),
            "{file}"
        );
    }
    assert!(text(&std::fs::read(here.join("out/plant-contact.svg")).unwrap()).starts_with("<svg"));
    assert_eq!(written["plant"].as_array().unwrap().len(), 4);
    let again = run_in(&here, "run tap --out out");
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("touchstone accuracy"));
}

#[test]
fn a_scene_takes_another_integrator_and_an_unknown_one_is_refused() {
    let here = folder("integrator");
    let verdict = |arguments: &str| {
        let output = run_in(&here, arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        json["runs"][0].clone()
    };
    let exact = verdict("run tap --json");
    assert_eq!(exact, verdict("run tap --integrator exact --json"));
    let other = verdict("run tap --integrator implicit-euler --set plant.substeps=1 --json");
    assert_ne!(exact["penetration_max"], other["penetration_max"]);
    let wrong = run_in(&here, "run tap --integrator euler");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        text(&wrong.stderr).contains("implicit-euler"),
        "{}",
        text(&wrong.stderr)
    );
}
