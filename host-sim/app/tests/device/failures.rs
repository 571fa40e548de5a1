//! Tests of failures between the program and a device.

use crate::fake::{Fake, Trouble};
use crate::run;
use std::time::{Duration, Instant};

#[test]
fn no_port_and_nobody_behind_it() {
    // A TCP port that was free a moment ago, so that no program listens on it.
    let free = std::net::TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    let address = format!("tcp:{free}");
    run(&["device", "status", "--port", &address]).failed(1, &[&address, "cannot be reached"]);
    run(&["device", "status", "--port", "/dev/there-is-none"])
        .failed(1, &["/dev/there-is-none", "cannot be opened"]);
    // This is no valid port name, so the command line itself is wrong.
    let said = run(&["device", "status", "--port", "tcp:nowhere"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("HOST:PORT"), "{}", said.err);
}

#[test]
fn a_device_of_another_version_is_named_and_left_alone() {
    let device = Fake::with(Trouble {
        version: Some(77),
        ..Trouble::default()
    });
    device
        .run(&["config", "get"])
        .failed(1, &["version 77", "touchstone flash"]);
}

#[test]
fn a_silent_device_is_given_up_soon() {
    let device = Fake::with(Trouble {
        silent: true,
        ..Trouble::default()
    });
    let begun = Instant::now();
    device
        .run(&["device", "status"])
        .failed(1, &["no answer", "touchstone doctor"]);
    assert!(begun.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_command_whose_answer_is_damaged_is_not_given_twice() {
    // Answer 0 is that to `Hello`, answer 1 that to the command.
    let device = Fake::with(Trouble {
        damages: Some(1),
        ..Trouble::default()
    });
    device.run(&["device", "reboot"]).failed(
        1,
        &[
            "the device may or may not have carried out the command",
            "touchstone device status",
        ],
    );
    let world = &device.world().1;
    assert!(world.rebooted);
    assert_eq!(world.answers, 2);
}

#[test]
fn a_damaged_answer_is_asked_for_again() {
    let device = Fake::with(Trouble {
        damaged: 2,
        ..Trouble::default()
    });
    assert_eq!(
        device.run(&["config", "get", "motor.pole_pairs"]).done(),
        "motor.pole_pairs = 7\n"
    );
    let device = Fake::with(Trouble {
        damaged: 1000,
        ..Trouble::default()
    });
    device
        .run(&["device", "status"])
        .failed(1, &["no answer (3 damaged frames arrived)"]);
}

#[test]
fn a_connection_that_is_cut_is_named() {
    // The device closes the connection at request 0, which is `Hello`, or at request 1 or 2.
    for at in 0..3 {
        let device = Fake::with(Trouble {
            closes_at: Some(at),
            ..Trouble::default()
        });
        device
            .run(&["device", "status"])
            .failed(1, &["the connection was lost"]);
    }
}

/// Checks that a port may be a symbolic link, as `/dev/knob` of a udev rule. A file that is no port, and a port whose board is
/// unplugged, must give errors.
#[cfg(unix)]
#[test]
fn a_port_may_be_a_link_be_none_or_vanish() {
    use serialport::{SerialPort, TTYPort};
    use std::os::unix::fs::symlink;
    let here = crate::folder("ports");
    let device = Fake::on_a_terminal();
    let knob = here.join("knob");
    symlink(&device.address, &knob).unwrap();
    let knob = knob.display().to_string();
    run(&["device", "status", "--port", &knob]).done();

    std::fs::write(here.join("file"), "").unwrap();
    let nowhere = here.join("nowhere");
    symlink(here.join("none"), &nowhere).unwrap();
    for (port, parts) in [
        (here.join("file"), ["cannot be opened", "not a serial port"]),
        (here.clone(), ["cannot be opened", "not a serial port"]),
        (
            "/dev/null".into(),
            ["cannot be opened", "not a serial port"],
        ),
        (nowhere, ["cannot be opened", "connect the board"]),
    ] {
        let port = port.display().to_string();
        run(&["device", "status", "--port", &port]).failed(1, &[&[&port[..]], &parts[..]].concat());
    }

    let (master, slave) = TTYPort::pair().unwrap();
    let name = slave.name().unwrap();
    drop(slave);
    let waiting = std::thread::spawn(move || run(&["device", "status", "--port", &name]));
    std::thread::sleep(Duration::from_millis(500));
    drop(master);
    let begun = Instant::now();
    let said = waiting.join().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(10));
    said.failed(1, &["error: "]);
}
