//! A WebSocket server for programs and web pages that use the knob. Every client gets the same lines of JSON, and may send
//! requests.
//!
//! Any page in the browser can try to connect to this port. Three checks refuse pages of other sites:
//! - the address must have the secret token;
//! - the header `Origin` must name a page of this computer or a given one;
//! - the header `Host` must not name a foreign host that resolves to this computer (DNS rebinding).

use super::http::{HEAD_LIMIT, Head, Request, answer, head, refuse, serve, take, token};
use super::out::note;
use serde_json::Value;
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};
use touchstone_sim::error::{Error, Result};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Largest number of clients.
const CLIENTS: usize = 8;
/// Largest message from a client, bytes. A scene with all its values and comments fits.
const MESSAGE_MAX: usize = 65_536;
/// Largest number of bytes that wait for a client in this program, beyond the operating system's buffers.
const WAITING_MAX: usize = 64 * 1024;
/// Largest number of messages that are read from a client in one turn. A client that sends without pause then does not delay the
/// others.
const AT_A_TIME: usize = 8;
/// Time between two pings to a client.
const PING: Duration = Duration::from_secs(3);
/// Time without any message from a client, also without an answer to a ping, after which it counts as hung.
const HANGS: Duration = Duration::from_secs(10);

/// The WebSocket server with its clients.
#[derive(Debug)]
pub struct WebSocketServer {
    /// The address for clients; it contains the token.
    pub address: String,
    arrivals: Receiver<WebSocket<TcpStream>>,
    clients: Vec<Client>,
    /// Number of clients, including those whose connection is being opened.
    taken: Arc<AtomicUsize>,
    next: u64,
}

/// A connected program or page.
#[derive(Debug)]
struct Client {
    socket: WebSocket<TcpStream>,
    number: u64,
    heard: Instant,
    asked: Instant,
}

/// A client's message.
#[derive(Debug)]
pub struct ClientMessage {
    /// The client's number, for the answer.
    pub client: u64,
    pub text: String,
}

/// News since the last turn: new clients and received messages.
#[derive(Debug, Default)]
pub struct News {
    /// Numbers of the clients that have just connected.
    pub arrived: Vec<u64>,
    pub asked: Vec<ClientMessage>,
}

/// Data that the server's threads share.
struct Inside {
    token: String,
    /// The host in the address of the option `--websocket`.
    host: String,
    origins: Vec<String>,
    arrivals: Sender<WebSocket<TcpStream>>,
    taken: Arc<AtomicUsize>,
}

fn failed(problem: String, fix: &str) -> Error {
    Error::Option {
        option: "--websocket".into(),
        problem,
        fix: fix.into(),
    }
}

impl WebSocketServer {
    /// Opens the server. `place` is a port on this computer (0: any free one) or HOST:PORT. Pages of `origins` may connect as well
    /// as those of this computer.
    ///
    /// # Errors
    /// The address is invalid, or the port is in use.
    pub fn open(place: &str, origins: &[String]) -> Result<Self> {
        let full = match place.parse::<u16>() {
            Ok(port) => format!("{}:{port}", Ipv4Addr::LOCALHOST),
            Err(_) => place.to_owned(),
        };
        let listener = TcpListener::bind(&full).map_err(|error| {
            failed(
                format!("{place}: {error}"),
                "give a port that is free, e.g. 9002, or HOST:PORT of this computer",
            )
        })?;
        let own = listener.local_addr();
        let own = own.map_err(|error| failed(error.to_string(), "try another port"))?;
        if !own.ip().is_loopback() {
            note!(
                "note: --websocket: other computers can connect to {own}; the token crosses the network unencrypted"
            );
        }
        let token = token()?;
        let (arrived, arrivals) = channel();
        let taken = Arc::new(AtomicUsize::new(0));
        let inside = Inside {
            token: token.clone(),
            host: host_of(&full).to_owned(),
            origins: origins.to_vec(),
            arrivals: arrived,
            taken: Arc::clone(&taken),
        };
        serve(listener, move |stream| {
            // A client that closes its connection early is no error of this program.
            let _ = inside.welcome(stream);
        });
        Ok(Self {
            address: format!("ws://{own}/?token={token}"),
            arrivals,
            clients: Vec::new(),
            taken,
            next: 0,
        })
    }

    /// Accepts new clients, reads the messages of all clients, and disconnects clients that do not respond. Does not block.
    pub fn turn(&mut self) -> News {
        let mut news = News::default();
        while let Ok(socket) = self.arrivals.try_recv() {
            let now = Instant::now();
            self.next += 1;
            news.arrived.push(self.next);
            self.clients.push(Client {
                socket,
                number: self.next,
                heard: now,
                asked: now,
            });
        }
        self.keep(|client| {
            let number = client.number;
            client.turn(|text| {
                news.asked.push(ClientMessage {
                    client: number,
                    text,
                });
            })
        });
        news
    }

    /// Sends a line to every client.
    pub fn send(&mut self, line: &Value) {
        if !self.clients.is_empty() {
            let text = line.to_string();
            self.keep(|client| client.send(Message::text(&*text)));
        }
    }

    /// Sends a line to the client with this number.
    pub fn answer(&mut self, number: u64, line: &Value) {
        self.keep(|client| match client.number == number {
            true => client.send(Message::text(line.to_string())),
            false => Ok(()),
        });
    }

    /// Calls `each` for every client, and disconnects the clients for which it returns an error.
    fn keep(&mut self, mut each: impl FnMut(&mut Client) -> std::result::Result<(), Gone>) {
        let taken = &self.taken;
        self.clients.retain_mut(|client| {
            let Err(gone) = each(client) else { return true };
            taken.fetch_sub(1, Ordering::SeqCst);
            if let Some(why) = gone {
                note!("note: --websocket: a client {why}; it is disconnected");
            }
            false
        });
    }
}

/// Why the server disconnects a client; `None` if the client closed the connection.
type Gone = Option<&'static str>;

impl Client {
    fn turn(&mut self, mut take: impl FnMut(String)) -> std::result::Result<(), Gone> {
        for _ in 0..AT_A_TIME {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    self.heard = Instant::now();
                    take(text.as_str().to_owned());
                }
                Ok(Message::Close(_)) => {
                    // Reading has only queued the answer, without which the client takes the connection for lost (code 1006).
                    let _ = self.socket.flush();
                    return Err(None);
                }
                Ok(_) => self.heard = Instant::now(),
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    break;
                }
                Err(tungstenite::Error::Io(_) | tungstenite::Error::ConnectionClosed) => {
                    return Err(None);
                }
                Err(tungstenite::Error::Capacity(_)) => {
                    return Err(Some("sent a message of more than 65536 bytes"));
                }
                Err(_) => return Err(Some("sent an invalid WebSocket message")),
            }
        }
        if self.heard.elapsed() > HANGS {
            return Err(Some("answers no ping"));
        }
        if self.asked.elapsed() > PING {
            self.asked = Instant::now();
            return self.send(Message::Ping(Vec::new().into()));
        }
        Ok(())
    }

    fn send(&mut self, message: Message) -> std::result::Result<(), Gone> {
        match self.socket.send(message) {
            Ok(()) => Ok(()),
            // Bytes that do not fit into the system's buffer now are sent with the next message.
            Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(tungstenite::Error::WriteBufferFull(_)) => Err(Some("does not read its messages")),
            Err(_) => Err(None),
        }
    }
}

impl Inside {
    fn welcome(&self, mut stream: TcpStream) -> std::io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(HEAD_LIMIT))?;
        let head = match head(&stream)? {
            Head::Whole(head) => head,
            Head::Silent => return Ok(()),
            Head::Broken => {
                note!("note: --websocket: a connection without a request was refused");
                return refuse(
                    &mut stream,
                    "400 Bad Request",
                    "this is not a valid HTTP request",
                );
            }
        };
        if let Err((status, why)) = self.check(&head) {
            note!("note: --websocket: a client was refused: {}", why);
            take(&mut stream, head.len())?;
            return match status {
                "426 Upgrade Required" => {
                    answer(&mut stream, status, "Upgrade: websocket\r\n", &why)
                }
                _ => refuse(&mut stream, status, &why),
            };
        }
        if self.taken.fetch_add(1, Ordering::SeqCst) >= CLIENTS {
            self.taken.fetch_sub(1, Ordering::SeqCst);
            let why = format!("{CLIENTS} clients are connected; close one of them");
            note!("note: --websocket: a client was refused: {why}");
            take(&mut stream, head.len())?;
            return refuse(&mut stream, "503 Service Unavailable", &why);
        }
        stream.set_read_timeout(Some(HEAD_LIMIT))?;
        let socket = tungstenite::accept_with_config(stream, Some(limits())).ok();
        let socket = socket.filter(|socket| socket.get_ref().set_nonblocking(true).is_ok());
        if socket.is_none_or(|socket| self.arrivals.send(socket).is_err()) {
            self.taken.fetch_sub(1, Ordering::SeqCst);
        }
        Ok(())
    }

    /// Checks a request's header. The error holds the HTTP status and the reason with which the request is refused.
    fn check(&self, head: &[u8]) -> std::result::Result<(), (&'static str, String)> {
        let forbidden = |why: &str| ("403 Forbidden", why.to_owned());
        let Some(request) = Request::read(head) else {
            return Err((
                "400 Bad Request",
                "this is not a valid HTTP request".to_owned(),
            ));
        };
        let text = |name| match request.header(name) {
            (None, _) => Some(""),
            (Some(value), false) => std::str::from_utf8(value).ok(),
            (Some(_), true) => None,
        };
        let host = text("host").map(host_of).unwrap_or_default();
        if !is_named_here(host) && !host.eq_ignore_ascii_case(&self.host) {
            return Err(forbidden("wrong Host"));
        }
        let origin = text("origin").ok_or_else(|| forbidden("wrong Origin"))?;
        if !(origin.is_empty()
            || is_page_of_here(origin)
            || self.origins.iter().any(|named| named == origin))
        {
            let name: String = origin.chars().take(100).collect();
            return Err(forbidden(&format!(
                "pages of {name} may not connect; --websocket-origin permits them"
            )));
        }
        if !request.has_token(&self.token) {
            let why =
                "wrong or missing token: connect to the address that `touchstone events` printed";
            return Err(forbidden(why));
        }
        let upgrade = text("upgrade").unwrap_or_default();
        if request.method != "GET"
            || request.path != "/"
            || !upgrade.eq_ignore_ascii_case("websocket")
        {
            return Err((
                "426 Upgrade Required",
                "this address serves a WebSocket, not a page\n".to_owned(),
            ));
        }
        Ok(())
    }
}

fn limits() -> WebSocketConfig {
    WebSocketConfig::default()
        .max_message_size(Some(MESSAGE_MAX))
        .max_frame_size(Some(MESSAGE_MAX))
        .write_buffer_size(0)
        .max_write_buffer_size(WAITING_MAX)
}

/// The host in HOST:PORT, without the brackets of an IPv6 address.
fn host_of(place: &str) -> &str {
    let host = match place.rsplit_once(':') {
        Some((host, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => host,
        _ => place,
    };
    host.strip_prefix('[')
        .and_then(|host| host.strip_suffix(']'))
        .unwrap_or(host)
}

/// Whether the host is an IP address or `localhost`. A foreign name server cannot make these names point to this computer.
fn is_named_here(host: &str) -> bool {
    host.eq_ignore_ascii_case("localhost") || host.parse::<IpAddr>().is_ok()
}

/// Whether an origin is a page from a server on this computer (`localhost` or a loopback address).
fn is_page_of_here(origin: &str) -> bool {
    let place = origin
        .strip_prefix("http://")
        .or_else(|| origin.strip_prefix("https://"));
    place.map(host_of).is_some_and(|host| {
        host == "localhost" || host.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
    })
}

#[cfg(test)]
mod tests {
    use super::{WebSocketServer, host_of, is_page_of_here};
    use std::net::TcpStream;
    use std::time::{Duration, Instant};

    #[test]
    fn a_page_of_this_computer_is_known_by_its_origin() {
        for own in [
            "http://localhost",
            "http://localhost:8000",
            "https://127.0.0.1:1",
            "http://[::1]:8000",
        ] {
            assert!(is_page_of_here(own), "{own}");
        }
        for other in [
            "null",
            "",
            "http://",
            "localhost",
            "file://localhost",
            "http://localhost.evil.example",
            "http://evil.example/localhost",
            "http://localhost@evil.example",
            "http://192.0.2.1",
            "http://127.0.0.1.evil.example:80",
        ] {
            assert!(!is_page_of_here(other), "{other}");
        }
        assert_eq!(host_of("[::1]:80"), "::1");
        assert_eq!(host_of("[::1]"), "::1");
        assert_eq!(host_of("a.example"), "a.example");
    }

    /// Checks that a client that reads nothing is disconnected when its buffers are full, and that the server does not block
    /// meanwhile.
    #[test]
    fn a_client_that_never_reads_is_disconnected() {
        let mut server = WebSocketServer::open("0", &[]).unwrap();
        let place = server.address["ws://".len()..].split_once('/').unwrap().0;
        let stream = TcpStream::connect(place).unwrap();
        let (client, _) = tungstenite::client(&*server.address, stream).unwrap();
        let begun = Instant::now();
        while server.turn().arrived.is_empty() {
            assert!(begun.elapsed().as_secs() < 20, "no client came");
        }
        let line = serde_json::json!("x".repeat(60_000));
        let mut sent = 0;
        while !server.clients.is_empty() {
            let before = Instant::now();
            server.send(&line);
            sent += 1;
            assert!(before.elapsed() < Duration::from_secs(1), "it waits");
            assert!(sent < 2000, "120 MB wait for a client");
        }
        drop(client);
    }

    #[test]
    fn a_client_that_closes_its_connection_gets_an_answer() {
        let mut server = WebSocketServer::open("0", &[]).unwrap();
        let place = server.address["ws://".len()..].split_once('/').unwrap().0;
        let stream = TcpStream::connect(place).unwrap();
        let (mut client, _) = tungstenite::client(&*server.address, stream).unwrap();
        client.close(None).unwrap();
        let begun = Instant::now();
        // The client has come once it has a number, and is gone when the server has closed its connection.
        while server.next == 0 || !server.clients.is_empty() {
            server.turn();
            assert!(begun.elapsed().as_secs() < 20, "the client is not gone");
        }
        assert!(client.read().unwrap().is_close());
    }
}
