//! Tests of `touchstone bridge` with a client that follows SmartKnob's published messages and shares no code with the program.

use crate::demo::Demo;
use crate::fake::{Fake, Trouble};
use crate::program;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use touchstone_protocol::{Event, State};

/// Encodes a number as a protobuf varint: seven bits per byte, the lowest bits first.
fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    loop {
        let low = (value & 0x7f) as u8;
        value >>= 7;
        if value == 0 {
            bytes.push(low);
            return bytes;
        }
        bytes.push(low | 0x80);
    }
}
fn field(tag: u64, kind: u64, content: &[u8]) -> Vec<u8> {
    [&varint(tag << 3 | kind)[..], content].concat()
}
fn whole(tag: u64, value: i64) -> Vec<u8> {
    field(tag, 0, &varint(value.cast_unsigned()))
}
fn float(tag: u64, value: f32) -> Vec<u8> {
    field(tag, 5, &value.to_le_bytes())
}
fn bytes(tag: u64, content: &[u8]) -> Vec<u8> {
    field(
        tag,
        2,
        &[&varint(content.len() as u64)[..], content].concat(),
    )
}

/// Ethernet's CRC-32, computed bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    })
}
fn stuffed(content: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    for block in content.split(|byte| *byte == 0) {
        assert!(block.len() < 254);
        out.push(block.len() as u8 + 1);
        out.extend(block);
    }
    out.push(0);
    out
}
fn unstuffed(frame: &[u8]) -> Vec<u8> {
    let (mut out, mut at) = (Vec::new(), 0);
    while at < frame.len() {
        let count = usize::from(frame[at]);
        out.extend(&frame[at + 1..at + count]);
        at += count;
        if count < 255 && at < frame.len() {
            out.push(0);
        }
    }
    out
}

/// A field of a protobuf message: its tag, its integer or the bits of its float, and its bytes.
type Part = (u64, u64, Vec<u8>);
fn parts(mut message: &[u8]) -> Vec<Part> {
    fn number(message: &mut &[u8]) -> u64 {
        let (mut value, mut shift) = (0, 0);
        loop {
            let byte = message[0];
            *message = &message[1..];
            value |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte & 0x80 == 0 {
                return value;
            }
        }
    }
    let mut all = Vec::new();
    while !message.is_empty() {
        let key = number(&mut message);
        let (value, content) = match key & 7 {
            0 => (number(&mut message), Vec::new()),
            5 => {
                let (bits, rest) = message.split_at(4);
                message = rest;
                (
                    u32::from_le_bytes(bits.try_into().unwrap()).into(),
                    Vec::new(),
                )
            }
            2 => {
                let length = number(&mut message) as usize;
                let (content, rest) = message.split_at(length);
                message = rest;
                (0, content.to_vec())
            }
            kind => panic!("kind {kind}"),
        };
        all.push((key >> 3, value, content));
    }
    all
}
fn content(parts: &[Part], tag: u64) -> Option<&[u8]> {
    let part = parts.iter().find(|part| part.0 == tag)?;
    Some(&part.2)
}
fn value(parts: &[Part], tag: u64) -> u64 {
    parts.iter().find(|part| part.0 == tag).map_or(0, |it| it.1)
}

/// Position in a state message, as a signed 32-bit number. Protobuf omits the field if the position is 0.
fn position_of(state: &[Part]) -> i32 {
    value(state, 1) as u32 as i32
}

pub struct Client {
    terminal: File,
    buffer: Vec<u8>,
    nonce: i64,
    acknowledged: Vec<u64>,
    logs: Vec<String>,
    /// Position and configuration name in the newest state message.
    state: Option<(i32, String)>,
    positions: Vec<i32>,
    /// Distance from the position in the newest state message.
    beside: f32,
}

impl Client {
    fn new(path: &str) -> Self {
        let raw = std::process::Command::new("stty")
            .args(["-F", path, "raw", "-echo"])
            .status();
        assert!(raw.unwrap().success());
        let terminal = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags(0o4000)
            .open(path)
            .unwrap();
        Self {
            terminal,
            buffer: Vec::new(),
            nonce: 70,
            acknowledged: Vec::new(),
            logs: Vec::new(),
            state: None,
            positions: Vec::new(),
            beside: 0.0,
        }
    }

    fn send(&mut self, payload: &[u8]) -> u64 {
        self.nonce += 1;
        self.send_as(self.nonce, payload)
    }

    fn send_as(&mut self, nonce: i64, payload: &[u8]) -> u64 {
        let message = [&whole(1, 1)[..], &whole(2, nonce), payload].concat();
        let sum = crc(&message).to_le_bytes();
        let frame = stuffed(&[&message[..], &sum].concat());
        self.terminal.write_all(&frame).unwrap();
        nonce.cast_unsigned()
    }

    /// Reads messages until the condition holds; panics after two minutes.
    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let end = Instant::now() + Duration::from_secs(120);
        while !holds(self) {
            assert!(
                Instant::now() < end,
                "never: {what}; {:?} {:?}",
                self.state,
                self.logs
            );
            let mut bytes = [0; 1024];
            match self.terminal.read(&mut bytes) {
                Ok(count) => self.buffer.extend(&bytes[..count]),
                Err(_) => std::thread::sleep(Duration::from_millis(5)),
            }
            while let Some(end) = self.buffer.iter().position(|byte| *byte == 0) {
                let frame: Vec<u8> = self.buffer.drain(..=end).collect();
                self.take(&unstuffed(&frame[..end]));
            }
        }
    }

    fn take(&mut self, frame: &[u8]) {
        let (message, sum) = frame.split_at(frame.len() - 4);
        assert_eq!(crc(message).to_le_bytes(), sum);
        let message = parts(message);
        assert_eq!(value(&message, 1), 1, "version");
        if let Some(ack) = content(&message, 2) {
            self.acknowledged.push(value(&parts(ack), 1));
        }
        if let Some(log) = content(&message, 3) {
            let words = content(&parts(log), 1).unwrap_or_default().to_vec();
            self.logs.push(String::from_utf8(words).unwrap());
        }
        if let Some(state) = content(&message, 4) {
            let state = parts(state);
            let config = content(&state, 3).map(parts).unwrap_or_default();
            let name = content(&config, 10).unwrap_or_default().to_vec();
            let now = position_of(&state);
            self.beside = f32::from_bits(value(&state, 2) as u32);
            if self.positions.last() != Some(&now) {
                self.positions.push(now);
            }
            self.state = Some((now, String::from_utf8(name).unwrap()));
        }
    }
}

/// Encodes a configuration. `position` is the number of the present position, `bounds` the first and last number, `only` the
/// positions that have detents.
fn config(position: i64, bounds: [i64; 2], width_deg: f32, only: &[u64], name: &str) -> Vec<u8> {
    let mut config = [
        whole(1, position),
        whole(4, bounds[0]),
        whole(5, bounds[1]),
        float(6, width_deg.to_radians()),
        float(7, 1.0),
        float(8, 1.0),
        float(9, 0.7),
        bytes(10, name.as_bytes()),
    ]
    .concat();
    if !only.is_empty() {
        let list: Vec<u8> = only.iter().flat_map(|number| varint(*number)).collect();
        config.extend(bytes(11, &list));
    }
    bytes(4, &config)
}

/// A running `touchstone bridge`; its process ends with the test.
pub struct Bridge(pub Child);

impl Drop for Bridge {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts the program on a board, and connects a client to its pseudo terminal.
fn bridged(board: &Demo) -> (Bridge, Client) {
    connected(board.command(&["bridge", "--arm"]))
}

/// Starts the program at this port, and connects a client that chooses a dial. The program then arms the board.
pub fn armed(port: &str) -> (Bridge, Client) {
    let (bridge, mut client) = connected(program(&["bridge", "--arm", "--port", port]));
    client.send(&config(5, [0, 10], 12.0, &[], "dial"));
    (bridge, client)
}

fn connected(mut command: Command) -> (Bridge, Client) {
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut bridge = Bridge(command.spawn().unwrap());
    let mut path = String::new();
    BufReader::new(bridge.0.stdout.take().unwrap())
        .read_line(&mut path)
        .unwrap();
    let client = Client::new(path.trim());
    (bridge, client)
}

#[test]
fn a_program_for_a_smartknob_configures_turns_and_reads_a_board() {
    configures_turns_and_reads(&mut Demo::new());
}

/// Runs `configures_turns_and_reads` on the emulated firmware of a board.
#[test]
#[ignore = "needs the emulated firmware; `cargo xtask smartknob` builds it and runs this test"]
fn a_program_for_a_smartknob_configures_turns_and_reads_the_emulated_firmware() {
    configures_turns_and_reads(&mut Demo::emulated());
}

/// Checks that a reset of the board changes neither the position number nor the configuration that the client sees.
#[test]
#[ignore = "needs the emulated firmware; `cargo xtask smartknob` builds it and runs this test"]
fn a_reset_keeps_the_position_of_the_emulated_firmware() {
    let mut board = Demo::emulated();
    board.run(&["device", "calibrate"]);
    let (_bridge, mut client) = bridged(&board);
    board.happens("turn 0");
    client.send(&config(5, [0, 10], 12.0, &[], "dial"));
    client.until("a dial", |it| {
        it.state.as_ref().is_some_and(|state| state.1 == "dial")
    });
    board.happens("turn 26");
    client.until("position 7", |it| it.positions.last() == Some(&7));
    board.happens("reset");
    client.until("a reset", |it| {
        it.logs
            .iter()
            .any(|words| words.contains("zero has changed"))
    });
    let asked = client.send(&bytes(3, &[]));
    client.until("a state", |it| it.acknowledged.contains(&asked));
    assert_eq!(client.positions.last(), Some(&7), "{:?}", client.positions);
    assert_eq!(client.state.as_ref().unwrap().1, "dial");
}

fn configures_turns_and_reads(demo: &mut Demo) {
    demo.run(&["device", "calibrate"]);
    let (mut bridge, mut client) = bridged(demo);
    demo.happens("turn 0");
    let nonce = client.send(&config(5, [0, 10], 12.0, &[], "dial"));
    client.until("a dial", |it| {
        it.acknowledged.contains(&nonce) && it.state.as_ref().is_some_and(|state| state.1 == "dial")
    });
    // The knob turns to its end and back, and each position is reported once in each direction.
    demo.happens("turn 120");
    client.until("position 10", |it| it.positions.last() == Some(&10));
    demo.happens("turn -150");
    client.until("position 0", |it| it.positions.last() == Some(&0));
    let turned = client
        .positions
        .split_off(client.positions.iter().position(|it| *it == 5).unwrap());
    assert_eq!(turned, [5, 6, 7, 8, 9, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0]);
    // A repeated message is acknowledged, but not carried out again.
    let again = client.send_as(client.nonce, &config(3, [0, 10], 12.0, &[], "again"));
    client.until("a repetition", |it| {
        it.logs
            .iter()
            .any(|words| words.contains(&format!("Already handled nonce {again}")))
    });
    assert_eq!(client.state.as_ref().unwrap().1, "dial");
    // Magnetic detents at four of 32 positions, with a narrower width than before.
    client.send(&config(10, [0, 31], 7.0, &[2, 10, 21, 22], "magnetic"));
    client.until("magnetic detents", |it| {
        it.state
            .as_ref()
            .is_some_and(|state| *state == (10, "magnetic".into()))
    });
    // An invalid configuration is answered with a log line and changes nothing.
    client.send(&config(0, [0, 1], 400.0, &[], "wide"));
    client.until("a refusal", |it| {
        it.logs
            .iter()
            .any(|words| words.contains("position_width_radians"))
    });
    client.send(&[0xff; 3]);
    client.until("a complaint", |it| {
        it.logs
            .iter()
            .any(|words| words.contains("Decoding failed"))
    });
    let asked = client.send(&bytes(3, &[]));
    client.until("a state", |it| it.acknowledged.contains(&asked));
    assert_eq!(client.state.as_ref().unwrap().1, "magnetic");
    // Ctrl-C switches the board off.
    let stopped = std::process::Command::new("kill")
        .args(["-INT", &bridge.0.id().to_string()])
        .status();
    assert!(stopped.unwrap().success());
    assert!(bridge.0.wait().unwrap().success());
    assert!(demo.run(&["device", "status"]).contains("ready"));
}

/// Checks a knob whose number is below the first one of a new configuration. It gets the first number without being moved: its end
/// stop exerts no force.
#[test]
fn bounds_beside_the_knob_do_not_push_it() {
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    let (_bridge, mut client) = bridged(&demo);
    demo.happens("turn -40");
    client.until("a turn", |it| it.positions.last() == Some(&-4));
    client.send(&config(0, [0, 10], 10.0, &[], "above"));
    client.until("bounds", |it| {
        it.state
            .as_ref()
            .is_some_and(|state| *state == (0, "above".into()))
    });
    assert!(client.beside.abs() < 1.5, "{}", client.beside);
}

/// Checks that a board that refuses to be armed, and one that calibrates and refuses a configuration, tell the program why, and that
/// the program keeps its knob.
#[test]
fn a_refusal_by_the_board_is_told_and_does_not_end_the_bridge() {
    let board = Fake::new();
    let (_bridge, mut client) = armed(&board.address);
    let logs = |client: &Client, begin: &str| client.logs.iter().any(|it| it.starts_with(begin));
    client.until("no arming", |it| logs(it, "Not armed: "));
    let calibrates = Event::Command(touchstone_protocol::Command::Calibrate);
    assert!(board.world().1.machine.handle(calibrates));
    client.send(&config(0, [0, 3], 20.0, &[], "later"));
    client.until("a refusal", |it| logs(it, "Ignoring config: "));
    client.until("the first configuration", |it| {
        it.state.as_ref().is_some_and(|state| state.1 == "dial")
    });
    assert_eq!(board.world().1.machine.state(), State::Calibrating);
}

#[test]
fn a_board_of_one_wall_is_no_smartknob() {
    let device = Fake::with(Trouble {
        small: true,
        ..Trouble::default()
    });
    let said = device.run(&["bridge", "--seconds", "0.2"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("touchstone demo"), "{}", said.err);
}
