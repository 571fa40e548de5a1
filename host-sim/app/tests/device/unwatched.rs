//! Tests that each command which shows or uses a board warns where the host watchdog is off (`limits.host_silence_s = 0`).

use crate::fake::Fake;
use crate::program;
use crate::spun::Spun;
use std::io::{BufRead, BufReader, Read};
use std::process::Stdio;
use touchstone_world::motor::GIMBAL;
use touchstone_world::plant::{Coulomb, Device};

const WARNING: &str = "this device stays on when the computer hangs";

/// Returns what a command prints on standard error. The test ends `live` once its page exists; the other commands end by
/// themselves.
fn errors(device: &Fake, words: &[&str]) -> String {
    let mut child = program(&[words, &["--port", &device.address]].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    out.read_line(&mut line).unwrap();
    if words[0] == "live" {
        child.kill().unwrap();
    }
    // Standard output is read to its end; otherwise the program could block on a full pipe.
    out.read_to_string(&mut line).unwrap();
    let mut err = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut err)
        .unwrap();
    child.wait().unwrap();
    err
}

#[test]
fn every_command_that_keeps_a_board_company_warns_once() {
    let device = Fake::new();
    let commands: [&[&str]; 4] = [
        &["monitor", "--seconds", "0.2"],
        &["events", "--pitch", "30", "--seconds", "0.2"],
        &["live", "--no-open"],
        #[cfg(target_os = "linux")]
        &["bridge", "--seconds", "0.2"],
        #[cfg(not(target_os = "linux"))]
        &["monitor", "--seconds", "0.2"],
    ];
    for (silence_s, warnings) in [("2", 0), ("0", 1)] {
        device
            .run(&["config", "set", "limits.host_silence_s", silence_s])
            .done();
        for words in commands {
            let err = errors(&device, words);
            assert_eq!(err.matches(WARNING).count(), warnings, "{words:?}: {err}");
        }
    }
}

#[test]
fn a_setup_warns_where_it_leaves_the_watchdog_off() {
    let knob = Device {
        inertia: 0.7e-4,
        damping: 5.2e-4,
        friction: Some(Coulomb {
            kinetic: 1.3e-3,
            breakaway: 1.3e-3,
        }),
    };
    let device = Spun::new(GIMBAL, &knob, 41);
    device
        .run(&["config", "set", "limits.host_silence_s", "0"])
        .done();
    let here = crate::folder("unwatched-setup");
    let law = here.join("given.toml").display().to_string();
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.00007\n").unwrap();
    let out = here.join("knob").display().to_string();
    let said = device.run(&["setup", "--out", &out, "--law", &law]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(said.err.matches(WARNING).count(), 1, "{}", said.err);
    assert_eq!(device.world().0.settings().limits.host_silence_s, 0);
}
