//! A device with a motor behind a socket: the drive's two interrupt handlers run with a simulated knob, faster than real time.

use super::fake::{Served, listen};
use std::sync::{Arc, Mutex, MutexGuard};
use touchstone_drive::cogging::Played;
use touchstone_drive::wire::{checked, hardware};
use touchstone_protocol::frame::{self, FRAME_MAX};
use touchstone_protocol::session::{Backend, FlashError, LargeBackend, Session};
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
/// Number of control periods that the device runs between two reads of the socket.
const TICKS: u32 = 200;

/// Voltage of the motor's supply, V. The board itself keeps running at 0 V.
pub struct Supply(pub f64);

impl Tamper for Supply {
    fn bus_v(&mut self, _: u32) -> f64 {
        self.0
    }
}

/// Moment at which the cable is pulled. A board powered over USB then loses its supply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pulled {
    /// At the first control period of this part of the motor measurement.
    In(MeasuringPart),
    /// When settings are sent, before they take effect; holds the number of the sending, counted from 1.
    AtSettings(u32),
    /// While settings are written to the flash: the flash keeps its earlier contents.
    BeforeSaved,
    /// After the settings were written to the flash, before the answer is sent.
    AfterSaved,
    /// At the start of a calibration; holds its number, counted from 1.
    AtCalibration(u32),
}

/// State of the simulated board with motor and knob, on which the protocol session acts.
pub struct Spinning {
    pub knob: Knob<Supply, BareCoulomb>,
    pub saved: bool,
    /// Moment at which the cable is pulled; `None` for never.
    pub pulled_in: Option<Pulled>,
    pulled: bool,
    /// Part of the motor measurement at whose first control period the motor's supply fails; `None` for never.
    pub supply_goes_in: Option<MeasuringPart>,
    /// The data in the simulated flash; `None` if nothing was saved.
    kept: Option<stored::Start>,
    settings: u32,
    calibrations: u32,
    number: u8,
    decimation: u16,
}

/// A running device with a simulated motor, which the program reaches over a socket.
pub struct Spun {
    address: String,
    motor: MotorParameters,
    device: Device,
    both: Arc<Mutex<(Session, Spinning)>>,
}

impl Spun {
    /// Starts a device with this motor, this knob and this serial number.
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

    /// Restores supply and cable: the device restarts with the contents of its flash.
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

    /// Runs the program with these arguments, connected to this device.
    pub fn run(&self, arguments: &[&str]) -> super::Said {
        super::run(&[arguments, &["--port", &self.address]].concat())
    }

    /// Address of the device's port.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Locks and returns the device's session and board state.
    pub fn world(&self) -> MutexGuard<'_, (Session, Spinning)> {
        self.both.lock().unwrap()
    }

    /// Plugs the computer's cable in again, without a restart of the device.
    pub fn plug_in(&self) {
        let (_, world) = &mut *self.world();
        (world.pulled, world.pulled_in) = (false, None);
    }
}

/// Creates the simulated knob as it is after a start with these settings.
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
    /// Number of times that settings were sent, and number of calibrations, since the device was created.
    pub fn counted(&self) -> (u32, u32) {
        (self.settings, self.calibrations)
    }

    /// Passes the session's cogging map to the simulated drive.
    pub fn show_map(&mut self, session: &Session) {
        self.use_cogging(session.settings(), session.cogging(BOARD));
    }

    /// Whether the cable is pulled at this moment; if so, marks it as pulled.
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
}

impl LargeBackend for Spinning {
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
