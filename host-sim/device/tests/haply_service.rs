//! The Inverse3 against a service of the tests' own, which speaks both generations of messages around the simulated plant.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;
use touchstone_device::haptic::{DeviceTwin, HapticDevice, HapticFault, SimulatedArm};
use touchstone_device::servo::{
    DevicePace, Ending, ForceLaw, ServoLimits, ServoReport, ServoTick, play,
};
use touchstone_device::{Inverse3, haptic};
use tungstenite::{Message, accept};

/// What goes wrong at a state.
#[derive(Clone, Copy, PartialEq)]
enum Wrong {
    Nothing,
    Gone,
    Silent,
    Unlisted,
    NoNumber,
    NotReady,
    Uncalibrated,
}

/// What a service saw until its end.
#[derive(Debug, Default, Clone)]
struct Saw {
    longest_n: f64,
    last_n: f64,
    commands: u32,
    refused: u32,
}

struct Service {
    address: String,
    saw: Receiver<Saw>,
}

/// Where its own frame has the handle.
const BASE_M: [f64; 3] = [0.05, -0.2, 0.1];

impl Service {
    fn new(version: &'static str, wrong: Wrong, at: u32) -> Self {
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

    fn saw(&self) -> Saw {
        self.saw
            .recv_timeout(Duration::from_secs(10))
            .expect("the service ends")
    }
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
            "status": { "calibrated": now != Wrong::Uncalibrated, "ready": now != Wrong::NotReady, "power_supply": true },
        }] });
        match now {
            Wrong::Gone => break,
            Wrong::Silent => thread::sleep(Duration::from_millis(700)),
            _ => {}
        }
        if socket.send(Message::text(state.to_string())).is_err() {
            break;
        }
        // Its own pace, a state a millisecond at most.
        thread::sleep(Duration::from_micros(900));
        let Ok(Message::Text(text)) = socket.read() else {
            break;
        };
        let command: serde_json::Value = serde_json::from_str(&text).unwrap();
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
    told.send(saw).unwrap();
}

struct Floor;

impl ForceLaw for Floor {
    fn tick(&mut self, [_, _, z]: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        Ok([0.0, 0.0, (-1000.0 * z).max(0.0)])
    }
}

fn played(service: &Service) -> Result<ServoReport, HapticFault> {
    let mut inverse = Inverse3::connect(&service.address)?;
    let rate_hz = inverse.sheet().rates_hz.0;
    let limits = ServoLimits {
        ramp_s: 0.05,
        // A busy machine is no fault of the device.
        late_s: 0.25,
        ..ServoLimits::of(inverse.sheet())
    };
    let more = |tick: &ServoTick| tick.number < 400;
    Ok(play(
        &mut inverse,
        &mut Floor,
        &limits,
        rate_hz,
        &mut DevicePace::new(rate_hz),
        more,
    ))
}

#[test]
fn both_generations_get_a_force_for_every_state_and_none_at_the_end() {
    for version in ["3.1.2", "3.5.0"] {
        let service = Service::new(version, Wrong::Nothing, 0);
        let report = played(&service).unwrap();
        assert_eq!(
            (&report.ending, &report.release),
            (&Ending::Asked, &Ok(())),
            "{version}"
        );
        assert_eq!(report.ticks, 401);
        let saw = service.saw();
        assert_eq!((saw.refused, saw.last_n), (0, 0.0), "{version}: {saw:?}");
        assert!(
            (saw.longest_n - report.force_max_n).abs() < 1e-9 && saw.longest_n > 1.0,
            "{saw:?}"
        );
        assert!(saw.longest_n <= 3.0 + 1e-9, "never more than was chosen");
        // 100 to measure the pace, one to catch up, one a tick, one to end with.
        assert!(saw.commands >= 503, "{saw:?}");
    }
}

#[test]
fn whatever_goes_wrong_ends_with_no_force() {
    let lost = |fault: &HapticFault| matches!(fault, HapticFault::Lost(..));
    let off = |fault: &HapticFault| matches!(fault, HapticFault::SwitchedOff(_));
    type Row = (Wrong, fn(&HapticFault) -> bool, bool);
    let rows: [Row; 5] = [
        (Wrong::Gone, lost, false),
        (Wrong::Silent, lost, true),
        (Wrong::Unlisted, lost, true),
        (Wrong::NoNumber, lost, true),
        (Wrong::NotReady, off, true),
    ];
    for (wrong, expected, reachable) in rows {
        let service = Service::new("3.5.1", wrong, 250);
        let report = played(&service).unwrap();
        assert!(
            matches!(&report.ending, Ending::Fault(fault) if expected(fault)),
            "{:?}",
            report.ending
        );
        let saw = service.saw();
        assert!(saw.longest_n > 0.5, "a force was there");
        assert!(
            !reachable || saw.last_n == 0.0,
            "{:?}: {saw:?}",
            report.ending
        );
    }
}

#[test]
fn what_cannot_be_used_is_said() {
    let service = Service::new("3.5.1", Wrong::Uncalibrated, 0);
    let fault = Inverse3::connect(&service.address).expect_err("not calibrated");
    assert!(
        fault.to_string().contains("049D is not calibrated"),
        "{fault}"
    );
    let service = Service::new("unknown", Wrong::Nothing, 0);
    let fault = Inverse3::connect(&service.address).expect_err("no version");
    assert!(fault.to_string().contains("says no version"), "{fault}");
    // A port that was free a moment ago.
    let free = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .to_string();
    let fault = Inverse3::connect(&free).expect_err("nothing there");
    assert!(
        fault.to_string().contains("no service at 127.0.0.1"),
        "{fault}"
    );
    assert!(fault.fix().contains("--haply"));
}
