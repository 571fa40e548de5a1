//! A simulated service of Haply for tests: speaks both generations of the service's messages and simulates the device.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};
use touchstone_device::haptic::{self, DeviceTwin, HapticDevice, SimulatedArm};
use tungstenite::{Message, WebSocket, accept};

/// A fault of the simulated service's messages.
#[derive(Clone, Copy, PartialEq)]
pub enum Wrong {
    Nothing,
    Gone,
    Silent,
    /// Sends pings instead of device states.
    Pings,
    /// Sends the device state byte by byte, one byte every 200 ms.
    Drip,
    /// Sends the device state as a binary message instead of text.
    Binary,
    Unlisted,
    NoNumber,
    NotReady,
    NoSupply,
    Uncalibrated,
}

/// What the simulated service had received by its end.
#[derive(Debug, Default, Clone)]
pub struct Saw {
    pub longest_n: f64,
    pub last_n: f64,
    pub commands: u32,
    pub refused: u32,
    /// Time for which the client stayed connected after the service stopped sending states, s.
    pub held_s: f64,
}

pub struct Service {
    pub address: String,
    saw: Receiver<Saw>,
}

/// Position of the handle in the device's own frame, m.
const BASE_M: [f64; 3] = [0.05, -0.2, 0.1];

impl Service {
    pub fn new(version: &'static str, wrong: Wrong, at: u32) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let (told, saw) = channel();
        thread::spawn(move || {
            for stream in listener.incoming() {
                let stream = stream.unwrap();
                let mut begin = [0; 12];
                while stream.peek(&mut begin).unwrap() < begin.len() {
                    thread::sleep(Duration::from_millis(1));
                }
                match begin.starts_with(b"GET /version") {
                    true => say_version(stream, version),
                    false => return served(stream, version, wrong, at, &told),
                }
            }
        });
        Self { address, saw }
    }

    pub fn saw(&self) -> Saw {
        self.saw_at_all().expect("the service ends")
    }

    /// Same as [`Self::saw`]; `None` if the service broke, or if nobody connected to its WebSocket.
    pub fn saw_at_all(&self) -> Option<Saw> {
        self.saw.recv_timeout(Duration::from_secs(10)).ok()
    }
}

/// Sends other data than states until the client disconnects or ten seconds are over. Returns the time that passed, s.
fn other_than_states(socket: &mut WebSocket<TcpStream>, wrong: Wrong, state: &str) -> f64 {
    let begun = Instant::now();
    let stream = socket.get_ref().try_clone().unwrap();
    stream.set_nonblocking(true).unwrap();
    let mut bytes = [
        &[0x81, 126][..],
        &(state.len() as u16).to_be_bytes(),
        state.as_bytes(),
    ]
    .concat()
    .into_iter();
    while begun.elapsed() < Duration::from_secs(10) {
        let sent = match wrong {
            Wrong::Pings => socket.send(Message::Ping(Vec::new().into())).is_ok(),
            Wrong::Binary => socket
                .send(Message::binary(state.as_bytes().to_vec()))
                .is_ok(),
            _ => (&stream).write_all(&[bytes.next().unwrap_or(0)]).is_ok(),
        };
        let is_gone = match (&stream).read(&mut [0; 4096]) {
            Ok(0) => true,
            Ok(_) => false,
            Err(why) => why.kind() != std::io::ErrorKind::WouldBlock,
        };
        if !sent || is_gone {
            break;
        }
        let pause_ms = if wrong == Wrong::Drip { 200 } else { 2 };
        thread::sleep(Duration::from_millis(pause_ms));
    }
    begun.elapsed().as_secs_f64()
}

fn say_version(mut stream: TcpStream, version: &str) {
    let _ = stream.read(&mut [0; 1024]);
    let body = format!("{{\"version\":\"{version}\"}}");
    let length = body.len();
    let _ = write!(
        stream,
        "HTTP/1.1 200 OK\r\nContent-Length: {length}\r\n\r\n{body}"
    );
}

fn served(stream: TcpStream, version: &str, wrong: Wrong, at: u32, told: &Sender<Saw>) {
    let mut socket = accept(stream).unwrap();
    let rest = |t: f64| [0.0, 0.0, -0.015 * (t / 0.3).min(1.0)];
    let mut arm = SimulatedArm::new(DeviceTwin::default(), 1000, Box::new(rest)).unwrap();
    arm.engage().unwrap();
    let mut saw = Saw::default();
    for number in 0.. {
        let now = if number >= at { wrong } else { Wrong::Nothing };
        let [x, y, z] =
            std::array::from_fn(|axis| arm.sense().unwrap().position_m[axis] + BASE_M[axis]);
        let id = if now == Wrong::Unlisted {
            "XXXX"
        } else {
            "049D"
        };
        let x = if now == Wrong::NoNumber {
            serde_json::Value::Null
        } else {
            x.into()
        };
        let state = serde_json::json!({ "session_id": 1, "inverse3": [{
            "device_id": id,
            "state": { "cursor_position": { "x": x, "y": y, "z": z }, "mode": "idle" },
            "status": { "calibrated": now != Wrong::Uncalibrated, "ready": now != Wrong::NotReady && now != Wrong::NoSupply, "power_supply": now != Wrong::NoSupply },
        }] });
        match now {
            Wrong::Gone => break,
            Wrong::Silent => thread::sleep(Duration::from_millis(700)),
            Wrong::Pings | Wrong::Drip | Wrong::Binary => {
                saw.held_s = other_than_states(&mut socket, now, &state.to_string());
                break;
            }
            _ => {}
        }
        if socket.send(Message::text(state.to_string())).is_err() {
            break;
        }
        // The service sets the pace: at most one state per millisecond.
        thread::sleep(Duration::from_micros(900));
        let Ok(Message::Text(text)) = socket.read() else {
            break;
        };
        // A link that damages a command ends the connection. What the real service does then is not known.
        let Ok(command) = serde_json::from_str::<serde_json::Value>(&text) else {
            break;
        };
        let key = if version.starts_with("3.1") {
            "values"
        } else {
            "vector"
        };
        let force = &command["inverse3"][0]["commands"]["set_cursor_force"][key];
        saw.commands += 1;
        match ["x", "y", "z"].map(|axis| force[axis].as_f64()) {
            [Some(x), Some(y), Some(z)] => {
                saw.last_n = haptic::length([x, y, z]);
                saw.longest_n = saw.longest_n.max(saw.last_n);
                arm.command([x, y, z]).unwrap();
            }
            _ => saw.refused += 1,
        }
    }
    // The result is ignored, because a test need not read what the service has seen.
    let _ = told.send(saw);
}
