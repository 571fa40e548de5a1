//! Tests of `touchstone scorecard` and `touchstone tune`.

use super::{folder, names, run, run_in};

#[test]
fn a_scorecard_has_a_row_for_every_law_that_was_asked_for() {
    let folder = folder("scorecard");
    let arguments = [
        "scorecard",
        "thesis-knob",
        "--k-desired",
        "0.5",
        "--law",
        "spring",
        "fba",
        "--out",
        "card",
        "--json",
    ];
    let said = run_in(&folder, &arguments).ended(0);
    let card = said.json();
    let rows = card["rows"].as_array().unwrap();
    let laws: Vec<_> = rows
        .iter()
        .map(|row| row["law"].as_str().unwrap())
        .collect();
    assert_eq!(laws, ["spring", "fba"]);
    assert_eq!(rows[0]["cells"].as_array().unwrap().len(), 9);
    assert!(
        rows[0]["cells"][0]["figures"]["phase_deg"]
            .as_f64()
            .unwrap()
            < 1.0
    );
    assert_eq!(names(&folder.join("card")), ["index.html", "results.json"]);
    // A command does not replace the results of another command.
    run_in(&folder, &["scorecard", "--law", "fba", "--out", "card"]).refused(&["card", "--force"]);
}

#[test]
fn what_cannot_be_asked_is_refused() {
    run(&["tune", "--law", "spring-dampr"])
        .refused(&["spring-dampr", "did you mean spring-damper?"]);
    run(&["scorecard", "--set", "law.kind=fba"]).refused(&["law.kind=fba"]);
    run(&["run", "tap", "--settings", "no-such.toml"]).refused(&["no-such.toml"]);
    let folder = folder("settings");
    std::fs::write(folder.join("s.toml"), "[device]\ninertia_kg_m2 = 1e-4\n").unwrap();
    run_in(&folder, &["run", "tap", "--settings", "s.toml"])
        .refused(&["s.toml: device.inertia_kg_m2", "law"]);
}

#[test]
fn tuned_settings_go_into_a_scene() {
    let folder = folder("tune");
    // A law with a single parameter, so that the search is short.
    let tune = [
        "tune",
        "--law",
        "fba",
        "--quick",
        "--k-desired",
        "1",
        "--out",
        "found.toml",
        "--force",
        "--json",
    ];
    // Force bounding fails the dynamic limits for a moving hand. The settings file is written only because of `--force`.
    let found = run_in(&folder, &tune).ended(3).json();
    assert_eq!(found["cause"], "dynamics");
    let c_i = &found["settings"]["law.device_damping_n_m_s_per_rad"];
    let printed = run_in(
        &folder,
        &[
            "run",
            "tap",
            "--settings",
            "found.toml",
            "--print",
            "--json",
        ],
    );
    let scene = printed.ended(0).json();
    assert_eq!(&scene["law"]["device_damping_n_m_s_per_rad"], c_i);
    assert_eq!(scene["law"]["kind"], "fba");
    assert_eq!(scene["wall"]["k_desired_n_m_per_rad"], 1.0);
}

#[test]
fn what_does_not_hold_is_written_only_where_that_is_asked_for() {
    let folder = folder("tune-fails");
    // Force bounding alone never holds five times the critical stiffness.
    let tune = ["tune", "--law", "fba", "--quick", "--out", "found.toml"];
    let said = run_in(&folder, &tune).ended(3);
    let line = said.err.lines().last().unwrap();
    assert!(line.starts_with("error: thesis-knob: no setting"), "{line}");
    assert!(
        line.contains("cause: ") && line.contains("--force"),
        "{line}"
    );
    assert!(names(&folder).is_empty());
    run_in(&folder, &[&tune[..], &["--force"]].concat()).ended(3);
    assert_eq!(names(&folder), ["found.toml"]);
    // The energy bound of the guard covers at most one tick of delay. For a device with more delay no file is written.
    run(&["tune", "--set", "timing.computational_delay_s=0.0015"]).refused(&[
        "timing.computational_delay_s",
        "1.500 control periods",
        "667 Hz",
    ]);
}

#[test]
fn tuned_settings_are_written_in_the_language_of_the_files_ending() {
    let folder = folder("tune-languages");
    for name in ["found.txt", "found.TOML"] {
        run_in(&folder, &["tune", "--out", name])
            .refused(&[name, ".toml, .rs (Rust), .c or .h (C)"]);
    }
    let blind = folder.join("blind.toml");
    std::fs::write(&blind, "[device]\ninertia_kg_m2 = 1e-4\n").unwrap();
    run_in(&folder, &["tune", "blind.toml", "--out", "found.rs"])
        .refused(&["encoder.counts_per_rev"]);
    // A law with a single parameter, so that the search is short.
    for (name, part) in [
        ("found.rs", "pub fn tuned_settings() -> Settings {"),
        ("found.c", "{\"law.kind\", \"fba\"},"),
    ] {
        let tune = [
            "tune",
            "--law",
            "fba",
            "--quick",
            "--k-desired",
            "1",
            "--force",
        ];
        run_in(&folder, &[&tune[..], &["--out", name]].concat()).ended(3);
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(
            text.starts_with("// force bounding approach for thesis-knob:"),
            "{text}"
        );
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn a_certificate_speaks_of_the_grips_first() {
    let said = run(&["certify", "low-stiffness", "--no-margins"]).ended(0);
    let text = &said.out;
    let place = |words: &str| {
        text.find(words)
            .unwrap_or_else(|| panic!("{words}: {text}"))
    };
    assert!(place("at rest: stable") < place("feel: holds"));
    assert!(place("feel: holds") < place("hypothetical hand"));
    let json = run(&["certify", "low-stiffness", "--no-margins", "--json"])
        .ended(0)
        .json();
    assert_eq!(json["verdict"], "stable");
    assert_eq!(json["feel"]["holds"], true);
    assert!(json["every_hand"].is_string());
    let json = run(&[
        "certify",
        "low-stiffness",
        "--grips",
        "--no-margins",
        "--json",
    ])
    .ended(0)
    .json();
    assert!(json["every_hand"].is_null());
}

#[test]
fn a_boundary_is_a_drawing_with_its_cells_and_goes_on() {
    let folder = folder("boundary");
    let small = [
        "boundary",
        "--law",
        "spring",
        "--columns",
        "2",
        "--rows",
        "3",
        "--delays",
        "0,1",
        "--out",
        "b",
        "--json",
    ];
    let found = run_in(&folder, &small).ended(0).json();
    assert_eq!(found["cells"], 12);
    assert_eq!(found["columns"].as_array().unwrap().len(), 4);
    // The softest wall on the most damped device is below its critical stiffness, and a spring holds it.
    assert!(found["columns"][1]["rests_up_to"].as_f64().unwrap() >= 0.1);
    let place = folder.join("b");
    assert_eq!(
        names(&place),
        ["boundary.svg", "cells.csv", "index.html", "results.json"]
    );
    let cells = std::fs::read(place.join("cells.csv")).unwrap();
    assert_eq!(run_in(&folder, &small).ended(0).json(), found);
    assert_eq!(std::fs::read(place.join("cells.csv")).unwrap(), cells);
    run_in(
        &folder,
        &["boundary", "--set", "law.kind=fba", "--out", "c"],
    )
    .refused(&["law.kind=fba"]);
    run_in(&folder, &["boundary", "--delays", "3", "--out", "c"]).refused(&["--delays"]);
}
