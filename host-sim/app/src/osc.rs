//! Sends and receives messages of Open Sound Control (OSC 1.0) over UDP, as music and lighting programs use them. A message has an
//! address and arguments: numbers or texts. Received bundles and arguments of other types are ignored.

use super::out::note;
use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use touchstone_sim::error::{Error, Result};

/// Room for a received datagram, bytes: more than UDP can carry.
const LONGEST: usize = 65_536;

/// An argument of a message.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Int(i32),
    Float(f32),
    Text(String),
}

/// A message: address and arguments.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    pub address: String,
    pub values: Vec<Value>,
}

impl Message {
    /// Creates a message with this address and these arguments.
    pub fn new(address: &str, values: impl Into<Vec<Value>>) -> Self {
        Self {
            address: address.to_owned(),
            values: values.into(),
        }
    }

    /// Encodes the message as a datagram. Every text ends with one to four zero bytes, so that the next part begins at a multiple
    /// of four.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let text = |bytes: &mut Vec<u8>, text: &str| {
            bytes.extend(text.bytes().filter(|byte| *byte != 0));
            let padded = bytes.len() / 4 * 4 + 4;
            bytes.resize(padded, 0);
        };
        text(&mut bytes, &self.address);
        let mut types = ",".to_owned();
        types.extend(self.values.iter().map(|value| match value {
            Value::Int(_) => 'i',
            Value::Float(_) => 'f',
            Value::Text(_) => 's',
        }));
        text(&mut bytes, &types);
        for value in &self.values {
            match value {
                Value::Int(value) => bytes.extend(value.to_be_bytes()),
                Value::Float(value) => bytes.extend(value.to_be_bytes()),
                Value::Text(value) => text(&mut bytes, value),
            }
        }
        bytes
    }

    /// Decodes a datagram; `None` if it is not a message, or has an argument of another type.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let mut rest = bytes;
        let address = text(&mut rest)?;
        let types = text(&mut rest)?;
        let types = types.strip_prefix(',')?;
        let values = types.chars().map(|kind| match kind {
            'i' => word(&mut rest).map(|it| Value::Int(i32::from_be_bytes(it))),
            'f' => word(&mut rest).map(|it| Value::Float(f32::from_be_bytes(it))),
            's' => text(&mut rest).map(Value::Text),
            _ => None,
        });
        let values = values.collect::<Option<_>>()?;
        address.starts_with('/').then_some(Self { address, values })
    }
}

fn word(rest: &mut &[u8]) -> Option<[u8; 4]> {
    let (word, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*word)
}

fn text(rest: &mut &[u8]) -> Option<String> {
    let length = rest.iter().position(|byte| *byte == 0)?;
    let text = std::str::from_utf8(rest.get(..length)?).ok()?.to_owned();
    *rest = rest.get(length / 4 * 4 + 4..)?;
    Some(text)
}

/// The UDP sockets for the programs that use the knob.
#[derive(Debug, Default)]
pub struct Osc {
    /// Socket and destination of sent messages.
    to: Option<(UdpSocket, SocketAddr)>,
    /// Socket for received messages.
    from: Option<UdpSocket>,
}

impl Osc {
    /// Opens the sockets. Sends to `to`, a port on this computer or HOST:PORT. Receives on the port `from`, only from this
    /// computer.
    ///
    /// # Errors
    /// The address is invalid, or the port is in use.
    pub fn open(to: Option<&str>, from: Option<u16>) -> Result<Self> {
        let failed = |option: &'static str, problem: String, fix: &str| Error::Option {
            option: option.into(),
            problem,
            fix: fix.into(),
        };
        let to = match to {
            None => None,
            Some(text) => {
                let place = match text.parse::<u16>() {
                    Ok(port) => format!("{}:{port}", Ipv4Addr::LOCALHOST),
                    Err(_) => text.to_owned(),
                };
                let place = place.to_socket_addrs().ok().and_then(|mut all| all.next());
                // Nothing can be sent to port 0.
                let place = place.filter(|place| place.port() != 0);
                let place = place.ok_or_else(|| {
                    let problem = format!("{text} is not an address");
                    failed(
                        "--osc",
                        problem,
                        "give a port from 1 to 65535, e.g. 9000, or HOST:PORT",
                    )
                })?;
                let own = match place {
                    SocketAddr::V4(_) => "0.0.0.0:0",
                    SocketAddr::V6(_) => "[::]:0",
                };
                let own = if place.ip().is_loopback() && place.is_ipv4() {
                    "127.0.0.1:0"
                } else {
                    own
                };
                let socket = UdpSocket::bind(own).and_then(|it| {
                    it.set_nonblocking(true)?;
                    Ok(it)
                });
                let socket = socket
                    .map_err(|error| failed("--osc", error.to_string(), "try another address"))?;
                Some((socket, place))
            }
        };
        let from = from.map(|port| {
            let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, port))?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        });
        let from = from.transpose().map_err(|error: std::io::Error| {
            failed(
                "--osc-listen",
                error.to_string(),
                "give a port that is free",
            )
        })?;
        Ok(Self { to, from })
    }

    /// Whether messages are received.
    pub const fn listens(&self) -> bool {
        self.from.is_some()
    }

    /// Sends a message. If no program receives it, it is lost without an error.
    pub fn send(&self, address: &str, values: impl Into<Vec<Value>>) {
        if let Some((socket, place)) = &self.to {
            let _ = socket.send_to(&Message::new(address, values).bytes(), place);
        }
    }

    /// The next received message; `None` if none is waiting, or after an invalid datagram, which a note reports.
    pub fn next(&self) -> Option<Message> {
        let socket = self.from.as_ref()?;
        let mut bytes = vec![0; LONGEST];
        let (length, _) = socket.recv_from(&mut bytes).ok()?;
        let read = bytes.get(..length).and_then(Message::read);
        if read.is_none() {
            note!(
                "note: --osc-listen: ignored {length} bytes that are not an OSC message of integers, floats and texts"
            );
        }
        read
    }
}

#[cfg(test)]
mod tests {
    use super::{Message, Osc, Value};

    #[test]
    fn a_message_has_the_bytes_of_the_specification() {
        // The examples of the OSC 1.0 specification.
        let message = Message::new("/oscillator/4/frequency", [Value::Float(440.0)]);
        assert_eq!(
            message.bytes(),
            b"/oscillator/4/frequency\0,f\0\0\x43\xdc\0\0"
        );
        let values = [
            Value::Int(1000),
            Value::Int(-1),
            Value::Text("hello".into()),
            Value::Float(1.234),
            Value::Float(5.678),
        ];
        let message = Message::new("/foo", values);
        assert_eq!(
            message.bytes(),
            b"/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d"
        );
        assert_eq!(Message::read(&message.bytes()), Some(message));
    }

    #[test]
    fn what_is_no_message_is_left_out() {
        let whole = Message::new("/touchstone/feel", [Value::Text("on-off".into())]).bytes();
        for cut in 0..whole.len() {
            assert_eq!(Message::read(&whole[..cut]), None, "{cut} bytes");
        }
        for bytes in [
            &b"#bundle\0\0\0\0\0\0\0\0\x01"[..],
            b"/a\0\0,b\0\0\0\0\0\0",
            b"/\xff\0\0,\0\0\0",
            b"a\0\0\0,\0\0\0",
        ] {
            assert_eq!(Message::read(bytes), None, "{bytes:?}");
        }
    }

    #[test]
    fn messages_go_to_this_computer_unless_another_is_named() {
        let there = Osc::open(None, Some(0)).unwrap();
        let port = there.from.as_ref().unwrap().local_addr().unwrap();
        assert!(port.ip().is_loopback());
        let here = Osc::open(Some(&port.port().to_string()), None).unwrap();
        here.send("/touchstone/position", [Value::Int(3)]);
        let begun = std::time::Instant::now();
        let read = loop {
            if let Some(message) = there.next() {
                break message;
            }
            assert!(begun.elapsed().as_secs() < 5, "nothing came");
        };
        assert_eq!(read, Message::new("/touchstone/position", [Value::Int(3)]));
        for wrong in ["no such place", "0", "127.0.0.1:0", "65536"] {
            assert!(Osc::open(Some(wrong), None).is_err(), "{wrong}");
        }
    }
}
