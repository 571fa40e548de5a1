//! Haply's Inverse3, through the maker's service on this machine: a WebSocket that sends device states and receives force commands.
//!
//! The service expects a command after every state, so the service sets the rate of the servo loop. The program moves the origin
//! from the device's base to the position of the handle at the start. The device's limits are not published, so force and workspace
//! are assumed.

mod message;
mod timed;

pub use message::Generation;

use crate::haptic::{
    Applied, DataSheet, DeviceStanding, HapticDevice, HapticFault, Sensed, Workspace, length,
};
use crate::transport;
use message::CursorState;
use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};
use timed::Timed;
use touchstone_sim::harmless::one_line;
use tungstenite::{Message, WebSocket, client::client};

/// Default TCP address of the maker's service.
pub const SERVICE: &str = "localhost:10001";
/// Longest time for connecting to the service, and longest wait for a device state.
const PATIENCE: Duration = Duration::from_millis(300);
/// Number of device states over which the service's rate is measured.
const MEASURED: u32 = 100;
/// Largest force that the program commands, N. `REACH_M` is both radius and half height of the workspace, `COUNT_M` the position's
/// resolution. All three are assumed, not published by the maker.
const FORCE_N: f64 = 3.0;
const REACH_M: f64 = 0.1;
const COUNT_M: f64 = 5e-5;

/// An Inverse3 that this program commands.
#[derive(Debug)]
pub struct Inverse3 {
    socket: WebSocket<Timed>,
    generation: Generation,
    device: String,
    sheet: DataSheet,
    origin_m: [f64; 3],
    standing: DeviceStanding,
    engaged: bool,
    open: bool,
    /// Number of commands that no state has followed yet. The service sends a state for every command.
    unanswered: u32,
    /// Whether reading or sending a message has failed.
    broken: bool,
}

fn lost(call: &'static str) -> impl Fn(String) -> HapticFault {
    move |said| HapticFault::Lost(call, said)
}

fn absent(service: &str, why: &std::io::Error) -> HapticFault {
    HapticFault::NoService(format!("{service}: {why}"))
}

/// Opens a TCP connection to the service whose reads and writes have a time limit.
fn connected(service: &str) -> Result<Timed, HapticFault> {
    let stream = transport::connected(service, PATIENCE).map_err(|why| absent(service, &why))?;
    Ok(Timed::new(stream, PATIENCE))
}

/// Requests the service's version text by `GET /version`.
fn version(service: &str) -> Result<String, HapticFault> {
    let mut stream = connected(service)?;
    let wrong = |why: std::io::Error| absent(service, &why);
    // Sent as one packet: a service may answer and close the connection after the first packet.
    let asked = format!("GET /version HTTP/1.1\r\nHost: {service}\r\nConnection: close\r\n\r\n");
    stream.write_all(asked.as_bytes()).map_err(wrong)?;
    let mut answer = Vec::new();
    // If the service keeps the connection open or sends slowly, the deadline ends the read. What arrived until then is the answer.
    let _ = stream.take(65_536).read_to_end(&mut answer);
    let answer = String::from_utf8_lossy(&answer).into_owned();
    let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    Ok(body.trim().to_owned())
}

impl Inverse3 {
    /// Connects to the service's first Inverse3. Measures the rate at which the service sends states, while commanding no force.
    ///
    /// # Errors
    /// No service, no device, or a device without supply or that is not calibrated.
    pub fn connect(service: &str) -> Result<Self, HapticFault> {
        let version = version(service)?;
        let generation = Generation::of(&version).map_err(|why| {
            HapticFault::Unusable(
                format!("the service at {service} {why}: {version:?}"),
                "install a service of version 3, or report it".into(),
            )
        })?;
        let stream = connected(service)?;
        let (socket, _) = client(format!("ws://{service}/"), stream)
            .map_err(|why| lost("opening the WebSocket")(why.to_string()))?;
        let mut inverse = Self {
            socket,
            generation,
            device: String::new(),
            sheet: DataSheet {
                name: String::new(),
                degrees: 3,
                force_n: FORCE_N,
                workspace: Workspace {
                    radius_m: REACH_M,
                    half_height_m: REACH_M,
                },
                count_m: COUNT_M,
                rates_hz: (1000, 1000),
                delay_s: 1e-3,
                axes: None,
                least_damping_n_s_per_m: None,
                sets_the_pace: true,
            },
            origin_m: [0.0; 3],
            standing: DeviceStanding {
                powered: true,
                calibrated: true,
                motors_on: true,
                switched_off: None,
            },
            engaged: false,
            open: true,
            unanswered: 0,
            broken: false,
        };
        inverse.meet(&version)?;
        Ok(inverse)
    }

    /// Reads the first device states, from which follow the device's name, whether it is calibrated, and the rate of the states.
    fn meet(&mut self, version: &str) -> Result<(), HapticFault> {
        let first = self.state()?;
        if !first.standing.powered {
            return Err(HapticFault::Unusable(
                format!("Inverse3 {} has no supply", one_line(&first.device)),
                "switch its supply on, then start again".into(),
            ));
        }
        if !first.standing.calibrated {
            return Err(HapticFault::Unusable(
                format!("Inverse3 {} is not calibrated", one_line(&first.device)),
                "calibrate it by its maker's instructions".into(),
            ));
        }
        self.device = first.device;
        self.origin_m = first.position_m;
        let begun = Instant::now();
        for _ in 0..MEASURED {
            self.say([0.0; 3])?;
            self.state()?;
        }
        let rate = f64::from(MEASURED) / begun.elapsed().as_secs_f64();
        let rate_hz = rate.round().clamp(100.0, 10_000.0) as u32;
        self.sheet.rates_hz = (rate_hz, rate_hz);
        self.sheet.delay_s = 1.0 / rate;
        let version = version.trim_matches(|c: char| !c.is_ascii_digit());
        self.sheet.name = format!("Inverse3 {} (service {version})", one_line(&self.device));
        Ok(())
    }

    /// Waits for the next device state.
    fn state(&mut self) -> Result<CursorState, HapticFault> {
        let state = self.next_state();
        match &state {
            Ok(_) => self.unanswered = self.unanswered.saturating_sub(1),
            Err(_) => self.broken = true,
        }
        state
    }

    /// Waits for the next device state. The whole message must arrive before one deadline, which neither pings nor single bytes
    /// extend.
    fn next_state(&mut self) -> Result<CursorState, HapticFault> {
        let wrong = lost("reading its state");
        let known = (!self.device.is_empty()).then(|| self.device.clone());
        self.socket.get_mut().begin(PATIENCE);
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    let state = CursorState::of(&text, known.as_deref()).map_err(&wrong)?;
                    self.standing = state.standing;
                    return Ok(state);
                }
                Ok(Message::Close(_)) => return Err(wrong("the service closed it".into())),
                // The socket answers pings automatically. Data that already arrived are read without a check of the deadline.
                Ok(_) if self.socket.get_ref().is_over() => {
                    return Err(wrong(self.socket.get_ref().over().to_string()));
                }
                Ok(_) => {}
                Err(why) => return Err(wrong(why.to_string())),
            }
        }
    }

    fn say(&mut self, force_n: [f64; 3]) -> Result<(), HapticFault> {
        let text = self.generation.force(&self.device, force_n);
        self.socket.get_mut().begin(PATIENCE);
        let sent = self.socket.send(Message::text(text));
        self.broken |= sent.is_err();
        self.unanswered = self.unanswered.saturating_add(1);
        sent.map_err(|why| lost("commanding the force")(why.to_string()))
    }

    /// Waits for one state for each command that has had none. The last command ends the force, which may still act until the
    /// state that follows this command arrives. After a failed read or write nothing is awaited: the connection may never answer
    /// again, and the end of the force counts as not confirmed.
    fn confirmed(&mut self) -> Result<(), HapticFault> {
        while self.unanswered > 0 && !self.broken {
            self.state()?;
        }
        match self.unanswered {
            0 => Ok(()),
            _ => Err(lost("confirming the release")(
                "no device state followed the command that ends the force".into(),
            )),
        }
    }

    /// Discards old device states, which arrived while the program did not read any.
    fn catch_up(&mut self) -> Result<(), HapticFault> {
        let until = Instant::now() + PATIENCE;
        loop {
            self.socket.get_mut().begin(Duration::from_millis(1));
            match self.socket.read() {
                Err(tungstenite::Error::Io(why)) if why.kind() == ErrorKind::TimedOut => break,
                Err(why) => return Err(lost("reading its state")(why.to_string())),
                // A service that does not wait for commands never stops sending states.
                Ok(_) if Instant::now() > until => break,
                Ok(_) => {}
            }
        }
        self.unanswered = 0;
        self.say([0.0; 3])
    }
}

impl HapticDevice for Inverse3 {
    fn sheet(&self) -> &DataSheet {
        &self.sheet
    }

    fn engage(&mut self) -> Result<(), HapticFault> {
        self.catch_up()?;
        self.engaged = true;
        Ok(())
    }

    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        if !self.engaged {
            self.catch_up()?;
        }
        let at = self.state()?.position_m;
        Ok(Sensed {
            position_m: std::array::from_fn(|axis| at[axis] - self.origin_m[axis]),
            fresh: true,
        })
    }

    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        self.say(if self.engaged { force_n } else { [0.0; 3] })?;
        // A force above the assumed limit is reported as saturated, because what the device does with it is unknown. The servo
        // loop commands no such force.
        Ok(match length(force_n) > FORCE_N * (1.0 + 1e-9) {
            true => Applied::Saturated(None),
            false => Applied::Whole,
        })
    }

    /// Supply, calibration and motors from the last message. The service has no request for them.
    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        Ok(self.standing)
    }

    fn release(&mut self) -> Result<(), HapticFault> {
        if !std::mem::take(&mut self.open) {
            return Ok(());
        }
        self.engaged = false;
        let said = self.say([0.0; 3]).and_then(|()| self.confirmed());
        self.socket.get_mut().begin(PATIENCE);
        let closed = self.socket.close(None).and_then(|()| self.socket.flush());
        said?;
        match closed {
            Ok(()) | Err(tungstenite::Error::ConnectionClosed) => Ok(()),
            Err(why) => Err(lost("closing the WebSocket")(why.to_string())),
        }
    }
}

impl Drop for Inverse3 {
    fn drop(&mut self) {
        // The result is ignored: a caller that needs it has released the device before.
        let _ = self.release();
    }
}
