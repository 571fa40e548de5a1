//! Tests of `touchstone events`.

use crate::demo::Demo;
use crate::fake::Fake;
use std::io::{BufRead, BufReader};
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
    // With `--pitch` the command counts positions.
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
}
