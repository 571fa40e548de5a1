//! Tests of a report's folder: it records how its files were made, and every run in it can be repeated from it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::common;

fn folder(test: &str) -> PathBuf {
    common::folder(&format!("cli-folder-{test}"))
}

fn run_in(folder: &Path, arguments: &str) -> Output {
    common::run_in(folder, arguments.split_whitespace())
}

#[track_caller]
fn done(folder: &Path, arguments: &str) {
    let output = run_in(folder, arguments);
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{err}");
}

#[track_caller]
fn refused(folder: &Path, arguments: &str) -> String {
    let output = run_in(folder, arguments);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    err
}

fn results(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("results.json")).unwrap()).unwrap()
}

fn schema_file(name: &str) -> PathBuf {
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema");
    Path::new(docs).join(format!("{name}.schema.json"))
}

/// Whether each of `instances` is valid under a documented JSON schema. A Python validator decides, which shares no code with the
/// program.
fn valid(here: &Path, schema: &str, instances: &[Value]) -> Vec<bool> {
    const PROGRAM: &str = "
import json, jsonschema, sys
schema = json.load(open(sys.argv[1]))
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
for instance in json.load(open(sys.argv[2])):
    print(validator.is_valid(instance))
    for error in validator.iter_errors(instance):
        print(error.message, file=sys.stderr)
";
    let file = here.join("instances.json");
    std::fs::write(&file, Value::from(instances).to_string()).unwrap();
    let output = Command::new("python3")
        .args(["-c", PROGRAM])
        .arg(schema_file(schema))
        .arg(&file)
        .output()
        .unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{err}");
    let out = String::from_utf8(output.stdout).unwrap();
    let said: Vec<bool> = out.lines().map(|line| line == "True").collect();
    assert_eq!(said.len(), instances.len(), "{err}");
    println!("{err}");
    said
}

/// Data pages of all columns of a Parquet file: the bytes before the footer. The footer also holds the command line, which differs
/// between runs.
fn pages(file: &[u8]) -> &[u8] {
    let end = file.len() - 8;
    let footer = u32::from_le_bytes(file[end..end + 4].try_into().unwrap()) as usize;
    &file[..end - footer]
}

/// Runs the command `first`, repeats the run from the scene file in its report's folder, and checks that both results are equal.
#[track_caller]
fn assert_made_again(here: &Path, first: &str) {
    done(here, &format!("{first} --out a"));
    // Only the results folder remains, and it has been renamed.
    std::fs::rename(here.join("a"), here.join("kept")).unwrap();
    let _ = std::fs::remove_file(here.join("motion.csv"));
    done(here, "run kept/scene.toml --out b");
    let (a, b) = (results(&here.join("kept")), results(&here.join("b")));
    assert_eq!(a["runs"], b["runs"]);
    let read = |folder: &str, name: &Value| {
        std::fs::read(here.join(folder).join(name.as_str().unwrap())).unwrap()
    };
    let run = &a["runs"][0];
    for file in ["trace_csv", "scene_file"] {
        let (a, b) = (read("kept", &run[file]), read("b", &run[file]));
        assert!(a == b && a.len() > 1000, "{file}");
    }
    let parquet = &run["trace_parquet"];
    let (a, b) = (read("kept", parquet), read("b", parquet));
    assert!(pages(&a) == pages(&b) && pages(&a).len() > 1000);
    let _ = std::fs::remove_dir_all(here.join("kept"));
    let _ = std::fs::remove_dir_all(here.join("b"));
}

#[test]
fn a_run_is_made_again_from_its_folder() {
    let here = folder("again");
    for changes in [
        "",
        "--law fba --k-desired 2.5",
        "--set device.inertia_kg_m2=1.7e-4 --set timing.duration_s=5.3",
        "--set law.number=fixed16 --set encoder.counts_per_rev=16384",
    ] {
        assert_made_again(&here, &format!("run thesis-knob {changes}"));
    }
    let rows: String = (0..400)
        .map(|i| {
            let t = f64::from(i) * 0.005;
            format!("{t},{}\n", 0.1 * (6.0 * t).sin())
        })
        .collect();
    std::fs::write(here.join("motion.csv"), format!("time_s,angle_rad\n{rows}")).unwrap();
    assert_made_again(&here, "run tap --operator-motion motion.csv");
}

#[test]
fn a_cell_of_the_comparison_is_made_again_and_the_comparison_repeats() {
    let here = folder("cells");
    done(&here, "thesis --no-csv --out report");
    let first = results(&here.join("report"));
    let runs = first["runs"].as_array().unwrap();
    // Each run has its own scene file. For runs without figures the page names the command.
    let page = std::fs::read_to_string(here.join("report/index.html")).unwrap();
    let mut scenes = std::collections::HashSet::new();
    for run in runs {
        let scene = run["scene_file"].as_str().unwrap();
        assert!(scenes.insert(scene));
        if run["trace_parquet"].is_null() {
            assert!(page.contains(&format!("touchstone run {scene} --out plots/")));
        }
        assert!(run.get("trace_csv").is_none());
    }
    for index in [3, 20, 47, 104] {
        let scene = runs[index]["scene_file"].as_str().unwrap();
        done(&here, &format!("run report/{scene} --out cell --force"));
        let again = results(&here.join("cell"));
        for (field, value) in again["runs"][0].as_object().unwrap() {
            if !field.starts_with("trace_") && field != "scene_file" {
                assert_eq!(value, &runs[index][field], "{index}: {field}");
            }
        }
    }
    // The comparison is repeated into the same folder.
    done(&here, "thesis --no-csv --out report");
    assert_eq!(first, results(&here.join("report")));
}

#[test]
fn results_of_another_command_are_not_overwritten() {
    let here = folder("other");
    done(&here, "run tap --out out");
    done(&here, "run tap --out out");
    let before = results(&here.join("out"));
    let err = refused(&here, "run tap --law fba --out out");
    assert!(
        err.contains("touchstone run tap --out out") && err.contains("--force"),
        "{err}"
    );
    assert_eq!(before, results(&here.join("out")));
    done(&here, "run tap --law fba --out out --force");
    let after = results(&here.join("out"));
    assert_eq!(after["runs"][0]["law"], "fba");
    // No trace of the replaced report is left in the folder.
    let traces = std::fs::read_dir(here.join("out/traces")).unwrap();
    for file in traces {
        let name = file.unwrap().file_name().into_string().unwrap();
        assert!(name.contains("_fba_"), "{name}");
    }
}

#[test]
fn the_folder_says_where_it_is_from() {
    let here = folder("origin");
    done(&here, "run tap --out first");
    std::fs::copy(here.join("first/scene.toml"), here.join("mine.toml")).unwrap();
    done(&here, "run mine.toml --every 5 --out out");
    let json = results(&here.join("out"));
    assert_eq!(json["schema_version"], 1);
    assert_eq!(
        json["command"],
        "touchstone run mine.toml --every 5 --out out"
    );
    assert_eq!(json["trace_every"], 5);
    assert_eq!(json["inputs"][0]["path"], "mine.toml");
    // The scene is in canonical form, so the file that was read and the file that is written have the same hash.
    let run = &json["runs"][0];
    assert_eq!(json["inputs"][0]["sha256"], run["scene_sha256"]);
    for file in json["files"].as_array().unwrap() {
        assert!(here.join("out").join(file.as_str().unwrap()).is_file());
    }
    let csv = run["trace_csv"].as_str().unwrap();
    let text = std::fs::read_to_string(here.join("out").join(csv)).unwrap();
    let ticks = run["ticks"].as_u64().unwrap();
    assert_eq!(text.lines().count() as u64, 1 + ticks.div_ceil(5));
    let sidecar = here.join(format!("out/{csv}-metadata.json"));
    let sidecar: Value = serde_json::from_slice(&std::fs::read(sidecar).unwrap()).unwrap();
    let notes = &sidecar["notes"][0];
    assert_eq!(notes["trace_every"], 5);
    assert_eq!(notes["command"], json["command"]);
    assert_eq!(notes["scene_sha256"], run["scene_sha256"]);
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let columns = sidecar["tableSchema"]["columns"].as_array().unwrap();
    assert_eq!(
        header,
        columns.iter().map(|c| &c["name"]).collect::<Vec<_>>()
    );
    // The footer of the Parquet file contains the same information as text.
    let parquet = here
        .join("out")
        .join(run["trace_parquet"].as_str().unwrap());
    let parquet = std::fs::read(parquet).unwrap();
    let footer = String::from_utf8_lossy(&parquet[pages(&parquet).len()..]).into_owned();
    for words in [
        json["command"].as_str().unwrap(),
        "schema_version",
        "[operator",
    ] {
        assert!(footer.contains(words), "{words}");
    }
}

#[test]
#[ignore = "needs Python's jsonschema: cargo xtask schema"]
fn results_obey_the_documented_schema_and_it_refuses_others() {
    let here = folder("schema");
    done(&here, "thesis --no-csv --out report");
    done(&here, "run free-release --out free");
    let printed = run_in(&here, "run tap --json").stdout;
    let printed: Value = serde_json::from_slice(&printed).unwrap();
    let written = results(&here.join("free"));
    let good = [printed, written.clone(), results(&here.join("report"))];
    assert_eq!(valid(&here, "results", &good), [true; 3]);

    let spoilt = |change: fn(&mut Value)| {
        let mut json = written.clone();
        change(&mut json);
        json
    };
    let bad = [
        spoilt(|json| json["runs"][0]["verdict"] = "fine".into()),
        spoilt(|json| json["runs"][0]["force_max"] = "0.1".into()),
        spoilt(|json| json["runs"][0]["more"] = 1.into()),
        spoilt(|json| json["runs"][0]["scene_sha256"] = "abc".into()),
        spoilt(|json| json["units"]["force_max"] = "N".into()),
        spoilt(|json| json["schema_version"] = 2.into()),
        spoilt(|json| json["files"][0] = json["files"][1].clone()),
    ];
    assert_eq!(valid(&here, "results", &bad), [false; 7]);
}

/// The two kinds of file that a user writes, each with the command that prints its JSON schema.
const WRITTEN: [(&str, &str); 2] = [
    ("scene", "scenes --json-schema"),
    ("settings", "config schema --json-schema"),
];

#[test]
fn the_documented_schemas_are_those_that_the_program_prints() {
    let here = folder("printed");
    for (name, command) in WRITTEN {
        let printed = String::from_utf8(run_in(&here, command).stdout).unwrap();
        if std::env::var_os("TOUCHSTONE_WRITE_SCHEMA").is_some() {
            std::fs::write(schema_file(name), &printed).unwrap();
        }
        let documented = std::fs::read_to_string(schema_file(name)).unwrap();
        assert!(
            documented == printed && printed.len() > 1000,
            "write it anew: TOUCHSTONE_WRITE_SCHEMA=1 cargo test -p touchstone --test cli documented_schemas"
        );
    }
}

#[test]
#[ignore = "needs Python's jsonschema: cargo xtask schema"]
fn scenes_obey_their_documented_schema_and_it_refuses_others() {
    let here = folder("schema-scene");
    let scene = |arguments: &str| -> Value {
        let text = String::from_utf8(run_in(&here, arguments).stdout).unwrap();
        let table: toml::Table = text.parse().unwrap();
        serde_json::to_value(table).unwrap()
    };
    let names = touchstone_sim::scene::names();
    let good: Vec<Value> = (names.iter())
        .map(|name| scene(&format!("run {name} --print")))
        .collect();
    assert_eq!(valid(&here, "scene", &good), vec![true; names.len()]);
    // `feel` is another name of `environment`, and no scene has both.
    let mut feel = scene("run five-positions --print");
    feel["feel"] = feel["environment"].clone();
    let both = feel.clone();
    feel.as_object_mut().unwrap().remove("environment");
    assert_eq!(valid(&here, "scene", &[feel, both]), [true, false]);
    // The program refuses each of these scenes.
    let spoilt = [
        ("law", "kind", Value::from("sponge")),
        ("device", "inertia_kg_m2", 0.into()),
        ("timing", "rate_hz", 1000.5.into()),
        ("timing", "rate_hz", 100_001.into()),
        ("timing", "computational_delay_s", "0".into()),
        ("wall", "colour", "red".into()),
        ("feel", "colour", "red".into()),
    ];
    let bad = spoilt.map(|(table, field, value)| {
        let mut json = good[0].clone();
        json[table][field] = value;
        let text = toml::to_string(&json).unwrap();
        std::fs::write(here.join("spoilt.toml"), text).unwrap();
        refused(&here, "run spoilt.toml --print");
        json
    });
    assert_eq!(valid(&here, "scene", &bad), [false; 7]);
}

#[test]
#[ignore = "needs Python's jsonschema: cargo xtask schema"]
fn settings_obey_their_documented_schema_and_it_refuses_others() {
    use serde_json::json;
    let here = folder("schema-settings");
    // A value of each type and at each type's limits.
    let good = [
        json!({}),
        json!({"wall": {"k_desired_n_m_per_rad": 0, "surface_rad": -100}, "law": {"kind": "tdpa", "filter": {"mass_kg_m2": 1e-6}}}),
        json!({"timing": {"rate_hz": 10_000}, "encoder": {"reversed": true}}),
    ];
    assert_eq!(valid(&here, "settings", &good), [true; 3]);
    let bad = [
        json!({"wall": {"k_desired_n_m_per_rad": -1}}),
        json!({"wall": {"k_desired": 1}}),
        json!({"law": {"kind": "sponge"}}),
        json!({"timing": {"rate_hz": 10_001}}),
        json!({"timing": {"rate_hz": 1000.5}}),
        json!({"encoder": {"reversed": 1}}),
    ];
    assert_eq!(valid(&here, "settings", &bad), [false; 6]);
}

#[test]
#[ignore = "needs Python's jsonschema: cargo xtask schema"]
fn accuracy_and_hard_cases_obey_their_documented_schemas() {
    let here = folder("schema-accuracy");
    for (name, command, field) in [
        ("accuracy", "accuracy --quick --json", "plant"),
        (
            "hard",
            "hard --only stick --only mass-ratio --json",
            "cases",
        ),
    ] {
        let printed: Value = serde_json::from_slice(&run_in(&here, command).stdout).unwrap();
        let mut spoilt = printed.clone();
        spoilt[field][0]["more"] = 1.into();
        let mut less = printed.clone();
        less.as_object_mut().unwrap().remove(field);
        let said = valid(&here, name, &[printed, spoilt, less]);
        assert_eq!(said, [true, false, false], "{name}");
    }
}

#[test]
#[ignore = "needs Python's jsonschema: cargo xtask schema"]
fn what_other_commands_write_obeys_its_documented_schema() {
    let here = folder("schema-others");
    let device = "device run plane --device simulated --fast --seconds 3 --out device-run";
    let map = "sweep tap --x device.inertia_kg_m2=1e-4,2e-4 --y timing.rate_hz=1000,2000";
    let map = format!("{map} --out sweep");
    for (name, command, field) in [
        ("sweep", map.as_str(), "measures"),
        ("device-run", device, "run"),
        (
            "thesis-space",
            "thesis --dof 3 --no-csv --out thesis-space",
            "runs",
        ),
    ] {
        done(&here, command);
        check(&here, name, results(&here.join(name)), field);
    }
    let plan: Value = serde_json::from_slice(&run_in(&here, "plan tap --json").stdout).unwrap();
    check(&here, "plan", plan, "effects");

    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/delta-ball.toml");
    let scene: toml::Table = std::fs::read_to_string(scene).unwrap().parse().unwrap();
    let scene = serde_json::to_value(scene).unwrap();
    check(&here, "space-scene", scene, "dof");
}

/// Checks a JSON schema: `good` is valid, `good` with an unknown field is invalid, and `good` without the required `field` is
/// invalid.
fn check(here: &Path, name: &str, good: Value, field: &str) {
    let mut more = good.clone();
    more["more"] = 1.into();
    let mut less = good.clone();
    less.as_object_mut().unwrap().remove(field).unwrap();
    let said = valid(here, name, &[good, more, less]);
    assert_eq!(said, [true, false, false], "{name}");
}
