//! A device on a TCP socket or a pseudo terminal: session, fault machine and frames are the firmware's own; only the board around them is made up.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;
use touchstone_drive::wire::checked;
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::session::{Answered, Backend, FlashError, Session};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::telemetry::RING_CHUNK;
use touchstone_protocol::{
    Board, Command, Context, Counters, CountsFrom, Decimal, DeviceCommand, DeviceSettings, Event,
    Fault, FaultCode, FromDevice, Identity, Machine, PROTOCOL_VERSION, Phase, ResetReason,
    RingChunk, RingRecord, State, Surround, Telemetry, stored,
};

/// What may be wrong with it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trouble {
    /// The device answers no request.
    pub silent: bool,
    /// It speaks this version.
    pub version: Option<u16>,
    /// So many of its answers have a flipped bit.
    pub damaged: usize,
    /// Its answer of this number has a flipped bit.
    pub damages: Option<usize>,
    /// It closes the connection instead of its answer of this number.
    pub closes_at: Option<usize>,
    /// Its flash cannot be written.
    pub flash_fails: bool,
    /// Every record of this number is dropped, and counted.
    pub drops_every: Option<u32>,
    /// Its telemetry ends after so many records.
    pub records: Option<u32>,
    /// Its calibration ends with a fault.
    pub calibration_fails: bool,
    /// It is the board without room for more than one wall.
    pub small: bool,
    /// The NUCLEO of the kit: magnetic encoders, and no room for more than one wall.
    pub kit: bool,
    /// It is the board that measures no current.
    pub no_current: bool,
}

/// Ticks between two looks at the socket, and how long one takes.
const TICKS: u32 = 5;
const LOOK: Duration = Duration::from_millis(5);
/// A calibration takes so many ticks.
const CALIBRATION: u32 = 400;

/// The board around the talk.
pub struct World {
    pub machine: Machine,
    pub saved: Option<Vec<u8>>,
    pub used: DeviceSettings,
    pub rebooted: bool,
    /// The cable is out.
    pub pulled: bool,
    /// Bytes that mean nothing, to be sent next.
    pub noise: usize,
    trouble: Trouble,
    board: Board,
    tick: u32,
    calibrated_at: Option<u32>,
    decimation: u16,
    dropped: u32,
    /// Requests that came in.
    pub answers: usize,
    records: u32,
}

/// A running device.
pub struct Fake {
    pub address: String,
    both: Arc<Mutex<(Session, World)>>,
}

impl Fake {
    /// A device without troubles.
    pub fn new() -> Self {
        Self::with(Trouble::default())
    }

    /// A device with troubles.
    pub fn with(trouble: Trouble) -> Self {
        let both = Self::switched_on(trouble);
        let address = listen(&both);
        Self { address, both }
    }

    /// A device without troubles at a pseudo terminal.
    #[cfg(unix)]
    pub fn on_a_terminal() -> Self {
        use serialport::{SerialPort, TTYPort};
        let (mut master, slave) = TTYPort::pair().unwrap();
        let address = slave.name().unwrap();
        // A terminal that nobody has open is at its end; one that is open as a port cannot be opened again.
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
        let board = if trouble.small {
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
            dropped: 0,
            answers: 0,
            records: 0,
        };
        Arc::new(Mutex::new((Session::new(settings, true), world)))
    }

    /// The program, spoken to this device.
    pub fn run(&self, arguments: &[&str]) -> super::Said {
        super::run(&[arguments, &["--port", &self.address]].concat())
    }

    /// A look into the device.
    pub fn world(&self) -> MutexGuard<'_, (Session, World)> {
        self.both.lock().unwrap()
    }

    /// Makes a fault occur.
    pub fn fault(&self, code: FaultCode, value: i32) {
        let (_, world) = &mut *self.world();
        let tick = world.tick;
        world
            .machine
            .handle(Event::Fault(Context { code, tick, value }));
    }
}

/// Bytes that mean nothing.
pub fn nonsense(count: usize) -> Vec<u8> {
    (0..count).map(|i| ((i * 7919) >> 3) as u8).collect()
}

/// A board behind a session.
pub trait Served: Backend {
    /// Nobody hears it any more.
    fn is_gone(&self) -> bool;
    /// Bytes before everything else.
    fn noise(&mut self) -> Vec<u8> {
        Vec::new()
    }
    /// Takes notice of a request; `false` ends the connection instead.
    fn is_asked(&mut self) -> bool {
        true
    }
    /// What goes out for an answer.
    fn answered(&mut self, answer: &FromDevice) -> Vec<u8> {
        let mut buffer = [0; FRAME_MAX];
        frame::encode(answer, &mut buffer).unwrap().to_vec()
    }
    /// Some control ticks; their telemetry.
    fn ticks(&mut self) -> Vec<u8>;
}

/// Serves connections, one after the other, as long as the test's process lives; the address.
pub fn listen<B: Served + Send + 'static>(both: &Arc<Mutex<(Session, B)>>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let shared = Arc::clone(both);
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            // A connection that breaks is the other side's right.
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
    /// Damaged if that is its trouble.
    fn answered(&mut self, message: &FromDevice) -> Vec<u8> {
        if self.trouble.silent {
            return Vec::new();
        }
        let mut buffer = [0; FRAME_MAX];
        let mut frame = frame::encode(message, &mut buffer).unwrap().to_vec();
        // Answers are counted from 0, and this one is counted already.
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
    /// One control tick: the telemetry record's frame, if one is due.
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
            count: 7,
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
