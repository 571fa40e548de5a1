//! A link with faults: a proxy on a socket between a program and a device.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use touchstone_protocol::frame::{Decoder, message};
use touchstone_protocol::{FromDevice, Phase};

/// A pseudo-random number generator.
#[derive(Clone)]
pub struct Draw(u64);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66_D1CE_4E5B | 1)
    }

    pub fn below(&mut self, most: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) % most
    }
}

/// A fault of the link that begins at some time, and is permanent or ends.
#[derive(Clone)]
pub struct Fault {
    what: What,
    /// Begin of the fault, ms after the first connection; `until_ms` is its end.
    from_ms: u64,
    until_ms: u64,
    draw: Draw,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    /// Frames are lost with these probabilities, %: on the way to the device, and from it.
    Drops([u64; 2]),
    /// Frames get a wrong byte with these probabilities, %: on the way to the device, and from it.
    Damages([u64; 2]),
    /// No bytes pass in one direction: to the device, or from it.
    Deaf { to_device: bool },
    /// Frames are delayed by at most this time, ms.
    Delays(u64),
    /// The connection is cut, and new connections fail while the fault lasts.
    Cuts,
}

impl Fault {
    /// The fault that belongs to a seed.
    pub fn of(seed: u64) -> Self {
        let mut draw = Draw::new(seed);
        let mut shares = || [0, 1].map(|_| [0, 10, 30, 60, 90, 100][draw.below(6) as usize]);
        let what = match seed % 5 {
            0 => What::Drops(shares()),
            1 => What::Damages(shares()),
            2 => What::Deaf {
                to_device: (seed / 5).is_multiple_of(2),
            },
            3 => What::Delays([5, 50, 300, 1_000][draw.below(4) as usize]),
            _ => What::Cuts,
        };
        let from_ms = draw.below(1_600);
        let lasts_ms = [100, 1_000, u64::MAX / 2][draw.below(3) as usize];
        Self {
            what,
            from_ms,
            until_ms: from_ms.saturating_add(lasts_ms),
            draw,
        }
    }

    /// A link without a fault, until the proxy's connections are closed.
    pub fn none() -> Self {
        Self {
            what: What::Cuts,
            from_ms: u64::MAX,
            until_ms: u64::MAX,
            draw: Draw::new(0),
        }
    }

    pub fn kind(&self) -> &'static str {
        match self.what {
            What::Drops(_) => "drops",
            What::Damages(_) => "damages",
            What::Deaf { .. } => "one-way",
            What::Delays(_) => "delays",
            What::Cuts => "cuts",
        }
    }

    fn acts(&self, now: Duration) -> bool {
        (u128::from(self.from_ms)..u128::from(self.until_ms)).contains(&now.as_millis())
    }
}

/// The unit of a stream that a fault affects: a frame, which ends with a zero byte, or all bytes of one read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    Frame,
    Chunk,
}

/// A running proxy. Its connections end when it is dropped.
pub struct Proxy {
    pub address: String,
    over: Arc<AtomicBool>,
    phase: Arc<Mutex<Option<Phase>>>,
}

impl Drop for Proxy {
    fn drop(&mut self) {
        self.end();
    }
}

impl Proxy {
    /// Starts a proxy for the device at this address.
    pub fn new(device: &str, fault: Fault, unit: Unit) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        let address = format!("tcp:{}", listener.local_addr().unwrap());
        let device = device.trim_start_matches("tcp:").to_owned();
        let over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&over);
        let phase = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&phase);
        std::thread::spawn(move || {
            let mut begun = None;
            while !ends.load(Ordering::Relaxed) {
                let Ok((program, _)) = listener.accept() else {
                    std::thread::sleep(Duration::from_millis(2));
                    continue;
                };
                let begun = *begun.get_or_insert_with(Instant::now);
                if fault.what == What::Cuts && fault.acts(begun.elapsed()) {
                    continue;
                }
                let Ok(device) = TcpStream::connect(&device) else {
                    continue;
                };
                for stream in [&program, &device] {
                    stream.set_nonblocking(false).unwrap();
                    stream.set_nodelay(true).unwrap();
                    let limit = Some(Duration::from_millis(5));
                    stream.set_read_timeout(limit).unwrap();
                }
                let closed = Arc::new(AtomicBool::new(false));
                for to_device in [true, false] {
                    let ends = [Arc::clone(&ends), Arc::clone(&closed)];
                    let (from, to) = match to_device {
                        true => (&program, &device),
                        false => (&device, &program),
                    };
                    let way = Way {
                        from: from.try_clone().unwrap(),
                        to: to.try_clone().unwrap(),
                        to_device,
                        begun,
                        fault: fault.clone(),
                        unit,
                        decoder: Decoder::new(),
                        phase: Arc::clone(&seen),
                    };
                    std::thread::spawn(move || way.passes(&ends));
                }
            }
        });
        Self {
            address,
            over,
            phase,
        }
    }

    /// State of the device in its newest telemetry record, as it came from the device; `None` before the first record.
    pub fn phase(&self) -> Option<Phase> {
        *self.phase.lock().unwrap()
    }

    /// Closes all connections.
    pub fn end(&self) {
        self.over.store(true, Ordering::Relaxed);
    }
}

/// One direction of a connection.
struct Way {
    from: TcpStream,
    to: TcpStream,
    to_device: bool,
    begun: Instant,
    fault: Fault,
    unit: Unit,
    /// Decodes what the device sends, to follow the device's state.
    decoder: Decoder,
    phase: Arc<Mutex<Option<Phase>>>,
}

impl Way {
    /// Forwards bytes until either end closes the connection, or one of `ends` is set.
    fn passes(mut self, ends: &[Arc<AtomicBool>; 2]) {
        let mut bytes = [0; 4096];
        let mut rest = Vec::new();
        while !ends.iter().any(|end| end.load(Ordering::Relaxed)) {
            if self.fault.what == What::Cuts && self.fault.acts(self.begun.elapsed()) {
                break;
            }
            match self.from.read(&mut bytes) {
                Ok(0) => break,
                Ok(count) => {
                    if !self.to_device {
                        self.follow(&bytes[..count]);
                    }
                    rest.extend(&bytes[..count]);
                }
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    continue;
                }
                Err(_) => break,
            }
            let whole = match self.unit {
                Unit::Chunk => rest.len(),
                Unit::Frame => rest
                    .iter()
                    .rposition(|byte| *byte == 0)
                    .map_or(0, |at| at + 1),
            };
            let whole: Vec<u8> = rest.drain(..whole).collect();
            let parts: Vec<&[u8]> = match self.unit {
                Unit::Chunk => vec![&whole],
                Unit::Frame => whole.split_inclusive(|byte| *byte == 0).collect(),
            };
            let mut out = Vec::new();
            for part in parts {
                out.extend(self.through(part));
            }
            if self.to.write_all(&out).is_err() {
                break;
            }
        }
        ends[1].store(true, Ordering::Relaxed);
        for stream in [&self.from, &self.to] {
            let _ = stream.shutdown(std::net::Shutdown::Both);
        }
    }

    /// Stores the state of the newest telemetry record in these bytes of the device.
    fn follow(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let Some(Ok(payload)) = self.decoder.push(byte) else {
                continue;
            };
            if let Some(FromDevice::Telemetry(record)) = message(payload) {
                *self.phase.lock().unwrap() = Some(record.phase);
            }
        }
    }

    /// The bytes of a frame after the link's faults.
    fn through(&mut self, part: &[u8]) -> Vec<u8> {
        let mut part = part.to_vec();
        if part.is_empty() || !self.fault.acts(self.begun.elapsed()) {
            return part;
        }
        let way = usize::from(!self.to_device);
        let chance = self.fault.draw.below(100);
        match self.fault.what {
            What::Drops(shares) if chance < shares[way] => Vec::new(),
            What::Damages(shares) if chance < shares[way] => {
                let at = self.fault.draw.below(part.len() as u64) as usize;
                part[at] ^= 1 << self.fault.draw.below(8);
                part
            }
            What::Deaf { to_device } if to_device == self.to_device => Vec::new(),
            What::Delays(most_ms) => {
                std::thread::sleep(Duration::from_millis(self.fault.draw.below(most_ms)));
                part
            }
            _ => part,
        }
    }
}
