//! Tests with typical inputs of users: a folder of cases, if present, and paths that are not valid UTF-8.

use crate::{Said, folder, run_in};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The expected outcome of a case: what the program must print or refuse.
enum Right {
    /// The input is accepted and the output contains all these parts.
    Said(&'static [&'static str]),
    /// The input is accepted without a note.
    Quiet,
    /// The input is refused with this message.
    Refused(&'static str),
    /// The input is accepted, and the verdict is neither a limit cycle nor instability: the hand causes the motion, not the wall.
    NotTheWall,
    /// Every cell of the CSV file that the program writes is a decimal number.
    Decimals,
}

/// Expected outcome of a case, by its folder and file.
fn right(case: &str, file: &str) -> Option<Right> {
    use Right::{Decimals, NotTheWall, Quiet, Refused, Said};
    Some(match (case, file) {
        ("03-stl-uppercase" | "04-stl-spacing", _) => Said(&["12 triangles", "most      5.30 N"]),
        ("06-stl-two-solids", _) => Said(&["24 triangles", "has 2 solids", "most      5.30 N"]),
        ("08-stl-inverted", "half.stl") => Said(&["edges run the same way", "inside out"]),
        ("08-stl-inverted", _) => Said(&["its volume is -288.000 cm³: the mesh is inside out"]),
        ("10-stl-broken", "countless.stl") => {
            Refused("6 triangles, but its 600 bytes of data hold 12")
        }
        ("10-stl-broken", _) => Refused("no STL: "),
        ("12-stl-far", "far.stl" | "offset1m.stl") => {
            Said(&["does not meet the device's workspace"])
        }
        ("12-stl-far", "metres.stl" | "micron.stl") => {
            Said(&["mm across: check that --mesh-unit-m is the file's unit"])
        }
        ("12-stl-far", _) => Quiet,
        ("23-csv-time", "gap.csv") => Said(&["a gap of 3.000 s after 2.250 s"]),
        ("23-csv-time" | "28-csv-burst", _) => Said(&["samples come in bursts"]),
        ("24-csv-values", "wrap360.csv") => Said(&["by a whole turn between two samples, 3 times"]),
        ("24-csv-values", _) => Said(&["is faster than a hand"]),
        ("25-csv-header", _) => Said(&["from 0.200 to 0.800 rad"]),
        ("27-csv-ragged", "right.csv") => Said(&["from 0.151 to 0.849 rad"]),
        ("27-csv-ragged", "unescaped-comma-note.csv") => Refused(".csv:1003: row: 4 cells"),
        ("27-csv-ragged", "concat.csv") => Refused(".csv:2002: time_s: "),
        ("27-csv-ragged", _) => Refused(".csv:2: "),
        ("29-csv-tapping", _) => NotTheWall,
        ("60-device-csv", _) => Decimals,
        _ => return None,
    })
}

fn said_of(here: &Path, file: &str) -> Said {
    if file.ends_with(".csv") {
        let first = [
            "run",
            "low-stiffness",
            "--preset",
            "thesis",
            "--law",
            "spring",
        ];
        return run_in(here, &[&first[..], &["--operator-motion", file]].concat());
    }
    let run = [
        "device",
        "run",
        file,
        "--device",
        "simulated",
        "--fast",
        "--seconds",
        "2",
    ];
    run_in(
        here,
        &[&run[..], &["--csv", "ticks.csv", "--force"]].concat(),
    )
}

fn check(here: &Path, file: &Path, right: &Right) {
    let name = file.display().to_string();
    let begun = Instant::now();
    let said = said_of(here, &name);
    assert!(begun.elapsed() < Duration::from_secs(30), "{name}");
    let text = format!("{}{}", said.out, said.err);
    if let Right::Refused(part) = right {
        assert!(said.code == Some(2) && said.err.contains(part), "{text}");
        assert_eq!(said.err.lines().count(), 1, "{text}");
        return;
    }
    assert_eq!(said.code, Some(0), "{text}");
    match right {
        Right::Said(parts) => parts
            .iter()
            .for_each(|part| assert!(text.contains(part), "{name}: {part}: {text}")),
        Right::Quiet => assert!(!text.contains("note: "), "{name}: {text}"),
        Right::NotTheWall => assert!(
            !text.contains("limit cycle\n") && !text.contains("unstable"),
            "{name}: {text}"
        ),
        Right::Decimals => {
            let csv = std::fs::read_to_string(here.join("ticks.csv")).unwrap();
            let mut cells = csv.lines().skip(1).flat_map(|row| row.split(','));
            assert!(cells.all(|cell| cell.contains('.')), "{name}");
        }
        Right::Refused(_) => {}
    }
}

/// Folder of the cases: beside the repository, or from the environment variable `TOUCHSTONE_CASES`.
fn cases() -> PathBuf {
    match std::env::var_os("TOUCHSTONE_CASES") {
        Some(folder) => folder.into(),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases/host"),
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn every_case_of_the_folder_is_right() {
    let folder_of_cases = cases();
    if !folder_of_cases.is_dir() {
        println!(
            "skipped: no cases in {}; TOUCHSTONE_CASES names another folder",
            folder_of_cases.display()
        );
        return;
    }
    let here = folder("cases");
    let mut checked = 0;
    for case in files(&folder_of_cases).iter().filter(|path| path.is_dir()) {
        let name = case.file_name().unwrap().to_string_lossy().into_owned();
        // The cases that need a device service are run by the tests of the crate `host-sim/device`.
        for file in files(case) {
            let of_case = file.file_name().unwrap().to_string_lossy().into_owned();
            if !of_case.ends_with(".stl") && !of_case.ends_with(".csv") {
                continue;
            }
            let right = right(&name, &of_case);
            check(
                &here,
                &file,
                &right.unwrap_or_else(|| panic!("{name}/{of_case} has no rule here")),
            );
            checked += 1;
        }
    }
    assert!(checked > 0, "{}: empty", folder_of_cases.display());
}

/// Checks file names with arbitrary bytes, which Linux allows. The program must accept such names for files that it only reads.
/// Where a scene names such a file, the program must refuse it with one line of error.
#[cfg(target_os = "linux")]
#[test]
fn a_path_that_is_not_utf_8_works_or_is_refused_in_a_line() {
    use std::ffi::OsString;
    use std::os::unix::ffi::OsStringExt as _;
    let here = folder("no-utf-8");
    let odd = |end: &str| OsString::from_vec([b"m\xff", end.as_bytes()].concat());
    std::fs::write(
        here.join(odd(".csv")),
        "time_s,angle_rad\n0,0\n1,0.1\n2,0\n",
    )
    .unwrap();
    std::fs::copy(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/tap.toml"),
        here.join(odd(".toml")),
    )
    .unwrap();
    let run = |words: &[OsString]| crate::run_words(&here, words);
    let words = |text: &str| -> Vec<OsString> { text.split(' ').map(OsString::from).collect() };
    for (first, end, more) in [
        ("run tap --operator-motion", ".csv", ""),
        ("run tap --operator-motion", ".csv", "--json"),
        ("run tap --operator-motion", ".csv", "--print"),
        ("certify tap --operator-motion", ".csv", ""),
        ("run", ".toml", ""),
        ("plan", ".toml", ""),
        ("device run", ".stl", "--device simulated --seconds 0.1"),
        ("flash --board b-g431b-esc1", ".elf", "--dry-run"),
        ("config --port", "", "get law.kind"),
    ] {
        let mut all = words(first);
        all.push(odd(end));
        if !more.is_empty() {
            all.extend(words(more));
        }
        let said = run(&all);
        assert_eq!(said.code, Some(2), "{all:?}: {}{}", said.out, said.err);
        assert!(
            said.err.starts_with("error: ") && said.err.lines().count() == 1,
            "{all:?}: {}",
            said.err
        );
    }
    for option in ["--out", "--junit"] {
        let mut all = words("run tap -q --expect active --expect passive");
        all.push(option.into());
        all.push(odd("-new"));
        let said = run(&all);
        assert_eq!(said.code, Some(0), "{option}: {}", said.err);
        std::fs::rename(
            here.join(odd("-new")),
            here.join(format!("written{option}")),
        )
        .unwrap();
    }
}
