//! Tests of every output of the program with every obstacle at its path: an older file, a link, a full disk, another user's folder,
//! a killed process, two processes at once.
//!
//! Afterwards the file at the path must be complete or unchanged, no other file may be left, and the error must be one line. The
//! table of all outputs and obstacles is printed by `cargo test -p touchstone --test device writers -- --nocapture --test-threads 1`.

use crate::fake::Fake;
use crate::{Said, folder};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use touchstone_protocol::FaultCode;

/// An output: its name; its command with `OUT` in place of the file; whether the command needs a board; whether it replaces its own
/// earlier file without `--force`.
struct Output(&'static str, &'static str, bool, bool);

const FILES: [Output; 10] = [
    Output(
        "run --junit",
        "run tap -q --expect active --expect passive --junit OUT",
        false,
        true,
    ),
    Output(
        "live --out",
        "live thesis-knob --no-open -q --out OUT",
        false,
        true,
    ),
    Output(
        "scorecard --programme",
        "scorecard thesis-knob --grip light -q --programme OUT",
        false,
        false,
    ),
    Output(
        "device run --csv",
        "device run plane --device simulated --fast --seconds 0.5 -q --csv OUT",
        false,
        false,
    ),
    Output(
        "device identify --out",
        "device identify --device simulated --fast --axis-s 2 -q --out OUT",
        false,
        false,
    ),
    Output(
        "device identify --scene",
        "device identify --device simulated --fast --axis-s 2 -q --scene OUT",
        false,
        false,
    ),
    Output(
        "monitor --csv",
        "monitor --seconds 0.3 -q --csv OUT",
        true,
        false,
    ),
    Output(
        "device survey --out",
        "device survey --seconds 0.3 -q --out OUT",
        false,
        false,
    ),
    Output("device ring --out", "device ring -q --out OUT", true, false),
    Output("config export", "config export OUT -q", true, false),
];

/// Outputs that are folders: reports, which the same code writes for all commands, and manual pages.
const FOLDERS: [Output; 6] = [
    Output("run --out", "run tap -q --out OUT", false, true),
    Output(
        "sweep --out",
        "sweep low-stiffness --no-certificate -q --x wall.k_desired_n_m_per_rad=1,2 --y timing.rate_hz=1000,2000 --out OUT",
        false,
        true,
    ),
    Output(
        "device run --out",
        "device run plane --device simulated --fast --seconds 0.5 -q --out OUT",
        false,
        true,
    ),
    Output(
        "scorecard --out",
        "scorecard thesis-knob --grip light --law spring -q --out OUT",
        false,
        true,
    ),
    Output(
        "boundary --out",
        "boundary press-hold --columns 2 --rows 2 --delays 0 --ticks 1000 -q --out OUT",
        false,
        true,
    ),
    Output("man", "man OUT", false, true),
];

/// Outputs of commands that compute for long before they write. They must refuse an existing file of another command before they
/// compute.
const SLOW: [Output; 5] = [
    Output(
        "tune --out",
        "tune thesis-knob -q --out OUT.toml",
        false,
        true,
    ),
    Output(
        "tune --report",
        "tune thesis-knob -q --report OUT",
        false,
        true,
    ),
    Output("thesis --out", "thesis -q --out OUT", false, true),
    Output("accuracy --out", "accuracy -q --out OUT", false, true),
    Output(
        "compare --out",
        "compare none.csv thesis-knob -q --out OUT",
        false,
        true,
    ),
];

/// A command in whose environment a mock is in place of the omega.3's driver library.
fn with_mock(program: &str) -> Command {
    let mut command = Command::new(program);
    command.env("TOUCHSTONE_DHD", touchstone_mock_dhd::door::built());
    command
}

impl Output {
    fn words(&self, board: &Fake, out: &str) -> Vec<String> {
        let mut words: Vec<String> = self
            .1
            .split(' ')
            .map(|word| word.replace("OUT", out))
            .collect();
        if self.2 {
            words.extend(["--port".to_owned(), board.address.clone()]);
        }
        words
    }

    fn command(&self, here: &Path, board: &Fake) -> Command {
        let mut command = with_mock(env!("CARGO_BIN_EXE_touchstone"));
        command.args(self.words(board, "out")).current_dir(here);
        command
    }

    fn run(&self, here: &Path, board: &Fake) -> Said {
        self.command(here, board).output().unwrap().into()
    }

    /// Checks that the command failed with exit code 1 or 2 and one line of error that contains `part`.
    #[track_caller]
    fn fails(&self, said: &Said, part: &str) {
        assert!(
            matches!(said.code, Some(1 | 2)),
            "{}: {:?} {}{}",
            self.0,
            said.code,
            said.out,
            said.err
        );
        let errors: Vec<&str> = said
            .err
            .lines()
            .filter(|line| line.starts_with("error: "))
            .collect();
        assert!(
            errors.len() == 1 && errors[0].contains(part) && errors[0].contains("; "),
            "{}: {}",
            self.0,
            said.err
        );
    }
}

/// A board in a fault, so that the ring buffer of its last second has stopped and can be read.
fn board() -> Fake {
    let board = Fake::new();
    board.fault(FaultCode::OverSpeed, 61_000);
    board
}

/// Names of all files in the folder, including hidden ones, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entry = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.unwrap().file_name().into_string().unwrap()
    };
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(entry).collect();
    names.sort();
    names
}

/// Prints a row of the table of outputs and obstacles, after its checks.
fn met(output: &Output, obstacle: &str, outcome: &str) {
    println!("{obstacle:<22}{:<24}{outcome}", output.0);
}

fn fresh(test: &str, output: &Output) -> std::path::PathBuf {
    folder(&format!(
        "writers-{test}-{}",
        output.0.replace([' ', '-'], "")
    ))
}

#[test]
fn no_older_file_is_lost_without_force_and_no_link_is_followed() {
    let board = board();
    for output in &FILES {
        let here = fresh("older", output);
        std::fs::write(here.join("out"), "mine").unwrap();
        output.fails(&output.run(&here, &board), "is there");
        assert_eq!(
            std::fs::read(here.join("out")).unwrap(),
            b"mine",
            "{}",
            output.0
        );
        std::fs::remove_file(here.join("out")).unwrap();
        // Some commands replace the output of their own earlier run. The others need `--force`.
        assert_eq!(output.run(&here, &board).code, Some(0), "{}", output.0);
        let again = output.run(&here, &board);
        match output.3 {
            true => assert_eq!(again.code, Some(0), "{}: {}", output.0, again.err),
            false => output.fails(&again, "--force"),
        }
        // The output path is a symbolic link. The file to which it leads is never changed, with --force or without.
        std::fs::write(here.join("other"), "mine").unwrap();
        std::fs::remove_file(here.join("out")).unwrap();
        symlink("other", here.join("out")).unwrap();
        output.fails(&output.run(&here, &board), "is there");
        if !output.3 {
            let forced = output
                .command(&here, &board)
                .arg("--force")
                .output()
                .unwrap();
            assert_eq!(forced.status.code(), Some(0), "{}", output.0);
            assert!(
                here.join("out").symlink_metadata().unwrap().is_file(),
                "{}",
                output.0
            );
        }
        assert_eq!(
            std::fs::read(here.join("other")).unwrap(),
            b"mine",
            "{}",
            output.0
        );
        assert_eq!(names(&here), ["other", "out"], "{}", output.0);
        let own = match output.3 {
            true => "its own replaced",
            false => "its own with --force",
        };
        met(output, "older file, link", &format!("refused; {own}"));
    }
}

#[test]
fn in_a_folder_no_foreign_file_is_lost_and_no_link_is_followed() {
    let board = board();
    for output in &FOLDERS {
        let here = fresh("foreign", output);
        assert_eq!(output.run(&here, &board).code, Some(0), "{}", output.0);
        let again = output.run(&here, &board);
        assert_eq!(again.code, Some(0), "{}: {}", output.0, again.err);
        let made = names(&here.join("out"));
        // A file of the user has the same name as one of the command's files; then a symbolic link has this name.
        let page = here
            .join("out")
            .join(made.iter().find(|name| name.contains('.')).unwrap());
        std::fs::remove_dir_all(here.join("out")).unwrap();
        std::fs::create_dir(here.join("out")).unwrap();
        std::fs::write(&page, "mine").unwrap();
        let said = output.run(&here, &board);
        output.fails(&said, "; ");
        assert_eq!(std::fs::read(&page).unwrap(), b"mine", "{}", output.0);
        std::fs::write(here.join("other"), "mine").unwrap();
        std::fs::remove_file(&page).unwrap();
        symlink(here.join("other"), &page).unwrap();
        let said = output.run(&here, &board);
        assert_ne!(said.code, None, "{}", output.0);
        assert_eq!(
            std::fs::read(here.join("other")).unwrap(),
            b"mine",
            "{}: {}",
            output.0,
            said.err
        );
        met(output, "foreign file, link", "refused");
    }
}

#[test]
fn what_takes_long_refuses_a_taken_place_before_it_begins() {
    let board = board();
    for output in &SLOW {
        let here = fresh("slow", output);
        std::fs::write(here.join("mine"), "mine").unwrap();
        let begun = std::time::Instant::now();
        if output.0 == "tune --out" {
            let out = here.join("out.toml");
            std::fs::write(&out, "mine").unwrap();
            output.fails(&output.run(&here, &board), "is there");
            std::fs::remove_file(&out).unwrap();
            symlink("mine", &out).unwrap();
            output.fails(&output.run(&here, &board), "is there");
            assert_eq!(names(&here), ["mine", "out.toml"], "{}", output.0);
        } else {
            std::fs::create_dir(here.join("out")).unwrap();
            symlink("../mine", here.join("out/index.html")).unwrap();
            std::fs::write(here.join("out/results.json"), "mine").unwrap();
            output.fails(&output.run(&here, &board), "another folder");
            assert_eq!(
                names(&here.join("out")),
                ["index.html", "results.json"],
                "{}",
                output.0
            );
        }
        assert_eq!(
            std::fs::read(here.join("mine")).unwrap(),
            b"mine",
            "{}",
            output.0
        );
        assert!(begun.elapsed() < Duration::from_secs(5), "{}", output.0);
        met(output, "older file, link", "refused before the work");
    }
}

/// Runs each command on a full disk, mounted in a separate mount namespace. Checks that it reports the error and leaves no file.
#[test]
fn a_full_disk_is_said_and_nothing_is_left() {
    let board = board();
    let can = |words: &[&str]| {
        let tried = Command::new("unshare")
            .args(["-rm", "sh", "-c"])
            .args(words)
            .output();
        tried.is_ok_and(|output| output.status.success())
    };
    if !can(&["mount -t tmpfs none /mnt"]) {
        println!("skipped: no disk of one's own can be mounted here (unshare -rm)");
        return;
    }
    for output in FILES.iter().chain(&FOLDERS) {
        let here = fresh("full", output);
        std::fs::create_dir(here.join("disk")).unwrap();
        let script =
            "mount -t tmpfs -o size=16k none disk && cat /dev/zero > disk/filler 2>/dev/null
            \"$0\" \"$@\" >said 2>&1; echo $? >code; ls -A disk >left";
        let mut command = with_mock("unshare");
        command.args(["-rm", "sh", "-c", script, env!("CARGO_BIN_EXE_touchstone")]);
        command
            .args(output.words(&board, "disk/out"))
            .current_dir(&here);
        command.output().unwrap();
        let read = |name: &str| std::fs::read_to_string(here.join(name)).unwrap();
        let said = Said {
            code: read("code").trim().parse().ok(),
            out: String::new(),
            err: read("said"),
        };
        output.fails(&said, "No space left on device");
        let left = read("left");
        // A recording that is written row by row leaves its file, and a sweep leaves its folder.
        let begun = matches!(
            output.0,
            "monitor --csv" | "sweep --out" | "boundary --out" | "man"
        );
        assert!(
            left == "filler\n" || begun && left == "filler\nout\n",
            "{}: {left}",
            output.0
        );
        let outcome = match left.contains("out") {
            true => "said; what was begun is left",
            false => "said; nothing is left",
        };
        met(output, "full disk", outcome);
    }
}

/// Runs each command in a folder without write permission, and checks that it reports the error. If the tests run as root, the
/// command runs as the user nobody.
#[test]
fn a_folder_that_may_not_be_written_is_said() {
    let board = board();
    let is_root = std::fs::metadata("/proc/self")
        .is_ok_and(|it| std::os::unix::fs::MetadataExt::uid(&it) == 0);
    for output in FILES.iter().chain(&FOLDERS) {
        let here = fresh("read-only", output);
        let words = output.words(&board, "out");
        let mut command = match is_root {
            true => {
                let mut command = with_mock("setpriv");
                command.args(["--reuid=65534", "--regid=65534", "--clear-groups"]);
                command.arg(env!("CARGO_BIN_EXE_touchstone"));
                command
            }
            false => {
                std::fs::set_permissions(&here, PermissionsExt::from_mode(0o555)).unwrap();
                with_mock(env!("CARGO_BIN_EXE_touchstone"))
            }
        };
        let Ok(ended) = command.args(&words).current_dir(&here).output() else {
            println!("skipped: the tests run as root, and there is no setpriv");
            return;
        };
        let said = Said::from(ended);
        if said.err.contains("setpriv:") {
            println!("skipped: {}", said.err.trim());
            return;
        }
        output.fails(&said, "Permission denied");
        std::fs::set_permissions(&here, PermissionsExt::from_mode(0o755)).unwrap();
        assert!(names(&here).is_empty(), "{}", output.0);
        met(output, "read-only folder", "said; nothing is left");
    }
}

fn begun(output: &Output, here: &Path, board: &Fake) -> Child {
    let mut command = output.command(here, board);
    command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Whether the file is complete: a page, a table or settings with the expected last line.
fn is_whole(output: &Output, file: &Path) -> bool {
    let text = std::fs::read_to_string(file).unwrap();
    if output.0 == "monitor --csv" {
        // This file is written during the recording, so it may contain only complete rows.
        return text.is_empty()
            || text.ends_with('\n') && text.lines().all(|row| row.split(',').count() == 13);
    }
    ["</html>", "</testsuites>"]
        .iter()
        .any(|end| text.trim_end().ends_with(end))
        || text.ends_with('\n') && text.lines().count() > 3
}

#[test]
fn a_killed_process_leaves_nothing_torn_and_what_it_left_goes_with_the_next() {
    let board = board();
    for output in &FILES {
        let here = fresh("killed", output);
        let begins = std::time::Instant::now();
        assert_eq!(output.run(&here, &board).code, Some(0), "{}", output.0);
        let takes = begins.elapsed();
        let mut torn = Vec::new();
        for part in 0..12_u32 {
            let _ = std::fs::remove_file(here.join("out"));
            let mut child = begun(output, &here, &board);
            // The command writes in the last tenths of its running time.
            std::thread::sleep(takes.mul_f64(0.6 + 0.04 * f64::from(part)));
            let _ = child.kill();
            child.wait().unwrap();
            let file = here.join("out");
            if file.exists() && !is_whole(output, &file) {
                torn.push(part);
            }
        }
        assert!(torn.is_empty(), "{}: {torn:?}", output.0);
        // A killed process leaves a hidden file like this one.
        let _ = std::fs::remove_file(here.join("out"));
        std::fs::write(here.join(".touchstone-4194305-out"), "half").unwrap();
        let again = output.run(&here, &board);
        assert_eq!(again.code, Some(0), "{}: {}", output.0, again.err);
        if output.0 != "monitor --csv" {
            assert_eq!(names(&here), ["out"], "{}", output.0);
        }
        let outcome = match output.0 {
            "monitor --csv" => "whole rows",
            _ => "whole or not there",
        };
        met(output, "killed", outcome);
    }
}

/// A folder whose command is killed has either no results or all that they list, and the same command ends it.
#[test]
fn a_killed_process_leaves_no_half_folder() {
    let board = board();
    for output in FOLDERS.iter().filter(|output| output.0 != "man") {
        let here = fresh("killed-folder", output);
        let begins = std::time::Instant::now();
        assert_eq!(output.run(&here, &board).code, Some(0), "{}", output.0);
        let takes = begins.elapsed();
        for part in 0..6_u32 {
            let _ = std::fs::remove_dir_all(here.join("out"));
            let mut child = begun(output, &here, &board);
            std::thread::sleep(takes.mul_f64(0.5 + 0.1 * f64::from(part)));
            let _ = child.kill();
            child.wait().unwrap();
            listed_files_are_there(output, &here);
            let again = output.run(&here, &board);
            assert_eq!(again.code, Some(0), "{}: {}", output.0, again.err);
            assert!(here.join("out/results.json").is_file(), "{}", output.0);
            listed_files_are_there(output, &here);
        }
        // A later report removes the temporary folders of killed ones; young ones may still be in use.
        let mut left = names(&here);
        left.retain(|name| !name.starts_with(".touchstone-report-"));
        assert_eq!(left, ["out"], "{}", output.0);
        met(output, "killed", "whole, or ended by the same command");
    }
}

/// Checks that every file that a report lists is there, if there is a report.
fn listed_files_are_there(output: &Output, here: &Path) {
    let Ok(results) = std::fs::read_to_string(here.join("out/results.json")) else {
        return;
    };
    let results: serde_json::Value = serde_json::from_str(&results).unwrap();
    for file in results["files"].as_array().unwrap() {
        let file = here.join("out").join(file.as_str().unwrap());
        assert!(file.is_file(), "{}: {}", output.0, file.display());
    }
}

#[test]
fn of_two_at_once_one_has_the_place_and_what_is_there_is_whole() {
    for output in &FILES {
        let here = fresh("two", output);
        let boards = [board(), board()];
        let both = [&boards[0], &boards[1]].map(|board| begun(output, &here, board));
        let ended = both.map(|child| Said::from(child.wait_with_output().unwrap()));
        let done = ended.iter().filter(|said| said.code == Some(0)).count();
        assert!(done >= 1, "{}: {} {}", output.0, ended[0].err, ended[1].err);
        for said in ended.iter().filter(|said| said.code != Some(0)) {
            output.fails(said, "is there");
        }
        assert!(is_whole(output, &here.join("out")), "{}", output.0);
        assert_eq!(names(&here), ["out"], "{}", output.0);
        met(output, "two at once", "whole");
    }
    let board = board();
    for output in &FOLDERS {
        let here = fresh("two", output);
        let both = [(); 2].map(|()| begun(output, &here, &board));
        let ended = both.map(|child| Said::from(child.wait_with_output().unwrap()));
        assert!(
            ended.iter().any(|said| said.code == Some(0)),
            "{}: {}",
            output.0,
            ended[0].err
        );
        std::thread::sleep(Duration::from_millis(10));
        assert_eq!(names(&here), ["out"], "{}", output.0);
        if output.0 != "man" {
            assert!(here.join("out/results.json").is_file(), "{}", output.0);
            listed_files_are_there(output, &here);
            assert!(
                names(&here.join("out"))
                    .iter()
                    .all(|name| !name.starts_with('.')),
                "{}",
                output.0
            );
        }
        met(output, "two at once", "whole");
    }
}
