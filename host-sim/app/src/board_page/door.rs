//! HTTP server on a port that only this machine reaches. It serves one page, to a browser whose request has the secret token.
//!
//! Pages of other sites could make the same browser send requests here. Three checks keep such requests out. The address that this
//! program opens in the browser has the token. A foreign host name that resolves to this machine (DNS rebinding) fails the check of
//! the header `Host`. A WebSocket is opened only for a request with the right header `Origin`.

use crate::http::{HEAD_LIMIT, Head, Request, answer, head, refuse, serve, take, token};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use touchstone_sim::error::{Error, Result};
use tungstenite::WebSocket;
use tungstenite::protocol::WebSocketConfig;

/// Largest message from the page, in bytes: each message is one short command.
const MESSAGE_MAX: usize = 4096;

/// WebSocket of a page whose request passed all checks.
pub type Socket = WebSocket<TcpStream>;

/// The answer that the server gives to a request: the page, a WebSocket, or a refusal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    Page,
    Socket,
    Refused(&'static str, &'static str),
}

/// HTTP and WebSocket server of the page.
pub struct Door {
    /// The address that the browser opens; it has the token.
    pub address: String,
    /// Receives the WebSocket of each accepted page; only one page is open at a time.
    pub sockets: Receiver<Socket>,
    /// Whether a page is open; the thread that serves the page sets the flag to false when the page is gone.
    pub taken: Arc<AtomicBool>,
}

/// Data that the server's threads share.
struct Inside {
    host: String,
    token: String,
    head: String,
    page: String,
    sockets: Sender<Socket>,
    taken: Arc<AtomicBool>,
}

impl Door {
    /// Opens the server at a free port. `page` gets the address of the WebSocket and returns the HTML page with its content
    /// security policy.
    pub fn open(page: impl FnOnce(&str) -> (String, String)) -> Result<Self> {
        let wrong = |error: std::io::Error| {
            Error::device(
                "127.0.0.1",
                format!("this computer cannot open a TCP port for the page: {error}"),
                "allow this program to listen on 127.0.0.1, for example in the firewall",
            )
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).map_err(wrong)?;
        let host = listener.local_addr().map_err(wrong)?.to_string();
        let token = token()?;
        let address = format!("http://{host}/?token={token}");
        let (page, policy) = page(&format!("ws://{host}/socket?token={token}"));
        let (sender, sockets) = channel();
        let taken = Arc::new(AtomicBool::new(false));
        let inside = Inside {
            host,
            token,
            head: format!(
                "Content-Type: text/html; charset=utf-8\r\nContent-Security-Policy: {policy}; frame-ancestors 'none'\r\n"
            ),
            page,
            sockets: sender,
            taken: Arc::clone(&taken),
        };
        serve(listener, move |stream| {
            // A browser that closes the connection or sends an invalid request is no error of this program.
            let _ = inside.welcome(stream);
        });
        Ok(Self {
            address,
            sockets,
            taken,
        })
    }
}

impl Inside {
    fn welcome(&self, mut stream: TcpStream) -> std::io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(HEAD_LIMIT))?;
        let head = match head(&stream)? {
            Head::Whole(head) => head,
            // Browsers open connections in advance. A reply sent now would be taken for the reply to the next request.
            Head::Silent => return Ok(()),
            Head::Broken => {
                return refuse(
                    &mut stream,
                    "400 Bad Request",
                    "this is not a valid HTTP request",
                );
            }
        };
        match self.wish(&head) {
            Wish::Refused(status, why) => {
                take(&mut stream, head.len())?;
                refuse(&mut stream, status, why)
            }
            Wish::Page => {
                take(&mut stream, head.len())?;
                answer(&mut stream, "200 OK", &self.head, &self.page)
            }
            Wish::Socket if self.taken.swap(true, Ordering::SeqCst) => {
                take(&mut stream, head.len())?;
                let why = "another page is connected to the device; close that page first";
                refuse(&mut stream, "409 Conflict", why)
            }
            Wish::Socket => {
                let config = WebSocketConfig::default()
                    .max_message_size(Some(MESSAGE_MAX))
                    .max_frame_size(Some(MESSAGE_MAX));
                stream.set_read_timeout(Some(HEAD_LIMIT))?;
                let socket = tungstenite::accept_with_config(stream, Some(config)).ok();
                let given = socket.filter(|socket| socket.get_ref().set_nonblocking(true).is_ok());
                if given.is_none_or(|socket| self.sockets.send(socket).is_err()) {
                    self.taken.store(false, Ordering::SeqCst);
                }
                Ok(())
            }
        }
    }

    /// Parses the header of a request and decides how the server answers.
    fn wish(&self, head: &[u8]) -> Wish {
        let Some(request) = Request::read(head) else {
            return Wish::Refused("400 Bad Request", "this is not a valid HTTP request");
        };
        if request.header("host") != (Some(self.host.as_bytes()), false) {
            return Wish::Refused("403 Forbidden", "wrong Host");
        }
        let origin = format!("http://{}", self.host);
        let own_origin = request.header("origin") == (Some(origin.as_bytes()), false);
        if request.header("origin").0.is_some() && !own_origin {
            return Wish::Refused("403 Forbidden", "wrong Origin");
        }
        if !request.has_token(&self.token) {
            return Wish::Refused(
                "403 Forbidden",
                "wrong or missing token: open the address that `touchstone live` printed",
            );
        }
        match (&*request.method, &*request.path) {
            ("GET", "/") => Wish::Page,
            ("GET", "/socket") if !own_origin => Wish::Refused("403 Forbidden", "missing Origin"),
            ("GET", "/socket") => Wish::Socket,
            _ => Wish::Refused("404 Not Found", "this address has no page"),
        }
    }
}
