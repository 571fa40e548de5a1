//! Tests with a serial port at which no device answers.

use super::{FILES, Output, fresh, met, names};
use crate::Said;
use serialport::{SerialPort, TTYPort};
use std::process::Command;

/// Checks that a command to which no device answers creates no file and no folder.
#[test]
fn a_silent_port_leaves_nothing() {
    let (_master, slave) = TTYPort::pair().unwrap();
    let port = slave.name().unwrap();
    // Keeps the pseudo-terminal open as a plain file. If it were open as a serial port, the command could not open it.
    let _held = std::fs::File::open(&port).unwrap();
    drop(slave);
    let setup = [
        Output("setup --out", "setup -q --out OUT", true, true),
        Output(
            "setup, in a new folder",
            "setup -q --out new/OUT",
            true,
            true,
        ),
    ];
    let of_boards = FILES.iter().filter(|output| output.2);
    for output in of_boards.chain(&setup) {
        let here = fresh("silent", output);
        let words = output.1.replace("OUT", "out");
        let ended = Command::new(env!("CARGO_BIN_EXE_touchstone"))
            .args(words.split(' '))
            .args(["--port", &port])
            .current_dir(&here)
            .output();
        let said = Said::from(ended.unwrap());
        output.fails(&said, "no answer");
        assert!(names(&here).is_empty(), "{}: {:?}", output.0, names(&here));
        met(output, "silent port", "said; nothing is left");
    }
}
