//! Tests of the folder of `touchstone setup` with faults: files of the user, links, a full disk, another user's folder, a killed
//! process, two processes at once.

use super::spun::Spun;
use super::{Said, folder};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use touchstone_world::motor::GIMBAL;
use touchstone_world::plant::{Coulomb, Device};

/// All files and folders that a setup leaves in its folder.
const MADE: [&str; 5] = [
    "before.toml",
    "knob.toml",
    "law.toml",
    "report",
    "setup.json",
];

fn device(number: u8) -> Spun {
    let knob = Device {
        inertia: 0.7e-4,
        damping: 5.2e-4,
        friction: Some(Coulomb {
            kinetic: 1.3e-3,
            breakaway: 1.3e-3,
        }),
    };
    Spun::new(GIMBAL, &knob, number)
}

/// Makes an empty folder with the settings of a control law, so that the setup need not tune.
fn place(test: &str) -> PathBuf {
    let here = folder(&format!("setup-outputs-{test}"));
    let law = "[law.estimator]\ninertia_kg_m2 = 0.00007\n";
    std::fs::write(here.join("given.toml"), law).unwrap();
    here
}

fn words<'a>(device: &'a Spun, out: &'a str) -> [&'a str; 8] {
    let port = device.address();
    [
        "setup",
        "-q",
        "--law",
        "given.toml",
        "--out",
        out,
        "--port",
        port,
    ]
}

fn command(here: &Path, device: &Spun) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.args(words(device, "out")).current_dir(here);
    command
}

fn setup(here: &Path, device: &Spun) -> Said {
    command(here, device).output().unwrap().into()
}

/// Names of all files in the folder, also hidden ones, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[track_caller]
fn is_refused(said: &Said, part: &str) {
    let err = &said.err;
    assert!(matches!(said.code, Some(1 | 2)), "{:?} {err}", said.code);
    assert!(
        err.lines().count() == 1 && err.starts_with("error: ") && err.contains(part),
        "{part}: {err}"
    );
}

#[test]
fn what_is_the_users_in_the_folder_is_not_touched() {
    let (here, device) = (place("foreign"), device(31));
    let out = here.join("out");
    std::fs::write(&out, "mine").unwrap();
    is_refused(&setup(&here, &device), "out");
    assert_eq!(std::fs::read(&out).unwrap(), b"mine");
    std::fs::remove_file(&out).unwrap();
    std::fs::create_dir(&out).unwrap();
    std::fs::write(here.join("other"), "mine").unwrap();
    for name in MADE {
        let file = out.join(name);
        std::fs::write(&file, "mine").unwrap();
        is_refused(&setup(&here, &device), name);
        assert_eq!(std::fs::read(&file).unwrap(), b"mine", "{name}");
        std::fs::remove_file(&file).unwrap();
        symlink("../other", &file).unwrap();
        is_refused(&setup(&here, &device), name);
        assert!(file.symlink_metadata().unwrap().is_symlink(), "{name}");
        std::fs::remove_file(&file).unwrap();
        // A link that leads nowhere.
        symlink("../none", &file).unwrap();
        is_refused(&setup(&here, &device), name);
        std::fs::remove_file(&file).unwrap();
        assert!(names(&out).is_empty(), "{name}: {:?}", names(&out));
    }
    std::fs::create_dir(out.join("report")).unwrap();
    std::fs::write(out.join("report/index.html"), "mine").unwrap();
    is_refused(&setup(&here, &device), "report");
    let page = std::fs::read(out.join("report/index.html")).unwrap();
    assert_eq!(page, b"mine");
    assert_eq!(std::fs::read(here.join("other")).unwrap(), b"mine");
    assert_eq!(names(&here), ["given.toml", "other", "out"]);
}

#[test]
fn a_full_disk_is_said_and_the_same_command_goes_on_where_there_is_room() {
    let (here, device) = (place("full"), device(32));
    std::fs::create_dir(here.join("disk")).unwrap();
    let script = "mount -t tmpfs -o size=16k none disk && cat /dev/zero > disk/filler 2>/dev/null
        \"$0\" \"$@\" >said 2>&1; echo $? >code; ls -A disk disk/out >left 2>&1; rm disk/filler
        \"$0\" \"$@\" >said2 2>&1; echo $? >code2; ls -A disk/out >left2";
    let ran = Command::new("unshare")
        .args(["-rm", "sh", "-c", script, env!("CARGO_BIN_EXE_touchstone")])
        .args(words(&device, "disk/out"))
        .current_dir(&here)
        .output();
    let read = |name: &str| std::fs::read_to_string(here.join(name)).unwrap_or_default();
    if ran.is_err() || read("code").is_empty() {
        println!("skipped: no disk of one's own can be mounted here (unshare -rm)");
        return;
    }
    let said = |name: &str, code: &str| Said {
        code: read(code).trim().parse().ok(),
        out: String::new(),
        err: read(name),
    };
    is_refused(&said("said", "code"), "No space left on device");
    let left = read("left");
    assert!(
        !left.contains(".touchstone") && !left.contains("before.toml"),
        "{left}"
    );
    // The disk has room for the first files but not for the page. The measured values must be kept.
    is_refused(&said("said2", "code2"), "No space left on device");
    let left = read("left2");
    assert!(
        left.contains("setup.json") && !left.contains(".touchstone"),
        "{left}"
    );
}

/// Checks the error for a folder without write permission. If the tests run as root, the command runs as the user nobody.
#[test]
fn a_folder_that_may_not_be_written_is_said() {
    let (here, device) = (place("read-only"), device(33));
    let is_root = std::fs::metadata("/proc/self")
        .is_ok_and(|it| std::os::unix::fs::MetadataExt::uid(&it) == 0);
    let mut command = match is_root {
        true => {
            let mut command = Command::new("setpriv");
            command.args(["--reuid=65534", "--regid=65534", "--clear-groups"]);
            command.arg(env!("CARGO_BIN_EXE_touchstone"));
            command
        }
        false => {
            std::fs::set_permissions(&here, PermissionsExt::from_mode(0o555)).unwrap();
            Command::new(env!("CARGO_BIN_EXE_touchstone"))
        }
    };
    let ran = command
        .args(words(&device, "out"))
        .current_dir(&here)
        .output();
    let _ = std::fs::set_permissions(&here, PermissionsExt::from_mode(0o755));
    let Ok(ended) = ran else {
        println!("skipped: the tests run as root, and there is no setpriv");
        return;
    };
    let said = Said::from(ended);
    if said.err.contains("setpriv:") {
        println!("skipped: {}", said.err.trim());
        return;
    }
    is_refused(&said, "Permission denied");
    assert_eq!(names(&here), ["given.toml"]);
}

#[test]
fn a_killed_setup_leaves_nothing_torn_and_the_same_command_ends_it() {
    let here = place("killed");
    let begins = Instant::now();
    let whole = setup(&here, &device(34));
    assert_eq!(whole.code, Some(0), "{}", whole.err);
    assert_eq!(names(&here.join("out")), MADE);
    let takes = begins.elapsed();
    for part in 0..8_u32 {
        std::fs::remove_dir_all(here.join("out")).unwrap();
        let device = device(34);
        let mut child = command(&here, &device)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // The kills are spread over the time in which the setup writes, from its first file to its last.
        std::thread::sleep(takes.mul_f64(0.02 + 0.14 * f64::from(part)));
        let _ = child.kill();
        child.wait().unwrap();
        // A killed process leaves a hidden file like this one.
        std::fs::create_dir_all(here.join("out")).unwrap();
        std::fs::write(here.join("out/.touchstone-4194305-knob.toml"), "half").unwrap();
        let said = setup(&here, &device);
        assert_eq!(said.code, Some(0), "{part}: {}", said.err);
        assert_eq!(names(&here.join("out")), MADE, "{part}");
        let results = std::fs::read_to_string(here.join("out/report/results.json")).unwrap();
        let _: serde_json::Value = serde_json::from_str(&results).unwrap();
    }
}

/// Checks that a setup resumes if it was interrupted after its first file and before its second.
#[test]
fn an_interruption_between_the_first_files_costs_nothing() {
    let (here, device) = (place("first"), device(35));
    assert_eq!(setup(&here, &device).code, Some(0));
    let out = here.join("out");
    let text = std::fs::read_to_string(out.join("setup.json")).unwrap();
    let number = serde_json::from_str::<serde_json::Value>(&text).unwrap()["device"].clone();
    std::fs::remove_dir_all(&out).unwrap();
    std::fs::create_dir(&out).unwrap();
    let first = serde_json::json!({ "device": number }).to_string();
    std::fs::write(out.join("setup.json"), first).unwrap();
    let said = setup(&here, &device);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(names(&out), MADE);
    // A finished setup whose file of earlier settings is missing is refused: the board now has the tuned settings instead.
    std::fs::remove_file(out.join("before.toml")).unwrap();
    is_refused(&setup(&here, &device), "before.toml");
    assert!(!out.join("before.toml").exists());
}

#[test]
fn of_two_at_once_one_has_the_folder() {
    let here = place("two");
    let devices = [device(36), device(37)];
    let both = [&devices[0], &devices[1]].map(|device| {
        command(&here, device)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    });
    let ended = both.map(|child| Said::from(child.wait_with_output().unwrap()));
    let done = ended.iter().filter(|said| said.code == Some(0)).count();
    assert_eq!(done, 1, "{} {}", ended[0].err, ended[1].err);
    let other = ended.iter().find(|said| said.code != Some(0)).unwrap();
    is_refused(other, "choose another folder with --out");
    std::thread::sleep(Duration::from_millis(10));
    assert_eq!(names(&here.join("out")), MADE);
}
