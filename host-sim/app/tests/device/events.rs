//! Tests of `touchstone events`.

use crate::demo::Demo;
use crate::fake::Fake;
use crate::websocket::Events;
use std::io::{BufRead, BufReader};
#[cfg(target_os = "linux")]
use std::process::Command;
use std::process::Stdio;

/// Turns a dial of eleven detents up to its end and back. Checks that the program prints every position once, in order, and that
/// the position stays constant while the hand holds the end.
#[test]
fn a_program_gets_every_position_of_a_turned_knob() {
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    demo.run(&["config", "environment", "bounded-detents"]);
    demo.happens("turn 0");
    demo.run(&["device", "arm"]);
    let mut events = demo
        .command(&["--json", "events", "--position", "100", "--seconds", "60"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(events.stdout.take().unwrap()).lines();
    let mut next = || -> serde_json::Value {
        serde_json::from_str(&lines.next().expect("events ended").unwrap()).unwrap()
    };
    let state = next();
    assert_eq!(
        (&state["event"], &state["state"]),
        (&"state".into(), &"armed".into()),
        "{state}"
    );
    let first = next();
    assert_eq!(
        (&first["position"], &first["change"]),
        (&100.into(), &0.into()),
        "{first}"
    );
    // The first position may be 0 or 1, because the hand has already begun to turn.
    let begun = first["first"].as_i64().unwrap();
    assert_eq!(first["last"].as_i64(), Some(begun + 10));
    demo.happens("turn 200");
    let mut position = 100;
    while position < begun + 10 {
        let event = next();
        assert_eq!(event["change"], 1, "{event}");
        position += 1;
        assert_eq!(event["position"], position, "{event}");
    }
    demo.happens("turn -40");
    while position > begun {
        let event = next();
        assert_eq!(event["change"], -1, "{event}");
        position -= 1;
        assert_eq!(event["position"], position, "{event}");
    }
    events.kill().unwrap();
    events.wait().unwrap();
}

#[test]
fn a_knob_without_positions_says_what_to_give() {
    let device = Fake::new();
    let said = device.run(&["events", "--seconds", "0.3"]);
    assert_eq!(said.code, Some(2));
    assert!(
        said.err.contains("--pitch") && said.err.contains("config environment"),
        "{}",
        said.err
    );
    // With `--pitch`, a device without detents has positions, too.
    let said = device
        .run(&["events", "--pitch", "10", "--seconds", "0.3"])
        .done();
    assert!(said.contains("position"), "{said}");
    for wrong in ["0", "-1", "361"] {
        assert_eq!(
            device.run(&["events", "--pitch", wrong]).code,
            Some(2),
            "{wrong}"
        );
    }
    // At port 0 no program could be reached, and none could reach this one.
    for option in ["--osc", "--osc-listen"] {
        let said = device.run(&["events", "--pitch", "10", "--seconds", "0.3", option, "0"]);
        said.failed(2, &[option, "65535"]);
    }
}

/// Checks that a missing folder is refused before the board is asked anything, and that a number that cannot be stored leaves the
/// board with its own telemetry rate. The folder /proc exists, but nobody can make a file in it.
#[test]
#[cfg(target_os = "linux")]
fn a_number_that_cannot_be_stored_is_refused_and_leaves_the_telemetry_as_it_was() {
    let device = Fake::new();
    let events = |file: &str| {
        let words = ["--quiet", "events", "--pitch", "10", "--seconds", "0.3"];
        device.run(&[&words[..], &["--keep", file]].concat())
    };
    events("/no/such/folder/n").failed(2, &["there is no folder /no/such/folder", "--keep"]);
    assert_eq!(device.world().1.answers, 0);
    events("/proc/touchstone-number").failed(2, &["--keep"]);
    let (session, world) = &*device.world();
    assert_eq!(world.decimation, session.settings().telemetry.decimation);
}

/// Checks that a knob with a bias leaves number 0 later than it comes back to it, on both sides, and that wrong
/// values are refused by name.
#[test]
fn a_bias_holds_a_knob_longer_at_its_first_position() {
    let board = Fake::new();
    board.run(&["config", "environment", "smooth"]).done();
    let words = [
        "--pitch",
        "10",
        "--hysteresis",
        "0.1",
        "--bias",
        "0.3",
        "--position",
        "0",
    ];
    board.world().1.count = 0;
    let events = Events::at(
        &board.address,
        &[&words[..], &["--seconds", "120"]].concat(),
    );
    let mut program = events.page();
    assert_eq!(program.until("position")["position"], 0);
    // Number 0 is left at 0.5 + 0.1 + 0.3 of the way and entered at 0.5 - 0.1 + 0.3 of it.
    let turn = |share: f64| board.world().1.count = (share * 16384.0 / 36.0) as i32;
    for (before, after, position) in [
        (0.88, 0.92, 1),
        (0.72, 0.68, 0),
        (-0.88, -0.92, -1),
        (-0.72, -0.68, 0),
    ] {
        turn(before);
        // Long enough for a wrong change to come first.
        std::thread::sleep(std::time::Duration::from_millis(200));
        turn(after);
        let line = program.until("position");
        assert_eq!(line["position"], position, "{before} to {after}: {line}");
        let found = line["angle_rad"].as_f64().unwrap().to_degrees() / 10.0;
        assert!((found - after).abs() < 0.01, "{before} to {after}: {line}");
    }
    for (wrong, named) in [
        (["--bias", "-0.1"], "between 0 and 0.49"),
        (["--bias", "0.5"], "between 0 and 0.49"),
        (["--bias", "far"], "between 0 and 0.49"),
        (
            ["--bias", "0.3"],
            "give --bias 0.240 at most, or a smaller --hysteresis",
        ),
    ] {
        let said = board.run(&[&["events"][..], &wrong].concat());
        assert_eq!(said.code, Some(2), "{wrong:?}");
        assert!(
            said.err.contains("--bias") && said.err.contains(named),
            "{}",
            said.err
        );
    }
}

/// Checks that a program on this computer gets positions as OSC messages, numbers them and chooses the feel. Each refused message
/// is noted.
#[test]
fn a_program_gets_positions_and_chooses_the_feel_by_osc() {
    use std::net::UdpSocket;
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    demo.happens("turn 0");
    let program = UdpSocket::bind("127.0.0.1:0").unwrap();
    program
        .set_read_timeout(Some(std::time::Duration::from_secs(30)))
        .unwrap();
    let port = |socket: &UdpSocket| socket.local_addr().unwrap().port().to_string();
    // A port that was free a moment ago.
    let listen = port(&UdpSocket::bind("127.0.0.1:0").unwrap());
    let mut events = demo
        .command(&[
            "--json",
            "events",
            "--osc",
            &port(&program),
            "--osc-listen",
            &listen,
            "--seconds",
            "60",
        ])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let next = |address: &str| -> Vec<u8> {
        let mut bytes = [0; 1024];
        loop {
            let (length, _) = program.recv_from(&mut bytes).expect("a message");
            if bytes.starts_with(address.as_bytes()) {
                return bytes[..length].to_vec();
            }
        }
    };
    let say = |message: &[u8]| {
        let sent = program.send_to(message, format!("127.0.0.1:{listen}"));
        assert_eq!(sent.unwrap(), message.len());
    };
    // The knob has no detents, so each position is a whole turn.
    let first = next("/touchstone/position\0\0\0\0,iif\0\0\0\0");
    assert_eq!(&first[32..36], [0; 4]);
    say(b"/touchstone/position\0\0\0\0,i\0\0\0\0\0\x64");
    let numbered = next("/touchstone/position");
    assert_eq!(&numbered[32..36], 100_i32.to_be_bytes());
    // Invalid requests: a file in place of a feel, and a text in place of a number.
    say(b"/touchstone/feel\0\0\0\0,s\0\0/etc/passwd\0");
    say(b"/touchstone/position\0\0\0\0,s\0\0no\0\0");
    say(b"/touchstone/feel\0\0\0\0,s\0\0bounded-detents\0");
    let chosen = next("/touchstone/position");
    assert_eq!(&chosen[36..40], [0; 4], "the first of the new positions");
    events.kill().unwrap();
    let said = std::io::read_to_string(events.stderr.take().unwrap()).unwrap();
    events.wait().unwrap();
    assert!(said.contains("there is no feel /etc/passwd"), "{said}");
    assert!(
        said.contains("/touchstone/position is not a message"),
        "{said}"
    );
    let shown = demo.run(&["config", "environment"]);
    assert!(shown.contains("[environment.endstops]"), "{shown}");
}

/// Checks that a reset of the board and a calibration, which turns the shaft, do not change the position's number. The next start
/// reads the number from the file.
#[test]
#[cfg(target_os = "linux")]
#[ignore = "needs the emulated firmware; `cargo xtask smartknob` builds it and runs this test"]
fn a_number_is_kept_over_a_reset_of_the_emulated_firmware() {
    let kept = crate::folder("kept-number").join("number");
    let kept = kept.display().to_string();
    let mut board = Demo::emulated();
    board.run(&["device", "calibrate"]);
    board.happens("turn 0");
    let words = ["--json", "events", "--pitch", "10", "--keep", &kept];
    let follow = |board: &Demo, seconds: &str| {
        let mut events = board
            .command(&[&words[..], &["--seconds", seconds]].concat())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        (
            BufReader::new(events.stdout.take().unwrap()).lines(),
            events,
        )
    };
    let parsed = |line: std::io::Result<String>| -> serde_json::Value {
        serde_json::from_str(&line.unwrap()).unwrap()
    };
    let (mut lines, mut events) = follow(&board, "60");
    let mut next = || loop {
        let line = parsed(lines.next().expect("events ended"));
        if line["event"] == "position" {
            return (
                line["position"].as_i64().unwrap(),
                line["change"].as_i64().unwrap(),
            );
        }
    };
    let (begun, change) = next();
    assert_eq!(change, 0);
    board.happens("turn 30");
    for step in 1..=3 {
        assert_eq!(next(), (begun + step, 1));
    }
    board.happens("reset");
    assert_eq!(next(), (begun + 3, 0));
    let ended = Command::new("kill")
        .args(["-INT", &events.id().to_string()])
        .status();
    assert!(ended.unwrap().success());
    assert!(events.wait().unwrap().success());
    assert_eq!(
        std::fs::read_to_string(&kept).unwrap(),
        format!("{}\n", begun + 3)
    );
    // The next start continues with the number in the file.
    let (mut lines, mut events) = follow(&board, "1");
    let first = lines
        .by_ref()
        .map(parsed)
        .find(|line| line["event"] == "position");
    assert_eq!(first.unwrap()["position"], begun + 3);
    events.wait().unwrap();
}
