//! Tests of the program's commands for haptic devices. They run in real time, so they are apart from the tests that calculate for long.
#![cfg(target_os = "linux")]

#[path = "../common/mod.rs"]
mod common;

mod cli_device_scorecard;
mod cli_haptic;
mod cli_haptic_ends;
