//! Tests of `touchstone live --port`: which clients may connect, what the page shows, which orders the board executes, and that no
//! wall stays on after its page is closed.

use crate::fake::{Fake, Trouble, nonsense};
use crate::program;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Stdio};
use std::time::{Duration, Instant};
use touchstone_protocol::{FaultCode, Phase};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Longest time for any step of these tests, with a margin for a busy machine.
const LIMIT: Duration = Duration::from_secs(20);

/// A running `touchstone live --port`; its process ends with the test.
struct Served {
    child: Child,
    out: BufReader<ChildStdout>,
    host: String,
    token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Served {
    fn new(device: &Fake) -> Self {
        let mut child = program(&["live", "--no-open", "--port", &device.address])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        out.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("page    http://").unwrap();
        let (host, token) = address.split_once("/?token=").unwrap();
        assert!(
            host.starts_with("127.0.0.1:") && token.len() == 32,
            "{line}"
        );
        let (host, token) = (host.to_owned(), token.to_owned());
        Self {
            child,
            out,
            host,
            token,
        }
    }

    /// Sends raw bytes to the server and returns its answer.
    fn raw(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        // The server may close the connection before it has received all bytes, so an error is ignored.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Sends an HTTP GET request with these headers and returns the answer.
    fn get(&self, path: &str, host: &str, headers: &str) -> String {
        self.raw(format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n{headers}\r\n").as_bytes())
    }

    fn socket(&self, token: &str, origin: Option<&str>) -> Result<Page, String> {
        let mut request = format!("ws://{}/socket?token={token}", self.host)
            .into_client_request()
            .unwrap();
        if let Some(origin) = origin {
            let headers = request.headers_mut();
            headers.insert("Origin", origin.parse().unwrap());
        }
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(Page {
                socket,
                numbers: Vec::new(),
            }),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Opens a page's WebSocket as a browser does. Repeats while the server still holds the connection of an earlier page.
    fn page(&self) -> Page {
        let begun = Instant::now();
        loop {
            match self.socket(&self.token, Some(&format!("http://{}", self.host))) {
                Ok(page) => return page,
                Err(error) => assert!(begun.elapsed() < LIMIT, "{error}"),
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

/// A page in the browser, as the test imitates it: its end of the WebSocket, with the telemetry received so far.
struct Page {
    socket: WebSocket<TcpStream>,
    /// All numbers of all telemetry records that the page has received.
    numbers: Vec<f64>,
}

impl Page {
    fn say(&mut self, order: Value) {
        self.socket.send(Message::text(order.to_string())).unwrap();
    }

    /// Waits for a JSON message that satisfies `holds`, and returns it. Stores and acknowledges telemetry batches meanwhile.
    #[track_caller]
    fn until(&mut self, holds: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        while begun.elapsed() < LIMIT {
            let message = match self.socket.read() {
                // A system call was interrupted, for example because the process was paused. The read is repeated.
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::Interrupted => {
                    continue;
                }
                read => read.unwrap(),
            };
            match message {
                Message::Text(text) => {
                    let words: Value = serde_json::from_str(text.as_str()).unwrap();
                    if holds(&words) {
                        return words;
                    }
                }
                Message::Binary(bytes) => {
                    let all = bytes.chunks_exact(8);
                    let mut all = all.map(|eight| f64::from_le_bytes(eight.try_into().unwrap()));
                    let batch = all.next().unwrap();
                    self.numbers.extend(all);
                    self.say(json!({ "seen": batch as u64 }));
                }
                _ => {}
            }
        }
        panic!("it was never said");
    }

    #[track_caller]
    fn until_phase(&mut self, phase: &str) -> Value {
        self.until(|words| words["type"] == "state" && words["phase"] == phase)
    }

    /// Sends an order, waits for its result, and returns its error message, if any.
    #[track_caller]
    fn ask(&mut self, order: Value) -> Option<String> {
        self.say(order.clone());
        let done = self.until(|words| words["type"] == "done" && words["do"] == order["do"]);
        done["error"].as_str().map(str::to_owned)
    }

    #[track_caller]
    fn arm(&mut self) {
        // A calibration can only begin if the device is stopped or was just switched on.
        let _ = self.ask(json!({ "do": "stop" }));
        assert_eq!(self.ask(json!({ "do": "calibrate" })), None);
        self.until_phase("ready");
        assert_eq!(self.ask(json!({ "do": "arm" })), None);
        self.until_phase("armed");
    }
}

/// Waits until the device is in this phase.
#[track_caller]
fn stands(device: &Fake, phase: Phase) {
    let begun = Instant::now();
    loop {
        let now = Phase::from(device.world().1.machine.state());
        if now == phase {
            return;
        }
        assert!(begun.elapsed() < LIMIT, "{now:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Runs a whole session of a page with the board, from the server's greeting to the stop.
fn talk(device: &Fake) {
    let served = Served::new(device);
    let mut page = served.page();
    let hello = page.until(|words| words["type"] == "hello");
    let fields = hello["fields"].as_array().unwrap();
    let field = |fields: &[Value], path: &str| {
        let found = fields.iter().find(|field| field["path"] == path);
        found.unwrap_or_else(|| panic!("no {path}")).clone()
    };
    let stiffness = field(fields, "wall.k_desired_n_m_per_rad");
    assert!(fields.len() > 50 && stiffness["unit"] == "N·m/rad");
    assert!(stiffness["value"]["max"].is_string() && stiffness["about"].is_string());
    page.until_phase("boot");
    let refused = page.ask(json!({ "do": "arm" })).unwrap();
    assert!(
        refused.contains("state `boot`; calibrate first"),
        "{refused}"
    );
    let set =
        |value: &str| json!({ "do": "set", "path": "wall.k_desired_n_m_per_rad", "value": value });
    assert_eq!(page.ask(set("1.5")), None);
    let hello = page.until(|words| words["type"] == "hello");
    let stiffness = field(
        hello["fields"].as_array().unwrap(),
        "wall.k_desired_n_m_per_rad",
    );
    assert_eq!(stiffness["shown"], "1.5");
    assert_eq!(device.world().0.settings().wall.k_desired_n_m_per_rad, 1.5);
    let refused = page.ask(set("-1")).unwrap();
    assert!(refused.contains("-1 is outside"), "{refused}");
    let refused = page.ask(json!({ "do": "set", "path": "wall.k", "value": "1" }));
    assert!(refused.unwrap().contains("there is no such setting"));
    assert!(page.until_phase("boot")["unsaved"] == true);
    assert_eq!(page.ask(json!({ "do": "save" })), None);
    assert!(device.world().1.saved.is_some());
    page.arm();
    let refused = page.ask(set("2")).unwrap();
    assert!(refused.contains("state `armed`"), "{refused}");
    assert_eq!(page.ask(json!({ "do": "disarm" })), None);
    page.until_phase("ready");
    assert_eq!(page.ask(json!({ "do": "stop" })), None);
    page.until_phase("stopped");
    assert!(page.ask(json!({ "do": "dance" })).is_some());
    // The page receives one record per tick and none is missing.
    let columns = 16;
    let rows: Vec<&[f64]> = page.numbers.chunks_exact(columns).collect();
    assert!(
        rows.len() > 200 && page.numbers.len().is_multiple_of(columns),
        "{}",
        rows.len()
    );
    assert!(
        rows.windows(2)
            .all(|pair| pair[1][1] - pair[0][1] == 1.0 && pair[1][2] == 0.0)
    );
    device.fault(FaultCode::EncoderJump, 812);
    let fault = page.until_phase("fault");
    assert_eq!(fault["fault"]["name"], "06 encoder-jump");
    assert_eq!(fault["fault"]["value"], 812);
    for part in ["meaning", "check", "clear"] {
        assert!(fault["fault"][part].as_str().unwrap().len() > 20, "{fault}");
    }
}

#[test]
fn telemetry_settings_arm_and_stop_over_a_socket() {
    talk(&Fake::new());
}

#[cfg(unix)]
#[test]
fn telemetry_settings_arm_and_stop_over_a_pseudo_terminal() {
    talk(&Fake::on_a_terminal());
}

#[test]
fn what_is_missing_is_told() {
    let device = Fake::with(Trouble {
        drops_every: Some(10),
        ..Trouble::default()
    });
    let served = Served::new(&device);
    let mut page = served.page();
    let troubles = page.until(|words| words["type"] == "troubles");
    assert!(troubles["dropped"].as_u64().unwrap() > 0);
    let rows: Vec<&[f64]> = page.numbers.chunks_exact(16).collect();
    let missing: f64 = rows.iter().map(|row| row[2]).sum();
    assert!(missing > 10.0, "{missing}");
    for pair in rows.windows(2) {
        assert_eq!(pair[1][1] - pair[0][1], 1.0 + pair[1][2]);
    }
}

#[test]
fn a_page_that_is_gone_or_hangs_disarms_the_device() {
    let device = Fake::new();
    let served = Served::new(&device);
    let mut page = served.page();
    page.arm();
    drop(page);
    stands(&device, Phase::Ready);
    // A page that is connected but reads no messages.
    let mut page = served.page();
    page.arm();
    stands(&device, Phase::Armed);
    std::thread::sleep(Duration::from_millis(500));
    stands(&device, Phase::Ready);
    // A calibration moves the shaft, so it is stopped when the page closes.
    let mut page = served.page();
    assert_eq!(page.ask(json!({ "do": "stop" })), None);
    assert_eq!(page.ask(json!({ "do": "calibrate" })), None);
    page.socket.close(None).unwrap();
    while !page.socket.read().unwrap().is_close() {}
    stands(&device, Phase::Stopped);
}

#[cfg(unix)]
/// A stop that is pressed while the program still carries out earlier commands does not wait for them.
#[test]
fn a_stop_overtakes_commands_that_wait() {
    const SETTINGS: usize = 1000;
    let device = Fake::new();
    let served = Served::new(&device);
    let mut page = served.page();
    page.until_phase("boot");
    let set = json!({ "do": "set", "path": "wall.k_desired_n_m_per_rad", "value": "1.5" });
    for _ in 0..SETTINGS {
        page.say(set.clone());
    }
    page.until(|words| words["do"] == "set");
    page.say(json!({ "do": "stop" }));
    let mut done = 1;
    for what in std::iter::repeat_with(|| page.until(|words| words["type"] == "done")) {
        if what["do"] == "stop" {
            break;
        }
        done += 1;
    }
    assert!(done < SETTINGS / 2, "after {done} of {SETTINGS}");
    stands(&device, Phase::Stopped);
}

#[test]
fn ctrl_c_disarms_the_device() {
    let device = Fake::new();
    let mut served = Served::new(&device);
    let mut page = served.page();
    page.arm();
    let id = served.child.id().to_string();
    let sent = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status();
    assert!(sent.unwrap().success());
    assert!(served.child.wait().unwrap().success());
    stands(&device, Phase::Ready);
    let mut rest = String::new();
    served.out.read_to_string(&mut rest).unwrap();
    let mut told = String::new();
    let mut errors = served.child.stderr.take().unwrap();
    errors.read_to_string(&mut told).unwrap();
    assert!(
        told.contains("the device was armed, and was disarmed now"),
        "{rest} {told}"
    );
}

#[test]
fn a_cable_that_is_pulled_is_told_and_the_device_is_disarmed_when_it_is_back() {
    let device = Fake::new();
    let served = Served::new(&device);
    let mut page = served.page();
    page.arm();
    device.world().1.pulled = true;
    let begun = Instant::now();
    let lost = page.until(|words| words["type"] == "connection");
    assert!(
        lost["lost"]
            .as_str()
            .unwrap()
            .contains("the connection was lost"),
        "{lost}"
    );
    assert!(
        begun.elapsed() < Duration::from_secs(2),
        "{:?}",
        begun.elapsed()
    );
    let refused = page.ask(json!({ "do": "stop" })).unwrap();
    assert!(refused.contains("there is no connection"), "{refused}");
    stands(&device, Phase::Armed);
    device.world().1.pulled = false;
    let back = page.until(|words| words["type"] == "connection" && words["lost"].is_null());
    assert_eq!(back["done"], "the device was armed, and was disarmed now");
    page.until_phase("ready");
    stands(&device, Phase::Ready);
}

#[cfg(unix)]
#[test]
fn a_pulled_serial_cable_is_told() {
    let device = Fake::on_a_terminal();
    let served = Served::new(&device);
    let mut page = served.page();
    page.until_phase("boot");
    device.world().1.pulled = true;
    let begun = Instant::now();
    let lost = page.until(|words| words["type"] == "connection");
    // If the other end of a pseudo-terminal is closed, the operating system reports a time-out or the end of the file.
    let why = lost["lost"].as_str().unwrap();
    assert!(why.starts_with(&device.address), "{why}");
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn only_the_page_that_was_opened_gets_in() {
    let device = Fake::new();
    let served = Served::new(&device);
    let (host, token) = (served.host.as_str(), served.token.as_str());
    let own = format!("/?token={token}");
    let page = served.get(&own, host, "");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n"), "{page:.100}");
    let socket = format!("connect-src ws://{host}/socket;");
    for part in [
        "frame-ancestors 'none'",
        "no-store",
        socket.as_str(),
        "default-src 'none'",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let wrong = format!("/?token={}", "0".repeat(32));
    let port = host.split_once(':').unwrap().1;
    let rebound = format!("evil.example:{port}");
    let foreign = format!("Origin: http://{rebound}\r\n");
    let twice = format!("Host: {host}\r\n");
    for (path, host, headers, status) in [
        (wrong.as_str(), host, "", "403"),
        ("/", host, "", "403"),
        (&own[..own.len() - 1], host, "", "403"),
        (&own, &rebound, "", "403"),
        (&own, host, &foreign, "403"),
        (&own, host, "Origin: null\r\n", "403"),
        (&own, host, &twice, "403"),
        (&format!("/other?token={token}"), host, "", "404"),
    ] {
        let answer = served.get(path, host, headers);
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status}")),
            "{path} {host} {headers}: {answer}"
        );
        assert!(!answer.contains(token) && answer.len() < 600, "{answer}");
    }
    let origin = format!("http://{host}");
    for (token, origin) in [
        (token, None),
        (token, Some("http://evil.example")),
        (token, Some("null")),
        ("", Some(origin.as_str())),
        ("0", Some(&origin)),
    ] {
        let error = served.socket(token, origin).err().unwrap();
        assert!(error.contains("403"), "{origin:?}: {error}");
    }
    let mut first = served.page();
    first.until_phase("boot");
    let second = served.socket(token, Some(&origin)).err().unwrap();
    assert!(second.contains("409"), "{second}");
}

#[test]
fn a_hundred_thousand_bytes_of_nonsense_change_nothing() {
    let device = Fake::new();
    let served = Served::new(&device);
    // Invalid bytes are sent to the HTTP server, with and without the end of a request header.
    let answer = served.raw(&nonsense(100_000));
    assert!(
        answer.is_empty() || answer.starts_with("HTTP/1.1 400"),
        "{answer:.100}"
    );
    let answer = served.raw(&[&nonsense(3000), b"\r\n\r\n".as_slice()].concat());
    assert!(
        answer.is_empty() || answer.starts_with("HTTP/1.1 400"),
        "{answer:.100}"
    );
    // Invalid bytes are sent as messages of a page. All are answered and none is carried out.
    let mut page = served.page();
    page.arm();
    for part in nonsense(20_000).chunks(500) {
        let text: String = part.iter().map(|byte| char::from(byte % 128)).collect();
        page.socket.send(Message::text(text)).unwrap();
        page.until(|words| words["type"] == "done" && !words["error"].is_null());
    }
    stands(&device, Phase::Armed);
    // Invalid bytes are sent outside of WebSocket frames. The server closes the page's connection and switches the device off.
    page.socket.get_mut().write_all(&nonsense(100_000)).ok();
    stands(&device, Phase::Ready);
    drop(page);
    // Invalid bytes are sent by the device.
    let mut page = served.page();
    page.until_phase("ready");
    device.world().1.noise = 100_000;
    let troubles = page.until(|words| words["type"] == "troubles" && words["damaged"] != 0);
    assert!(troubles["damaged"].as_u64().unwrap() > 1, "{troubles}");
    let before = page.numbers.len();
    assert_eq!(page.ask(json!({ "do": "arm" })), None);
    page.until(|words| words["type"] == "troubles");
    assert!(page.numbers.len() > before);
}

#[test]
fn a_scene_and_a_port_do_not_go_together() {
    for words in [
        ["live", "tap"],
        ["live", "--law=fba"],
        ["live", "--out=x.html"],
    ] {
        let said = crate::run(&[&words[..], &["--port", "tcp:localhost:1"]].concat());
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(said.err.contains("--port"), "{}", said.err);
    }
}
