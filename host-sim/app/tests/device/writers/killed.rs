//! Tests with a process that is killed while it writes, and with two processes that write at once.

use super::{Output, all_files, all_folders, board, fresh, met, names};
use crate::Said;
use crate::fake::Fake;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

fn begun(output: &Output, here: &Path, board: &Fake) -> Child {
    let mut command = output.command(here, board);
    command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Whether the file looks complete: it ends like a page or a JUnit file, or it has more than three lines, each with its line end.
fn is_whole(output: &Output, file: &Path) -> bool {
    let text = std::fs::read_to_string(file).unwrap();
    if output.0 == "monitor --csv" {
        // This file is written during the recording. It may end early, but only after a complete row.
        return text.is_empty()
            || text.ends_with('\n') && text.lines().all(|row| row.split(',').count() == 13);
    }
    ["</html>", "</testsuites>"]
        .iter()
        .any(|end| text.trim_end().ends_with(end))
        || text.ends_with('\n') && text.lines().count() > 3
}

/// Starts the command, and kills it at the time `after` from its first change in the folder.
fn killed(output: &Output, here: &Path, board: &Fake, after: Duration) {
    let seen = || {
        let within = std::fs::read_dir(here.join("out")).map_or(0, Iterator::count);
        (names(here), within)
    };
    let before = seen();
    let mut child = begun(output, here, board);
    while seen() == before && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_micros(50));
    }
    std::thread::sleep(after);
    let _ = child.kill();
    child.wait().unwrap();
}

/// Times from the first change in the folder to the kill, ms.
const AFTER_MS: [f64; 5] = [0.0, 0.2, 1.0, 4.0, 20.0];

#[test]
fn a_killed_process_leaves_nothing_torn_and_what_it_left_goes_with_the_next() {
    let board = board();
    for output in &all_files() {
        let here = fresh("killed", output);
        let mut left = 0;
        for after_ms in AFTER_MS {
            let _ = std::fs::remove_file(here.join("out"));
            killed(
                output,
                &here,
                &board,
                Duration::from_secs_f64(1e-3 * after_ms),
            );
            let file = here.join("out");
            if file.exists() {
                assert!(is_whole(output, &file), "{}: {after_ms}", output.0);
            }
            left += names(&here)
                .iter()
                .filter(|name| name.starts_with('.'))
                .count();
        }
        // A killed process leaves a hidden file like this one.
        let _ = std::fs::remove_file(here.join("out"));
        std::fs::write(here.join(".touchstone-4194305-out"), "half").unwrap();
        output.succeeds(&output.run(&here, &board));
        assert_eq!(names(&here), ["out"], "{}", output.0);
        let outcome = match output.0 {
            "monitor --csv" => "whole rows".to_owned(),
            _ => format!("whole or not there; {left} left, removed by the next"),
        };
        met(output, "killed", &outcome);
    }
}

/// Checks that a killed command leaves its folder without results or with every file that the results list, and that the same
/// command then completes the folder. Before the command, the folder is new, empty, or has results of the same command.
#[test]
fn a_killed_process_leaves_no_half_folder() {
    let board = board();
    for output in &all_folders() {
        let here = fresh("killed-folder", output);
        let out = here.join("out");
        output.succeeds(&output.run(&here, &board));
        let pages = pages_of(output, &out);
        for (at, after_ms) in AFTER_MS.into_iter().enumerate() {
            if at % 3 != 1 {
                std::fs::remove_dir_all(&out).unwrap();
            }
            if at % 3 == 2 {
                std::fs::create_dir(&out).unwrap();
            }
            killed(
                output,
                &here,
                &board,
                Duration::from_secs_f64(1e-3 * after_ms),
            );
            listed_files_are_there(output, &here);
            for (name, text) in pages_of(output, &out) {
                assert_eq!(Some(&text), pages.get(&name), "{}: {name}", output.0);
            }
            output.succeeds(&output.run(&here, &board));
            listed_files_are_there(output, &here);
            assert_eq!(names(&here), ["out"], "{}: {after_ms}", output.0);
            let hidden = names(&out).into_iter().find(|name| name.starts_with('.'));
            assert_eq!(hidden, None, "{}: {after_ms}", output.0);
            match output.0 {
                "man" => assert_eq!(pages_of(output, &out), pages),
                _ => assert!(out.join("results.json").is_file(), "{}", output.0),
            }
        }
        met(output, "killed", "whole, or ended by the same command");
    }
}

/// Manual pages in a folder, each with its text. Hidden files are left out. Empty for other outputs.
fn pages_of(output: &Output, folder: &Path) -> BTreeMap<String, Vec<u8>> {
    if output.0 != "man" || !folder.is_dir() {
        return BTreeMap::new();
    }
    let names = names(folder)
        .into_iter()
        .filter(|name| !name.starts_with('.'));
    names
        .map(|name| (name.clone(), std::fs::read(folder.join(name)).unwrap()))
        .collect()
}

/// Checks that every file that a report lists exists. Without a report it checks nothing.
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
    for output in &all_files() {
        let here = fresh("two", output);
        let boards = [board(), board()];
        let both = [&boards[0], &boards[1]].map(|board| begun(output, &here, board));
        let ended = both.map(|child| Said::from(child.wait_with_output().unwrap()));
        let good = output.good();
        assert!(
            ended.iter().any(|said| said.code == Some(good)),
            "{}: {} {}",
            output.0,
            ended[0].err,
            ended[1].err
        );
        for said in ended.iter().filter(|said| said.code != Some(good)) {
            output.fails(said, "exists");
        }
        assert!(is_whole(output, &here.join("out")), "{}", output.0);
        assert_eq!(names(&here), ["out"], "{}", output.0);
        met(output, "two at once", "whole");
    }
    let board = board();
    for output in &all_folders() {
        let here = fresh("two", output);
        let both = [(); 2].map(|()| begun(output, &here, &board));
        let ended = both.map(|child| Said::from(child.wait_with_output().unwrap()));
        assert!(
            ended.iter().any(|said| said.code == Some(output.good())),
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
