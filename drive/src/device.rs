//! One control period (tick), from the encoder's raw word to the command for the drive.
//!
//! ```text
//! reading -> supervisor -> fault machine -> penetration -> law -> torque -> drive
//! ```
//!
//! The law is [`touchstone_control::Controller`] over [`Fixed32`] numbers, as in the simulator. Its force depends only on three
//! inputs: the encoder counts since the device was armed, the guard's energy account at that time, and the forces that were really
//! commanded. Stages after the law reduce its force (fading in, current limit, temperature). They report the result to the law's
//! estimator and its energy guard.

use crate::angle::Angle;
#[cfg(feature = "large")]
use crate::around::{Around, Surrounding};
use crate::calibration::{Alignment, Calibration, Progress, failed};
use crate::command::{DriveCommand, Rotor};
use crate::config::{Config, Configs};
use crate::current::{CurrentConfig, CurrentReport};
use crate::encoder::EncoderReading;
use crate::hardware::Hardware;
use crate::input::ControlInput;
use crate::measurement::{Measurement, Measuring};
use crate::output::ControlOutput;
use crate::record::Record;
use crate::reset::ResetReason;
use crate::scenery::{Scenery, WallAlone};
use crate::supervisor::power::Power;
use crate::supervisor::{Supervisor, Watch};
use touchstone_control::law::Contact;
use touchstone_control::{Controller, Fixed32, Force, Position};
#[cfg(feature = "large")]
use touchstone_protocol::CountsFrom;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::{
    Command, Context, Event, FaultCode, Limit, Limits, Machine, MeasuringPart, Outputs, State,
};

/// The device: the coefficients computed from settings, and all memory from one control period to the next.
#[derive(Debug, Clone)]
pub struct Device {
    configs: Configs,
    memory: Memory,
    supervisor: Supervisor,
    calibration: Option<Calibration>,
    measurement: Option<Measurement>,
    #[cfg(feature = "large")]
    kept: kept::Kept,
    #[cfg(feature = "large")]
    swept: swept::Swept,
    law: Controller<Fixed32>,
}

impl Device {
    /// Makes a device in the state just after power-on.
    ///
    /// # Errors
    /// Same as [`Config::new`].
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Result<Self, SettingsError> {
        Ok(Self::of(Config::new(settings, hardware)?, Memory::new()))
    }

    /// Makes a device with a given memory, for restoring or examining one. Supervisor and control law start anew, and no
    /// calibration runs.
    #[must_use]
    pub fn of(config: Config, memory: Memory) -> Self {
        Self {
            configs: Configs::new(config),
            memory,
            supervisor: Supervisor::new(),
            calibration: None,
            measurement: None,
            #[cfg(feature = "large")]
            kept: kept::Kept::default(),
            #[cfg(feature = "large")]
            swept: swept::Swept::default(),
            law: config.law,
        }
    }

    /// The memory from which the next control period starts.
    #[must_use]
    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// The control law of the single wall that the settings describe, with the law's memory.
    #[must_use]
    pub const fn law(&self) -> &Controller<Fixed32> {
        &self.law
    }

    /// Reports to the device why the processor started. Some reasons are faults; the next control period latches them.
    pub fn started(&mut self, reason: ResetReason) {
        if reason != ResetReason::PowerOn {
            self.supervisor
                .motor_may_be_hot(&self.configs.now().supervisor);
        }
        if let Some((code, value)) = reason.fault() {
            self.report_fault(code, value);
        }
    }

    /// Reports a fault that another part of the firmware detected. The next control period latches the first reported fault.
    ///
    /// [`FaultCode::SettingsInvalid`] stays until [`Device::configure`] succeeds: until then every calibration ends with that
    /// fault.
    pub fn report_fault(&mut self, code: FaultCode, value: i32) {
        self.memory.reported.get_or_insert((code, value));
        self.memory.settings_refused |= code == FaultCode::SettingsInvalid;
    }

    /// Whether the device accepts settings in its present state: not while the motor may move.
    #[must_use]
    pub const fn may_configure(&self) -> bool {
        matches!(self.memory.machine.outputs(), Outputs::Off)
    }

    /// Sets other settings, which are used from the next calibration on. Until then nothing that runs changes. Call
    /// [`Device::may_configure`] first.
    ///
    /// # Errors
    /// Same as [`Config::new`]; the device is then unchanged.
    pub fn configure(
        &mut self,
        settings: &DeviceSettings,
        hardware: &Hardware,
    ) -> Result<(), SettingsError> {
        self.prepare(Config::new(settings, hardware)?);
        Ok(())
    }

    /// Same as [`Device::configure`], with coefficients that were computed before, so that the call needs little time and stack.
    pub fn prepare(&mut self, config: Config) {
        self.configs.prepare(config);
        self.memory.settings_refused = false;
    }

    /// Makes the position of the last control period the zero, until the next calibration. While the outputs may be on, the
    /// function changes nothing and returns `false`, since the wall would jump against the hand.
    pub fn zero_here(&mut self) -> bool {
        if !self.may_configure() {
            return false;
        }
        self.memory.zero = self.memory.zero.saturating_add(self.memory.record.count);
        self.memory.record.count = 0;
        true
    }

    /// Coefficients of the current loop.
    #[must_use]
    pub const fn current_config(&self) -> CurrentConfig {
        self.configs.now().current
    }

    /// State of the device, for example calibrating or armed.
    #[must_use]
    pub const fn state(&self) -> State {
        self.memory.machine.state()
    }

    /// The latched fault with its context; `None` without a fault.
    #[must_use]
    pub const fn fault(&self) -> Option<Context> {
        self.memory.machine.fault()
    }

    /// The telemetry record of the last control period.
    #[must_use]
    pub const fn record(&self) -> &Record {
        &self.memory.record
    }

    /// The part of the motor measurement that runs now; `None` while none runs.
    #[must_use]
    pub fn measuring(&self) -> Option<MeasuringPart> {
        #[cfg(feature = "large")]
        if let Some(sweep) = &self.swept.running {
            return sweep.part();
        }
        self.measurement.as_ref().map(Measurement::part)
    }

    /// Result of the last calibration: electrical angle at count 0 of the unwrapped encoder, and direction.
    #[must_use]
    pub const fn alignment(&self) -> Alignment {
        self.memory.alignment
    }

    /// Takes the encoder's second reading, made between two control periods, at the time that
    /// [`CurrentOutput::reads_change`](crate::CurrentOutput::reads_change) gives. If a control period drives the motor and this
    /// function is not called, or the reading is bad, the next period counts as one without a good reading.
    pub fn read_change(&mut self, reading: EncoderReading) {
        let config = self.configs.now();
        if config.change.is_none() {
            return;
        }
        let count = self
            .supervisor
            .shaft()
            .at(config.supervisor.shaft(), reading);
        let last = self.memory.record.count;
        self.memory.read = count.map(|count| {
            let count = count.saturating_sub(self.memory.zero);
            config.scale.moved(count.saturating_sub(last))
        });
    }

    /// Whether the motor is driven and the second encoder reading is still due. Code that delays the control interrupt for long
    /// while this is true makes the device lose that reading.
    #[must_use]
    pub fn awaits_reading(&self) -> bool {
        self.memory.record.law_ran
            && self.memory.read.is_none()
            && self.configs.now().change.is_some()
    }

    /// Runs one control period with the single wall of the settings.
    pub fn tick(&mut self, input: &ControlInput) -> ControlOutput {
        self.tick_with(input, &mut WallAlone)
    }

    /// Runs one control period with an environment of walls and detents.
    #[cfg(feature = "large")]
    pub fn tick_around(&mut self, input: &ControlInput, around: &mut Around) -> ControlOutput {
        self.tick_with(input, around)
    }

    /// Sets the environment of walls and detents to render, and returns from when on it is rendered. `surrounding` must have been
    /// computed with the settings that [`Device::prepare`] got last.
    #[cfg(feature = "large")]
    pub fn surround(&mut self, around: &mut Around, surrounding: &Surrounding) -> CountsFrom {
        let is_armed = self.memory.machine.state() == State::Armed;
        let settings_wait = self.configs.has_next();
        around.prepare(surrounding, &mut self.law, is_armed, settings_wait)
    }

    #[inline(always)]
    fn tick_with(&mut self, input: &ControlInput, scenery: &mut impl Scenery) -> ControlOutput {
        let tick = self.memory.record.tick.wrapping_add(1);
        let before = self.memory.machine.state();
        // New settings are used from the calibration's first period on, which is watched with their limits. The bridge is off until
        // then. By the old limits a supply that only the new ones allow would be a fault at every try.
        let begins = input.command == Some(Command::Calibrate) && !self.configs.has_next();
        let watched = begins || matches!(before, State::Calibrating | State::Ready | State::Armed);
        let read = self.memory.read.take();
        let watch = Watch {
            watched,
            may_be_on: self.memory.machine.outputs() == Outputs::On,
            driven: before == State::Armed && self.memory.record.law_ran,
            untold: read.is_none() && self.configs.now().change.is_some(),
            against: self.memory.alignment.against,
        };
        let verdict = self
            .supervisor
            .inspect(&self.configs.now().supervisor, input, watch);

        let refused =
            (self.memory.settings_refused && watched).then_some((FaultCode::SettingsInvalid, 0));
        let found = self.memory.reported.take().or(verdict.fault).or(refused);
        let progress = match (found, before, verdict.count) {
            (None, State::Calibrating, Some(count)) => {
                Some(self.calibrate(tick, count, &input.current, scenery))
            }
            _ => None,
        };
        let found = match progress {
            Some(Progress::Failed(code, value)) => Some((code, value)),
            _ => found,
        };
        let accepted = input
            .command
            .map(|command| found.is_none() && Machine::at(before).handle(Event::Command(command)));
        let calibrated = matches!(progress, Some(Progress::Done(_)));
        let fault = found.map(|(code, value)| Context { code, tick, value });
        let outputs = self.memory.machine.tick(fault, calibrated, input.command);
        let after = self.memory.machine.state();

        let reconfigure = self.change(before, after, progress, verdict.count, scenery);
        let last = (self.memory.record.penetration, self.memory.record.count);
        // A fault may have switched the outputs off before this control period.
        let acted = watch.driven && found.is_none() && verdict.count.is_some();
        self.observe(tick, input, verdict.count);
        if before == State::Armed && after != State::Armed {
            self.leave(acted, last, read, scenery);
        }
        let (drive, limits) = match (after, verdict.count) {
            (State::Armed, Some(_)) => {
                self.since_change(last, read, scenery);
                self.display(tick, verdict.derating, verdict.count, scenery)
            }
            (State::Calibrating, _) => (calibration_drive(progress), Limits::NONE),
            _ => (DriveCommand::Off, Limits::NONE),
        };
        self.finish(input, drive, limits, watched && verdict.count.is_none());
        ControlOutput {
            // Without a usable encoder reading the outputs are off in every state.
            outputs: if drive == DriveCommand::Off {
                Outputs::Off
            } else {
                outputs
            },
            drive,
            clear_latches: matches!(before, State::Fault(_)) && after == State::Stopped,
            reconfigure,
            accepted,
            record: self.memory.record,
        }
    }

    /// Runs one control period of the calibration. A drive without a motor to align is done at once.
    fn calibrate(
        &mut self,
        tick: u32,
        count: i64,
        report: &CurrentReport,
        scenery: &impl Scenery,
    ) -> Progress {
        #[cfg(not(feature = "large"))]
        let _ = scenery;
        #[cfg(feature = "large")]
        self.begin_with_kept();
        let config = self.configs.now();
        if !config.aligns() {
            return Progress::Done(Alignment::default());
        }
        if self.measurement.is_some() {
            return self.measure(tick, count);
        }
        #[cfg(feature = "large")]
        if self.swept.running.is_some() {
            return self.swept(tick, count, self.map_here(scenery));
        }
        // The calibration is built in its first control period, because the control period that switches the settings already
        // takes long.
        let progress = self
            .calibration
            .get_or_insert_with(|| Calibration::new(config.calibration))
            .tick(tick, count, report);
        match progress {
            Progress::Done(alignment) if config.measurement.wanted => {
                self.memory.alignment = alignment;
                self.measurement = Some(Measurement::new(config.measurement, count));
                self.measure(tick, count)
            }
            #[cfg(feature = "large")]
            Progress::Done(alignment) if self.begins_sweep() => {
                self.memory.alignment = alignment;
                self.swept(tick, count, self.map_here(scenery))
            }
            progress => progress,
        }
    }

    /// Runs one control period of the motor measurement after a calibration. It is a separate function, so that it adds no time to
    /// the control periods of a wall.
    #[cold]
    #[inline(never)]
    fn measure(&mut self, tick: u32, count: i64) -> Progress {
        let rotor = self.rotor(tick, count, 1 << 16);
        let shaft = self.supervisor.shaft();
        let speed = shaft.speed(self.configs.now().supervisor.shaft());
        let Some(measurement) = &mut self.measurement else {
            return Progress::Done(self.memory.alignment);
        };
        match measurement.tick(count, speed, &rotor) {
            Measuring::Running(command) => Progress::Running(command),
            Measuring::Done => Progress::Done(self.memory.alignment),
            Measuring::Failed(reason) => failed(reason),
        }
    }

    /// Electrical angle and motion of the rotor at this encoder count, as the drive needs them.
    #[inline(always)]
    fn rotor(&self, tick: u32, count: i64, derating: u32) -> Rotor {
        let config = self.configs.now();
        let advance = self.supervisor.shaft().advance(config.supervisor.shaft());
        let turned = config.electrical.angle(count);
        let against = self.memory.alignment.against;
        Rotor {
            tick,
            angle: self.memory.alignment.offset.plus(if against {
                Angle(turned.0.wrapping_neg())
            } else {
                turned
            }),
            advance: if against {
                advance.saturating_neg()
            } else {
                advance
            },
            against,
            derating,
            #[cfg(feature = "large")]
            map: crate::Amps::ZERO,
        }
    }

    /// Carries out a change of the device's state; returns whether the current loop must be rebuilt.
    fn change(
        &mut self,
        before: State,
        after: State,
        progress: Option<Progress>,
        count: Option<i64>,
        scenery: &mut impl Scenery,
    ) -> bool {
        if before == after {
            return false;
        }
        if let (State::Ready, Some(Progress::Done(alignment)), Some(count)) =
            (after, progress, count)
        {
            self.memory.alignment = alignment;
            self.memory.zero = count;
        }
        if after == State::Armed {
            scenery.armed(&mut self.law, &self.configs.now().law);
            self.memory.fade = 0;
            self.memory.pushes = false;
        }
        self.calibration = None;
        self.measurement = None;
        #[cfg(feature = "large")]
        self.leave_sweep(before);
        if after != State::Calibrating {
            return false;
        }
        let is_new = self.configs.turn();
        if is_new {
            self.supervisor.restart();
            scenery.calibrated(&mut self.law);
        }
        is_new
    }

    /// Writes the values that are reported in every state into the telemetry record.
    // Inlined, because a call would copy the whole input to memory.
    #[inline(always)]
    fn observe(&mut self, tick: u32, input: &ControlInput, count: Option<i64>) {
        let shaft = self.supervisor.shaft();
        let record = &mut self.memory.record;
        if let Some(count) = count {
            record.count = count.saturating_sub(self.memory.zero);
            record.penetration = self.configs.now().scale.penetration(record.count);
        }
        record.tick = tick;
        record.speed_rad_per_s = shaft.speed(self.configs.now().supervisor.shaft());
        record.temperature = Power::temperature(&self.configs.now().thermistor, &input.current);
        record.current = input.current.current;
        record.bus = input.current.bus;
        record.timing = input.timing;
        // These values hold unless the control law runs in this period.
        record.law_ran = false;
        record.force = Force::zero();
        record.torque = Force::zero();
        record.since_change = Position::zero();
        record.offset = Position::zero();
        record.energy = None;
        record.contact = Contact::Free;
    }

    /// Fills in the rest of the control period's telemetry record.
    fn finish(
        &mut self,
        input: &ControlInput,
        drive: DriveCommand,
        limits: Limits,
        bad_reading: bool,
    ) {
        let saturated = input.current.saturated != self.memory.saturated;
        self.memory.saturated = input.current.saturated;
        self.memory.record.state = self.memory.machine.state();
        self.memory.record.limits = limits
            .with(Limit::Voltage, saturated)
            .with(Limit::Encoder, bad_reading);
        self.memory.record.current_command = match drive {
            DriveCommand::Current(command) => command.current.q,
            DriveCommand::Off | DriveCommand::Analogue(_) => crate::Amps::ZERO,
        };
    }
}

/// The drive command of a calibration. It is off in the calibration's first control period and in periods without a good encoder
/// reading.
const fn calibration_drive(progress: Option<Progress>) -> DriveCommand {
    match progress {
        Some(Progress::Running(command)) => DriveCommand::Current(command),
        _ => DriveCommand::Off,
    }
}

mod display;
#[cfg(feature = "large")]
mod kept;
mod memory;
#[cfg(feature = "large")]
mod swept;
#[cfg(test)]
mod tests;

pub use display::torque_of;
pub use memory::Memory;
