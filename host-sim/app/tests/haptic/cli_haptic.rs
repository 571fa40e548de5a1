//! Tests of `touchstone device list`, `info`, `run` and `survey` with a mock of the omega.3's driver library. Each test runs the
//! program in a separate process.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use touchstone_mock_dhd::door::built;

use crate::common;

/// The program's command with the mock in place of the driver library; `plan` lists the faults that the mock produces.
pub fn program(folder: &Path, plan: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command
        .args(arguments)
        .current_dir(folder)
        .env("TOUCHSTONE_DHD", built())
        .env("TOUCHSTONE_MOCK_DHD", plan)
        .env("TOUCHSTONE_MOCK_LOG", folder.join("log"))
        .env("TOUCHSTONE_MOCK_LOCK", folder.join("lock"));
    command
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

pub fn ran(folder: &Path, plan: &str, arguments: &[&str]) -> Output {
    program(folder, plan, arguments).output().unwrap()
}

#[track_caller]
fn done(output: &Output) -> String {
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

#[track_caller]
pub fn failed(output: &Output, code: i32, parts: &[&str]) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert_eq!(said.lines().count(), 1, "one line: {said}");
    for part in parts {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// Checks the mock's log: the device was closed at zero force. Returns the last number in the log.
#[track_caller]
fn closed(folder: &Path) -> f64 {
    let log = std::fs::read_to_string(folder.join("log")).expect("it was closed");
    assert!(log.starts_with("closed true force 0 longest "), "{log}");
    log.trim().rsplit(' ').next().unwrap().parse().unwrap()
}

#[test]
fn without_the_library_it_is_said_what_where_and_how_to_mend_it() {
    let folder = common::folder("haptic-absent");
    let alone = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
        let sdk = folder.join("sdk");
        command
            .args(arguments)
            .env_remove("TOUCHSTONE_DHD")
            .env("FDSDK", sdk)
            .env("HOME", &folder);
        command.output().unwrap()
    };
    let run = alone(&["device", "run", "plane", "--seconds", "1"]);
    let looked = folder.join("sdk").join("lib").display().to_string();
    failed(
        &run,
        1,
        &[
            "Force Dimension's library: libdrd and libdhd were not found in",
            &looked,
            "set FDSDK",
            "--library FILE",
            "--device simulated",
        ],
    );
    let list = done(&alone(&["device", "list"]));
    assert!(
        list.contains("simulated omega.3") && list.contains("were not found"),
        "{list}"
    );
    let named = alone(&["device", "info", "--library", "/nowhere/libdrd.so"]);
    failed(&named, 1, &["/nowhere/libdrd.so cannot be loaded"]);
}

#[test]
fn the_device_is_found_and_shown_with_its_motors_off() {
    let folder = common::folder("haptic-info");
    let list = done(&ran(&folder, "", &["device", "list"]));
    assert!(
        list.contains("omega.3 (mock) no. 42; library 3.17.0"),
        "{list}"
    );
    let info = done(&ran(&folder, "", &["device", "info"]));
    for part in [
        "omega.3 (mock) no. 42",
        "3 axes, up to 12 N",
        "1000 to 4000 Hz",
        "calibrated yes, motors on no",
    ] {
        assert!(info.contains(part), "{part}: {info}");
    }
    assert_eq!(closed(&folder), 0.0);
    let doctor = text(&ran(&folder, "", &["doctor", "--port", "tcp:localhost:1"]).stdout);
    assert!(
        doctor.contains("library 3.17.0") && doctor.contains("no. 42"),
        "{doctor}"
    );
    let doctor = text(
        &ran(
            &folder,
            "uncalibrated",
            &["doctor", "--port", "tcp:localhost:1"],
        )
        .stdout,
    );
    assert!(
        doctor.contains("MISSING  omega.3") && doctor.contains("not calibrated"),
        "{doctor}"
    );
}

#[test]
fn a_wall_is_played_in_real_time_and_the_device_released() {
    let folder = common::folder("haptic-run");
    let said = ran(
        &folder,
        "",
        &["device", "run", "plane", "--seconds", "2", "--json"],
    );
    // A control tick that is 10 ms late is a fault, which may occur on a busy machine. The results must then name this fault.
    let results: serde_json::Value = serde_json::from_slice(&said.stdout).expect("JSON");
    let ticks = results["ticks"].as_u64().unwrap();
    match results["fault"].as_str() {
        None => {
            assert!(said.status.success(), "{}", text(&said.stderr));
            let due = ticks + results["missed_ticks"].as_u64().unwrap();
            assert!((7900..=8200).contains(&due), "{due}");
            assert!(closed(&folder) > 1.0, "a force was there");
        }
        Some(fault) => {
            assert!(fault.contains("ms late"), "{fault}");
            failed(&said, 1, &["ms late", "--rate-hz"]);
            closed(&folder);
        }
    }
    let classes = results["lateness"].as_array().unwrap();
    let counted: u64 = classes
        .iter()
        .map(|class| class["ticks"].as_u64().unwrap())
        .sum();
    assert!(
        counted == ticks || counted == ticks + 1,
        "{counted} of {ticks}"
    );
}

/// Checks that a run writes every control period as CSV. The forces in the file must be those of the run, the positions those of
/// the hand.
#[test]
fn a_run_is_kept_tick_by_tick() {
    let folder = common::folder("haptic-trace");
    let run = "device run plane --device simulated --fast --preset thesis --seconds 2 --csv run.csv --json";
    let said = done(&ran(&folder, "", &run.split(' ').collect::<Vec<_>>()));
    let results: serde_json::Value = serde_json::from_str(&said).unwrap();
    let mut file = csv::Reader::from_path(folder.join("run.csv")).unwrap();
    assert_eq!(file.headers().unwrap().get(0), Some("time_s"));
    let rows: Vec<Vec<f64>> = file
        .records()
        .map(|row| row.unwrap().iter().map(|x| x.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 8000);
    assert_eq!(rows[7999][0], 7999.0 / 4000.0);
    let longest = rows.iter().map(|row| row[4].hypot(row[5]).hypot(row[6]));
    assert_eq!(
        Some(longest.fold(0.0, f64::max)),
        results["force_max_n"].as_f64()
    );
    // A floor pushes only up, and only below its surface, because the thesis preset uses measured positions.
    assert!(
        rows.iter()
            .all(|row| row[6] >= 0.0 && (row[6] == 0.0 || row[3] < 0.0))
    );
    failed(
        &ran(&folder, "", &["device", "run", "plane", "--csv", "run.csv"]),
        2,
        &["--csv", "add --seconds"],
    );
    let card = &["device", "run", "plane", "--device", "simulated", "--fast"][..];
    let card = [card, &["--programme", "scorecard", "--csv", "card.csv"]].concat();
    let said = ran(&folder, "", &card);
    let code = said.status.code();
    assert!(matches!(code, Some(0 | 3)), "{}", text(&said.stderr));
    assert!(folder.join("card.csv").is_file());
}

/// Checks that a device simulated faster than real time gives the same results in two runs. With every control law and object the
/// run must end without a fault.
#[test]
fn a_simulated_device_plays_every_object_without_a_fault() {
    let folder = common::folder("haptic-fast");
    for object in ["plane", "inclined", "sphere"] {
        for extra in [
            &[][..],
            &["--per-axis"],
            &["--law", "spring", "--k-desired", "2"],
            // The name that scorecards have for the enhanced law.
            &["--law", "enhanced", "--k-desired", "2"],
            &["--rate-hz", "1000"],
        ] {
            let mut arguments = vec!["device", "run", object];
            arguments.extend("--device simulated --fast --seconds 5.4 --json".split(' '));
            arguments.extend(extra);
            let results: serde_json::Value =
                serde_json::from_str(&done(&ran(&folder, "", &arguments))).unwrap();
            let force = results["force_max_n"].as_f64().unwrap();
            assert!(
                (4.0..=12.0).contains(&force),
                "{object} {extra:?}: {force} N"
            );
            let account = results["guard_account_min_j"].as_f64().unwrap();
            assert!(
                (0.0..=0.04).contains(&account),
                "{object} {extra:?}: {account} J"
            );
            assert_eq!(
                (
                    results["missed_ticks"].as_u64(),
                    results["stale_ticks"].as_u64()
                ),
                (Some(0), Some(0))
            );
        }
    }
    let sphere = "device run sphere --device simulated --fast --seconds 2 --json";
    let sphere: Vec<&str> = sphere.split(' ').collect();
    let once = || done(&ran(&folder, "", &sphere));
    assert_eq!(once(), once());
}

#[test]
fn a_fault_ends_with_its_line_and_a_released_device() {
    let folder = common::folder("haptic-fault");
    for (plan, parts) in [
        (
            "fail dhdSetForce 900 1 2",
            &[
                "omega.3 (mock) no. 42: dhdSetForce failed: communication error (2)",
                "check its supply",
            ][..],
        ),
        ("nan 900", &["a position that is not a number"]),
        (
            "off 20 2",
            &["it switched its motors off: its velocity limit"],
        ),
    ] {
        // Without the guard: on a busy machine the hand moves on during a pause of the program, and the guard would end the run.
        let run = "device run sphere --seconds 20 --quiet --no-guard";
        let run: Vec<&str> = run.split(' ').collect();
        let said = ran(&folder, plan, &run);
        if text(&said.stderr).contains("ms late") {
            // On a busy machine, a late control tick ended the run before the fault under test.
            closed(&folder);
            continue;
        }
        failed(&said, 1, parts);
        closed(&folder);
    }
    failed(
        &ran(&folder, "absent", &["device", "run", "plane"]),
        1,
        &["no device found on USB", "docs/devices.md"],
    );
}

fn wait_for(file: &Path) {
    let begun = Instant::now();
    while !file.exists() {
        assert!(
            begun.elapsed() < Duration::from_secs(20),
            "no {}",
            file.display()
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn started(folder: &Path, seconds: &[&str]) -> Child {
    let rate = ["device", "run", "plane", "--rate-hz", "1000"];
    let arguments: Vec<&str> = rate.iter().chain(seconds).copied().collect();
    let child = program(folder, "", &arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(&folder.join("lock"));
    // Waits until the hand is in the wall.
    std::thread::sleep(Duration::from_millis(900));
    child
}

pub fn interrupt(child: &Child, signal: &str) {
    let number = child.id().to_string();
    assert!(
        Command::new("kill")
            .args([signal, &number])
            .status()
            .unwrap()
            .success()
    );
}

/// Checks that the program releases the device after Ctrl-C (SIGINT) or SIGTERM.
#[test]
fn an_interrupt_ends_with_a_released_device() {
    for (signal, seconds, code) in [("-INT", &[][..], 0), ("-TERM", &["--seconds", "30"], 130)] {
        let folder = common::folder(&format!("haptic-interrupt{signal}"));
        let child = started(&folder, seconds);
        interrupt(&child, signal);
        let output = child.wait_with_output().unwrap();
        if !text(&output.stderr).contains("ms late") {
            assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
            assert!(text(&output.stdout).contains("released  yes"));
        }
        closed(&folder);
    }
}

/// Checks that a second program gets an error when it opens a device that another program uses.
#[test]
fn a_second_program_is_told_that_the_first_has_it() {
    let folder = common::folder("haptic-held");
    let first = started(&folder, &[]);
    let second = ran(&folder, "", &["device", "run", "plane", "--seconds", "1"]);
    interrupt(&first, "-INT");
    let ended = first.wait_with_output().unwrap();
    if text(&ended.stderr).contains("ms late") {
        return;
    }
    failed(
        &second,
        1,
        &["omega.3: another program holds it", "end the other program"],
    );
}

#[test]
fn a_survey_becomes_a_plant() {
    let folder = common::folder("haptic-survey");
    let said = done(&ran(
        &folder,
        "",
        &["device", "survey", "--out", "mine.toml", "--seconds", "0.5"],
    ));
    assert!(
        said.contains("kg, mean of") && said.contains("--twin mine.toml"),
        "{said}"
    );
    assert_eq!(closed(&folder), 0.0, "its motors stayed off");
    let survey = std::fs::read_to_string(folder.join("mine.toml")).unwrap();
    for part in [
        "device = \"omega.3 (mock) no. 42\"",
        "effector_mass_kg = 0.148",
        "[[pose]]",
        "jacobian_m_per_rad",
    ] {
        assert!(survey.contains(part), "{part}: {survey}");
    }
    let run = [
        "device",
        "run",
        "plane",
        "--twin",
        "mine.toml",
        "--fast",
        "--seconds",
        "1",
    ];
    let twin = done(&ran(&folder, "", &run));
    assert!(twin.contains("simulated omega.3 (mock) no. 42"), "{twin}");
    let broken: PathBuf = folder.join("mine.toml");
    std::fs::write(&broken, survey.replace("inertia_kg = [", "inertia = [")).unwrap();
    failed(
        &ran(&folder, "", &run),
        2,
        &["mine.toml:", "survey:", "device survey"],
    );
    std::fs::write(
        &broken,
        survey.replacen("inertia_kg = [0.", "inertia_kg = [-0.", 1),
    )
    .unwrap();
    failed(&ran(&folder, "", &run), 2, &["--twin", "inertia"]);
}

#[test]
fn what_does_not_go_together_is_said() {
    let folder = common::folder("haptic-usage");
    for (words, parts) in [
        ("run plne", &["did you mean plane?"][..]),
        ("run plane --law sprin", &["did you mean spring?"]),
        (
            "run plane --fast",
            &["--fast", "a real device runs in real time only"],
        ),
        (
            "run plane --rate-hz 8000 --device simulated",
            &["--rate-hz", "1000 to 4000 Hz, not 8000"],
        ),
        (
            "run plane --device omega3 --twin x",
            &["--twin", "is for simulated only"],
        ),
        (
            "survey --device omega3 --twin x --out y",
            &["--twin", "is for simulated only"],
        ),
        (
            "list --device omega3 --haply a:1",
            &["--haply", "is for inverse3 only"],
        ),
        (
            "run plane --port COM3",
            &["--port", "haptic devices have none"],
        ),
        (
            "survey --device simulated --out x",
            &["the program does not know the mechanism"],
        ),
        ("lst", &["did you mean"]),
    ] {
        let words = format!("device {words}");
        let arguments: Vec<&str> = words.split(' ').collect();
        failed(&common::run_in(&folder, &arguments), 2, parts);
    }
}

/// Checks that a mesh of two triangles gives the same forces as the built-in floor, and that a file that is no mesh is refused
/// before the device moves.
#[test]
fn a_mesh_from_a_file_is_an_object() {
    let folder = common::folder("cli-haptic-mesh");
    let facet = |[a, b, c]: [&str; 3]| {
        format!(
            "facet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n"
        )
    };
    let [a, b, c, d] = ["-60 -60 0", "60 -60 0", "60 60 0", "-60 60 0"];
    let facets = [facet([a, b, c]), facet([a, c, d])].concat();
    std::fs::write(
        folder.join("floor.stl"),
        format!("solid f\n{facets}endsolid f\n"),
    )
    .unwrap();
    let force_max = |object: &str| {
        let run = ["device", "run", object, "--device", "simulated", "--fast"];
        let rest = [
            "--seconds",
            "2",
            "--law",
            "spring",
            "--k-desired",
            "2",
            "--json",
        ];
        let said = done(&ran(&folder, "", &[&run[..], &rest[..]].concat()));
        let value: serde_json::Value = serde_json::from_str(&said).unwrap();
        value["force_max_n"].as_f64().unwrap()
    };
    let (floor, mesh) = (force_max("plane"), force_max("floor.stl"));
    assert!(
        floor > 1.0 && (mesh - floor).abs() < 1e-3,
        "{floor} N, and {mesh} N"
    );
    failed(
        &ran(
            &folder,
            "",
            &[
                "device",
                "run",
                "none.stl",
                "--device",
                "simulated",
                "--fast",
            ],
        ),
        2,
        &["none.stl", "give an STL file"],
    );
}
