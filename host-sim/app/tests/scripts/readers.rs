//! Tests that pandas, Polars, DuckDB, R and LibreOffice read the program's CSV files with the right types and values.
//!
//! The files of `touchstone monitor` and `touchstone device ring` need a board. They are tested where they are written, with the
//! same script.

use crate::{folder, names, program, run_in};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// STL mesh of a triangle far from the simulated hand's path. The hand never touches it, so all forces are zero.
const NEVER_MET: &str = "solid far
facet normal 0 0 1
outer loop
vertex 70 70 50
vertex 71 70 50
vertex 70 71 50
endloop
endfacet
endsolid far
";

/// Number of rows that is larger than any reader inspects to infer the type of a column.
const QUIET_ROWS: usize = 30_000;

/// Runs a command, given as words separated by spaces.
fn run_words(here: &Path, words: &str) {
    let words: Vec<&str> = words.split(' ').collect();
    run_in(here, &words).ended(0);
}

/// Paths of the CSV files in the traces of a report.
fn traces(here: &Path, report: &str) -> Vec<String> {
    let traces = names(&here.join(report).join("traces")).into_iter();
    let traces = traces.filter(|name| name.ends_with(".csv"));
    traces
        .map(|name| format!("{report}/traces/{name}"))
        .collect()
}

/// A hand that rests far from the wall for longer than [`QUIET_ROWS`] control periods of a millisecond, and then presses.
fn late_press() -> String {
    let quiet_s = QUIET_ROWS as f64 / 1e3 + 0.5;
    let rows: String = (0..300)
        .map(|row| {
            let angle = 0.4 * (f64::from(row) / 300.0);
            format!("{},{angle}\n", quiet_s + 1e-3 * f64::from(row))
        })
        .collect();
    format!("time_s,angle_rad\n0,0\n0.5,0\n{rows}")
}

/// A recording in the columns of `touchstone monitor --csv`: a hand that moves to and fro before the wall at 0.3 rad.
fn monitored() -> String {
    let step = std::f64::consts::TAU / 4096.0;
    let rows: String = (0..400)
        .map(|tick| {
            let angle = 0.25 + 0.1 * (f64::from(tick) / 60.0).sin();
            let count = (angle / step).round();
            let penetration = count * step - 0.3;
            let time = 1e-3 * f64::from(tick);
            let force = penetration.max(0.0);
            format!("{tick},{time},{count},{penetration},{force},armed,\n")
        })
        .collect();
    format!("tick,time_s,count,penetration_rad,force_n_m,state,limits\n{rows}")
}

/// Starts a sweep of many cells and kills it when its file of finished cells has some rows. Returns the path of that file.
#[cfg(unix)]
fn journal(here: &Path) -> String {
    let words = "sweep low-stiffness --no-certificate -q --x wall.k_desired_n_m_per_rad=0.1..40:2000 --y timing.rate_hz=1000,2000,3000 \
        --out killed";
    let words: Vec<&str> = words.split_whitespace().collect();
    let mut child = program(here, &words).spawn().unwrap();
    let file = here.join("killed/journal.csv");
    let rows = || std::fs::read_to_string(&file).map_or(0, |text| text.lines().count());
    while rows() < 5 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // The interruption can leave at most the last line incomplete.
    let text = std::fs::read_to_string(&file).unwrap();
    let whole = text.rfind('\n').map_or(0, |at| at + 1);
    std::fs::write(&file, &text[..whole]).unwrap();
    "killed/journal.csv".to_owned()
}

#[test]
fn other_tools_read_what_was_written() {
    let here = folder("readers");
    let mut files = Vec::new();
    run_words(&here, "run thesis-knob -q --out run");
    files.extend(traces(&here, "run"));
    // Without a guard and an observer, their columns are empty.
    run_words(
        &here,
        "run free-release --preset thesis --law spring -q --out spring",
    );
    files.extend(traces(&here, "spring"));
    // This trace begins with 30,000 rows without contact, as `far.csv` below. A reader that infers the types from the first ten
    // thousand rows must not infer integers.
    std::fs::write(here.join("late.csv"), late_press()).unwrap();
    run_words(
        &here,
        "run low-stiffness --preset thesis --operator-motion late.csv --set timing.rate_hz=1000 -q --out late",
    );
    files.extend(traces(&here, "late"));
    let sweep = "sweep low-stiffness --no-certificate -q --x wall.k_desired_n_m_per_rad=1,2,40 --y timing.rate_hz=1000,2000 \
        --measure k_displayed --measure guard_limited_ticks --out sweep";
    run_words(
        &here,
        &sweep.split_whitespace().collect::<Vec<_>>().join(" "),
    );
    files.push("sweep/cells.csv".to_owned());
    #[cfg(unix)]
    files.push(journal(&here));
    run_words(
        &here,
        "boundary press-hold --columns 2 --rows 2 --delays 0 --ticks 1000 -q --out boundary",
    );
    files.push("boundary/cells.csv".to_owned());
    run_words(
        &here,
        "scorecard thesis-knob --grip light -q --programme programme.csv",
    );
    files.push("programme.csv".to_owned());
    std::fs::write(here.join("monitored.csv"), monitored()).unwrap();
    run_words(
        &here,
        "compare monitored.csv thesis-knob --set encoder.counts_per_rev=4096 -q --out compare",
    );
    files.push("compare/hand.csv".to_owned());
    std::fs::write(here.join("far.stl"), NEVER_MET).unwrap();
    for (object, seconds, file) in [("far.stl", "8", "far.csv"), ("plane", "1", "plane.csv")] {
        run_words(
            &here,
            // In real time, a busy machine would be late, which is a fault of the device.
            &format!(
                "device run {object} --device simulated --fast -q --seconds {seconds} --csv {file}"
            ),
        );
        files.push(file.to_owned());
    }
    let quiet = ["traces/", "far.csv"].map(|part| {
        let long = files.iter().filter(|file| file.contains(part));
        let rows = |file: &String| {
            std::fs::read_to_string(here.join(file))
                .unwrap()
                .lines()
                .count()
        };
        long.map(rows).max().unwrap_or(0)
    });
    assert!(quiet.iter().all(|rows| *rows > QUIET_ROWS), "{quiet:?}");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/readers.py");
    let python = Command::new("python3")
        .arg(script)
        .args(&files)
        .current_dir(&here)
        .output();
    let Ok(output) = python else {
        println!("skipped: there is no python3");
        return;
    };
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    match output.status.code() {
        Some(9) => println!("skipped: none of the readers is installed"),
        code => assert_eq!(
            code,
            Some(0),
            "{said}{}",
            String::from_utf8_lossy(&output.stderr)
        ),
    }
}
