//! A page of `touchstone live` over a link with faults. The page arms the device, and is then closed.

use super::{LONGEST, ended, started};
use crate::Said;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::net::TcpStream;
use std::process::{Child, ChildStdout};
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// How a page ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PageEnd {
    /// A person presses stop and reads the page's message.
    Stops,
    /// The tab is closed.
    Closes,
    /// The program is interrupted by Ctrl-C.
    Interrupts,
}

impl PageEnd {
    pub fn of(seed: u64) -> Self {
        [Self::Stops, Self::Closes, Self::Interrupts][(seed / 5 % 3) as usize]
    }
}

/// Time for which the page runs before it ends.
const PLAYS: Duration = Duration::from_millis(1_800);

/// Runs `touchstone live` with a page, on the device at `port`. Returns the program's output, and all texts that the page received.
pub fn played(port: &str, seed: u64, end: PageEnd) -> (Said, String) {
    let Opened {
        child,
        mut out,
        line,
        page,
    } = Opened::new(port);
    let mut shown = String::new();
    // Without a page, the program has no connection and ends with an error.
    if let Some(mut page) = page {
        page.plays(PLAYS, &mut shown);
        match end {
            PageEnd::Stops => {
                page.says(&json!({ "do": "stop" }));
                page.hears(LONGEST / 3, &mut shown, |words| {
                    words["type"] == "done" && words["do"] == "stop"
                });
            }
            PageEnd::Closes => drop(page.socket.close(None)),
            PageEnd::Interrupts => {}
        }
        if end != PageEnd::Interrupts {
            drop(page);
            // Time for the program to notice that the page is gone.
            std::thread::sleep(Duration::from_millis(300));
        }
        let id = child.id().to_string();
        let sent = std::process::Command::new("kill")
            .args(["-INT", &id])
            .status();
        assert!(sent.unwrap().success(), "seed {seed}");
    }
    let mut said = ended(child, seed);
    said.out = line;
    // The program has ended, so the rest of its output can be read.
    out.read_to_string(&mut said.out).unwrap();
    (said, shown)
}

/// A running `touchstone live` with a page.
pub struct Opened {
    pub child: Child,
    /// The program's standard output after its first line.
    pub out: BufReader<ChildStdout>,
    /// The program's first line.
    pub line: String,
    /// The page; `None` if the first line has no address of a page.
    pub page: Option<Page>,
}

impl Opened {
    /// Runs `touchstone live` on the device at `port`, and opens its page.
    pub fn new(port: &str) -> Self {
        let mut child = started(&["live", "--no-open", "--port", port]);
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        out.read_line(&mut line).unwrap();
        let place = line.trim().strip_prefix("page    http://");
        let page = place.map(|place| {
            let (host, token) = place.split_once("/?token=").unwrap();
            Page::open(host, token)
        });
        Self {
            child,
            out,
            line,
            page,
        }
    }
}

pub struct Page {
    socket: WebSocket<TcpStream>,
}

impl Page {
    fn open(host: &str, token: &str) -> Self {
        let mut request = format!("ws://{host}/socket?token={token}")
            .into_client_request()
            .unwrap();
        let origin = format!("http://{host}").parse().unwrap();
        request.headers_mut().insert("Origin", origin);
        let stream = TcpStream::connect(host).unwrap();
        let (socket, _) = tungstenite::client(request, stream).unwrap();
        let limit = Some(Duration::from_millis(20));
        socket.get_ref().set_read_timeout(limit).unwrap();
        Self { socket }
    }

    /// Sends an order. The program may have ended, so errors are ignored.
    pub fn says(&mut self, order: &Value) {
        let _ = self.socket.send(Message::text(order.to_string()));
    }

    /// For this time, calibrates and arms the device, and repeats both if necessary.
    fn plays(&mut self, time: Duration, shown: &mut String) {
        let begun = Instant::now();
        self.says(&json!({ "do": "calibrate" }));
        while begun.elapsed() < time {
            let mut phase = String::new();
            self.hears(Duration::from_millis(100), shown, |words| {
                let is_state = words["type"] == "state";
                if is_state {
                    phase = words["phase"].as_str().unwrap_or_default().to_owned();
                }
                is_state
            });
            match phase.as_str() {
                "ready" => self.says(&json!({ "do": "arm" })),
                "boot" | "stopped" => self.says(&json!({ "do": "calibrate" })),
                _ => {}
            }
        }
    }

    /// Reads messages until one satisfies `ends`, at most for this time. Acknowledges batches of records, and appends all texts to
    /// `shown`.
    pub fn hears(
        &mut self,
        time: Duration,
        shown: &mut String,
        mut ends: impl FnMut(&Value) -> bool,
    ) {
        let begun = Instant::now();
        while begun.elapsed() < time {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    let words: Value = serde_json::from_str(text.as_str()).unwrap();
                    if words["type"] != "hello" {
                        shown.push_str(text.as_str());
                        shown.push('\n');
                    }
                    if ends(&words) {
                        return;
                    }
                }
                Ok(Message::Binary(bytes)) => {
                    let batch = bytes
                        .first_chunk()
                        .map_or(0.0, |it| f64::from_le_bytes(*it));
                    self.says(&json!({ "seen": batch as u64 }));
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error))
                    if matches!(
                        error.kind(),
                        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                    ) => {}
                // The program closed the page.
                Err(_) => return,
            }
        }
    }
}
