//! Tests of what a run on a haptic device says at its end: a release that failed, a scorecard that was interrupted.

use crate::cli_haptic::{failed, interrupt, program, ran, text};
use crate::common;
use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::time::Duration;

/// Checks that a failed release is told even if the run also ended with a fault and the summary is not printed.
#[test]
fn a_release_that_fails_after_a_fault_is_told() {
    let folder = common::folder("haptic-not-released");
    let run = "device run sphere --seconds 20 --quiet --no-guard";
    let run: Vec<&str> = run.split(' ').collect();
    let said = ran(&folder, "fail dhdSetForce 900 1000000 2", &run);
    if text(&said.stderr).contains("ms late") {
        // On a busy machine, a late control period may end the run before its commands fail.
        return;
    }
    failed(
        &said,
        1,
        &[
            "; the motors may still be on: dhdSetForce failed",
            "; switch its supply off; then check its supply",
        ],
    );
}

/// Checks that an interrupted scorecard, which lacks figures, does not pass for a complete one.
#[test]
fn an_interrupted_scorecard_ends_with_the_code_of_an_interrupt() {
    let folder = common::folder("haptic-interrupted-scorecard");
    let run = "device run plane --device simulated --programme scorecard --late-limit-ms 1000";
    let run: Vec<&str> = run.split(' ').collect();
    let mut child = program(&folder, "", &run)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().starts_with("wall")));
    std::thread::sleep(Duration::from_millis(900));
    interrupt(&child, "-INT");
    assert!(lines.any(|line| line.unwrap() == "released  yes"));
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
}
