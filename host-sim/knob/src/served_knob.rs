//! A complete simulated knob on a TCP port, in real time: the firmware's code, the simulated motor and a board's protocol.
//!
//! Desktop programs connect to it as to a board. [`ServedKnob::suffer`] simulates faults of the board or its cable.

use crate::knob::{Knob, Tamper};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};
use touchstone_drive::ControlInput;
use touchstone_drive::around::Surrounding;
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::wire::checked;
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::session::{Answered, Backend, FlashError, LargeBackend, Session};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::{
    Board, Command, Counters, CountsFrom, DeviceCommand, DeviceSettings, Fault, FromDevice,
    Identity, PROTOCOL_VERSION, Phase, ResetReason, RingChunk, State, Surround, Telemetry, stored,
};
use touchstone_world::motor::GIMBAL;

const BOARD: Board = Board::NucleoG474re;
/// Period of the simulated hand's motion into the wall and out again, s.
const PRESS_S: f64 = 3.0;
/// Distance in rad outside the wall's surface from which the hand's rest point starts. It moves to `DEEP_RAD` inside and back.
const NEAR_RAD: f64 = 0.1;
const DEEP_RAD: f64 = 2.5;
/// Speed in rad/s at which the simulated hand turns the knob to the angle of the order `turn`.
const TURN_RAD_PER_S: f64 = 3.0;

/// Surroundings of a simulated knob that tests can change: the supply voltage, and a desktop program that may stop sending.
#[derive(Debug, Clone, Copy)]
pub struct Outside {
    supply_v: f64,
    /// Whether a frame from the desktop program arrived since the last control tick; `None` until the knob is served.
    heard: Option<bool>,
}

impl Tamper for Outside {
    fn bus_v(&mut self, _tick: u32) -> f64 {
        self.supply_v
    }

    fn input(&mut self, _tick: u32, input: &mut ControlInput) -> bool {
        if let Some(heard) = &mut self.heard {
            input.host_heard = std::mem::take(heard);
        }
        true
    }
}

/// The simulated knob, with its connection to a desktop program and its simulated hand.
pub struct ServedKnob {
    knob: Knob<Outside>,
    settings: DeviceSettings,
    decimation: u16,
    /// Number of telemetry records that are still to be dropped, to simulate a gap.
    gap: u32,
    dropped: u32,
    /// Telemetry records that were not sent yet.
    records: Vec<Telemetry>,
    armed_s: f64,
    /// Shaft angle in rad when the motor was last switched on. `outside_rad` is the distance from this angle to the wall's surface.
    start_rad: f64,
    outside_rad: f64,
    /// Angle in rad to which the simulated hand turns the knob; `None` if the hand presses into the wall.
    turned_rad: Option<f64>,
    /// Whether the simulated cable is plugged in.
    plugged: bool,
    noise: usize,
}

impl ServedKnob {
    /// A simulated knob with the default settings of the board Nucleo-G474RE.
    #[must_use]
    pub fn new() -> Self {
        let settings = DeviceSettings::defaults(BOARD);
        let outside = Outside {
            supply_v: 24.0,
            heard: None,
        };
        Self {
            knob: Knob::new(&settings, GIMBAL, 0.0, outside),
            settings,
            decimation: 1,
            gap: 0,
            dropped: 0,
            records: Vec::new(),
            armed_s: 0.0,
            start_rad: 0.0,
            outside_rad: 0.0,
            turned_rad: None,
            plugged: true,
            noise: 0,
        }
    }

    /// Carries out an order from the terminal. `gap N` drops N telemetry records, `noise N` sends N meaningless bytes, `volts V`
    /// sets the supply voltage, `pull` and `plug` disconnect and connect the cable. `turn DEGREES` makes the hand turn the knob
    /// to this angle, `press` makes the hand press into the wall.
    pub fn suffer(&mut self, what: &str) {
        let (word, number) = what.trim().split_once(' ').unwrap_or((what.trim(), "0"));
        let number: f64 = number.parse().unwrap_or(0.0);
        match word {
            "gap" => self.gap = number as u32,
            "noise" => self.noise = number as usize,
            "volts" => self.knob.tamper.supply_v = number,
            "pull" => self.plugged = false,
            "plug" => self.plugged = true,
            "turn" => self.turned_rad = Some(number.to_radians()),
            "press" => self.turned_rad = None,
            _ => eprintln!(
                "note: unknown line `{what}`; known: turn DEGREES, press, gap N, noise N, volts V, pull or plug"
            ),
        }
    }

    /// Calibrates the knob, as fast as the computer can simulate, and returns it.
    #[must_use]
    pub fn calibrated(mut self) -> Self {
        self.knob.calibrate();
        self
    }

    /// Runs one control tick with its PWM periods. The simulated hand turns the knob to the angle of a `turn` order, or presses
    /// into the wall while the motor is on. Queues a telemetry record if one is due.
    fn advance(&mut self) {
        let rate_hz = f64::from(self.settings.timing.rate_hz);
        if let Some(turned_rad) = self.turned_rad {
            let step = TURN_RAD_PER_S / rate_hz;
            self.knob.rest_rad += (turned_rad - self.knob.rest_rad).clamp(-step, step);
        } else if self.knob.device.state() == State::Armed {
            self.armed_s += 1.0 / rate_hz;
            // In the first second the hand's rest point moves from where the knob was armed to `NEAR_RAD` before the surface. From
            // there it moves to `DEEP_RAD` inside and back, again and again.
            let (near, pressing_s) = (self.outside_rad - NEAR_RAD, (self.armed_s - 1.0).max(0.0));
            let share = (1.0 - (std::f64::consts::TAU * pressing_s / PRESS_S).cos()) / 2.0;
            let ahead = near * self.armed_s.min(1.0) + (NEAR_RAD + DEEP_RAD) * share;
            self.knob.rest_rad = self.start_rad + ahead;
        } else {
            self.armed_s = 0.0;
            self.start_rad = self.knob.rig.now().angle_rad;
            self.outside_rad = -self.knob.record.penetration.0.to_num::<f64>();
            self.knob.rest_rad = self.start_rad;
        }
        let record = self.knob.tick();
        if self.decimation == 0 || !record.tick.is_multiple_of(u32::from(self.decimation)) {
            return;
        }
        if self.gap > 0 {
            self.gap -= 1;
            self.dropped += 1;
            return;
        }
        self.records.push(self.knob.telemetry());
    }

    /// Gives a command to the device's next control tick and runs it; returns whether the command had an effect.
    fn give(&mut self, command: Command) -> bool {
        self.knob.ask(command);
        self.advance();
        let output = self.knob.output;
        output.and_then(|output| output.accepted).unwrap_or(false)
    }
}

impl Default for ServedKnob {
    fn default() -> Self {
        Self::new()
    }
}

impl Backend for ServedKnob {
    fn identity(&self) -> Identity {
        Identity {
            protocol_version: PROTOCOL_VERSION,
            settings_version: stored::LAYOUT_VERSION,
            firmware_version: "simulated".try_into().unwrap_or_default(),
            board: BOARD,
            unique_id: [0; 12],
            reset_reason: ResetReason::PowerOn,
            build_hash: 0,
        }
    }
    fn phase(&self) -> Phase {
        self.knob.device.state().into()
    }
    fn fault(&self) -> Option<Fault> {
        self.knob.device.fault().map(Fault::from)
    }
    fn tick(&self) -> u32 {
        self.knob.record.tick
    }
    fn counters(&self) -> Counters {
        Counters {
            telemetry_dropped: self.dropped,
            ticks: self.knob.record.tick,
            ..Counters::default()
        }
    }
    fn ring(&self, _first: u16) -> Option<RingChunk> {
        None
    }
    fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        checked(settings, BOARD)
    }
    fn use_settings(&mut self, settings: &DeviceSettings) {
        // The settings were checked before, so they are accepted.
        if self.knob.device.configure(settings, &IHM08M1).is_ok() {
            self.settings = settings.clone();
        }
    }
    fn save(&mut self, _image: &[u8]) -> Result<(), FlashError> {
        Ok(())
    }
    fn command(&mut self, command: DeviceCommand) -> Option<bool> {
        let asked = match command {
            DeviceCommand::Calibrate => Command::Calibrate,
            DeviceCommand::Arm => Command::Arm,
            DeviceCommand::Disarm => Command::Disarm,
            DeviceCommand::Stop => Command::Stop,
            DeviceCommand::Zero => return Some(self.knob.device.zero_here()),
            DeviceCommand::Reboot => return Some(false),
        };
        Some(self.give(asked))
    }
    fn telemetry(&mut self, decimation: u16) {
        self.decimation = decimation;
    }
}

impl LargeBackend for ServedKnob {
    fn use_environment(
        &mut self,
        settings: &DeviceSettings,
        environment: &Surround,
    ) -> Option<Result<CountsFrom, SettingsError>> {
        let surrounding = Surrounding::new(settings, &IHM08M1, environment);
        let knob = &mut self.knob;
        Some(surrounding.map(|it| knob.device.surround(&mut knob.around, &it)))
    }
}

/// Serves one connection after the other until `stop` is set. The channel `happens` delivers the texts for [`ServedKnob::suffer`].
///
/// # Errors
/// The listener fails.
pub fn serve(
    mut knob: ServedKnob,
    listener: &TcpListener,
    happens: &Receiver<String>,
    stop: &AtomicBool,
) -> std::io::Result<()> {
    listener.set_nonblocking(true)?;
    let mut session = Session::new(DeviceSettings::defaults(BOARD), true);
    let mut line: Option<(TcpStream, Decoder)> = None;
    let begun = Instant::now();
    let mut ran_s = 0.0;
    knob.knob.tamper.heard = Some(false);
    while !stop.load(Ordering::Relaxed) {
        for what in happens.try_iter() {
            knob.suffer(&what);
        }
        if let Ok((stream, _)) = listener.accept() {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            line = Some((stream, Decoder::new()));
        }
        if !knob.plugged {
            line = None;
        }
        let mut out = Vec::new();
        if let Some((stream, decoder)) = &mut line {
            let mut bytes = [0; 1024];
            let count = match stream.read(&mut bytes) {
                Ok(0) => None,
                Ok(count) => Some(count),
                Err(error) if error.kind() == ErrorKind::WouldBlock => Some(0),
                Err(_) => None,
            };
            for &byte in bytes.get(..count.unwrap_or(0)).unwrap_or_default() {
                let errors = decoder.errors();
                let Some(Ok(payload)) = decoder.push(byte) else {
                    continue;
                };
                knob.knob.tamper.heard = Some(true);
                if let Answered::Now(answer) = session.answer_payload(payload, errors, &mut knob) {
                    out.extend(framed(&answer));
                }
            }
            if count.is_none() {
                line = None;
            }
        }
        out.extend((0..std::mem::take(&mut knob.noise)).map(|i| ((i * 7919) >> 3) as u8));
        let rate_hz = f64::from(knob.settings.timing.rate_hz);
        let now_s = begun.elapsed().as_secs_f64();
        // On a machine that is too slow the simulation runs slower instead of catching up.
        if now_s - ran_s > 0.25 {
            ran_s = now_s - 0.02;
        }
        while ran_s < now_s {
            ran_s += 1.0 / rate_hz;
            knob.advance();
        }
        for record in knob.records.drain(..) {
            out.extend(framed(&FromDevice::Telemetry(record)));
        }
        if let Some((stream, _)) = &mut line {
            // Bytes that the connection cannot take are lost, as on a serial port.
            match stream.write(&out) {
                Err(error) if error.kind() != ErrorKind::WouldBlock => line = None,
                _ => {}
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(())
}

fn framed(message: &FromDevice) -> Vec<u8> {
    let mut buffer = [0; FRAME_MAX];
    frame::encode(message, &mut buffer).map_or_else(|_| Vec::new(), <[u8]>::to_vec)
}
