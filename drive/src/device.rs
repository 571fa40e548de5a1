//! One control tick, from the encoder's raw word to what the drive is told.
//!
//! ```text
//! reading -> supervisor -> fault machine -> penetration -> law -> torque -> drive
//! ```
//!
//! The law is [`touchstone_control::Controller`] over [`Fixed32`], as in the simulator: its force is a function of the counts
//! since the tick that armed, and of nothing else. What holds the force back (fading in, current limit, temperature) comes
//! after it.

use crate::angle::{Angle, ElectricalScale};
use crate::calibration::{Alignment, Calibration, CalibrationConfig, Progress};
use crate::command::{AnyDrive, DacCode, Drive, DriveCommand, Rotor};
use crate::current::{CurrentCommand, CurrentConfig, CurrentReport};
use crate::encoder::EncoderReading;
use crate::hardware::Hardware;
use crate::pi::PiGains;
use crate::record::Record;
use crate::reset::ResetReason;
use crate::settings::{DriveKind, Field, Settings, SettingsError};
use crate::supervisor::power::Power;
use crate::supervisor::{Found, Supervisor, SupervisorConfig};
use crate::thermistor::Thermistor;
use crate::timing::TickTiming;
use crate::units::{clamp_i32, narrow, quotient};
use fixed::types::I8F24;
use touchstone_control::law::Contact;
use touchstone_control::{Controller, CountScale, Fixed32, Force, Number, Position, Si};
use touchstone_protocol::{
    Command, Context, Event, FaultCode, Limit, Limits, Machine, Outputs, State,
};

/// What the firmware read for a control tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlInput {
    /// The encoder.
    pub encoder: EncoderReading,
    /// The current loop's mailbox; the default for a board without one.
    pub current: CurrentReport,
    /// What a person or the desktop asks for, if anything.
    pub command: Option<Command>,
    /// The hardware break has pulled since [`ControlOutput::clear_latches`] was last given.
    pub hardware_break: bool,
    /// The gate driver reports an error.
    pub gate_driver_error: bool,
    /// Cycles.
    pub timing: TickTiming,
}

/// What the firmware does after a control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlOutput {
    /// Whether anything may be on at all; `Off` clears the main output enable. `Off` exactly when `drive` is.
    pub outputs: Outputs,
    /// For the current loop or the analogue output, see [`ControlOutput::mailbox`] and [`ControlOutput::analogue`].
    pub drive: DriveCommand,
    /// Clear the timer's break flag, and the encoder's error flag: the fault was left by command.
    pub clear_latches: bool,
    /// The settings of this calibration differ from the last one's: rebuild the current loop from [`Device::current_config`]
    /// before its next sample. The bridge is off.
    pub reconfigure: bool,
    /// Whether the command of this tick had an effect; `None` without one.
    pub accepted: Option<bool>,
    /// The telemetry record; also for the [`crate::Ring`], which is no part of the device: it is too large for a stack.
    pub record: Record,
}

impl ControlOutput {
    /// The current loop's mailbox: also when nothing is to move it gets a command, as a sign of life.
    #[must_use]
    pub const fn mailbox(&self) -> CurrentCommand {
        match self.drive {
            DriveCommand::Current(command) => command,
            DriveCommand::Off | DriveCommand::Analogue(_) => CurrentCommand {
                tick: self.record.tick,
                ..CurrentCommand::OFF
            },
        }
    }

    /// The analogue output, and whether the amplifier is enabled.
    #[must_use]
    pub const fn analogue(&self) -> (DacCode, bool) {
        match self.drive {
            DriveCommand::Analogue(code) => (code, true),
            DriveCommand::Off | DriveCommand::Current(_) => (DacCode::ZERO, false),
        }
    }
}

/// What settings are computed into.
#[derive(Debug, Clone, Copy)]
pub struct Config {
    current: CurrentConfig,
    supervisor: SupervisorConfig,
    calibration: CalibrationConfig,
    drive: AnyDrive,
    /// The law at its beginning.
    law: Controller<Fixed32>,
    force_limit: I8F24,
    scale: CountScale,
    electrical: ElectricalScale,
    thermistor: Thermistor,
    /// By how much the torque's share grows in a tick while it fades in, 2^-32.
    fade_step: u32,
}

impl Config {
    /// Validates and computes.
    ///
    /// # Errors
    /// As [`Settings::validate`], and coefficients that do not fit their formats.
    pub fn new(settings: &Settings, hardware: &Hardware) -> Result<Self, SettingsError> {
        settings.validate(hardware)?;
        let motor = &settings.motor;
        let rate = Si::saturating_from_num(settings.wall.rate_hz);
        let ticks = settings.limits.fade_in_s.saturating_mul(rate);
        // 32 fractional bits, so that the quotient's bits are the step; all at once below a tick.
        // Rounded up, so that the last of these ticks has all of it.
        let fade_step = u32::try_from(quotient(Si::ONE, ticks).to_bits())
            .unwrap_or(u32::MAX)
            .saturating_add(1);
        let counts = settings.encoder.counts_per_rev;
        Ok(Self {
            current: CurrentConfig::new(settings, hardware)?,
            supervisor: SupervisorConfig::new(settings, hardware),
            calibration: CalibrationConfig::new(settings, hardware),
            drive: AnyDrive::new(settings)?,
            law: Controller::new(&settings.wall)?,
            force_limit: Fixed32::saturating_signal(settings.wall.force_limit),
            scale: CountScale::new(counts, settings.surface_rad).ok_or(
                SettingsError::Coefficient {
                    field: Field::CountsPerRev,
                    value: Si::ZERO,
                },
            )?,
            electrical: ElectricalScale::new(motor.pole_pairs, counts),
            thermistor: hardware.thermistor,
            fade_step,
        })
    }

    /// Whether there is a motor to be aligned.
    const fn aligns(&self) -> bool {
        matches!(self.drive, AnyDrive::ThreePhase(_))
    }
}

impl CurrentConfig {
    /// The current loop's coefficients.
    ///
    /// # Errors
    /// Gains that do not fit. For an analogue drive they are not used and never refused.
    pub fn new(settings: &Settings, hardware: &Hardware) -> Result<Self, SettingsError> {
        let motor = &settings.motor;
        let gains = match settings.drive {
            DriveKind::ThreePhase => PiGains::new(
                motor.resistance_ohm,
                motor.inductance_h,
                motor.current_bandwidth_hz,
                Si::saturating_from_num(hardware.pwm_hz),
            )?,
            DriveKind::Analogue => PiGains::NONE,
        };
        Ok(Self {
            gains,
            modulator: hardware.modulator(),
            voltage_share: hardware.modulator().share(),
            amps_per_code: hardware.amps_per_code_bits(),
            volts_per_code: narrow(hardware.volts_per_code),
            limit: narrow(motor.current_limit_a),
            trip: narrow(settings.limits.trip_current_a),
            periods_per_tick: settings.periods_per_tick(hardware),
        })
    }
}

/// The device: settings made into coefficients, and everything that a control tick remembers.
#[derive(Debug, Clone)]
pub struct Device {
    config: Config,
    /// For the next calibration.
    next_config: Option<Config>,
    machine: Machine,
    supervisor: Supervisor,
    calibration: Option<Calibration>,
    alignment: Alignment,
    law: Controller<Fixed32>,
    /// Count of the unwrapped encoder that is the device's zero.
    zero: i64,
    /// Share of the torque while it fades in, 2^-32.
    fade: u32,
    /// A fault that another part saw, for the next tick.
    reported: Option<Found>,
    settings_refused: bool,
    saturated: u16,
    record: Record,
}

impl Device {
    /// Just switched on.
    ///
    /// # Errors
    /// As [`Config::new`].
    pub fn new(settings: &Settings, hardware: &Hardware) -> Result<Self, SettingsError> {
        let config = Config::new(settings, hardware)?;
        Ok(Self {
            config,
            next_config: None,
            machine: Machine::new(),
            supervisor: Supervisor::new(),
            calibration: None,
            alignment: Alignment::default(),
            law: config.law,
            zero: 0,
            fade: 0,
            reported: None,
            settings_refused: false,
            saturated: 0,
            record: Record::empty(),
        })
    }

    /// Takes the reason of the start: some are faults, latched with the next tick.
    pub fn started(&mut self, reason: ResetReason) {
        if let Some((code, value)) = reason.fault() {
            self.report_fault(code, value);
        }
    }

    /// Latches a fault that another part of the firmware saw, with the next tick; the first of several.
    ///
    /// [`FaultCode::SettingsInvalid`] stays until [`Device::configure`] succeeds: until then every calibration ends with it.
    pub fn report_fault(&mut self, code: FaultCode, value: i32) {
        self.reported.get_or_insert((code, value));
        self.settings_refused |= code == FaultCode::SettingsInvalid;
    }

    /// Whether settings are taken now: not while anything may move.
    #[must_use]
    pub const fn may_configure(&self) -> bool {
        matches!(self.machine.outputs(), Outputs::Off)
    }

    /// Other settings; they count from the next calibration on. Whoever calls it asks [`Device::may_configure`] first; at any other
    /// time it changes nothing that runs.
    ///
    /// # Errors
    /// As [`Config::new`]; nothing is changed then.
    pub fn configure(
        &mut self,
        settings: &Settings,
        hardware: &Hardware,
    ) -> Result<(), SettingsError> {
        self.prepare(Config::new(settings, hardware)?);
        Ok(())
    }

    /// As [`Device::configure`], with coefficients that were computed before: takes no time, needs no stack.
    pub fn prepare(&mut self, config: Config) {
        self.next_config = Some(config);
        self.settings_refused = false;
    }

    /// The position of the last tick is zero from now on, until the next calibration. `false`, and nothing changes, while the
    /// outputs may be on: a wall must not jump at a hand.
    pub fn zero_here(&mut self) -> bool {
        if !self.may_configure() {
            return false;
        }
        self.zero = self.zero.saturating_add(self.record.count);
        self.record.count = 0;
        true
    }

    /// Coefficients of the current loop.
    #[must_use]
    pub const fn current_config(&self) -> CurrentConfig {
        self.config.current
    }

    /// Where the device stands.
    #[must_use]
    pub const fn state(&self) -> State {
        self.machine.state()
    }

    /// The latched fault.
    #[must_use]
    pub const fn fault(&self) -> Option<Context> {
        self.machine.fault()
    }

    /// The last tick's record.
    #[must_use]
    pub const fn record(&self) -> Record {
        self.record
    }

    /// What the last calibration found: electrical angle at the encoder's zero, and direction.
    #[must_use]
    pub const fn alignment(&self) -> Alignment {
        self.alignment
    }

    /// One control tick.
    pub fn tick(&mut self, input: &ControlInput) -> ControlOutput {
        let tick = self.record.tick.wrapping_add(1);
        let before = self.machine.state();
        let watched = matches!(before, State::Calibrating | State::Ready | State::Armed)
            || input.command == Some(Command::Calibrate);
        let driven = before == State::Armed && self.record.law_ran;
        let verdict = self
            .supervisor
            .look(&self.config.supervisor, input, watched, driven);

        let refused = (self.settings_refused && watched).then_some((FaultCode::SettingsInvalid, 0));
        let found = self.reported.take().or(verdict.fault).or(refused);
        let progress = match (found, before, verdict.count) {
            (None, State::Calibrating, Some(count)) => {
                Some(self.calibrate(tick, count, &input.current))
            }
            _ => None,
        };
        let found = match progress {
            Some(Progress::Failed(code, value)) => Some((code, value)),
            _ => found,
        };
        let accepted = input
            .command
            .map(|command| found.is_none() && Machine::at(before).take(Event::Command(command)));
        let calibrated = matches!(progress, Some(Progress::Done(_)));
        let fault = found.map(|(code, value)| Context { code, tick, value });
        let outputs = self.machine.tick(fault, calibrated, input.command);
        let after = self.machine.state();

        let reconfigure = self.change(before, after, progress, verdict.count);
        self.observe(tick, input, verdict.count);
        let (drive, limits) = match (after, verdict.count) {
            (State::Armed, Some(_)) => self.display(tick, verdict.derating, verdict.count),
            (State::Calibrating, _) => (calibration_drive(progress), Limits::NONE),
            _ => (DriveCommand::Off, Limits::NONE),
        };
        self.finish(input, drive, limits, watched && verdict.count.is_none());
        ControlOutput {
            // A tick without a reading to drive by is off as well, whatever the state.
            outputs: if drive == DriveCommand::Off {
                Outputs::Off
            } else {
                outputs
            },
            drive,
            clear_latches: matches!(before, State::Fault(_)) && after == State::Stopped,
            reconfigure,
            accepted,
            record: self.record,
        }
    }

    /// One tick of the calibration; without a motor to be aligned there is nothing to find out.
    fn calibrate(&mut self, tick: u32, count: i64, report: &CurrentReport) -> Progress {
        match &mut self.calibration {
            Some(calibration) => calibration.tick(tick, count, report),
            None => Progress::Done(Alignment::default()),
        }
    }

    /// What a change of state brings with it; whether the current loop must be rebuilt.
    fn change(
        &mut self,
        before: State,
        after: State,
        progress: Option<Progress>,
        count: Option<i64>,
    ) -> bool {
        if before == after {
            return false;
        }
        if let (State::Ready, Some(Progress::Done(alignment)), Some(count)) =
            (after, progress, count)
        {
            self.alignment = alignment;
            self.zero = count;
        }
        if after == State::Armed {
            self.law = self.config.law;
            self.fade = 0;
        }
        if after != State::Calibrating {
            self.calibration = None;
            return false;
        }
        // Copied once, in place: `take` would copy all the coefficients twice.
        let is_new = self.next_config.is_some();
        if let Some(config) = &self.next_config {
            self.config = *config;
            self.supervisor = self.supervisor.restarted();
            self.next_config = None;
        }
        self.calibration = self
            .config
            .aligns()
            .then(|| Calibration::new(self.config.calibration));
        is_new
    }

    /// What telemetry shows in every state.
    fn observe(&mut self, tick: u32, input: &ControlInput, count: Option<i64>) {
        let shaft = self.supervisor.shaft();
        let record = &mut self.record;
        if let Some(count) = count {
            record.count = count.saturating_sub(self.zero);
            record.penetration = self.config.scale.penetration(record.count);
        }
        record.tick = tick;
        record.speed_rad_per_s = shaft.speed(self.config.supervisor.shaft());
        record.temperature = Power::temperature(&self.config.thermistor, &input.current);
        record.current = input.current.current;
        record.bus = input.current.bus;
        record.timing = input.timing;
        // Unless the law runs.
        record.law_ran = false;
        record.force = Force::zero();
        record.torque = Force::zero();
        record.offset = Position::zero();
        record.energy = None;
        record.contact = Contact::Free;
    }

    /// One tick of the law, and what becomes of its force.
    fn display(&mut self, tick: u32, derating: u32, count: Option<i64>) -> (DriveCommand, Limits) {
        let force = law_tick(&mut self.law, self.record.penetration);
        let view = self.law.view();
        let fading = self.fade < u32::MAX;
        self.fade = self.fade.saturating_add(self.config.fade_step);
        // Out of the wall is against x. The share is at most 1 - 2^-32, and 1 when the fading is over.
        let wide = i64::from(force.0.to_bits());
        let share = i64::from(self.fade >> 1);
        let faded = if fading { (wide * share) >> 31 } else { wide };
        let torque = Force(I8F24::from_bits(clamp_i32(faded.wrapping_neg())));

        let shaft = self.supervisor.shaft();
        let advance = shaft.advance(self.config.supervisor.shaft());
        let turned = self.config.electrical.angle(count.unwrap_or_default());
        let against = self.alignment.against;
        let rotor = Rotor {
            tick,
            angle: self.alignment.offset.plus(if against {
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
        };
        let (drive, limits) = self.config.drive.command(torque, &rotor);
        let record = &mut self.record;
        record.law_ran = true;
        record.force = force;
        record.torque = torque;
        record.offset = view.offset;
        record.energy = view.energy;
        record.contact = view.contact;
        let full = force.modulus().0 >= self.config.force_limit;
        (
            drive,
            limits.with(Limit::FadeIn, fading).with(Limit::Force, full),
        )
    }

    /// The rest of the record.
    fn finish(
        &mut self,
        input: &ControlInput,
        drive: DriveCommand,
        limits: Limits,
        bad_reading: bool,
    ) {
        let saturated = input.current.saturated != self.saturated;
        self.saturated = input.current.saturated;
        self.record.state = self.machine.state();
        self.record.limits = limits
            .with(Limit::Voltage, saturated)
            .with(Limit::Encoder, bad_reading);
        self.record.current_command = match drive {
            DriveCommand::Current(command) => command.current.q,
            DriveCommand::Off | DriveCommand::Analogue(_) => crate::Amps::ZERO,
        };
    }
}

/// What a calibration asks of the drive; off in the tick that begins it, and in ticks without a reading.
const fn calibration_drive(progress: Option<Progress>) -> DriveCommand {
    match progress {
        Some(Progress::Running(command)) => DriveCommand::Current(command),
        _ => DriveCommand::Off,
    }
}

/// The law's tick, a function of its own in every program: so that what it costs can be counted (`cargo xtask cycles`).
#[inline(never)]
fn law_tick(law: &mut Controller<Fixed32>, penetration: Position<Fixed32>) -> Force<Fixed32> {
    law.tick(penetration)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoder::EncoderKind;
    use crate::hardware::IHM08M1;

    #[test]
    fn the_present_position_becomes_zero_while_nothing_may_move() {
        let mut settings = Settings::default();
        settings.encoder.kind = EncoderKind::Incremental;
        let mut device = Device::new(&settings, &IHM08M1).unwrap();
        let count = |device: &mut Device, counter| {
            let input = ControlInput {
                encoder: EncoderReading::Counter32(counter),
                current: CurrentReport::default(),
                command: None,
                hardware_break: false,
                gate_driver_error: false,
                timing: TickTiming::default(),
            };
            device.tick(&input).record.count
        };
        let first = count(&mut device, 1_000);
        assert_eq!(count(&mut device, 1_007), first + 7);
        assert!(device.zero_here());
        assert_eq!(count(&mut device, 1_007), 0);
        assert_eq!(count(&mut device, 1_004), -3);
        device.machine = Machine::at(State::Armed);
        assert!(!device.zero_here());
    }
}
