//! Transport of bytes to and from a device, with time limits.

use super::Address;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};
use touchstone_sim::error::{Error, Result};

/// Rate of the serial port, baud. 115,200 is too slow for the telemetry.
const BAUD: u32 = 921_600;
/// Longest time that a read waits for bytes.
const PATIENCE: Duration = Duration::from_millis(20);
/// Longest time for a connection or a write; one that takes longer has failed.
const LIMIT: Duration = Duration::from_secs(2);

/// The outcome of a read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Received {
    /// Bytes arrived; holds their number.
    Bytes(usize),
    /// No byte arrived within some 20 ms.
    Quiet,
}

/// A connection over which bytes go to and from a device.
pub trait Transport {
    /// Waits for bytes, at most some 20 ms.
    ///
    /// # Errors
    /// The connection is lost.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Received>;

    /// Sends all bytes.
    ///
    /// # Errors
    /// The connection is lost, or the device accepts no more bytes.
    fn send(&mut self, bytes: &[u8]) -> Result<()>;
}

/// Opens the connection to a device.
///
/// # Errors
/// There is no device at this address, or this user may not access it.
pub fn open(address: &Address) -> Result<Box<dyn Transport>> {
    match address {
        Address::Serial(name) => serial(name),
        Address::Tcp(socket) => tcp(socket),
    }
}

fn serial(name: &str) -> Result<Box<dyn Transport>> {
    let port = serialport::new(name, BAUD).timeout(PATIENCE).open();
    let stream = port.map_err(|error| {
        let said = error.to_string();
        let fix = remedy(error.kind(), &said);
        Error::device(name, format!("cannot be opened: {said}"), fix)
    })?;
    Ok(Box::new(Stream {
        stream,
        name: name.into(),
    }))
}

/// The advice to the user for a serial port that does not open. The library `serialport` reports a busy port as a missing one, so
/// its message `said` is read as well.
fn remedy(kind: serialport::ErrorKind, said: &str) -> &'static str {
    use serialport::ErrorKind::{Io, NoDevice};
    match kind {
        _ if said.contains("busy") => {
            "another program uses this port: close it, or choose another port with --port"
        }
        _ if ["typewriter", "Is a directory", "symbolic links"]
            .iter()
            .any(|part| said.contains(part)) =>
        {
            "this is not a serial port: choose one with --port; `touchstone doctor` lists them"
        }
        Io(ErrorKind::PermissionDenied) => "`touchstone doctor` shows how to get the permission",
        NoDevice | Io(ErrorKind::NotFound) => {
            "connect the board, or choose another port with --port"
        }
        _ => "close other programs that use it, or see `touchstone doctor`",
    }
}

fn tcp(socket: &str) -> Result<Box<dyn Transport>> {
    let name = format!("tcp:{socket}");
    let refused = |error: std::io::Error| {
        let fix = "start the emulator or the serial server, or give its HOST:PORT";
        Error::device(&*name, format!("cannot be reached: {error}"), fix)
    };
    let stream = connected(socket, LIMIT).map_err(refused)?;
    stream.set_read_timeout(Some(PATIENCE)).map_err(refused)?;
    stream.set_write_timeout(Some(PATIENCE)).map_err(refused)?;
    Ok(Box::new(Stream { stream, name }))
}

/// Connects to `HOST:PORT` for requests that are one small packet each. Looking up the name and trying its addresses, such as ::1
/// and 127.0.0.1 of localhost, share the deadline `limit`, but each address gets at least 20 ms.
pub(crate) fn connected(socket: &str, limit: Duration) -> std::io::Result<TcpStream> {
    let until = Instant::now() + limit;
    let left = || until.saturating_duration_since(Instant::now());
    // The system's look-up has no deadline, so it runs in a thread. If the name server does not answer, that thread keeps waiting.
    let (sender, receiver) = std::sync::mpsc::channel();
    let name = socket.to_owned();
    std::thread::spawn(move || {
        let places = name.to_socket_addrs();
        // After the deadline nobody receives the addresses.
        drop(sender.send(places.map(Vec::from_iter)));
    });
    let places = receiver.recv_timeout(left());
    let mut last = ErrorKind::NotFound.into();
    for place in places.map_err(|_| std::io::Error::from(ErrorKind::TimedOut))?? {
        match TcpStream::connect_timeout(&place, left().max(PATIENCE)) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(why) => last = why,
        }
    }
    Err(last)
}

/// A transport over any stream whose reads and writes have a time limit.
struct Stream<S> {
    stream: S,
    name: String,
}

impl<S: Read + Write> Stream<S> {
    fn gone(&self, why: impl std::fmt::Display) -> Error {
        let fix = "connect it again; if the board restarts by itself, `touchstone device status` shows why";
        Error::device(&*self.name, format!("the connection was lost: {why}"), fix)
    }
}

impl<S: Read + Write> Transport for Stream<S> {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Received> {
        match self.stream.read(buffer) {
            Ok(0) => Err(self.gone("the other end closed it")),
            Ok(count) => Ok(Received::Bytes(count)),
            Err(error) => match error.kind() {
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => {
                    Ok(Received::Quiet)
                }
                _ => Err(self.gone(error)),
            },
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<()> {
        let until = Instant::now() + LIMIT;
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.stream.write(rest) {
                Ok(0) => return Err(self.gone("the other end closed it")),
                Ok(count) => rest = rest.get(count..).unwrap_or_default(),
                Err(error) => match error.kind() {
                    ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => {
                        if Instant::now() >= until {
                            return Err(self.gone("the device accepts no more data"));
                        }
                    }
                    _ => return Err(self.gone(error)),
                },
            }
        }
        // The stream is not flushed: this side buffers nothing, and the flush of a serial port waits endlessly for a device that
        // accepts no bytes.
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::ErrorKind::{Io, NoDevice, Unknown};

    #[test]
    fn a_name_of_several_addresses_is_tried_at_each() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        open(&Address::Tcp(format!("localhost:{port}"))).map_or_else(|e| panic!("{e}"), drop);
    }

    #[test]
    fn an_end_that_takes_nothing_is_given_up_at_its_deadline() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = Address::Tcp(listener.local_addr().unwrap().to_string());
        let mut sender = open(&address).unwrap_or_else(|e| panic!("{e}"));
        let _silent = listener.accept().unwrap();
        let begun = Instant::now();
        let error = sender.send(&vec![0; 100_000_000]).unwrap_err().to_string();
        assert!(
            error.contains("the connection was lost: the device accepts no more data; "),
            "{error}"
        );
        assert!(begun.elapsed() < 2 * LIMIT, "{:?}", begun.elapsed());
    }

    #[test]
    fn a_port_that_does_not_open_has_the_remedy_of_its_cause() {
        for (kind, said, part) in [
            (
                NoDevice,
                "Device or resource busy",
                "another program uses this port",
            ),
            (NoDevice, "No such file or directory", "connect the board"),
            (
                Io(ErrorKind::NotFound),
                "No such file or directory",
                "connect the board",
            ),
            (
                Io(ErrorKind::PermissionDenied),
                "Permission denied",
                "the permission",
            ),
            (Unknown, "Not a typewriter", "this is not a serial port"),
            (Unknown, "Is a directory", "this is not a serial port"),
            (
                Unknown,
                "Too many symbolic links encountered",
                "this is not a serial port",
            ),
            (
                Unknown,
                "Input/output error",
                "close other programs that use it",
            ),
        ] {
            assert!(remedy(kind, said).contains(part), "{said}");
        }
    }
}
