//! Tests of `touchstone sweep`: a map resumed after an interrupt, or combined from parts, is byte for byte that of a single run.

use crate::{folder, names, program, run, run_in};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const MAP: [&str; 10] = [
    "sweep",
    "tap",
    "--x",
    "wall.k_desired_n_m_per_rad=0.4..4:24",
    "--y",
    "timing.rate_hz=1000..4000:16",
    "--measure",
    "penetration_max",
    "--set",
    "timing.duration_s=3",
];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&MAP[..], more].concat()
}

fn same(here: &std::path::Path, a: &str, b: &str) {
    let files = names(&here.join(a));
    assert_eq!(files, names(&here.join(b)));
    for file in files {
        let read = |folder: &str| std::fs::read(here.join(folder).join(&file)).unwrap();
        assert!(read(a) == read(b), "{file} differs between {a} and {b}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_cells_and_the_same_command_goes_on() {
    let here = folder("sweep-interrupt");
    let whole = run_in(&here, &with(&["--out", "whole", "--threads", "2"])).ended(0);
    assert!(whole.out.contains("cells and maps"), "{}", whole.out);

    let mut child = program(&here, &with(&["--out", "ended", "--threads", "1"]))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let journal = here.join("ended/journal.csv");
    let lines = || std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    let until = Instant::now() + Duration::from_secs(120);
    while lines() < 2 {
        if Instant::now() > until {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("no cell came");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{err}");
    assert!(err.contains("finished cells are saved"), "{err}");
    assert_eq!(names(&here.join("ended")), ["journal.csv", "sweep.json"]);
    // The journal contains complete lines below a header.
    let kept = lines() - 1;
    assert!((1..24 * 16).contains(&kept), "{kept}");

    let again = run_in(&here, &with(&["--out", "ended"])).ended(0);
    assert!(
        again
            .err
            .contains(&format!("{kept} cells were already computed"))
            && again.err.contains(&format!("{} cells in", 24 * 16 - kept)),
        "{}",
        again.err
    );
    same(&here, "whole", "ended");
    // All cells are in the journal, so nothing is computed and the files have the same bytes.
    let third = run_in(&here, &with(&["--out", "ended"])).ended(0);
    assert!(!third.err.contains("cells in"), "{}", third.err);
    same(&here, "whole", "ended");
}

#[test]
fn parts_make_the_whole_to_the_byte() {
    let here = folder("sweep-parts");
    let few = |more: &[&'static str]| {
        let mut words = with(more);
        words[3] = "wall.k_desired_n_m_per_rad=0.4..4:4";
        words[5] = "timing.rate_hz=1000..4000:3";
        words
    };
    run_in(&here, &few(&["--out", "whole"])).ended(0);
    run_in(&here, &few(&["--out", "a", "--shard", "1/2"])).ended(0);
    run_in(&here, &few(&["--out", "a", "--shard", "2/2"])).refused(&["of another part"]);
    run_in(&here, &few(&["--out", "whole", "--shard", "1/2"])).refused(&["of another part"]);
    run_in(&here, &["sweep", "merge", "a", "--out", "short"])
        .refused(&["6 of 12 cells are in none"]);
    let json = run_in(&here, &few(&["--shard=2/2", "--out=b", "--json", "-q"])).ended(0);
    assert_eq!(json.json()["cells"], 6);
    assert!(json.err.is_empty(), "{}", json.err);
    let merged = run_in(&here, &["sweep", "merge", "b", "a", "--out", "merged"]).ended(0);
    assert!(merged.out.contains("cells and maps"), "{}", merged.out);
    same(&here, "whole", "merged");
    let other = few(&["--out", "a", "--set", "timing.rate_hz=500", "-q"]);
    run_in(&here, &other).refused(&["holds the results of"]);
}

#[test]
fn mistakes_are_told_before_the_first_cell() {
    run(&["sweep", "tap", "--out", "nowhere"]).ended(2);
    run(&[
        "sweep",
        "tap",
        "--x",
        "law.kind=spring",
        "--y",
        "law.kind=fba",
        "--out",
        "nowhere",
    ])
    .refused(&["other axis"]);
    run(&with(&["--out", "nowhere", "--shard", "3/2"])).refused(&["3/2"]);
    run(&with(&["--out", "nowhere", "--measure", "k_display"])).refused(&["did you mean"]);
    run(&["sweep", "merge", "nowhere-at-all", "--out", "nowhere"]).refused(&["holds no sweep"]);
}
