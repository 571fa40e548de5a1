//! Tests with an older file, a foreign file or a link at the output's path.

use super::{FILES, FOLDERS, SLOW, board, fresh, met, names};
use std::os::unix::fs::symlink;
use std::time::Duration;

#[test]
fn no_older_file_is_lost_without_force_and_no_link_is_followed() {
    let board = board();
    for output in &FILES {
        let here = fresh("older", output);
        std::fs::write(here.join("out"), "mine").unwrap();
        output.fails(&output.run(&here, &board), "exists");
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
        output.fails(&output.run(&here, &board), "exists");
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
            std::fs::write(here.join("out"), "mine").unwrap();
            output.fails(&output.run(&here, &board), "exists");
            std::fs::remove_file(here.join("out")).unwrap();
            symlink("mine", here.join("out")).unwrap();
            output.fails(&output.run(&here, &board), "exists");
            assert_eq!(names(&here), ["mine", "out"], "{}", output.0);
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
