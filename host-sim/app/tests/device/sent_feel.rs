//! Tests of the feels that other programs send to `touchstone events`, by WebSocket and by OSC.

use crate::demo::Demo;
use crate::fake::Fake;
use crate::websocket::Events;
use serde_json::{Value, json};
use touchstone_protocol::{Command, Event};

/// The environment of a board, as `touchstone config environment` prints it.
fn on_board(demo: &Demo) -> String {
    demo.run(&["config", "environment"])
}

/// Checks that a program can send a whole feel: as the text of a scene's file, as the tables in it, and as a shipped scene with
/// changes. The board then renders the same as after `touchstone config environment` with that file.
#[test]
fn a_program_sends_a_whole_feel() {
    let demo = Demo::new();
    demo.run(&["config", "environment", "--change", "0.25", "--wall-alone"]);
    let events = Events::new(&demo, &["--seconds", "120"]);
    let mut program = events.page();
    program.until("position");
    let five = "[environment]\nfirst_wall = false\n[environment.detents]\nper_rev = 12\nstrength_n_m = 0.02\n\
                [environment.endstops]\nlower_rad = -0.1745\nupper_rad = 2.2689\n";
    let shipped = include_str!("../../../../scenes/feels/five-positions.toml");
    let tables = json!({ "environment": {
        "first_wall": false,
        "detents": { "per_rev": 12, "strength_n_m": 0.02 },
        "endstops": { "lower_rad": -0.1745, "upper_rad": 2.2689 },
    } });
    let printed = demo_scene("five-positions");
    let feels = [
        (Value::from("five-positions"), 4),
        (five.into(), 4),
        (shipped.into(), 4),
        (printed.into(), 4),
        (tables.clone(), 4),
        (tables.to_string().into(), 4),
        // Values without torque are counted: 0 to 255.
        ("fine-values".into(), 255),
        (
            "base = \"five-positions\"\nenvironment.detents.per_rev = 24".into(),
            8,
        ),
    ];
    for (feel, last) in feels {
        program.say(&json!({ "feel": feel }).to_string());
        let line = program.next();
        assert_eq!(
            (&line["event"], &line["change"], &line["last"]),
            (&"position".into(), &0.into(), &last.into()),
            "{line} for {feel}"
        );
    }
    drop(events.ended());
    let shown = on_board(&demo);
    for part in [
        "per_rev = 24",
        "strength_n_m = 0.02",
        "upper_rad = 2.2689",
        "0.25 N·m/s",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    // A feel without positions has those of --pitch, between its end stops.
    let events = Events::new(&demo, &["--pitch", "10", "--seconds", "120"]);
    let mut program = events.page();
    program.until("position");
    for (feel, last) in [("hard-stops", 13), ("on-off", 1)] {
        program.say(&json!({ "feel": feel }).to_string());
        let line = program.next();
        assert_eq!(
            (&line["event"], &line["last"]),
            (&"position".into(), &last.into()),
            "{line}"
        );
    }
}

/// The whole scene as text, with every value and comments.
fn demo_scene(name: &str) -> String {
    crate::run(&["run", name, "--print"]).done()
}

/// Checks that a feel with a mistake is answered with the setting and the reason, that no part of it is used, and that no message
/// makes the program read a file.
#[test]
fn a_wrong_feel_is_answered_with_its_setting_and_changes_nothing() {
    let demo = Demo::new();
    demo.run(&["config", "environment", "on-off"]);
    let before = on_board(&demo);
    let events = Events::new(&demo, &["--seconds", "120"]);
    let mut program = events.page();
    program.until("position");
    let detents = |text: &str| format!("[environment.detents]\nper_rev = 12\n{text}");
    for (feel, setting, why) in [
        (
            Value::from(detents("strength_n_m = 3.0")),
            "environment.detents.strength_n_m",
            "feel:3: environment.detents.strength_n_m: 3 is more than the device's law.force_limit_n_m",
        ),
        (
            detents("strength = 0.01").into(),
            "environment.detents.strength",
            "feel:3: environment.detents.strength: ",
        ),
        (
            json!({ "environment": { "detents": { "per_rev": 12, "strength_n_m": -1 } } }),
            "environment.detents.strength_n_m",
            "environment.detents.strength_n_m: ",
        ),
        (
            json!({ "environment": { "endstops": { "lower_rad": 1, "upper_rad": 0 } } }),
            "environment.endstops",
            "environment.endstops",
        ),
        (
            "environment.profile.file = \"/etc/passwd\"".into(),
            "environment.profile.file",
            "only a scene's file names the file of a profile",
        ),
        (json!({}), "environment", "the feel has no such table"),
    ] {
        program.say(&json!({ "feel": feel }).to_string());
        let line = program.next();
        let said = line["problem"].as_str().unwrap_or_default();
        assert!(
            line["event"] == "error" && said.contains(why),
            "{line} for {feel}"
        );
        let named = line["setting"].as_str().unwrap();
        assert!(named.starts_with(setting), "{line}");
    }
    for (request, why) in [
        (
            r#"{"feel": 3}"#.to_owned(),
            "feel: is 3; give a feel's name",
        ),
        (
            r#"{"feel": {"environment": {"wall2": null}}}"#.to_owned(),
            "feel: ",
        ),
        (
            r#"{"feel": "{\"environment\": "}"#.to_owned(),
            "this is not valid JSON",
        ),
        (
            format!(r#"{{"feel": "{}"}}"#, "x".repeat(60_000)),
            "there is no feel xxx",
        ),
    ] {
        program.say(&request);
        let line = program.next();
        let said = line["problem"].as_str().unwrap_or_default();
        assert!(said.contains(why) && said.len() <= 1000, "{line}");
        assert!(
            line["event"] == "error" && line["setting"].is_null(),
            "{line}"
        );
    }
    drop(events.ended());
    assert_eq!(on_board(&demo), before);
}

/// Checks that a feel that the board refuses during a calibration is answered with the board's reason, that the old feel and its
/// positions stay, and that the program then renders the next one.
#[test]
fn a_refusal_of_the_board_is_told_to_the_sender_and_the_program_goes_on() {
    let board = Fake::new();
    board.run(&["config", "environment", "on-off"]).done();
    let events = Events::at(&board.address, &["--seconds", "120"]);
    let [mut program, mut other] = [events.page(), events.page()];
    for page in [&mut program, &mut other] {
        assert_eq!(page.until("position")["last"], 1);
    }
    let happens = |event| assert!(board.world().1.machine.handle(event));
    happens(Event::Command(Command::Calibrate));
    assert_eq!(program.until("state")["state"], "calibrating");
    program.say(r#"{"feel": "five-positions"}"#);
    let line = program.until("error");
    let said = line["problem"].as_str().unwrap();
    assert!(said.contains("state `calibrating`"), "{line}");
    assert_eq!(line["setting"], Value::Null, "{line}");
    happens(Event::Calibrated);
    assert_eq!(program.until("position")["last"], 1);
    program.say(r#"{"feel": "five-positions"}"#);
    assert_eq!(program.until("position")["last"], 4);
    // Every line but the refusal goes to all programs.
    let mut last = Value::Null;
    while last != 4 {
        let line = other.next();
        assert_ne!(line["event"], "error", "{line}");
        if line["event"] == "position" {
            last = line["last"].clone();
        }
    }
}

/// An OSC message with texts as its arguments.
fn osc(address: &str, texts: &[&str]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let types = format!(",{}", "s".repeat(texts.len()));
    for text in [&[address, &*types], texts].concat() {
        bytes.extend(text.as_bytes());
        bytes.resize(bytes.len() / 4 * 4 + 4, 0);
    }
    bytes
}

/// Checks that a program can send a feel as text by OSC, also one that is longer than a network's packet, and that each refused
/// message is answered with the setting and the reason.
#[test]
fn a_program_sends_a_feel_by_osc() {
    use std::net::UdpSocket;
    use std::process::Stdio;
    let demo = Demo::new();
    let program = UdpSocket::bind("127.0.0.1:0").unwrap();
    let limit = Some(std::time::Duration::from_secs(30));
    program.set_read_timeout(limit).unwrap();
    let port = |socket: &UdpSocket| socket.local_addr().unwrap().port().to_string();
    // A port that was free a moment ago.
    let listen = port(&UdpSocket::bind("127.0.0.1:0").unwrap());
    let words = ["events", "--osc", &port(&program), "--osc-listen", &listen];
    let mut events = demo
        .command(&[&["--quiet"], &words[..]].concat())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let next = |address: &str| -> Vec<u8> {
        let mut bytes = [0; 2048];
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
    next("/touchstone/position");
    let long = format!(
        "{}{}",
        include_str!("../../../../scenes/feels/five-positions.toml"),
        "# a comment\n".repeat(500)
    );
    say(&osc("/touchstone/feel", &[&long]));
    next("/touchstone/position");
    for (address, text, setting, problem) in [
        (
            "/touchstone/feel",
            "environment.detents.strength_n_m = 3.0",
            "environment.detents.strength_n_m",
            "feel:1: environment.detents.strength_n_m: 3 is more than the device's law.force_limit_n_m",
        ),
        (
            "/touchstone/feel",
            "ratchett",
            "",
            "there is no feel ratchett; give ",
        ),
        (
            "/touchstone/feels",
            "ratchet",
            "",
            "/touchstone/feels is not a message",
        ),
    ] {
        say(&osc(address, &[text]));
        let answer = next("/touchstone/error");
        let wanted = osc("/touchstone/error", &[setting, problem]);
        // The zero bytes at the end depend on the length of the whole problem.
        let end = wanted.iter().rposition(|byte| *byte != 0).unwrap() + 1;
        let said = String::from_utf8_lossy(&answer);
        assert!(answer.starts_with(&wanted[..end]), "{said:?}");
    }
    events.kill().unwrap();
    events.wait().unwrap();
    let shown = on_board(&demo);
    assert!(
        shown.contains("strength_n_m = 0.02") && shown.contains("per_rev = 12"),
        "{shown}"
    );
}

/// Checks that a program whose OSC messages come back to it does not answer its own answers for ever.
#[test]
fn a_program_that_hears_itself_goes_on() {
    use std::net::UdpSocket;
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    let demo = Demo::new();
    let program = UdpSocket::bind("127.0.0.1:0").unwrap();
    // A port that was free a moment ago.
    let free = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port().to_string();
    drop(free);
    let words = ["--osc", &port, "--osc-listen", &port, "--seconds", "2"];
    let mut events = demo
        .command(&[&["--quiet", "events"], &words[..]].concat())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let ended = loop {
        let message = osc("/touchstone/feel", &["on-off"]);
        let _ = program.send_to(&message, format!("127.0.0.1:{port}"));
        match events.try_wait().unwrap() {
            Some(status) => break status.success(),
            None if begun.elapsed() > Duration::from_secs(60) => break false,
            None => std::thread::sleep(Duration::from_millis(100)),
        }
    };
    let _ = events.kill();
    events.wait().unwrap();
    assert!(ended, "it is still reading its own messages");
    assert!(on_board(&demo).contains("strength_n_m = 0.025"));
}
