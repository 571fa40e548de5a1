//! Tests of `touchstone events --websocket`: what programs and pages receive, what they may request, and which clients are refused.

use crate::demo::Demo;
use serde_json::Value;
use std::io::{BufRead, BufReader, ErrorKind, Lines, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Stdio};
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Longest time for any step of these tests, with a margin for a busy machine.
const LIMIT: Duration = Duration::from_secs(30);

/// A running `touchstone --json events --websocket`; its process ends with the test.
pub struct Events {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
    /// The printed address, which contains the token.
    address: String,
}

impl Drop for Events {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Events {
    pub fn new(demo: &Demo, words: &[&str]) -> Self {
        Self::at(demo.address(), words)
    }

    /// Starts the program with the board at this port.
    pub fn at(port: &str, words: &[&str]) -> Self {
        let all = [&["--json", "events", "--port", port, "--websocket"], words].concat();
        let mut child = crate::program(&all)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let first: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
        assert_eq!(first["event"], "websocket", "{first}");
        let address = first["address"].as_str().unwrap().to_owned();
        assert!(address.starts_with("ws://127.0.0.1:"), "{address}");
        Self {
            child,
            lines,
            address,
        }
    }

    fn next(&mut self) -> Value {
        serde_json::from_str(&self.lines.next().expect("events ended").unwrap()).unwrap()
    }

    fn host(&self) -> &str {
        let rest = self.address.strip_prefix("ws://").unwrap();
        rest.split_once('/').unwrap().0
    }

    fn connect(&self, address: &str, headers: &[(&'static str, &str)]) -> Result<Page, String> {
        let mut request = address.into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let stream = TcpStream::connect(self.host()).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(Page { socket }),
            Err(error) => Err(error.to_string()),
        }
    }

    pub fn page(&self) -> Page {
        self.connect(&self.address, &[]).unwrap()
    }

    /// Ends the program; returns what it wrote to standard error.
    pub fn ended(mut self) -> String {
        self.child.kill().unwrap();
        std::io::read_to_string(self.child.stderr.take().unwrap()).unwrap()
    }
}

/// A connected client.
pub struct Page {
    socket: WebSocket<TcpStream>,
}

impl Page {
    pub fn say(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    pub fn next(&mut self) -> Value {
        let begun = Instant::now();
        while begun.elapsed() < LIMIT {
            match self.socket.read() {
                Ok(Message::Text(text)) => return serde_json::from_str(text.as_str()).unwrap(),
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => panic!("{error}"),
            }
        }
        panic!("no line came");
    }

    pub fn until(&mut self, event: &str) -> Value {
        loop {
            let line = self.next();
            if line["event"] == event {
                return line;
            }
        }
    }

    /// Waits until the program has closed the connection.
    fn closed(mut self) {
        let begun = Instant::now();
        while self.socket.read().is_ok() {
            assert!(begun.elapsed() < LIMIT, "it stays connected");
        }
    }
}

/// Checks that two clients get every printed line. One of them numbers the position and chooses the feel. Only the sender of an
/// invalid request gets an error.
#[test]
fn programs_and_pages_get_positions_and_choose_the_feel() {
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    demo.happens("turn 0");
    demo.run(&["device", "arm"]);
    let mut events = Events::new(&demo, &["--seconds", "120"]);
    let state = events.next();
    let first = events.next();
    assert_eq!(
        (&first["event"], &first["change"]),
        (&"position".into(), &0.into())
    );
    // Both clients connect after the first lines were printed, and must get these lines, too.
    let mut program = events.page();
    let own = [("Origin", "http://localhost:8000")];
    let mut page = events.connect(&events.address, &own).unwrap();
    for client in [&mut program, &mut page] {
        assert_eq!(
            (client.next(), client.next()),
            (state.clone(), first.clone())
        );
    }
    program.say(r#"{"position": 100}"#);
    let numbered = events.next();
    assert_eq!(numbered["position"], 100, "{numbered}");
    for client in [&mut program, &mut page] {
        assert_eq!(client.next(), numbered);
    }
    for (wrong, why) in [
        (
            r#"{"feel": "/etc/passwd"}"#,
            "there is no feel /etc/passwd; give ",
        ),
        (r#"{"position": 1e99}"#, "this is not a valid request"),
        (
            r#"{"position": 9223372036854775807}"#,
            "this is not a valid request",
        ),
        (r#"{"arm": true}"#, "expected `position` or `feel`"),
        ("turn", "this is not a valid request"),
    ] {
        program.say(wrong);
        let line = program.next();
        let said = line["problem"].as_str().unwrap_or_default();
        assert!(line["event"] == "error" && said.contains(why), "{line}");
    }
    program.say(r#"{"feel": "bounded-detents"}"#);
    let chosen = events.next();
    assert_eq!(
        (&chosen["change"], &chosen["last"]),
        (&0.into(), &10.into()),
        "{chosen}"
    );
    for client in [&mut program, &mut page] {
        assert_eq!(client.next(), chosen, "and no other line before it");
    }
    demo.happens("turn 60");
    for client in [&mut program, &mut page] {
        let place = client.until("position");
        assert_eq!(place["change"], 1, "{place}");
    }
    // For a client that connects later, the newest line is not a change.
    let mut late = events.page();
    assert_eq!(late.next()["state"], "armed");
    let place = late.next();
    assert!(
        place["change"] == 0 && place["position"].as_i64() >= Some(1),
        "{place}"
    );
}

/// Checks that wrong clients are refused and harmful ones disconnected, each with a note, while another client keeps getting
/// positions.
#[test]
fn wrong_clients_are_refused_and_harmful_ones_disconnected() {
    let mut demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    demo.run(&["config", "environment", "coarse-detents"]);
    demo.happens("turn 0");
    demo.run(&["device", "arm"]);
    let named = ["0", "--websocket-origin", "https://own.example"];
    let events = Events::new(&demo, &named);
    let mut good = events.page();
    good.until("position");
    // This client is connected and reads nothing, not even a ping.
    let silent = events.page();
    let silent_since = Instant::now();

    let own = &*events.address.clone();
    let token = own.split_once("token=").unwrap().1;
    let wrong = own.replace(token, &"0".repeat(32));
    let none = own.replace(token, "");
    let other_path = own.replace("/?", "/socket?");
    let page = |origin| [("Origin", origin)];
    for (address, headers, status) in [
        (&*wrong, &[][..], "403"),
        (&none, &[], "403"),
        (&own[..own.len() - 1], &[], "403"),
        (own, &page("https://evil.example"), "403"),
        (own, &page("http://localhost.evil.example"), "403"),
        (own, &page("null"), "403"),
        (own, &[("Host", "evil.example")], "403"),
        (&other_path, &[], "426"),
    ] {
        let error = events.connect(address, headers).err().unwrap();
        assert!(error.contains(status), "{address} {headers:?}: {error}");
    }
    drop(events.connect(own, &page("https://own.example")).unwrap());
    drop(events.connect(own, &page("http://127.0.0.1:8000")).unwrap());

    let raw = |bytes: &[u8]| {
        let mut stream = TcpStream::connect(events.host()).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        // The program may close the connection before it has received all bytes.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    };
    let endless = raw(&vec![b'x'; 100_000]);
    assert!(
        endless.is_empty() || endless.starts_with("HTTP/1.1 400"),
        "{endless}"
    );
    let plain = format!(
        "GET /?token={token} HTTP/1.1\r\nHost: {}\r\n\r\n",
        events.host()
    );
    let plain = raw(plain.as_bytes());
    assert!(plain.starts_with("HTTP/1.1 426"), "{plain}");
    assert!(
        plain.contains("this address serves a WebSocket, not a page"),
        "{plain}"
    );

    // The header of a masked text frame of 2^62 bytes.
    let mut endless = events.page();
    let header = [0x81, 0xff, 0x40, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4];
    endless.socket.get_mut().write_all(&header).unwrap();
    endless.closed();
    // A message of many frames without a last one.
    let mut parts = events.page();
    let part = [&[0x01, 0xfe, 0x9c, 0x40, 0, 0, 0, 0][..], &[b'x'; 40_000]].concat();
    let next = [&[0x00, 0xfe, 0x9c, 0x40, 0, 0, 0, 0][..], &[b'x'; 40_000]].concat();
    let _ = parts.socket.get_mut().write_all(&[part, next].concat());
    parts.closed();
    let mut nonsense = events.page();
    let _ = nonsense.socket.get_mut().write_all(&[0x7f; 1000]);
    nonsense.closed();

    // Connects the largest allowed number of clients, then one more.
    let mut many = Vec::new();
    let full = loop {
        assert!(many.len() < 20, "there is no limit");
        match events.connect(own, &[]) {
            Ok(page) => many.push(page),
            Err(error) => break error,
        }
    };
    assert!(
        full.contains("503") && many.len() > 4,
        "{} {full}",
        many.len()
    );
    drop(many);

    demo.happens("turn 90");
    // On a busy machine the knob may still be moving to its first position.
    while good.until("position")["change"] != 1 {}
    // Keeps reading, because a client that answers no ping is disconnected.
    while silent_since.elapsed() < Duration::from_secs(12) {
        let _ = good
            .socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_millis(200)));
        match good.socket.read() {
            Ok(_) => {}
            Err(tungstenite::Error::Io(error))
                if matches!(
                    error.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) => {}
            Err(error) => panic!("the good client: {error}"),
        }
    }
    silent.closed();
    good.socket.get_ref().set_read_timeout(Some(LIMIT)).unwrap();
    demo.happens("turn 0");
    assert_eq!(good.until("position")["change"], -1);
    let said = events.ended();
    for line in [
        "wrong or missing token",
        "pages of https://evil.example may not connect; --websocket-origin permits them",
        "pages of null may not connect",
        "wrong Host",
        "this address serves a WebSocket, not a page",
        "8 clients are connected",
        "a client sent a message of more than 65536 bytes; it is disconnected",
        "a client sent an invalid WebSocket message; it is disconnected",
        "a client answers no ping; it is disconnected",
    ] {
        assert!(said.contains(line), "{line} is not in {said}");
    }
    assert!(!said.contains(token), "{said}");
}

#[test]
fn an_address_that_is_none_is_refused() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    for place in [&*port, "no place", "192.0.2.1:0"] {
        let said = crate::run(&["events", "--websocket", place, "--port", "tcp:127.0.0.1:1"]);
        said.failed(2, &["--websocket", place]);
    }
    let said = crate::run(&["events", "--websocket-origin", "null"]);
    said.failed(2, &["--websocket"]);
}
