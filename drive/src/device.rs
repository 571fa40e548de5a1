//! One control tick, from the encoder's raw word to what the drive is told.

use crate::calibration::Alignment;
use crate::command::DriveCommand;
use crate::current::{CurrentConfig, CurrentReport};
use crate::encoder::EncoderReading;
use crate::hardware::Hardware;
use crate::pi::PiGains;
use crate::record::Record;
use crate::reset::ResetReason;
use crate::settings::{Settings, SettingsError};
use crate::timing::TickTiming;
use crate::units::narrow;
use touchstone_control::Si;
use touchstone_protocol::{Command, Context, FaultCode, Machine, Outputs};

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
    /// Whether anything may be on at all; `Off` clears the main output enable.
    pub outputs: Outputs,
    /// For the current loop's mailbox or the analogue output. [`DriveCommand::Off`] whenever `outputs` is.
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

/// What settings are computed into.
#[derive(Debug, Clone, Copy)]
pub struct Config {
    current: CurrentConfig,
}

impl Config {
    /// Validates and computes.
    ///
    /// # Errors
    /// As [`Settings::validate`], and coefficients that do not fit their formats.
    pub fn new(settings: &Settings, hardware: &Hardware) -> Result<Self, SettingsError> {
        settings.validate(hardware)?;
        let motor = &settings.motor;
        let gains = PiGains::new(
            motor.resistance_ohm,
            motor.inductance_h,
            motor.current_bandwidth_hz,
            Si::saturating_from_num(hardware.pwm_hz),
        )?;
        Ok(Self {
            current: CurrentConfig {
                gains,
                modulator: hardware.modulator(),
                amps_per_code: hardware.amps_per_code_bits(),
                volts_per_code: narrow(hardware.volts_per_code),
                limit: narrow(motor.current_limit_a),
                trip: narrow(settings.limits.trip_current_a),
                periods_per_tick: settings.periods_per_tick(hardware),
            },
        })
    }
}

/// The device: settings made into coefficients, and everything that a control tick remembers.
#[derive(Debug, Clone)]
pub struct Device {
    config: Config,
    machine: Machine,
    record: Record,
    alignment: Option<Alignment>,
}

impl Device {
    /// Just switched on.
    ///
    /// # Errors
    /// As [`Config::new`].
    pub fn new(settings: &Settings, hardware: &Hardware) -> Result<Self, SettingsError> {
        Ok(Self {
            config: Config::new(settings, hardware)?,
            machine: Machine::new(),
            record: Record::empty(),
            alignment: None,
        })
    }

    /// Takes the reason of the start: some are faults, latched with the next tick.
    pub fn started(&mut self, reason: ResetReason) {
        let _ = reason;
    }

    /// Latches a fault that another part of the firmware saw (damaged settings), with the next tick.
    pub fn report_fault(&mut self, code: FaultCode, value: i32) {
        let _ = (code, value);
    }

    /// Other settings; they count from the next calibration.
    ///
    /// # Errors
    /// As [`Config::new`]; nothing is changed then.
    pub fn configure(
        &mut self,
        settings: &Settings,
        hardware: &Hardware,
    ) -> Result<(), SettingsError> {
        Config::new(settings, hardware).map(|_| ())
    }

    /// One control tick.
    pub fn tick(&mut self, input: &ControlInput) -> ControlOutput {
        let _ = input;
        ControlOutput {
            outputs: Outputs::Off,
            drive: DriveCommand::Off,
            clear_latches: false,
            reconfigure: false,
            accepted: None,
            record: self.record,
        }
    }

    /// Coefficients of the current loop.
    #[must_use]
    pub const fn current_config(&self) -> CurrentConfig {
        self.config.current
    }

    /// The latched fault.
    #[must_use]
    pub const fn fault(&self) -> Option<Context> {
        self.machine.fault()
    }
}
