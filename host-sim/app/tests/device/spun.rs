//! A device with a motor: the drive's two interrupts around a simulated knob, faster than real time, behind a socket.

use super::fake::{Served, listen};
use std::sync::{Arc, Mutex, MutexGuard};
use touchstone_drive::cogging::Played;
use touchstone_drive::wire::{checked, hardware};
use touchstone_protocol::frame::{self, FRAME_MAX};
use touchstone_protocol::session::{Backend, FlashError, Session};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::{
    Board, CoggingMap, Command, Counters, DeviceCommand, DeviceSettings, Fault, FromDevice,
    Identity, KeptAlignment, MeasuringPart, PROTOCOL_VERSION, Phase, ResetReason, RingChunk,
    SelfStart, Sweep, stored,
};
use touchstone_tests::knob::{Knob, PERIOD_S, Tamper};
use touchstone_world::motor::MotorParameters;
use touchstone_world::plant::{BareCoulomb, Device};

const BOARD: Board = Board::NucleoG474re;
/// Ticks between two looks at the socket.
const TICKS: u32 = 200;

/// The motor's supply, V: the board lives on without it.
pub struct Supply(pub f64);

impl Tamper for Supply {
    fn bus_v(&mut self, _: u32) -> f64 {
        self.0
    }
}

/// The moment at which the cable is pulled, which also cuts the supply of a board on USB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pulled {
    /// With the first tick of this part.
    In(MeasuringPart),
    /// With so manieth new settings: before they count.
    AtSettings(u32),
    /// While they are written: the flash has what it had.
    BeforeSaved,
    /// After the settings were written and before the answer.
    AfterSaved,
    /// With so manieth calibration, which begins.
    AtCalibration(u32),
}

/// The board around the talk.
pub struct Spinning {
    pub knob: Knob<Supply, BareCoulomb>,
    pub saved: bool,
    /// When the cable goes.
    pub pulled_in: Option<Pulled>,
    pulled: bool,
    /// The motor's supply goes with the first tick of this part.
    pub supply_goes_in: Option<MeasuringPart>,
    /// The contents of the flash.
    kept: Option<stored::Start>,
    settings: u32,
    calibrations: u32,
    number: u8,
    decimation: u16,
}

/// A running device.
pub struct Spun {
    address: String,
    motor: MotorParameters,
    device: Device,
    both: Arc<Mutex<(Session, Spinning)>>,
}

impl Spun {
    /// A device with this motor and knob, and this number.
    pub fn new(motor: MotorParameters, device: &Device, number: u8) -> Self {
        let settings = DeviceSettings::defaults(BOARD);
        let spinning = Spinning {
            knob: started(&settings, motor, device, 0.3),
            saved: false,
            pulled_in: None,
            pulled: false,
            supply_goes_in: None,
            kept: None,
            settings: 0,
            calibrations: 0,
            number,
            decimation: 1,
        };
        let both = Arc::new(Mutex::new((Session::new(settings, true), spinning)));
        Self {
            address: listen(&both),
            motor,
            device: *device,
            both,
        }
    }

    /// Restores supply and cable: the device starts with the contents of its flash.
    pub fn power_up(&self) {
        let (session, world) = &mut *self.world();
        let image = world.kept.clone();
        let start = image
            .unwrap_or_else(|| stored::start(None, DeviceSettings::defaults(BOARD), &|_| Ok(())));
        let (settings, kept) = (start.settings, start.kept);
        let angle = world.knob.rig.now().angle_rad;
        world.knob = started(&settings, self.motor, &self.device, angle);
        let usable = kept.usable(&settings, BOARD);
        world.knob.device.keep(usable.ok().map(Into::into));
        (world.pulled, world.pulled_in) = (false, None);
        *session = Session::new(settings, true)
            .with_kept(kept)
            .with_cogging(start.cogging);
        world.show_map(session);
    }

    /// The program, spoken to this device.
    pub fn run(&self, arguments: &[&str]) -> super::Said {
        super::run(&[arguments, &["--port", &self.address]].concat())
    }

    /// A look into the device.
    pub fn world(&self) -> MutexGuard<'_, (Session, Spinning)> {
        self.both.lock().unwrap()
    }

    /// The cable is in again.
    pub fn plug_in(&self) {
        let (_, world) = &mut *self.world();
        (world.pulled, world.pulled_in) = (false, None);
    }
}

/// The board as it starts.
fn started(
    settings: &DeviceSettings,
    motor: MotorParameters,
    device: &Device,
    angle_rad: f64,
) -> Knob<Supply, BareCoulomb> {
    let plant = BareCoulomb::new(device, PERIOD_S / 2.0).unwrap();
    let mut knob = Knob::with_plant(settings, motor, plant, angle_rad, Supply(24.0));
    knob.rig.bridge.dead_share = 0.01;
    knob
}

impl Spinning {
    /// Numbers of new settings and calibrations so far.
    pub fn counted(&self) -> (u32, u32) {
        (self.settings, self.calibrations)
    }

    /// The map of the cogging that the session has.
    pub fn show_map(&mut self, session: &Session) {
        self.use_cogging(session.settings(), session.cogging(BOARD));
    }

    /// Whether the cable goes now.
    fn goes(&mut self, now: Pulled) -> bool {
        let goes = self.pulled_in == Some(now);
        self.pulled |= goes;
        goes
    }
}

impl Served for Spinning {
    fn is_gone(&self) -> bool {
        self.pulled
    }
    fn answered(&mut self, answer: &FromDevice) -> Vec<u8> {
        let mut buffer = [0; FRAME_MAX];
        match self.pulled {
            true => Vec::new(),
            false => frame::encode(answer, &mut buffer).unwrap().to_vec(),
        }
    }
    fn ticks(&mut self) -> Vec<u8> {
        let mut out = Vec::new();
        if self.pulled {
            return out;
        }
        for _ in 0..TICKS {
            self.knob.tick();
            let telemetry = self.knob.telemetry();
            let part = telemetry.measuring.map(|it| it.part);
            if let Some(part) = part {
                self.goes(Pulled::In(part));
                if self.supply_goes_in.take_if(|it| *it == part).is_some() {
                    self.knob.tamper.0 = 0.0;
                }
            }
            let due =
                self.decimation > 0 && telemetry.tick.is_multiple_of(u32::from(self.decimation));
            if self.pulled || !due {
                continue;
            }
            let mut buffer = [0; FRAME_MAX];
            let message = FromDevice::Telemetry(telemetry);
            out.extend(frame::encode(&message, &mut buffer).unwrap().to_vec());
        }
        out
    }
}

impl Backend for Spinning {
    fn identity(&self) -> Identity {
        Identity {
            protocol_version: PROTOCOL_VERSION,
            settings_version: stored::LAYOUT_VERSION,
            firmware_version: "0.1.0".try_into().unwrap(),
            board: BOARD,
            unique_id: [self.number; 12],
            reset_reason: ResetReason::PowerOn,
            build_hash: 0x1234,
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
        Counters::default()
    }
    fn ring(&self, _: u16) -> Option<RingChunk> {
        None
    }
    fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        checked(settings, BOARD)
    }
    fn use_settings(&mut self, settings: &DeviceSettings) {
        self.settings += 1;
        if self.goes(Pulled::AtSettings(self.settings)) {
            return;
        }
        let configured = self.knob.device.configure(settings, hardware(BOARD));
        configured.unwrap();
    }
    fn save(&mut self, image: &[u8]) -> Result<(), FlashError> {
        if !self.goes(Pulled::BeforeSaved) {
            let start = stored::decode_with(image, &|_| Ok(())).unwrap();
            (self.saved, self.kept) = (true, Some(start));
            self.goes(Pulled::AfterSaved);
        }
        Ok(())
    }
    fn command(&mut self, command: DeviceCommand) -> Option<bool> {
        if command == DeviceCommand::Calibrate {
            self.calibrations += 1;
            self.goes(Pulled::AtCalibration(self.calibrations));
        }
        self.knob.ask(match command {
            DeviceCommand::Calibrate => Command::Calibrate,
            DeviceCommand::Arm => Command::Arm,
            DeviceCommand::Disarm => Command::Disarm,
            DeviceCommand::Stop => Command::Stop,
            DeviceCommand::Zero | DeviceCommand::Reboot => return Some(false),
        });
        self.knob.tick();
        self.knob.output.and_then(|output| output.accepted)
    }
    fn telemetry(&mut self, decimation: u16) {
        self.decimation = decimation;
    }
    fn use_kept(&mut self, kept: Option<KeptAlignment>) {
        self.knob.device.keep(kept.map(Into::into));
    }
    fn use_cogging(&mut self, settings: &DeviceSettings, map: Option<&CoggingMap>) {
        let played = map.map(|map| Played::new(map, settings, hardware(BOARD)));
        let knob = &mut self.knob;
        knob.device.play(&mut knob.around, played.as_ref());
    }
    fn sweep(&mut self, sweep: Sweep) {
        self.knob.device.sweep(sweep);
    }
    fn alignment(&self) -> Option<(u16, bool)> {
        let found = self.knob.device.found()?;
        Some((found.offset.0, found.against))
    }
    fn started(&self) -> (bool, SelfStart) {
        (self.knob.device.was_checked(), SelfStart::Off)
    }
}
