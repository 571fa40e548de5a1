//! A complete simulated knob without a board: the firmware's two interrupt functions and the simulated motor, run alternately and
//! connected as in the firmware.
//!
//! ```text
//! every PWM period:            current samples -> CurrentLoop::tick -> PWM compare values, which act from half a period later on
//! when a control tick is due:  encoder, mailboxes -> Device::tick -> mailbox; switching the outputs off acts at once
//! ```

use touchstone_drive::around::Around;
use touchstone_drive::encoder::Frames;
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::{
    ControlInput, ControlOutput, CurrentCommand, CurrentLoop, CurrentReport, CurrentSample, Device,
    DeviceSettings, EncoderKind, EncoderReading, Hardware, Record, TickTiming, wire,
};
use touchstone_protocol::{Command, FaultCode, Outputs, State, Telemetry};
use touchstone_world::motor::{self, Bridge, Drive, GIMBAL, KNOB, MotorParameters, Rig, Shunt};
use touchstone_world::plant::{HeldLinear, MEDIUM, Stepper};

/// PWM period, s.
pub const PERIOD_S: f64 = 1.0 / 20_000.0;

/// Reading of the power stage's temperature sensor at room temperature, in codes of the analogue-to-digital converter.
pub const WARM: u16 = 1_300;

/// Falsifies the readings that the firmware's code gets from the simulated motor, for tests of faults. The default methods change
/// nothing.
pub trait Tamper {
    /// Changes the readings of the current loop in one PWM period (currents, bus voltage, temperature).
    fn sample(&mut self, _tick: u32, _sample: &mut CurrentSample) {}
    /// Changes the readings of one control tick. Returns whether the tick runs; false simulates a control tick that is left out.
    fn input(&mut self, _tick: u32, _input: &mut ControlInput) -> bool {
        true
    }
    /// Changes the encoder reading that is taken when the commanded force changes; `None` simulates a missing reading.
    fn change(&mut self, _tick: u32, reading: EncoderReading) -> Option<EncoderReading> {
        Some(reading)
    }
    /// Bus voltage in the current PWM period, V.
    fn bus_v(&mut self, _tick: u32) -> f64 {
        24.0
    }
    /// Changes the state of the bridge in half a PWM period.
    fn bridge(&mut self, _tick: u32, drive: Drive) -> Drive {
        drive
    }
    /// The number of PWM periods by which the control tick comes late, and how often it runs.
    fn when(&mut self, _tick: u32) -> (u32, u32) {
        (0, 1)
    }
}

/// The [`Tamper`] of a knob without faults: changes no reading.
#[derive(Debug, Default)]
pub struct Honest;
impl Tamper for Honest {}

/// One harmonic of the encoder's angle error, e.g. of an off-centre magnet: `A sin(n θ + φ)` at the shaft angle `θ`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderError {
    /// Amplitude `A` of the angle error `A sin(n θ + φ)`, rad.
    pub amplitude_rad: f64,
    /// Number `n` of periods of the angle error `A sin(n θ + φ)` per turn.
    pub per_rev: f64,
    /// Phase `φ` of the angle error `A sin(n θ + φ)`, rad.
    pub phase_rad: f64,
}

/// A simulated knob that runs the firmware's code. `T` falsifies readings, `S` simulates the mechanics.
#[derive(Clone)]
pub struct Knob<T: Tamper, S: Stepper = HeldLinear> {
    /// The firmware's control code, which runs once per control tick.
    pub device: Device,
    /// What acts in addition to the wall: further walls, end stops, detents, and the compensation of the motor's cogging.
    pub around: Around,
    /// The firmware's current loop, which runs once per PWM period.
    pub current: CurrentLoop,
    /// The simulated motor and the mechanics of knob and hand.
    pub rig: Rig<S>,
    /// Changes the readings that the firmware's code gets, to simulate faults.
    pub tamper: T,
    /// Harmonics of the encoder's angle error. The encoder reads the shaft angle plus their sum.
    pub encoder_error: Vec<EncoderError>,
    /// Rest point of the hand's spring (the angle to which the hand pulls the knob), rad.
    pub rest_rad: f64,
    /// State of the motor's bridge in the present PWM period: off, or its duty cycles.
    pub acting: Drive,
    /// Telemetry values of the last control tick.
    pub record: Record,
    /// Output of the firmware's control code in the last control tick; `None` before the first.
    pub output: Option<ControlOutput>,
    settings: DeviceSettings,
    hardware: &'static Hardware,
    shunts: [Shunt; 2],
    mailbox: CurrentCommand,
    /// Measurements that the current loop passes to the next control tick.
    pub report: CurrentReport,
    preloaded: Drive,
    command: Option<Command>,
    hardware_break: bool,
    /// PWM periods until the control tick that is due, and how late it then is.
    due: Option<(u32, u32)>,
}

fn off_or(bridge: touchstone_drive::BridgeCommand) -> Drive {
    match bridge {
        touchstone_drive::BridgeCommand::Off => Drive::Off,
        touchstone_drive::BridgeCommand::On(duties) => Drive::On(duties),
    }
}

/// The current sensors of a board. As on a real board, their offsets lie between two codes and differ from the constants in
/// `drive`.
fn shunts(hardware: &Hardware) -> [Shunt; 2] {
    if *hardware == IHM08M1 || !hardware.senses_current {
        return [2_128.3, 2_099.8].map(|offset| Shunt::low_side(0.01, 5.7 * 6.8 / 7.48, offset));
    }
    let amps_per_code: f64 = hardware.amps_per_code.to_num();
    [6.3, -22.2].map(|off| Shunt::bits12(amps_per_code, f64::from(hardware.offset_code) + off))
}

/// Creates a knob without falsified readings, with a gimbal motor (0.25 N·m/A) on a bus of 24 V.
#[must_use]
pub fn honest(settings: &DeviceSettings) -> Knob<Honest> {
    Knob::new(settings, GIMBAL, 0.0, Honest)
}

impl<T: Tamper> Knob<T> {
    /// Creates a knob that was just switched on, at rest at the given shaft angle (rad).
    ///
    /// # Panics
    /// The firmware refuses the settings.
    #[must_use]
    pub fn new(
        settings: &DeviceSettings,
        motor: MotorParameters,
        angle_rad: f64,
        tamper: T,
    ) -> Self {
        let plant = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S / 2.0).expect("a plant");
        Self::with_plant(settings, motor, plant, angle_rad, tamper)
    }
}

impl<T: Tamper, S: Stepper> Knob<T, S> {
    /// Same as [`Knob::new`], with another simulation of the mechanics. Its time step must be half a PWM period.
    ///
    /// # Panics
    /// The firmware refuses the settings.
    #[must_use]
    pub fn with_plant(
        settings: &DeviceSettings,
        motor: MotorParameters,
        plant: S,
        angle_rad: f64,
        tamper: T,
    ) -> Self {
        Self::on(&IHM08M1, settings, motor, plant, angle_rad, tamper)
    }

    /// Same as [`Knob::with_plant`], with the hardware constants (scales, limits) of another board.
    ///
    /// # Panics
    /// The firmware refuses the settings.
    #[must_use]
    pub fn on(
        hardware: &'static Hardware,
        settings: &DeviceSettings,
        motor: MotorParameters,
        plant: S,
        angle_rad: f64,
        tamper: T,
    ) -> Self {
        let device = Device::new(settings, hardware).expect("settings");
        let record = *device.record();
        Self {
            current: CurrentLoop::new(device.current_config()),
            device,
            hardware,
            around: Around::new(),
            rig: Rig::new(
                motor,
                Bridge::ideal(24.0, hardware.timer_top),
                plant,
                angle_rad,
            ),
            tamper,
            encoder_error: Vec::new(),
            rest_rad: angle_rad,
            acting: Drive::Off,
            record,
            output: None,
            settings: settings.clone(),
            shunts: shunts(hardware),
            mailbox: CurrentCommand::OFF,
            report: CurrentReport::default(),
            preloaded: Drive::Off,
            command: None,
            hardware_break: false,
            due: None,
        }
    }

    /// Restarts the processor with this device: all that is not stored is forgotten, and the bridge is off.
    pub fn restart(&mut self, device: Device) {
        self.record = *device.record();
        self.current = CurrentLoop::new(device.current_config());
        self.device = device;
        self.around = Around::new();
        self.mailbox = CurrentCommand::OFF;
        self.report = CurrentReport::default();
        (self.acting, self.preloaded) = (Drive::Off, Drive::Off);
        (self.output, self.command, self.due) = (None, None, None);
        self.hardware_break = false;
    }

    /// Gives a command, such as "arm", to the next control tick.
    pub fn ask(&mut self, command: Command) {
        self.command = Some(command);
    }

    /// What the encoder reads at the present shaft angle, with its angle error.
    #[must_use]
    pub fn reading(&self) -> EncoderReading {
        let angle = self.rig.now().angle_rad;
        let read = self.encoder_error.iter().fold(angle, |read, it| {
            read + it.amplitude_rad * (it.per_rev * angle + it.phase_rad).sin()
        });
        let count = motor::count(read, self.settings.encoder.counts_per_rev);
        match self.settings.encoder.kind {
            EncoderKind::Incremental => EncoderReading::Counter16(count as u16),
            EncoderKind::As5047p => {
                EncoderReading::As5047p(Frames::alone(motor::as5047p_frame(count)))
            }
            EncoderKind::Mt6701 => EncoderReading::Mt6701(motor::mt6701_frame(count, 0)),
        }
    }

    /// Runs one PWM period; returns whether a control tick was due in it.
    pub fn period(&mut self) -> bool {
        let next = self.record.tick.wrapping_add(1);
        self.rig.bridge.bus_v = self.tamper.bus_v(next);
        let now = self.rig.now();
        let volts: f64 = self.hardware.volts_per_code.to_num();
        let mut sample = CurrentSample {
            phase_a: self.shunts[0].code(now.currents_a[0]),
            phase_b: self.shunts[1].code(now.currents_a[1]),
            bus: (self.rig.bridge.bus_v / volts).round() as u16,
            temperature: WARM,
            hardware_break: self.hardware_break,
            late: false,
            command: self.mailbox,
        };
        self.tamper.sample(next, &mut sample);
        // The hardware break has switched the outputs off, and its flag stays set.
        self.hardware_break |= sample.hardware_break;
        let out = self.current.tick(&sample);
        self.report = *self.current.report();
        // The currents are sampled at the counter's top. Compare values take effect at the bottom, half a period later; switching
        // off acts at once.
        self.acting = match (out.bridge, self.preloaded) {
            (touchstone_drive::BridgeCommand::Off, _) => Drive::Off,
            (_, Drive::Off) => Drive::On(self.hardware.modulator().zero()),
            (_, before) => before,
        };
        self.preloaded = off_or(out.bridge);
        if out.reads_change {
            let reading = self.reading();
            if let Some(reading) = self.tamper.change(next, reading) {
                self.device.read_change(reading);
            }
        }
        let runs = if out.pend_control {
            let (late, runs) = self.tamper.when(next);
            self.due = Some((late, late));
            runs
        } else {
            1
        };
        match self.due {
            Some((0, late)) => {
                self.due = None;
                for _ in 0..runs {
                    self.control(late);
                }
            }
            Some((left, late)) => self.due = Some((left - 1, late)),
            None => {}
        }
        for _ in 0..2 {
            let drive = self.tamper.bridge(next, self.acting);
            self.rig.step(drive, self.rest_rad);
            self.acting = self.preloaded;
        }
        out.pend_control
    }

    fn control(&mut self, late_periods: u32) {
        let mut input = ControlInput {
            encoder: self.reading(),
            current: self.report,
            command: self.command.take(),
            hardware_break: self.hardware_break,
            gate_driver_error: false,
            stop_button: false,
            host_heard: true,
            timing: TickTiming {
                lateness: 40 + late_periods * (self.hardware.core_hz / self.hardware.pwm_hz),
                duration: 2_500,
            },
        };
        if !self
            .tamper
            .input(self.record.tick.wrapping_add(1), &mut input)
        {
            return;
        }
        let output = self.device.tick_around(&input, &mut self.around);
        self.mailbox = output.mailbox();
        if output.outputs == Outputs::Off {
            // The firmware clears the main output enable.
            self.acting = Drive::Off;
            self.preloaded = Drive::Off;
        }
        if output.clear_latches {
            self.hardware_break = false;
        }
        if output.reconfigure {
            self.current.reconfigure(self.device.current_config());
        }
        self.record = output.record;
        self.output = Some(output);
    }

    /// Runs PWM periods up to the one in which a control tick is due. Returns the telemetry values of the last tick that ran.
    pub fn tick(&mut self) -> Record {
        while !self.period() {}
        self.record
    }

    /// Runs the firmware's calibration to its end. The simulated hand does not resist: its rest point follows the shaft. Returns
    /// the device's state after the calibration.
    pub fn calibrate(&mut self) -> State {
        self.ask(Command::Calibrate);
        self.tick();
        while self.device.state() == State::Calibrating {
            self.rest_rad = self.rig.now().angle_rad;
            self.tick();
        }
        self.device.state()
    }

    /// Calibrates the knob and switches its motor on (arms it).
    ///
    /// # Panics
    /// The calibration or the arming fails.
    pub fn armed(mut self) -> Self {
        assert_eq!(self.calibrate(), State::Ready);
        self.ask(Command::Arm);
        self.tick();
        assert_eq!(self.device.state(), State::Armed);
        self
    }

    /// The telemetry record of the last control tick.
    #[must_use]
    pub fn telemetry(&self) -> Telemetry {
        let part = self.device.measuring();
        Telemetry {
            measuring: part.map(|part| wire::measuring(part, &self.report)),
            ..Telemetry::from(&self.record)
        }
    }

    /// The code of the fault that the firmware has stored; `None` without a fault.
    #[must_use]
    pub fn fault(&self) -> Option<FaultCode> {
        self.device.fault().map(|context| context.code)
    }
}
