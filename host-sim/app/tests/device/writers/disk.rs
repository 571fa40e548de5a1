//! Tests with a full disk, and with a folder without write permission.

use super::{all_files, all_folders, board, fresh, met, names, with_mock};
use crate::Said;
use std::os::unix::fs::PermissionsExt;
use std::process::Command;

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
    for output in all_files().iter().chain(&all_folders()) {
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
        assert_eq!(read("left"), "filler\n", "{}", output.0);
        met(output, "full disk", "said; nothing is left");
    }
}

/// Runs each command in a folder without write permission, and checks that it reports the error. If the tests run as root, the
/// command runs as the user nobody.
#[test]
fn a_folder_that_may_not_be_written_is_said() {
    let board = board();
    let is_root = std::fs::metadata("/proc/self")
        .is_ok_and(|it| std::os::unix::fs::MetadataExt::uid(&it) == 0);
    for output in all_files().iter().chain(&all_folders()) {
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
