//! Tests of the options `--expect`, `--max-penetration`, `--min-stiffness`, `--max-energy-out` and `--junit`.

use crate::{folder, run, run_in};

/// Verdicts, each with the arguments of a `touchstone run` that ends with the verdict.
const ENDS: [(&str, &[&str]); 6] = [
    ("passive", &["low-stiffness"]),
    ("active", &["thesis-knob"]),
    ("unstable", &["thesis-knob", "--law", "spring"]),
    // 10 % above the critical stiffness, without dry friction.
    (
        "limit-cycle",
        &["press-hold", "--law", "spring", "--k-desired", "1.1"],
    ),
    // The hand holds still for too short a time.
    (
        "not-judged",
        &["low-stiffness", "--set", "motion.hold_s=0.04"],
    ),
    // The shaft starts outside the wall and no hand moves it.
    (
        "no-contact",
        &["free-release", "--set", "device.initial_angle_rad=0.4"],
    ),
];

#[test]
fn every_verdict_can_be_asked_for() {
    for (verdict, scene) in ENDS {
        for (asked, _) in ENDS {
            let mut arguments = vec!["run", "--preset", "thesis"];
            arguments.extend(scene);
            arguments.extend(["--expect", asked]);
            let said = run(&arguments);
            if asked == verdict {
                assert_eq!(said.ended(0).err, "");
            } else {
                let err = said.ended(3).err;
                assert_eq!(err.lines().count(), 1, "{err}");
                let line = format!("not met: --expect: required {asked}, result {verdict}");
                assert!(err.starts_with(&line), "{err}");
            }
        }
        // A list of verdicts is met by any one of them.
        let mut arguments = vec!["run", "--preset", "thesis"];
        arguments.extend(scene);
        let other = ENDS[usize::from(verdict == ENDS[0].0)].0;
        arguments.extend(["--expect", other, "--expect", verdict]);
        run(&arguments).ended(0);
    }
}

#[test]
fn numbers_are_asked_for_from_both_sides() {
    let results = run(&["run", "thesis-knob", "--preset", "thesis", "--json"])
        .ended(0)
        .json();
    let measured = |field: &str| results["runs"][0][field].as_f64().unwrap();
    for (option, field, sign) in [
        ("--max-penetration", "penetration_max", 1.0),
        ("--min-stiffness", "k_displayed", -1.0),
        ("--max-energy-out", "energy_out", 1.0),
    ] {
        let value = measured(field);
        assert!(value > 0.0, "{field}");
        let asked = |share: f64| {
            let limit = (value * (1.0 + sign * share)).to_string();
            run(&["run", "thesis-knob", "--preset", "thesis", option, &limit])
        };
        assert_eq!(asked(1e-3).ended(0).err, "", "{option}");
        let err = asked(-1e-3).ended(3).err;
        assert!(
            err.starts_with(&format!("not met: {option}: required at "))
                && err.lines().count() == 1,
            "{err}"
        );
    }
    // A run without a hold displays no stiffness, so it does not even meet a minimum of 0.
    let err = run(&["run", "tap", "--min-stiffness", "0"]).ended(3).err;
    assert!(err.contains("result none"), "{err}");
}

#[test]
fn depth_and_energy_are_those_of_the_trace() {
    let here = folder("depth");
    let said = run_in(&here, &["run", "thesis-knob", "--json", "--out", "out"]).ended(0);
    let results = said.json();
    let traces = here.join("out/traces");
    let csv = crate::names(&traces)
        .into_iter()
        .find(|name| name.ends_with(".csv"));
    let text = std::fs::read_to_string(traces.join(csv.unwrap())).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (angle, surface) = (place("angle_rad"), place("surface_rad"));
    let (wall, loss) = (place("energy_true_j"), place("energy_device_loss_j"));
    let (mut depth, mut lowest) = (0.0_f64, 0.0_f64);
    for row in rows {
        let row: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        depth = depth.max(row[angle] - row[surface]);
        lowest = lowest.min(row[wall] + row[loss]);
    }
    let run = &results["runs"][0];
    assert_eq!(run["penetration_max"].as_f64(), Some(depth));
    let out = run["energy_out"].as_f64().unwrap();
    assert!((out + lowest).abs() < 1e-9, "{out} {lowest}");
}

#[test]
fn demands_add_up_and_every_one_that_fails_is_named() {
    let said = run(&[
        "run",
        "thesis-knob",
        "--preset",
        "thesis",
        "--json",
        "--expect",
        "passive",
        "--max-penetration",
        "0.001",
        "--min-stiffness",
        "1",
        "--max-energy-out",
        "0",
    ])
    .ended(3);
    assert_eq!(said.err.lines().count(), 3, "{}", said.err);
    let results = said.json();
    let asked = results["expectations"].as_array().unwrap();
    let met: Vec<bool> = asked
        .iter()
        .map(|demand| demand["met"].as_bool().unwrap())
        .collect();
    assert_eq!(met, [false, false, true, false]);
    // Without expectations the results do not mention them.
    let plain = run(&["run", "tap", "--json"]).ended(0).json();
    assert!(plain.get("expectations").is_none());
}

#[test]
fn junit_has_a_test_for_each_demand() {
    let here = folder("junit");
    let junit = |options: &[&str], code: i32| {
        let mut arguments = vec!["run", "low-stiffness", "--junit", "wall.xml"];
        arguments.extend(options);
        run_in(&here, &arguments).ended(code);
        let text = std::fs::read_to_string(here.join("wall.xml")).unwrap();
        assert!(text.starts_with("<?xml"), "{text}");
        let count = |part: &str| text.matches(part).count();
        (count("<testcase "), count("<failure "), text)
    };
    let (tests, failures, _) = junit(&["--expect", "passive", "--min-stiffness", "0.4"], 0);
    assert_eq!((tests, failures), (2, 0));
    let (tests, failures, text) = junit(&["--expect", "unstable", "--min-stiffness", "0.4"], 3);
    assert_eq!((tests, failures), (2, 1));
    assert!(
        text.contains("tests=\"2\"")
            && text.contains("failures=\"1\"")
            && text.contains("required unstable, result passive"),
        "{text}"
    );
    run_in(&here, &["run", "tap", "--junit", "no.xml"]).refused(&["--junit", "--expect"]);
    run_in(
        &here,
        &[
            "run",
            "tap",
            "--expect",
            "active",
            "--junit",
            "wall.xml/no.xml",
        ],
    )
    .refused(&["wall.xml/no.xml", "--junit"]);
    assert_eq!(crate::names(&here), ["wall.xml"]);
    // The program creates the folder of the report.
    let passive = [
        "run",
        "tap",
        "--expect",
        "passive",
        "--junit",
        "new/tap.xml",
    ];
    run_in(&here, &passive).ended(0);
    assert!(here.join("new/tap.xml").is_file());
}

#[test]
fn the_comparison_asks_it_of_the_enhanced_law() {
    let here = folder("thesis");
    let said = run_in(
        &here,
        &[
            "thesis", "--quiet", "--expect", "passive", "--expect", "active", "--junit", "all.xml",
        ],
    )
    .ended(0);
    assert_eq!((said.out.as_str(), said.err.as_str()), ("", ""));
    let text = std::fs::read_to_string(here.join("all.xml")).unwrap();
    // Three grips, two encoders and five stiffnesses, the last of which is beyond those of the thesis.
    assert_eq!(text.matches("<testcase ").count(), 30);
    assert!(!text.contains("tdpa"), "{text}");
    let said = run_in(
        &here,
        &["thesis", "--quiet", "--force", "--min-stiffness", "4"],
    )
    .ended(3);
    // The runs with 0.5, 1 and 2.5 N·m/rad display less than the minimum.
    assert_eq!(said.err.lines().count(), 18, "{}", said.err);
}

#[test]
fn what_is_no_demand_is_refused() {
    for (options, parts) in [
        (
            &["--expect", "Passive"][..],
            &["--expect", "did you mean passive?"][..],
        ),
        (
            &["--expect", "good"],
            &["--expect", "\"good\"", "limit-cycle", "no-contact"],
        ),
        (
            &["--max-penetration", "-1"],
            &["--max-penetration", "must be 0 or more, is -1", "rad"],
        ),
        (
            &["--min-stiffness", "stiff"],
            &["--min-stiffness", "must be 0 or more, is stiff", "N·m/rad"],
        ),
        (
            &["--max-energy-out", "nan"],
            &["--max-energy-out", "must be 0 or more, is nan", "in J"],
        ),
    ] {
        let mut arguments = vec!["run", "tap"];
        arguments.extend(options);
        run(&arguments).refused(parts);
    }
}

/// Checks the comparison with a baseline: an equal or better run passes; a softer wall, another verdict or another scene fails.
#[test]
fn a_baseline_says_what_became_worse() {
    let here = folder("baseline");
    let keep = |name: &str, more: &[&str]| {
        let mut arguments = vec!["run", "thesis-knob", "--json"];
        arguments.extend(more);
        std::fs::write(here.join(name), run(&arguments).ended(0).out).unwrap();
    };
    keep("same.json", &[]);
    let hold = |file: &str, more: &[&str]| {
        let mut arguments = vec!["run", "thesis-knob", "--baseline", file];
        arguments.extend(more);
        run_in(&here, &arguments)
    };
    assert_eq!(hold("same.json", &[]).ended(0).err, "");
    assert_eq!(hold("same.json", &["--margin", "0"]).ended(0).err, "");

    let thesis = hold("same.json", &["--preset", "thesis"]).ended(3).err;
    for measure in ["peak_penetration_ratio", "settle_from_ramp_end_s"] {
        assert!(thesis.contains(measure), "{thesis}");
    }
    // In the opposite comparison the shipped wall is better in both measures. Only the verdict differs.
    keep("thesis.json", &["--preset", "thesis"]);
    let better = hold("thesis.json", &[]);
    assert!(
        !better.err.contains("peak_penetration_ratio"),
        "{}",
        better.err
    );

    // Without the pulse the shipped wall's touch is softer.
    let tap = run(&["run", "tap", "--json"]).ended(0).out;
    std::fs::write(here.join("tap.json"), tap).unwrap();
    let tapped = |set: &str| {
        run_in(
            &here,
            &["run", "tap", "--baseline", "tap.json", "--set", set],
        )
    };
    tapped("law.impact.share_of_momentum=1").ended(0);
    let soft = tapped("law.impact.share_of_momentum=0").ended(3).err;
    for measure in ["extended_rate_hardness", "touch_torque_n_m"] {
        assert!(soft.contains(measure), "{soft}");
    }

    let other = hold("same.json", &["--k-desired", "4"]).ended(3).err;
    let none = "required a run to compare with, result none of this scene, law, stiffness";
    assert!(other.contains(none), "{other}");
    let missing = hold("missing.json", &[]).ended(2).err;
    assert!(missing.contains("missing.json"), "{missing}");
    std::fs::write(here.join("empty.json"), "{}").unwrap();
    assert!(
        hold("empty.json", &[])
            .ended(2)
            .err
            .contains("has no \"runs\"")
    );
}

/// Checks that the shipped wall meets the limits documented in docs/ci.md with every grip.
#[test]
fn the_demands_of_the_documented_script_are_met() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/ci.md");
    let text = std::fs::read_to_string(page).unwrap();
    let line = text
        .lines()
        .find(|line| line.trim_start().starts_with("--expect "))
        .expect("a line of demands");
    let demands: Vec<&str> = line.trim_end_matches('\\').split_whitespace().collect();
    assert!(demands.len() >= 6, "{demands:?}");
    for grip in ["light", "medium", "firm"] {
        let grip = format!("operator.grip={grip}");
        let mut arguments = vec!["run", "thesis-knob", "--set", &grip];
        arguments.extend(&demands);
        run(&arguments).ended(0);
    }
}

/// Checks a run at whose end the hand still taps. The program must not judge the wall by the hand's motion, and every output must
/// say why there is no verdict.
#[test]
fn what_cannot_be_judged_is_said_with_why() {
    let here = folder("not-judged");
    let mut text = String::from("time_s,angle_rad\n");
    for n in 0..4000 {
        let time = f64::from(n) / 1e3;
        text += &format!("{time},{:.6}\n", 0.1 * (19.0 * time).sin());
    }
    std::fs::write(here.join("taps.csv"), text).unwrap();
    let taps = |options: &[&str]| {
        let first = [
            "run",
            "low-stiffness",
            "--operator-motion",
            "taps.csv",
            "--set",
            "timing.duration_s=4",
        ];
        run_in(&here, &[&first[..], options].concat())
    };
    let why = "the hand never rests: it moves by ";
    let table = taps(&[]).ended(0).out;
    assert!(
        table.contains("not judged") && table.contains(why),
        "{table}"
    );
    let results = taps(&["--json"]).ended(0).json();
    assert_eq!(results["runs"][0]["verdict"], "not-judged");
    let said = results["runs"][0]["not_judged"].as_str().unwrap();
    assert!(said.starts_with(why), "{said}");
    let err = taps(&["--expect", "passive", "--junit", "taps.xml"])
        .ended(3)
        .err;
    assert!(
        err.contains(&format!("required passive, result not-judged: {said}")),
        "{err}"
    );
    let junit = std::fs::read_to_string(here.join("taps.xml")).unwrap();
    assert!(
        junit.contains(&format!("result not-judged: {said}")),
        "{junit}"
    );
    taps(&["--expect", "not-judged"]).ended(0);
}

/// Checks a run that is not judged but meets its demands. The JUnit file must not read as a wall that rests, nor as one that
/// failed.
#[test]
fn what_is_met_by_a_run_that_is_not_judged_is_no_verdict() {
    let here = folder("not-judged-met");
    let short = |options: &[&str], code: i32| {
        let first = [
            "run",
            "low-stiffness",
            "--set",
            "motion.hold_s=0.04",
            "--junit",
            "short.xml",
        ];
        let said = run_in(&here, &[&first[..], options].concat()).ended(code);
        let text = std::fs::read_to_string(here.join("short.xml")).unwrap();
        (said.err, text)
    };
    let why = "not-judged: the run shows only 10.0 ms of rest; at least 20 ms are needed";
    // Without a demand on the verdict, a skipped test says that there is no verdict.
    let met = ["--max-penetration", "10", "--max-energy-out", "10"];
    let (err, text) = short(&met, 0);
    let count = |part: &str| text.matches(part).count();
    assert_eq!((count("<testcase "), count("<failure")), (3, 0), "{text}");
    assert_eq!(count("<skipped "), 1, "{text}");
    assert!(
        text.contains("skipped=\"1\"") || text.contains("disabled"),
        "{text}"
    );
    assert!(
        text.contains(&format!("<skipped message=\"{why}\"")),
        "{text}"
    );
    assert_eq!(
        count(&format!("; the run is {why}</system-out>")),
        2,
        "{text}"
    );
    assert!(
        err.starts_with("note: the run is not judged") && err.lines().count() == 1,
        "{err}"
    );
    // A demand that is not met is a failure; the skipped test still says that there is no verdict.
    let (err, text) = short(&["--max-penetration", "0", "--max-energy-out", "10"], 3);
    let count = |part: &str| text.matches(part).count();
    assert_eq!((count("<failure "), count("<skipped ")), (1, 1), "{text}");
    assert!(err.starts_with("not met: --max-penetration"), "{err}");
    // With a demand on the verdict, the test of that demand names the reason, so no test is skipped.
    let (err, text) = short(&["--expect", "not-judged", "--max-penetration", "10"], 0);
    let count = |part: &str| text.matches(part).count();
    assert_eq!((count("<testcase "), count("<skipped ")), (2, 0), "{text}");
    assert!(
        text.contains(&format!("<system-out>result {why}</system-out>")),
        "{text}"
    );
    assert_eq!(err, "");
    // For a judged run, the file contains no such text.
    run_in(
        &here,
        &[
            "run",
            "low-stiffness",
            "--max-penetration",
            "10",
            "--junit",
            "short.xml",
        ],
    )
    .ended(0);
    let text = std::fs::read_to_string(here.join("short.xml")).unwrap();
    assert!(
        !text.contains("skipped ") && !text.contains("system-out"),
        "{text}"
    );
}
