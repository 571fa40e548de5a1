//! A fake device on a TCP socket or a pseudo terminal. It uses the firmware's own session, fault state machine and frames; only the
//! board hardware is imitated.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;
use touchstone_drive::wire::checked;
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::session::{Answered, Backend, FlashError, LargeBackend, Session};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::telemetry::RING_CHUNK;
use touchstone_protocol::{
    Board, Command, Context, Counters, CountsFrom, Decimal, DeviceCommand, DeviceSettings, Event,
    Fault, FaultCode, FromDevice, Identity, Machine, PROTOCOL_VERSION, Phase, ResetReason,
    RingChunk, RingRecord, State, Surround, Telemetry, stored,
};

/// Faults that the fake device can be given.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trouble {
    /// Whether the device answers no request.
    pub silent: bool,
    /// Protocol version that the device reports in place of the right one.
    pub version: Option<u16>,
    /// Number of the device's next answers that have a flipped bit.
    pub damaged: usize,
    /// Index of the one answer, counted from 0, that has a flipped bit.
    pub damages: Option<usize>,
    /// Index of the request, counted from 0, at which the device closes the connection without an answer.
    pub closes_at: Option<usize>,
    /// Whether writing the device's flash fails.
    pub flash_fails: bool,
    /// Interval of lost telemetry records: with `Some(N)` the device drops every Nth record and counts the dropped ones.
    pub drops_every: Option<u32>,
    /// Number of telemetry records after which the device sends no more.
    pub records: Option<u32>,
    /// Whether the device's calibration ends with a fault.
    pub calibration_fails: bool,
    /// Whether the device is a board without memory for more than one wall.
    pub small: bool,
    /// Whether the device is the NUCLEO board of the motor kit: magnetic encoders, and no memory for more than one wall.
    pub kit: bool,
    /// Whether the device is a board without current sensors.
    pub no_current: bool,
    /// The board that the device is, whatever `small`, `kit` and `no_current` say.
    pub board: Option<Board>,
}

/// Number of control periods that the fake device runs between two reads of the socket. One read waits at most `LOOK`.
const TICKS: u32 = 5;
const LOOK: Duration = Duration::from_millis(5);
/// Duration of a calibration in control periods.
const CALIBRATION: u32 = 400;

/// State of the imitated board hardware, on which the protocol session acts.
pub struct World {
    pub machine: Machine,
    pub saved: Option<Vec<u8>>,
    pub used: DeviceSettings,
    pub rebooted: bool,
    /// Whether the cable is unplugged.
    pub pulled: bool,
    /// Number of meaningless bytes that the device sends next.
    pub noise: usize,
    trouble: Trouble,
    board: Board,
    tick: u32,
    calibrated_at: Option<u32>,
    /// Number of control periods for each telemetry record; 0: no telemetry.
    pub decimation: u16,
    /// Encoder count of the knob's angle.
    pub count: i32,
    dropped: u32,
    /// Number of requests that the fake device has received.
    pub answers: usize,
    records: u32,
}

/// A running fake device.
pub struct Fake {
    pub address: String,
    both: Arc<Mutex<(Session, World)>>,
}

impl Fake {
    /// Starts a device without faults on a TCP socket.
    pub fn new() -> Self {
        Self::with(Trouble::default())
    }

    /// Starts a device with these faults on a TCP socket.
    pub fn with(trouble: Trouble) -> Self {
        let both = Self::switched_on(trouble);
        let address = listen(&both);
        Self { address, both }
    }

    /// Starts a device without faults on a pseudo terminal.
    #[cfg(unix)]
    pub fn on_a_terminal() -> Self {
        use serialport::{SerialPort, TTYPort};
        let (mut master, slave) = TTYPort::pair().unwrap();
        let address = slave.name().unwrap();
        // If no program has the pseudo-terminal open, reading it reports the end of the file. If it is open as a serial port, no
        // other program can open it. So it is kept open as a plain file.
        let held = std::fs::File::options()
            .read(true)
            .write(true)
            .open(&address)
            .unwrap();
        drop(slave);
        master.set_timeout(LOOK).unwrap();
        let both = Self::switched_on(Trouble::default());
        let shared = Arc::clone(&both);
        std::thread::spawn(move || {
            let _held = held;
            let _ = serve(master, &shared);
        });
        Self { address, both }
    }

    fn switched_on(trouble: Trouble) -> Arc<Mutex<(Session, World)>> {
        let board = if let Some(board) = trouble.board {
            board
        } else if trouble.small {
            Board::BG431bEsc1
        } else if trouble.kit {
            Board::NucleoG431rbIhm16m1
        } else if trouble.no_current {
            Board::NucleoG474reSimplefocMini
        } else {
            Board::NucleoG474re
        };
        let settings = DeviceSettings::defaults(board);
        let world = World {
            machine: Machine::new(),
            saved: None,
            used: settings.clone(),
            rebooted: false,
            pulled: false,
            noise: 0,
            trouble,
            board,
            tick: 0,
            calibrated_at: None,
            decimation: 1,
            count: 7,
            dropped: 0,
            answers: 0,
            records: 0,
        };
        Arc::new(Mutex::new((Session::new(settings, true), world)))
    }

    /// Runs the program with these arguments, connected to this device.
    pub fn run(&self, arguments: &[&str]) -> super::Said {
        super::run(&[arguments, &["--port", &self.address]].concat())
    }

    /// Locks and returns the device's session and board state.
    pub fn world(&self) -> MutexGuard<'_, (Session, World)> {
        self.both.lock().unwrap()
    }

    /// Makes the device latch this fault.
    pub fn fault(&self, code: FaultCode, value: i32) {
        let (_, world) = &mut *self.world();
        let tick = world.tick;
        world
            .machine
            .handle(Event::Fault(Context { code, tick, value }));
    }
}

/// Meaningless bytes, the same in each call.
pub fn nonsense(count: usize) -> Vec<u8> {
    (0..count).map(|i| ((i * 7919) >> 3) as u8).collect()
}

/// An imitated board that answers requests through the firmware's protocol session.
pub trait Served: Backend {
    /// Whether the board is disconnected.
    fn is_gone(&self) -> bool;
    /// Bytes that the board sends before its answers.
    fn noise(&mut self) -> Vec<u8> {
        Vec::new()
    }
    /// Called for each request, before it is answered. If the function returns `false`, the connection is closed.
    fn is_asked(&mut self) -> bool {
        true
    }
    /// Encodes an answer to the bytes that the board sends.
    fn answered(&mut self, answer: &FromDevice) -> Vec<u8> {
        let mut buffer = [0; FRAME_MAX];
        frame::encode(answer, &mut buffer).unwrap().to_vec()
    }
    /// Runs some control periods; returns their encoded telemetry.
    fn ticks(&mut self) -> Vec<u8>;
}

/// Serves connections one after the other until the test's process ends. Returns the server's address.
pub fn listen<B: Served + Send + 'static>(both: &Arc<Mutex<(Session, B)>>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let shared = Arc::clone(both);
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            // The other side may end the connection at any time, so errors are ignored.
            let _ = stream.set_read_timeout(Some(LOOK));
            let _ = serve(stream, &shared);
        }
    });
    address
}

/// Serves one connection until it ends.
fn serve<B: Served>(
    mut stream: impl Read + Write,
    shared: &Mutex<(Session, B)>,
) -> std::io::Result<()> {
    let mut decoder = Decoder::new();
    let mut bytes = [0; 1024];
    loop {
        let count = match stream.read(&mut bytes) {
            Ok(0) => return Ok(()),
            Ok(count) => count,
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut => 0,
                _ => return Err(error),
            },
        };
        let mut out = Vec::new();
        let (session, world) = &mut *shared.lock().unwrap();
        if world.is_gone() {
            return Ok(());
        }
        out.extend(world.noise());
        for &byte in &bytes[..count] {
            let errors = decoder.errors();
            if let Some(Ok(payload)) = decoder.push(byte) {
                if !world.is_asked() {
                    return Ok(());
                }
                if let Answered::Now(answer) = session.answer_payload(payload, errors, world) {
                    out.extend(world.answered(&answer));
                }
            }
        }
        out.extend(world.ticks());
        stream.write_all(&out)?;
    }
}

impl Served for World {
    fn is_gone(&self) -> bool {
        self.pulled
    }
    fn noise(&mut self) -> Vec<u8> {
        nonsense(std::mem::take(&mut self.noise))
    }
    fn is_asked(&mut self) -> bool {
        let goes_on = self.trouble.closes_at != Some(self.answers);
        self.answers += usize::from(goes_on);
        goes_on
    }
    fn ticks(&mut self) -> Vec<u8> {
        (0..TICKS).flat_map(|_| self.tick()).collect()
    }
    /// Encodes an answer; flips a bit or returns nothing if the configured fault says so.
    fn answered(&mut self, message: &FromDevice) -> Vec<u8> {
        if self.trouble.silent {
            return Vec::new();
        }
        let mut buffer = [0; FRAME_MAX];
        let mut frame = frame::encode(message, &mut buffer).unwrap().to_vec();
        // Answers are numbered from 0. The counter already includes this answer.
        let this_one = self
            .trouble
            .damages
            .is_some_and(|at| at + 1 == self.answers);
        if this_one || self.trouble.damaged > 0 {
            self.trouble.damaged = self.trouble.damaged.saturating_sub(1);
            frame[2] ^= 0x10;
        }
        frame
    }
}

impl World {
    /// Runs one control period; returns the encoded telemetry record if one is due.
    fn tick(&mut self) -> Vec<u8> {
        self.tick += 1;
        if self.calibrated_at.take_if(|at| *at <= self.tick).is_some() {
            if self.trouble.calibration_fails {
                let (code, tick) = (FaultCode::CalibrationFailed, self.tick);
                self.machine.handle(Event::Fault(Context {
                    code,
                    tick,
                    value: 3,
                }));
            } else {
                self.machine.handle(Event::Calibrated);
            }
        }
        let due = self.decimation > 0 && self.tick.is_multiple_of(u32::from(self.decimation));
        if !due
            || self
                .trouble
                .records
                .is_some_and(|records| self.records >= records)
        {
            return Vec::new();
        }
        self.records += 1;
        if self
            .trouble
            .drops_every
            .is_some_and(|every| self.records.is_multiple_of(every))
        {
            self.dropped += 1;
            return Vec::new();
        }
        let record = Telemetry {
            tick: self.tick,
            count: self.count,
            penetration_rad: fixed::types::I8F24::from_bits(self.tick.cast_signed() % 1000),
            since_change_rad: fixed::types::I8F24::ZERO,
            force_n_m: fixed::types::I8F24::from_bits(1),
            offset_rad: fixed::types::I8F24::ZERO,
            energy_j: Decimal::lit("0.001"),
            phase: self.phase(),
            fault: self.fault().map_or(0, |fault| fault.code),
            limits: 0,
            cycles: 2500,
            lateness_cycles: 12,
            current_q_ma: -250,
            measuring: None,
        };
        let mut buffer = [0; FRAME_MAX];
        let message = FromDevice::Telemetry(record);
        frame::encode(&message, &mut buffer).unwrap().to_vec()
    }
}

impl Backend for World {
    fn identity(&self) -> Identity {
        Identity {
            protocol_version: self.trouble.version.unwrap_or(PROTOCOL_VERSION),
            settings_version: stored::LAYOUT_VERSION,
            firmware_version: "0.1.0".try_into().unwrap(),
            board: self.board,
            unique_id: [0xab; 12],
            reset_reason: ResetReason::PowerOn,
            build_hash: 0x1234,
        }
    }
    fn phase(&self) -> Phase {
        self.machine.state().into()
    }
    fn fault(&self) -> Option<Fault> {
        self.machine.fault().map(Fault::from)
    }
    fn tick(&self) -> u32 {
        self.tick
    }
    fn counters(&self) -> Counters {
        Counters {
            telemetry_dropped: self.dropped,
            ticks: self.tick,
            tick_cycles_max: 2_600,
            ..Counters::default()
        }
    }
    fn ring(&self, first: u16) -> Option<RingChunk> {
        matches!(self.machine.state(), State::Fault(_)).then(|| {
            let rest = (first..1000).take(RING_CHUNK);
            let records = rest.map(|index| RingRecord {
                tick: index,
                count: i32::from(index) - 500,
                force: 2048,
                current_q: -512,
                lateness_64: 2,
                limits: 0,
                phase: if index == 999 { 4 } else { 3 },
            });
            RingChunk {
                first,
                total: 1000,
                records: records.collect(),
            }
        })
    }
    fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        checked(settings, self.board)
    }
    fn use_settings(&mut self, settings: &DeviceSettings) {
        self.used = settings.clone();
    }
    fn save(&mut self, image: &[u8]) -> Result<(), FlashError> {
        if self.trouble.flash_fails {
            return Err(FlashError);
        }
        self.saved = Some(image.to_vec());
        Ok(())
    }
    fn command(&mut self, command: DeviceCommand) -> Option<bool> {
        let event = match command {
            DeviceCommand::Calibrate => {
                let taken = self.machine.handle(Event::Command(Command::Calibrate));
                self.calibrated_at = taken.then_some(self.tick + CALIBRATION);
                return Some(taken);
            }
            DeviceCommand::Arm => Command::Arm,
            DeviceCommand::Disarm => Command::Disarm,
            DeviceCommand::Stop => Command::Stop,
            DeviceCommand::Zero => return Some(self.phase() != Phase::Armed),
            DeviceCommand::Reboot => {
                self.rebooted = true;
                return Some(true);
            }
        };
        Some(self.machine.handle(Event::Command(event)))
    }
    fn telemetry(&mut self, decimation: u16) {
        self.decimation = decimation;
    }
}

impl LargeBackend for World {
    fn use_environment(
        &mut self,
        settings: &DeviceSettings,
        environment: &Surround,
    ) -> Option<Result<CountsFrom, SettingsError>> {
        let from = match self.phase() {
            Phase::Armed => CountsFrom::NextTick,
            _ => CountsFrom::Arming,
        };
        Some(environment.check(settings).map(|()| from))
    }
}
