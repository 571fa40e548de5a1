//! Tests of `touchstone events --midi` with a FIFO and a pseudo terminal in place of a raw MIDI device, and of `--keys`.

use crate::demo::Demo;
use crate::{folder, run};
use serialport::{SerialPort, TTYPort};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

struct Events(Child);

impl Events {
    fn new(demo: &Demo, words: &[&str]) -> Self {
        let words = [&["events", "--seconds", "120"], words].concat();
        let mut command = demo.command(&words);
        command.stdout(Stdio::piped());
        Self(command.spawn().unwrap())
    }
}

impl Drop for Events {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Reads bytes in a thread, and sends each to the returned receiver.
fn bytes(mut from: impl Read + Send + 'static) -> Receiver<u8> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut byte = [0];
        loop {
            match from.read(&mut byte) {
                Ok(1) if sender.send(byte[0]).is_ok() => {}
                Err(error) if error.kind() == std::io::ErrorKind::TimedOut => {}
                _ => break,
            }
        }
    });
    receiver
}

fn message(bytes: &Receiver<u8>) -> [u8; 3] {
    [0; 3].map(|_| {
        bytes
            .recv_timeout(Duration::from_secs(60))
            .expect("a message")
    })
}

/// Turns a dial of eleven positions to its end and back. Checks that every position is one control change, with exactly these
/// bytes.
#[test]
fn a_dial_is_a_midi_controller() {
    let values = [0, 13, 25, 38, 51, 64, 76, 89, 102, 114, 127];
    let fifo = folder("midi").join("line");
    let made = Command::new("mkfifo").arg(&fifo).status();
    assert!(made.unwrap().success());
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    demo.run(&["config", "environment", "bounded-detents"]);
    demo.happens("turn 30");
    demo.run(&["device", "arm"]);
    let path = fifo.display().to_string();
    let _events = Events::new(&demo, &["--midi", &path, "--midi-channel", "3"]);
    // A FIFO that is opened for both directions does not wait for a writer.
    let both = std::fs::File::options().read(true).write(true).open(&fifo);
    let line = bytes(both.unwrap());
    demo.happens("turn 250");
    let mut index = {
        let first = message(&line);
        assert_eq!(first[..2], [0xb2, 16]);
        values.iter().position(|it| *it == first[2]).unwrap()
    };
    for step in [1, -1] {
        let next = |index: usize| {
            index
                .checked_add_signed(step)
                .filter(|it| *it < values.len())
        };
        while let Some(after) = next(index) {
            index = after;
            assert_eq!(message(&line), [0xb2, 16, values[index]]);
        }
        demo.happens("turn -60");
    }
}

/// Checks that a program change chooses a feel, and that a control change sets the value of a knob without end stops.
#[test]
fn a_midi_program_chooses_the_feel_and_sets_the_value() {
    let feels = touchstone_sim::scene::feels();
    let number = |name: &str| feels.iter().position(|it| *it == name).unwrap() as u8;
    let (mut program, slave) = TTYPort::pair().unwrap();
    program.set_timeout(Duration::from_millis(100)).unwrap();
    let path = slave.name().unwrap();
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    demo.happens("turn 0");
    demo.run(&["device", "arm"]);
    let mut events = Events::new(&demo, &["--midi", &path, "--midi-controller", "7"]);
    let mut said = BufReader::new(events.0.stdout.take().unwrap()).lines();
    let line = bytes(program.try_clone_native().unwrap());
    // The first message contains a MIDI clock byte. The second feel is sent with running status.
    program
        .write_all(&[
            0xc0,
            number("bounded-detents"),
            0xf8,
            number("coarse-detents"),
        ])
        .unwrap();
    for feel in ["bounded-detents", "coarse-detents"] {
        let feel = format!("feel {feel}");
        let is_said = said.any(|line| line.unwrap().ends_with(&feel));
        assert!(is_said, "{feel}");
    }
    program.write_all(&[0xb0, 7, 100]).unwrap();
    std::thread::sleep(Duration::from_secs(1));
    demo.happens("turn 90");
    // The knob may move either way before it is turned, but each message is one step.
    let mut last = 100;
    while last != 103 {
        let [status, controller, value] = message(&line);
        assert_eq!([status, controller], [0xb0, 7]);
        assert_eq!(value.abs_diff(last), 1, "from {last} to {value}");
        last = value;
    }
}

#[test]
fn what_is_no_midi_device_and_no_key_is_refused() {
    let file = folder("midi-errors").join("file");
    std::fs::write(&file, "").unwrap();
    let file = file.display().to_string();
    let device = crate::fake::Fake::new();
    for (words, part) in [
        (&["--midi", "/nowhere/midi"][..], "/dev/snd/midi"),
        (&["--midi", &file], "neither a device nor a FIFO"),
        (
            &[
                "--midi",
                "/dev/null",
                "--midi-value",
                "14-bit",
                "--midi-controller",
                "40",
            ],
            "from 0 to 31",
        ),
        (&["--midi-channel", "3"], "--midi"),
        (
            &["--midi", "/dev/null", "--midi-channel", "17"],
            "between 1 and 16",
        ),
        (&["--keys", "volumeup"], "volumeup,volumedown"),
        (&["--keys", "volumeup,nosuchkey"], "--keys"),
    ] {
        let said = device.run(&[&["events", "--pitch", "10"], words].concat());
        assert_eq!(said.code, Some(2), "{words:?}: {}", said.err);
        assert!(said.err.contains(part), "{words:?}: {}", said.err);
    }
    assert!(run(&["events", "--help"]).done().contains("relative"));
}
