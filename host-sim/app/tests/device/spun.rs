//! A device with a motor: the drive's two interrupts around a simulated knob, faster than real time, behind a socket.

use super::fake::{Served, listen};
use std::sync::{Arc, Mutex, MutexGuard};
use touchstone_drive::wire::{checked, hardware};
use touchstone_protocol::frame::{self, FRAME_MAX};
use touchstone_protocol::session::{Backend, FlashError, Session};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::{
    Board, Command, Counters, DeviceCommand, DeviceSettings, Fault, FromDevice, Identity,
    MeasuringPart, PROTOCOL_VERSION, Phase, ResetReason, RingChunk, stored,
};
use touchstone_tests::knob::{Honest, Knob, PERIOD_S};
use touchstone_world::motor::MotorParameters;
use touchstone_world::plant::{BareCoulomb, Device};

const BOARD: Board = Board::NucleoG474re;
/// Ticks between two looks at the socket.
const TICKS: u32 = 200;

/// The board around the talk.
pub struct Spinning {
    pub knob: Knob<Honest, BareCoulomb>,
    pub saved: bool,
    /// The cable goes with the first tick of this part.
    pub pulled_in: Option<MeasuringPart>,
    pulled: bool,
    number: u8,
    decimation: u16,
}

/// A running device.
pub struct Spun {
    address: String,
    both: Arc<Mutex<(Session, Spinning)>>,
}

impl Spun {
    /// With this motor and knob, and a number of its own.
    pub fn new(motor: MotorParameters, device: &Device, number: u8) -> Self {
        let settings = DeviceSettings::defaults(BOARD);
        let plant = BareCoulomb::new(device, PERIOD_S / 2.0).unwrap();
        let mut knob = Knob::with_plant(&settings, motor, plant, 0.3, Honest);
        knob.rig.bridge.dead_share = 0.01;
        let spinning = Spinning {
            knob,
            saved: false,
            pulled_in: None,
            pulled: false,
            number,
            decimation: 1,
        };
        let both = Arc::new(Mutex::new((Session::new(settings, true), spinning)));
        Self {
            address: listen(&both),
            both,
        }
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

impl Served for Spinning {
    fn is_gone(&self) -> bool {
        self.pulled
    }
    fn ticks(&mut self) -> Vec<u8> {
        let mut out = Vec::new();
        for _ in 0..TICKS {
            self.knob.tick();
            let telemetry = self.knob.telemetry();
            let part = telemetry.measuring.map(|it| it.part);
            self.pulled |= part.is_some() && part == self.pulled_in;
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
        let configured = self.knob.device.configure(settings, hardware(BOARD));
        configured.unwrap();
    }
    fn save(&mut self, _: &[u8]) -> Result<(), FlashError> {
        self.saved = true;
        Ok(())
    }
    fn command(&mut self, command: DeviceCommand) -> Option<bool> {
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
