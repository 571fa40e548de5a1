//! The parts of HTTP that the program's servers use: reading a request's header with limits on size and time, the secret token,
//! answers.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use touchstone_sim::error::{Error, Result};

/// Largest size of a request's header in bytes; longer requests are refused.
const HEAD_MAX: usize = 8192;
/// Time in which the header of a request must be complete, from its first byte on.
pub const HEAD_LIMIT: Duration = Duration::from_secs(2);
/// Time for which a connection may stay open without a first byte. Browsers open connections before they need them.
const IDLE_LIMIT: Duration = Duration::from_secs(60);

/// Largest number of connections whose request is read at the same time.
const VISITORS: usize = 32;

/// Accepts connections until the program ends, and calls `welcome` for each in a thread of its own. Closes connections beyond
/// `VISITORS`.
pub fn serve(listener: TcpListener, welcome: impl Fn(TcpStream) + Send + Sync + 'static) {
    let shared = Arc::new((welcome, AtomicUsize::new(0)));
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let shared = Arc::clone(&shared);
            if shared.1.fetch_add(1, Ordering::Relaxed) >= VISITORS {
                shared.1.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            std::thread::spawn(move || {
                let (welcome, visitors) = &*shared;
                welcome(stream);
                visitors.fetch_sub(1, Ordering::Relaxed);
            });
        }
    });
}

/// Makes the secret token: 128 random bits as text.
pub fn token() -> Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| {
        Error::device(
            "random numbers",
            error.to_string(),
            "try again; if it fails again, restart the computer",
        )
    })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The header of a request.
#[derive(Debug)]
pub struct Request {
    pub method: String,
    /// The path without the query.
    pub path: String,
    query: String,
    headers: Vec<(String, Vec<u8>)>,
}

impl Request {
    /// Parses a request's header; `None` if the bytes are not a complete HTTP header.
    pub fn read(head: &[u8]) -> Option<Self> {
        let mut headers = [httparse::EMPTY_HEADER; 64];
        let mut request = httparse::Request::new(&mut headers);
        if !request.parse(head).is_ok_and(|done| done.is_complete()) {
            return None;
        }
        let path = request.path.unwrap_or("");
        let (path, query) = path.split_once('?').unwrap_or((path, ""));
        Some(Self {
            method: request.method.unwrap_or("").to_owned(),
            path: path.to_owned(),
            query: query.to_owned(),
            headers: request
                .headers
                .iter()
                .map(|header| (header.name.to_ascii_lowercase(), header.value.to_vec()))
                .collect(),
        })
    }

    /// The value of the header with this lower-case name, and whether the header occurs more than once. Callers treat a repeated
    /// header as invalid.
    pub fn header(&self, name: &str) -> (Option<&[u8]>, bool) {
        let mut all = self
            .headers
            .iter()
            .filter(|header| header.0 == name)
            .map(|header| &*header.1);
        (all.next(), all.next().is_some())
    }

    /// Whether the request's query contains this token.
    pub fn has_token(&self, token: &str) -> bool {
        same(self.query.strip_prefix("token=").unwrap_or(""), token)
    }
}

/// Whether two texts are equal. The time of the comparison does not depend on where they differ, so it reveals nothing of the
/// token.
fn same(given: &str, token: &str) -> bool {
    let (given, token) = (given.as_bytes(), token.as_bytes());
    let differing = given.iter().zip(token).fold(0, |sum, (a, b)| sum | (a ^ b));
    given.len() == token.len() && differing == 0
}

/// Result of waiting for the header of a request.
pub enum Head {
    /// The complete header. Its bytes stay in the TCP stream for the WebSocket library to read.
    Whole(Vec<u8>),
    /// The browser sent no byte.
    Silent,
    /// The header was not complete in time, or was too long.
    Broken,
}

/// Waits for the header of a request, and leaves its bytes in the stream.
pub fn head(stream: &TcpStream) -> std::io::Result<Head> {
    let begun = Instant::now();
    let mut said: Option<Instant> = None;
    let mut bytes = vec![0; HEAD_MAX];
    stream.set_read_timeout(Some(Duration::from_millis(100)))?;
    loop {
        let count = match stream.peek(&mut bytes) {
            Ok(0) if said.is_none() => return Ok(Head::Silent),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(error) => return Err(error),
        };
        let found = bytes[..count].windows(4).position(|end| end == b"\r\n\r\n");
        if let Some(end) = found {
            bytes.truncate(end + 4);
            return Ok(Head::Whole(bytes));
        }
        if count > 0 {
            said.get_or_insert_with(Instant::now);
        }
        match said {
            Some(since) if count == HEAD_MAX || since.elapsed() > HEAD_LIMIT => {
                return Ok(Head::Broken);
            }
            None if begun.elapsed() > IDLE_LIMIT => return Ok(Head::Silent),
            _ => {}
        }
        // `peek` returns at once with the bytes that it returned before, so this loop must pause.
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Reads `count` bytes that were only peeked at before, and drops them.
pub fn take(stream: &mut TcpStream, count: usize) -> std::io::Result<()> {
    stream.read_exact(&mut vec![0; count])
}

/// Answers a request with a status and a line of text.
pub fn refuse(stream: &mut TcpStream, status: &str, why: &str) -> std::io::Result<()> {
    let kind = "Content-Type: text/plain; charset=utf-8\r\n";
    answer(stream, status, kind, &format!("{why}\n"))
}

/// Answers a request. `head` contains further header lines of the answer.
pub fn answer(stream: &mut TcpStream, status: &str, head: &str, body: &str) -> std::io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\n{head}Content-Length: {}\r\nCache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body.as_bytes())?;
    stream.flush()
}
