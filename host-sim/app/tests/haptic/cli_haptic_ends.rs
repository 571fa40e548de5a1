//! Tests of what a run on a haptic device says at its end: a release that failed.

use crate::cli_haptic::{failed, ran, text};
use crate::common;

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
