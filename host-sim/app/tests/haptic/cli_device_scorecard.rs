//! Tests of the scorecard that `touchstone device run` writes. On simulated devices its figures must match the simulator's. For
//! mocks of real devices it must name the figures that cannot be measured.

#[path = "../../../device/tests/haply_mock/mod.rs"]
#[expect(
    dead_code,
    reason = "its faults are played by the device crate's own tests"
)]
mod haply_mock;

use crate::common;
use haply_mock::{Service, Wrong};
use std::path::Path;
use std::process::{Command, Output};
use touchstone_control::LawKind;
use touchstone_lab::scorecard::direction::DirectionFigures;
use touchstone_lab::scorecard::in_turn::DEEDS;
use touchstone_lab::scorecard::measure::Measure;
use touchstone_lab::space_report;
use touchstone_lab::thesis::space::pressed::{PressedSurface, PressedWall};
use touchstone_lab::thesis::space::{self, Deviation, Mechanism};
use touchstone_mock_dhd::door::built;
use touchstone_report::plain_schema::misfit;
use touchstone_world::plant::FIRM_TRANSLATION;

fn ran(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_touchstone"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .env("TOUCHSTONE_DHD", built())
        .env("TOUCHSTONE_MOCK_DHD", "")
        .output()
        .unwrap()
}

#[track_caller]
fn results(folder: &Path, arguments: &str) -> serde_json::Value {
    let out = ran(folder, arguments);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.success(), "{said}");
    serde_json::from_slice(&out.stdout).expect("JSON")
}

fn figure<'a>(card: &'a serde_json::Value, key: &str) -> &'a serde_json::Value {
    let figures = card["figures"].as_array().expect("figures");
    let found = figures.iter().find(|figure| figure["key"] == key);
    found.unwrap_or_else(|| panic!("no {key}"))
}

#[track_caller]
fn value(card: &serde_json::Value, key: &str) -> f64 {
    let figure = figure(card, key);
    figure["value"]
        .as_f64()
        .unwrap_or_else(|| panic!("{figure}"))
}

/// Number of measured figures that exceed their limits or have no value.
fn beyond(card: &serde_json::Value) -> usize {
    let figures = card["figures"].as_array().expect("figures");
    figures
        .iter()
        .filter(|figure| figure["not_measured"].is_null())
        .filter_map(|figure| figure["limit"].as_f64().map(|limit| (figure, limit)))
        .filter(|(figure, limit)| figure["value"].as_f64().is_none_or(|value| value > *limit))
        .count()
}

/// The figures of the simulator, for comparison: the worst ones over all actions of the hand, for the same wall and hand. The
/// simulator uses the true depths.
fn simulated(normal: [f64; 3]) -> DirectionFigures {
    let wall = PressedWall {
        surface: PressedSurface::Plane([0.0; 3], normal),
        law: space::settings(LawKind::EnhancedSfa, 5.0),
        estimator: None,
        mechanism: Mechanism::Cartesian,
        deviation: Deviation::NONE,
        hand: FIRM_TRANSLATION,
        push_n: 8.0,
    };
    DEEDS
        .into_iter()
        .fold(DirectionFigures::NONE, |worst, deed| {
            worst.worst(&wall.played(deed).expect("settings"))
        })
}

/// Checks that the scorecard of a simulated device has the simulator's figures. The figures of depth may differ by half an encoder
/// count of each axis along the wall's normal, relative to the depth of 8 N in 5 N/mm. The tested wall gives energy, which is the
/// harder comparison.
///
/// The test uses no energy guard: on the device one energy account lasts for all actions, in the simulator each action has a new
/// account.
#[test]
fn a_simulated_device_has_the_simulators_figures() {
    let folder = common::folder("device-scorecard-equal");
    for object in [space::Object::Horizontal, space::Object::Inclined] {
        let word = match object {
            space::Object::Horizontal => "plane",
            _ => "inclined",
        };
        let run = format!(
            "device run {word} --device simulated --fast --programme scorecard --preset thesis --rate-hz 1000 --no-guard --out {word} --json"
        );
        let seen = results(&folder, &run)["scorecard"].clone();
        let known = simulated(object.normal()).figures;
        let across: f64 = object.normal().iter().map(|n| n.abs()).sum();
        let depth_share = 0.5e-5 * across / (8.0 / 5000.0);
        for (key, measure, within) in [
            (
                "peak_penetration_ratio",
                Measure::PeakPenetrationRatio,
                depth_share,
            ),
            (
                "stiffness_error_held",
                Measure::StiffnessErrorHeld,
                depth_share,
            ),
            ("modulus_error", Measure::ModulusError, depth_share),
            ("phase_deg", Measure::PhaseDeg, 0.2),
            ("ripple_rms_n", Measure::RippleRmsNM, 1e-3),
        ] {
            let (seen, known) = (value(&seen, key), known.get(measure));
            println!("{word} {key}: {seen} on the device, {known} in the simulator");
            assert!(
                (seen - known).abs() <= within,
                "{word} {key}: {seen} {known}"
            );
        }
        let page = std::fs::read_to_string(folder.join(word).join("index.html")).unwrap();
        assert!(page.contains("Scorecard") && page.contains("hardness N/mm"));
        assert!(folder.join(word).join("results.json").exists());
    }
}

/// Checks that the default wall of an omega.3 meets all six limits at every control rate that has a default wall. With the thesis'
/// settings the wall must exceed limits, and the program must warn of this before the run.
#[test]
fn the_default_wall_of_an_omega3_is_within_the_limits() {
    let folder = common::folder("device-scorecard-default");
    for (object, rest) in [
        ("plane", ""),
        ("plane", " --grip light"),
        ("plane", " --rate-hz 2000"),
        ("plane", " --rate-hz 1500"),
        ("plane", " --rate-hz 1000"),
        ("inclined", ""),
    ] {
        let run = format!(
            "device run {object} --device simulated --fast --programme scorecard{rest} --json"
        );
        let found = results(&folder, &run);
        assert_eq!(beyond(&found["scorecard"]), 0, "{run}: {found:#}");
        assert_eq!(found["wall"]["k_desired_n_per_m"], 25_000.0, "{run}");
        assert_eq!(found["wall"]["guarded"], true);
        assert!(found["wall"]["caution"].is_null(), "{found:#}");
    }
    let thesis = "device run plane --device simulated --fast --programme scorecard --preset thesis";
    let found = results(&folder, &format!("{thesis} --json"));
    assert_eq!(beyond(&found["scorecard"]), 6, "{found:#}");
    assert_eq!(found["wall"]["k_desired_n_per_m"], 5000.0);
    let said = String::from_utf8_lossy(&ran(&folder, thesis).stderr).into_owned();
    assert!(said.contains("--preset tuned keeps them"), "{said}");
    // No wall was tuned for rates between 1500 and 2000 Hz.
    let between = "device run plane --device simulated --fast --seconds 1 --rate-hz 1750";
    let said = String::from_utf8_lossy(&ran(&folder, between).stderr).into_owned();
    assert!(said.contains("above k_v"), "{said}");
}

/// Checks that the scorecard shows a bad wall as bad. A spring far too stiff for the device, without a guard, must exceed at
/// least four limits. A spring that the device holds stably must meet them.
#[test]
fn a_bad_wall_is_seen_as_bad_on_both_simulated_devices() {
    let folder = common::folder("device-scorecard-bad");
    for device in ["simulated", "simulated-delta"] {
        let card = |wall: &str| {
            let run = format!(
                "device run plane --device {device} --fast --programme scorecard --rate-hz 1000 --law spring {wall} --json"
            );
            results(&folder, &run)["scorecard"].clone()
        };
        let (calm, wild) = (card("--k-desired 3"), card("--k-desired 25 --no-guard"));
        assert_eq!(beyond(&calm), 0, "{device}: {calm:#}");
        assert!(beyond(&wild) >= 4, "{device}: {wild:#}");
        let given = |card| value(card, "energy_out_wall_j");
        assert!(given(&wild) > 10.0 * given(&calm), "{device}");
    }
}

/// Checks the scorecard of real devices (mocks), on which the program cannot command the hand. It must have figures of the motion
/// that the hand made, and give the reason for each figure that is missing.
#[test]
fn on_the_mocks_it_is_said_what_cannot_be_known() {
    let folder = common::folder("device-scorecard-mocks");
    let service = Service::new("3.5.1", Wrong::Nothing, 0);
    let devices = [
        ("omega", "--rate-hz 1000".to_owned()),
        ("inverse", format!("--haply {}", service.address)),
    ];
    for (name, which) in devices {
        let run = format!(
            "device run plane {which} --seconds 6 --late-limit-ms 500 --k-desired 1 --out {name} --json"
        );
        let found = results(&folder, &run);
        assert_eq!(found["late_limit_ms"], 500.0);
        let card = &found["scorecard"];
        assert_eq!(card["commanded"], false);
        let peak = figure(card, "peak_penetration_ratio");
        assert!(peak["value"].is_null(), "{peak}");
        let why = peak["not_measured"].as_str().expect("why");
        assert!(why.contains("no F/k_de"), "{why}");
        assert!(value(card, "stiffness_error").is_finite());
        assert!(value(card, "energy_out_wall_worst_window_j").is_finite());
        let kept = std::fs::read_to_string(folder.join(name).join("results.json")).unwrap();
        let kept: serde_json::Value = serde_json::from_str(&kept).unwrap();
        assert_eq!(kept["run"]["scorecard"], *card);
        let schema = space_report::schema::device_run();
        assert_eq!(misfit(&schema, &kept, name), None);
        let mut more = kept.clone();
        more["run"]["wall"]["more"] = 1.into();
        assert!(misfit(&schema, &more, name).is_some());
        assert!(
            kept["run"]["lateness"]
                .as_array()
                .is_some_and(|it| !it.is_empty())
        );
        let page = std::fs::read_to_string(folder.join(name).join("index.html")).unwrap();
        assert!(page.contains("not measured") && page.contains("How late ticks began"));
        if name == "omega" {
            // The hand moves up and down in the wall at 6 rad/s (0.955 Hz).
            let moved = card["moved"].as_array().expect("rhythms");
            let near = |at: &serde_json::Value| {
                (at["frequency_hz"].as_f64().unwrap_or(0.0) - 0.955).abs() < 0.05
            };
            assert!(!moved.is_empty() && moved.iter().all(near), "{moved:?}");
        }
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = common::folder("device-scorecard-usage");
    for (arguments, part) in [
        ("device run plane --programme scorecard", "--programme"),
        (
            "device run plane --device simulated --fast --out x",
            "--seconds",
        ),
        (
            "device run plane --device simulated --grip light --seconds 1",
            "--grip",
        ),
        (
            "device run plane --device simulated --programme scorecard --seconds 1",
            "--seconds",
        ),
        (
            "device run plane --device simulated --late-limit-ms 0",
            "--late-limit-ms",
        ),
        (
            "device run plane --device simulated --preset tuned --law spring",
            "--preset thesis",
        ),
        (
            "device run plane --device simulated --preset tuned --rate-hz 1750",
            "there is no tuned law",
        ),
        (
            "device identify --device simulated --fast --rate-hz 8000",
            "1000 to 4000 Hz, not 8000",
        ),
    ] {
        let out = common::run_in(&folder, arguments.split(' '));
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{said}");
        assert!(said.contains(part), "{said}");
    }
}
