//! Tests that pandas, Polars, DuckDB, R and LibreOffice read the program's CSV files with the right types and values.

use crate::{folder, names, run_in};
use std::path::Path;
use std::process::Command;

/// STL mesh of a triangle far from the simulated hand's path. The hand never touches the mesh, so that all forces are zero.
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

#[test]
fn other_tools_read_what_was_written() {
    let here = folder("readers");
    let mut files = Vec::new();
    run_in(&here, &["run", "thesis-knob", "-q", "--out", "run"]).ended(0);
    let traces = names(&here.join("run/traces"));
    let traces = traces.into_iter().filter(|name| name.ends_with(".csv"));
    files.extend(traces.map(|name| format!("run/traces/{name}")));
    // Without a guard and an observer, their columns are empty.
    let spring = [
        "run",
        "free-release",
        "--preset",
        "thesis",
        "--law",
        "spring",
    ];
    run_in(&here, &[&spring[..], &["-q", "--out", "spring"]].concat()).ended(0);
    let traces = names(&here.join("spring/traces"));
    let traces = traces.into_iter().filter(|name| name.ends_with(".csv"));
    files.extend(traces.map(|name| format!("spring/traces/{name}")));
    let sweep = [
        "sweep",
        "low-stiffness",
        "--no-certificate",
        "-q",
        "--out",
        "sweep",
    ];
    let axes = [
        "--x",
        "wall.k_desired_n_m_per_rad=1,2,40",
        "--y",
        "timing.rate_hz=1000,2000",
    ];
    let measures = [
        "--measure",
        "k_displayed",
        "--measure",
        "guard_limited_ticks",
    ];
    run_in(&here, &[&sweep[..], &axes[..], &measures[..]].concat()).ended(0);
    files.push("sweep/cells.csv".to_owned());
    let programme = ["scorecard", "thesis-knob", "--grip", "light", "-q"];
    run_in(
        &here,
        &[&programme[..], &["--programme", "programme.csv"]].concat(),
    )
    .ended(0);
    files.push("programme.csv".to_owned());
    std::fs::write(here.join("far.stl"), NEVER_MET).unwrap();
    // `far.csv` begins with 30,000 rows of zeros. A reader that infers the types from the first ten thousand rows must not infer
    // integers.
    for (object, seconds, file) in [("far.stl", "8", "far.csv"), ("plane", "1", "plane.csv")] {
        let device = ["device", "run", object, "--device", "simulated", "-q"];
        run_in(
            &here,
            &[&device[..], &["--seconds", seconds, "--csv", file]].concat(),
        )
        .ended(0);
        files.push(file.to_owned());
    }
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
