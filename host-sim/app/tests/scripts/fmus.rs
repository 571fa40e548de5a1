//! Tests of `touchstone export-fmu`: its files, its refusals and its output. `bindings/fmi` runs the FMUs.

use crate::{folder, names, run_in};
use std::path::Path;

/// Writes a file that the program accepts as the shared library. No FMU runs in these tests.
fn with_library(here: &Path) {
    let text = format!("fmi3InstantiateCoSimulation {}", touchstone_fmu::MARK);
    std::fs::write(here.join("library"), text).unwrap();
}

#[test]
fn both_halves_are_written_or_the_one_that_was_asked_for() {
    let here = folder("fmus");
    with_library(&here);
    let said = run_in(
        &here,
        &[
            "export-fmu",
            "thesis-knob",
            "--library",
            "library",
            "--out",
            "both",
            "--json",
        ],
    )
    .ended(0)
    .json();
    assert_eq!(
        names(&here.join("both")),
        ["thesis_knob_law.fmu", "thesis_knob_plant.fmu"]
    );
    assert_eq!(said["fmus"][0]["inputs"], serde_json::json!(["angle_rad"]));
    assert_eq!(said["fmus"][1]["half"], "plant");
    assert!(said["step_s"].as_f64().is_some_and(|step| step > 0.0));
    // A user's scene file, whose name is not a valid identifier in C.
    std::fs::write(
        here.join("1 knob.toml"),
        "[device]\ninertia_kg_m2 = 0.0002\n",
    )
    .unwrap();
    let words = [
        "export-fmu",
        "1 knob.toml",
        "--of",
        "law",
        "--library",
        "library",
        "--out",
        "one",
    ];
    let said = run_in(&here, &words).ended(0);
    assert_eq!(names(&here.join("one")), ["scene_1_knob_law.fmu"]);
    assert!(said.out.contains("energy_account_j"), "{}", said.out);
    // An existing file is replaced only with `--force`.
    run_in(&here, &words).refused(&["scene_1_knob_law.fmu", "--force"]);
    run_in(&here, &[&words[..], &["--force"]].concat()).ended(0);
}

#[test]
fn what_is_no_library_is_refused_with_the_way_to_one() {
    let here = folder("fmus-refused");
    std::fs::write(
        here.join("other.so"),
        "fmi3InstantiateCoSimulation of another version",
    )
    .unwrap();
    for file in ["other.so", "none.so"] {
        run_in(&here, &["export-fmu", "tap", "--library", file]).refused(&[file, "cargo build"]);
    }
    run_in(&here, &["export-fmu", "tap", "--of", "hand"]).ended(2);
    let three = "dof = 3\n";
    std::fs::write(here.join("space.toml"), three).unwrap();
    with_library(&here);
    run_in(&here, &["export-fmu", "space.toml", "--library", "library"]).ended(2);
    assert_eq!(names(&here), ["library", "other.so", "space.toml"]);
}
