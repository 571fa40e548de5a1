//! Runs the program with invalid input. Each error is one line that names file or option, field and remedy; the exit code is 2, and
//! no file is written.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Folder for one test, empty at the start.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-errors-{test}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(&self.0)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// Runs the program in this folder.
    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_touchstone"))
            .args(arguments)
            .current_dir(&self.0)
            .output()
            .unwrap()
    }

    /// Runs the program, and checks that it refuses its input: exit code 2, one line of error with all `parts`, and no new file.
    #[track_caller]
    fn refused(&self, arguments: &[&str], parts: &[&str]) {
        let before = self.names();
        let output = self.run(arguments);
        let (out, err) = (text(&output.stdout), text(&output.stderr));
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
        assert_eq!(err.lines().count(), 1, "one line: {err}");
        assert!(err.starts_with("error: "), "{err}");
        for part in parts {
            assert!(err.contains(part), "{err:?} does not name {part:?}");
        }
        assert!(err.contains("; "), "problem; fix: {err}");
        assert_eq!(out, "", "{arguments:?}");
        assert_eq!(self.names(), before, "nothing is half-written");
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Text of a scene of ten lines: the text `device` is line 3, the text `law` begins on line 8.
fn scene(device: &str, law: &str) -> String {
    format!(
        "name = \"small\"\n[device]\n{device}\n[timing]\nrate_hz = 1000\nduration_s = 0.2\n[law]\n{law}\n[operator]\ngrip = \"none\"\n"
    )
}

const GOOD: &str = "inertia_kg_m2 = 1e-4";

#[test]
fn a_good_scene_runs_so_that_the_refusals_below_are_for_their_own_reasons() {
    let folder = Folder::new("good");
    folder.write("small.toml", &scene(GOOD, ""));
    let output = folder.run(&["run", "small.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(folder.names(), ["out", "small.toml"]);
}

#[test]
fn what_is_wrong_in_a_scene_is_named_with_file_line_field_and_fix() {
    let folder = Folder::new("scene");
    let cases: [(&str, &[&str]); 6] = [
        ("colour = 3", &["bad.toml:3:", "colour", "unknown field"]),
        (
            "inertai_kg_m2 = 1e-4",
            &[
                "bad.toml:3:",
                "inertai_kg_m2",
                "did you mean inertia_kg_m2?",
            ],
        ),
        (
            "inertia_g_m2 = 0.1",
            &[
                "bad.toml:3:",
                "inertia_g_m2",
                "wrong unit",
                "inertia_kg_m2 = 0.0001",
            ],
        ),
        (
            "inertia_kg_m2 = nan",
            &["bad.toml:3:", "inertia_kg_m2", "NaN", "finite"],
        ),
        (
            "inertia_kg_m2 = -1e-4",
            &["bad.toml:3:", "inertia_kg_m2", "above 0", "-0.0001"],
        ),
        (
            "inertia_kg_m2 = \"heavy\"",
            &["bad.toml:3:", "inertia_kg_m2", "number", "heavy"],
        ),
    ];
    for (line, parts) in cases {
        folder.write("bad.toml", &scene(line, ""));
        folder.refused(&["run", "bad.toml", "--out", "out"], parts);
    }
    folder.write("bad.toml", "name = \"small\"\n[device\n");
    folder.refused(&["run", "bad.toml", "--out", "out"], &["bad.toml:2:"]);
    folder.refused(
        &["run", "thesis-knop", "--out", "out"],
        &["thesis-knop", "did you mean", "thesis-knob"],
    );
}

#[test]
fn what_is_wrong_on_the_command_line_is_named_with_its_option() {
    let folder = Folder::new("option");
    let cases: [(&[&str], &[&str]); 6] = [
        (
            &["--set", "device.inertai_kg_m2=1e-4"],
            &["--set device.inertai_kg_m2", "did you mean inertia_kg_m2?"],
        ),
        (
            &["--set", "device.inertia_kg_m2=nan"],
            &["--set device.inertia_kg_m2", "NaN"],
        ),
        (
            &["--set", "device.inertia_kg_m2=-1"],
            &["--set device.inertia_kg_m2", "above 0"],
        ),
        (
            &["--set", "device.inertia=1e-4"],
            &["--set device.inertia", "unit", "inertia_kg_m2"],
        ),
        (&["--law", "sfa2"], &["--law", "sfa2", "did you mean sfa?"]),
        (
            &["--k-desired", "inf"],
            &["--k-desired", "finite", "N·m/rad"],
        ),
    ];
    for (options, parts) in cases {
        let mut arguments = vec!["run", "tap", "--out", "out"];
        arguments.extend(options);
        folder.refused(&arguments, parts);
    }
}

#[test]
fn a_value_outside_its_number_format_is_refused_where_it_stands() {
    let folder = Folder::new("format");
    folder.refused(
        &[
            "run",
            "tap",
            "--set",
            "law.number=fixed16",
            "--k-desired",
            "400000",
            "--out",
            "out",
        ],
        &["--k-desired", "400000", "fixed16", "fixed32"],
    );
    folder.write(
        "bad.toml",
        &scene(
            GOOD,
            "number = \"fixed16\"\nk_soft_n_m_per_rad = 600.0\nkind = \"sfa\"",
        ),
    );
    folder.refused(
        &["run", "bad.toml", "--out", "out"],
        &["bad.toml:9:", "k_soft_n_m_per_rad", "600", "fixed16"],
    );
    // The 32-bit format accepts the stiffness of 400,000 N·m/rad.
    let output = folder.run(&["run", "tap", "--k-desired", "400000", "--json"]);
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_recording_that_is_none_is_refused_with_file_line_and_column() {
    let folder = Folder::new("recording");
    let cases: [(&str, &[&str]); 6] = [
        ("", &["hand.csv:1:", "empty", "header"]),
        ("time_s,angle_deg\n", &["hand.csv:1:", "no row"]),
        (
            "time_s,angle_deg\n0,1\n0.2,2\n0.1,3\n0.3,4\n",
            &["hand.csv:4:", "time_s", "0.1 comes after 0.2", "sort"],
        ),
        (
            "time_s,angle_deg\n0,1\n0.1,nan\n0.2,3\n",
            &["hand.csv:3:", "angle_deg", "not a finite number"],
        ),
        (
            "time_s,angle_deg\n0,1\n0.1,two\n0.2,3\n",
            &["hand.csv:3:", "angle_deg", "two"],
        ),
        (
            "time_s,angle_furlong\n0,1\n0.1,2\n0.2,3\n",
            &["hand.csv:1:", "angle_furlong", "_deg"],
        ),
    ];
    for (csv, parts) in cases {
        folder.write("hand.csv", csv);
        folder.refused(
            &[
                "run",
                "tap",
                "--operator-motion",
                "hand.csv",
                "--out",
                "out",
            ],
            parts,
        );
    }
    folder.refused(
        &[
            "run",
            "tap",
            "--operator-motion",
            "missing.csv",
            "--out",
            "out",
        ],
        &["missing.csv", "no such file"],
    );
}

#[test]
fn a_folder_that_cannot_be_written_is_named_and_what_is_there_stays() {
    let folder = Folder::new("unwritable");
    folder.write("file", "kept\n");
    // Writing to a path below a regular file fails for every user, also for root.
    for command in [
        &["run", "tap", "--out", "file/report"][..],
        &["run", "tap", "--out", "file"],
        &["thesis", "--out", "file/report"],
    ] {
        let output = folder.run(command);
        let err = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
        assert!(
            err.contains("error: file") && err.contains("give --out another folder"),
            "{err}"
        );
        assert_eq!(folder.names(), ["file"]);
        assert_eq!(
            std::fs::read_to_string(folder.0.join("file")).unwrap(),
            "kept\n"
        );
    }
}

#[test]
fn a_live_page_replaces_its_own_kind_only() {
    let folder = Folder::new("live");
    folder.write("thesis.html", "<!doctype html>\n<title>mine</title>\n");
    let words = ["live", "tap", "--no-open", "--out"];
    let with = |file| [&words[..], &[file]].concat();
    folder.refused(
        &with("thesis.html"),
        &["thesis.html", "is not a page", "--out"],
    );
    folder.refused(&with("nowhere/page.html"), &["nowhere/page.html", "--out"]);
    folder.refused(&["live", "tapp", "--no-open"], &["tapp", "did you mean"]);
    for law in ["spring", "fba"] {
        let output = folder.run(&[&with("page.html")[..], &["--law", law, "--json"]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let page = std::fs::read_to_string(folder.0.join("page.html")).unwrap();
        assert_eq!(said["bytes"], page.len());
        assert!(
            page.contains(&format!("kind = \\\"{law}\\\"")),
            "{law} is in the scene"
        );
        assert!(
            page.contains(&format!("tap --law {law}")),
            "and in the command"
        );
    }
    assert_eq!(folder.names(), ["page.html", "thesis.html"]);
}
