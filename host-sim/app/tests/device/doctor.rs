//! Tests of `touchstone doctor` with an artificial PATH, artificial USB devices, and a fake device.
#![cfg(unix)]

use crate::fake::{Fake, Trouble};
use crate::{Said, folder, program, script};
use std::path::{Path, PathBuf};
use touchstone_protocol::PROTOCOL_VERSION;

/// An artificial machine: a folder with stand-ins for all tools and USB devices that a board needs.
struct Machine(PathBuf);

impl Machine {
    fn new(test: &str) -> Self {
        let here = folder(test);
        let bin = here.join("bin");
        std::fs::create_dir_all(&bin).unwrap();
        script(&bin, "probe-rs", "echo 'probe-rs 0.31.0 (git commit: 1)'");
        let sysroot = here.join("rust");
        std::fs::create_dir_all(sysroot.join("lib/rustlib/thumbv7em-none-eabihf")).unwrap();
        let rustc = format!(
            "if [ $1 = --print ]; then echo '{}'; else echo 'rustc 1.95.0'; fi",
            sysroot.display()
        );
        script(&bin, "rustc", &rustc);
        Self(here).with_probe("1-2", "374e")
    }

    fn with_probe(self, name: &str, product: &str) -> Self {
        let device = self.0.join("sys/bus/usb/devices").join(name);
        std::fs::create_dir_all(&device).unwrap();
        for (file, text) in [
            ("idVendor", "0483"),
            ("idProduct", product),
            ("product", "STLINK-V3"),
            ("serial", "0042"),
            ("busnum", "1"),
            ("devnum", "7"),
        ] {
            std::fs::write(device.join(file), format!("{text}\n")).unwrap();
        }
        let node = self.0.join("dev/bus/usb/001");
        std::fs::create_dir_all(&node).unwrap();
        std::fs::write(node.join("007"), "").unwrap();
        self
    }

    fn remove(&self, what: &str) {
        let path = self.0.join(what);
        if path.is_dir() {
            std::fs::remove_dir_all(path).unwrap();
        } else {
            std::fs::remove_file(path).unwrap();
        }
    }

    fn doctor(&self, port: &str) -> Said {
        let text = |path: &Path| path.to_str().unwrap().to_owned();
        let (sysfs, dev) = (text(&self.0.join("sys")), text(&self.0.join("dev")));
        let mut command = program(&["doctor", "--port", port, "--sysfs", &sysfs, "--dev", &dev]);
        command
            .current_dir(&self.0)
            .env("PATH", self.0.join("bin"))
            .env_remove("CARGO_TARGET_DIR");
        command.output().unwrap().into()
    }
}

#[test]
fn all_there() {
    let (machine, device) = (Machine::new("doctor"), Fake::new());
    let said = machine.doctor(&device.address).done();
    for part in [
        #[cfg(not(feature = "probe"))]
        "probe-rs 0.31.0",
        #[cfg(feature = "probe")]
        "probe-rs 0.32.0, in this program",
        "thumbv7em-none-eabihf, rustc 1.95.0",
        "STLINK-V3 0483:374e 0042",
        "bus/usb/001/007 may be used",
        "nucleo-g474re, firmware 0.1.0",
        "a hand gets out at most 45.15 mJ at once",
        "all there",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn each_thing_that_is_missing_is_named_with_its_remedy() {
    let device = Fake::new();
    for (what, parts) in [
        #[cfg(not(feature = "probe"))]
        (
            "bin/probe-rs",
            &["not on the PATH", "cargo install probe-rs-tools"][..],
        ),
        (
            "rust/lib/rustlib/thumbv7em-none-eabihf",
            &["rustup target add thumbv7em-none-eabihf"][..],
        ),
        ("bin/rustc", &["no rustc", "https://rustup.rs"]),
        (
            "sys/bus/usb/devices/1-2",
            &["no ST-LINK found on USB", "cable that carries data"],
        ),
        ("dev/bus/usb/001/007", &["connect the board again"]),
    ] {
        let machine = Machine::new("doctor-missing");
        machine.remove(what);
        let said = machine.doctor(&device.address);
        assert_eq!(said.code, Some(1), "{what}: {}", said.out);
        assert!(
            said.out.contains("1 thing is missing"),
            "{what}: {}",
            said.out
        );
        for part in parts {
            assert!(said.out.contains(part), "{part}: {}", said.out);
        }
    }
    // Another USB device of the same manufacturer is not reported as a probe.
    let machine = Machine::new("doctor-other");
    machine.remove("sys/bus/usb/devices/1-2");
    let machine = machine.with_probe("1-3", "5740");
    assert!(
        machine
            .doctor(&device.address)
            .out
            .contains("no ST-LINK found on USB")
    );
}

#[test]
fn a_device_that_does_not_answer_and_one_of_another_version() {
    let machine = Machine::new("doctor-device");
    let silent = Fake::with(Trouble {
        silent: true,
        ..Trouble::default()
    });
    let said = machine.doctor(&silent.address);
    assert_eq!(said.code, Some(1));
    assert!(
        said.out.contains("touchstone flash --board BOARD"),
        "{}",
        said.out
    );
    let other = Fake::with(Trouble {
        version: Some(PROTOCOL_VERSION + 1),
        ..Trouble::default()
    });
    let said = machine.doctor(&other.address);
    assert!(
        said.out
            .contains(&format!("version {}", PROTOCOL_VERSION + 1))
            && said.code == Some(1),
        "{}",
        said.out
    );
}

#[test]
fn who_asks_for_nothing_fails_for_nothing() {
    let machine = Machine::new("doctor-nothing");
    machine.remove("sys/bus/usb/devices/1-2");
    let run = |words: &[&str]| -> Said {
        let mut command = program(words);
        command
            .current_dir(&machine.0)
            .env("PATH", machine.0.join("bin"))
            .env("FDSDK", machine.0.join("none"))
            .env_remove("CARGO_TARGET_DIR");
        let (sysfs, dev) = (machine.0.join("sys"), machine.0.join("dev"));
        command.arg("--sysfs").arg(sysfs).arg("--dev").arg(dev);
        command.output().unwrap().into()
    };
    let said = run(&["doctor"]);
    assert_eq!(said.code, Some(0), "{}", said.out);
    for part in [
        "no ST-LINK found on USB",
        "a simulation needs none of the missing items",
    ] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
    let said = run(&["doctor", "board"]);
    assert_eq!(said.code, Some(1), "{}", said.out);
    let said = run(&["doctor", "omega3"]);
    assert_eq!(said.code, Some(1), "{}", said.out);
    assert!(!said.out.contains("ST-LINK"), "{}", said.out);
    assert!(said.out.contains("MISSING  omega.3"), "{}", said.out);
}

/// Checks that the program prints the udev rule for a USB node that the user may not open. The root user may open every node, so
/// for root the test is skipped.
#[test]
fn a_node_without_permission_comes_with_the_rule() {
    use std::os::unix::fs::PermissionsExt;
    let (machine, device) = (Machine::new("doctor-permission"), Fake::new());
    let node = machine.0.join("dev/bus/usb/001/007");
    std::fs::set_permissions(&node, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::File::open(&node).is_ok() {
        eprintln!("not run: this user may open everything");
        return;
    }
    let said = machine.doctor(&device.address);
    assert_eq!(said.code, Some(1));
    for part in [
        "cannot be opened: this user has no permission",
        "/etc/udev/rules.d/70-st-link.rules",
        "udevadm control --reload",
    ] {
        assert!(said.out.contains(part), "{}", said.out);
    }
}
