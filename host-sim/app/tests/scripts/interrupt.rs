//! Tests that Ctrl-C leaves no half-written files and prints a message, and that the next run removes the files of a killed run.

use crate::{folder, names, program, run_in};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Arguments of a command that runs for many seconds unless it is interrupted.
const LONG: [&str; 6] = [
    "run",
    "thesis-knob",
    "--set",
    "timing.duration_s=900",
    "--out",
    "new/out",
];

/// Starts a long run and waits until its hidden folder contains a trace.
fn begun(here: &Path) -> (Child, PathBuf) {
    let mut child = program(here, &LONG)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let until = Instant::now() + Duration::from_secs(120);
    let hidden = loop {
        let hidden = std::fs::read_dir(here.join("new"))
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .find(|path| path.join("traces").is_dir());
        if let Some(hidden) = hidden {
            break hidden;
        }
        if Instant::now() > until {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("no hidden folder came");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    (child, hidden)
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

#[test]
fn an_interrupt_leaves_nothing_and_says_so() {
    for name in ["-INT", "-TERM"] {
        let here = folder(&format!("interrupt{name}"));
        let (child, hidden) = begun(&here);
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{err}");
        let hidden = hidden.file_name().unwrap().to_str().unwrap().to_owned();
        assert!(
            err.lines().count() == 1 && err.contains("interrupted") && err.contains(&hidden),
            "{err}"
        );
        assert!(output.stdout.is_empty());
        // The folder that was made for the report is gone as well.
        assert!(names(&here).is_empty(), "{:?}", names(&here));
    }
}

#[test]
fn what_a_killed_run_left_is_removed_and_a_living_ones_is_not() {
    let here = folder("killed");
    let (mut child, hidden) = begun(&here);
    // While the first run works, another run does not remove its hidden folder.
    let next = || {
        run_in(&here, &["run", "tap", "--out", "new/other"])
            .ended(0)
            .err
    };
    assert!(!next().contains("note:"));
    assert!(hidden.is_dir());

    signal(&child, "-KILL");
    child.wait().unwrap();
    assert!(hidden.is_dir(), "nobody could remove it");
    let said = next();
    assert!(
        said.contains("note:") && said.contains("was removed: its run was ended"),
        "{said}"
    );
    assert_eq!(names(&here.join("new")), ["other"]);

    // A hidden folder without its locked file may be in use. The program prints its name and does not remove it.
    std::fs::create_dir(here.join("new/.touchstone-report-1.0")).unwrap();
    assert!(next().contains("may be the remainder of an interrupted run"));
    // Folders with other names, and links, are not the program's and must stay.
    let others = [".touchstone-report-1", ".touchstone-report-mine"];
    for other in others {
        std::fs::create_dir_all(here.join("new").join(other).join("kept")).unwrap();
    }
    std::fs::create_dir(here.join("mine")).unwrap();
    std::fs::write(here.join("mine/kept"), "").unwrap();
    let linked = here.join("new/.touchstone-report-2.0");
    std::os::unix::fs::symlink("../mine", &linked).unwrap();
    std::fs::write(linked.with_extension("0.lock"), "").unwrap();
    next();
    assert!(linked.is_symlink() && here.join("mine/kept").is_file());
    for other in others {
        assert!(
            here.join("new").join(other).join("kept").is_dir(),
            "{other}"
        );
    }
}

/// Checks that another command that writes a report beside the hidden folder of a killed run removes that folder.
#[test]
fn what_a_killed_run_left_is_removed_by_every_command_that_writes_a_report() {
    let here = folder("killed-any");
    let (mut child, hidden) = begun(&here);
    signal(&child, "-KILL");
    child.wait().unwrap();
    assert!(hidden.is_dir());
    let device = ["device", "run", "plane", "--device", "simulated", "--fast"];
    let words = [&device[..], &["--seconds", "0.2", "--out", "new/device"]].concat();
    run_in(&here, &words).ended(0);
    assert_eq!(names(&here.join("new")), ["device"]);
}
