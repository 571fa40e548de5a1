//! The states of a device, which decide whether its outputs may be on.
//!
//! ```text
//! Boot -> Calibrating -> Ready -> Armed
//!              \           \        \      any fault
//!               +-----------+--------+--------------> Fault(context) -> Stopped -> Calibrating
//! ```
//!
//! Outputs may be on in `Calibrating` and `Armed` only. The first fault is stored with its context, and later faults do not
//! overwrite it, because the first one is the cause. Only the command `Stop` leaves a fault, to `Stopped`. From `Stopped` the way
//! back to `Armed` leads through a calibration. A fault acts in every state, before any command of the same tick.

/// Why the outputs were switched off. The numbers go over the serial link and never change; a code that is not in use keeps its
/// number.
///
/// [`Context::value`] holds the value that each code's comment names at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum FaultCode {
    /// A phase current, or the length of the current vector, is above its limit. Value: mA.
    OverCurrent = 1,
    /// The bus voltage is above its limit. Value: mV.
    OverVoltage = 2,
    /// The bus voltage is below its limit. Value: mV.
    UnderVoltage = 3,
    /// The power stage is too hot, or its temperature sensor is broken or shorted. Value: temperature in units of 0.1 °C;
    /// `i32::MAX` if the sensor gives no plausible value.
    OverTemperature = 4,
    /// Several encoder readings in a row were bad, and in the last one the encoder did not answer. Value: the number of bad
    /// readings.
    EncoderSilent = 5,
    /// The encoder's count moved further in one tick than the shaft can turn. Value: counts since the last good reading.
    EncoderJump = 6,
    /// A control tick began too late, took too long, or was left out, or the current loop was late in several PWM periods in a row.
    /// Value: processor cycles of lateness or of the tick, or the number of missed ticks or late PWM periods.
    DeadlineMiss = 7,
    /// The hardware break input of the PWM timer was active. Value: 0.
    HardwareBreak = 8,
    /// The gate driver reported an error. Value: 0.
    GateDriver = 9,
    /// The calibration found no plausible result. Value: number of the reason (see the page of this fault).
    CalibrationFailed = 10,
    /// The stored settings are damaged, or their validation refused them. Value: 0.
    SettingsInvalid = 11,
    /// A watchdog reset the processor. Value: 0 for the independent, 1 for the window watchdog.
    Watchdog = 12,
    /// The shaft turned faster than allowed. Value: mrad/s.
    OverSpeed = 13,
    /// Several encoder readings in a row were bad, and the last one failed its parity or checksum. Value: its raw data word.
    EncoderCheck = 14,
    /// The shaft turns, as the motor's voltage shows, but the encoder shows no motion. Value: mV by which the voltage is too large.
    ///
    /// During a calibration: the field turned but the encoder did not follow. Value: counts moved.
    EncoderStuck = 15,
    /// Several encoder readings in a row were bad, and in the last one the encoder itself reported an error: magnet too weak or too
    /// strong, track lost, or framing. Value: its raw data word.
    EncoderStatus = 16,
    /// The current loop got no new command for two control periods. Value: periods of the current loop.
    StaleCommand = 17,
    /// The supply fell below the voltage that the processor needs. Value: 0.
    BrownOut = 18,
    /// The program panicked. Value: the place of the panic as a number, from the crash record in RAM.
    Panic = 19,
    /// The current sensors' readings at zero current are implausible. Value: the mean reading that is furthest from the expected
    /// one, or the scatter of the readings, in codes of the analogue-to-digital converter.
    CurrentSensor = 20,
    /// The motor is too hot by the model of its windings. Value: mean square of its current, in thousandths of the square of its
    /// continuous current.
    MotorHot = 21,
    /// The desktop sent no message for longer than allowed while the outputs may be on. Value: ms.
    HostSilent = 22,
    /// The board's stop button was pressed. Value: 0.
    StopButton = 23,
    /// Too many of the encoder's readings are bad, in a row or not. Value: 1 for readings at the control ticks, 2 for readings at
    /// the time when the force changes.
    EncoderUnsteady = 24,
    /// The motor's response to its voltage differs from that of the configured motor: the encoder's alignment slipped or a current
    /// reading is wrong. Value: mV beyond the allowed difference.
    MotorModel = 25,
    /// The shaft swings to and fro faster than a hand can move it: the control loop is unstable. Value: frequency, mHz.
    Oscillation = 26,
    /// The shaft turned fast against the motor's torque and did not slow down. Value: the current that opposed it, mA.
    Runaway = 27,
}

impl FaultCode {
    /// All fault codes, in the order of their numbers.
    pub const ALL: [Self; 27] = [
        Self::OverCurrent,
        Self::OverVoltage,
        Self::UnderVoltage,
        Self::OverTemperature,
        Self::EncoderSilent,
        Self::EncoderJump,
        Self::DeadlineMiss,
        Self::HardwareBreak,
        Self::GateDriver,
        Self::CalibrationFailed,
        Self::SettingsInvalid,
        Self::Watchdog,
        Self::OverSpeed,
        Self::EncoderCheck,
        Self::EncoderStuck,
        Self::EncoderStatus,
        Self::StaleCommand,
        Self::BrownOut,
        Self::Panic,
        Self::CurrentSensor,
        Self::MotorHot,
        Self::HostSilent,
        Self::StopButton,
        Self::EncoderUnsteady,
        Self::MotorModel,
        Self::Oscillation,
        Self::Runaway,
    ];

    /// The fault with this number on the serial link; `None` for an unknown number.
    #[must_use]
    pub fn from_wire(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number).checked_sub(1)?).copied()
    }

    /// The fault's number on the serial link.
    #[must_use]
    pub const fn to_wire(self) -> u8 {
        self as u8
    }
}

/// The record of a fault. If one fault causes others, the record is that of the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Context {
    /// The code of the fault.
    pub code: FaultCode,
    /// Number of the control tick in which the fault was detected.
    pub tick: u32,
    /// The measured value or the number that [`FaultCode`] names for this code.
    pub value: i32,
}

/// State of the device, which decides whether its outputs may be on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// Power is on and no calibration has started yet.
    #[default]
    Boot,
    /// The calibration is finding the encoder's alignment and the current sensors' offsets; the outputs move the shaft.
    Calibrating,
    /// The device is calibrated and its outputs are off.
    Ready,
    /// The control law drives the outputs.
    Armed,
    /// A fault switched the outputs off.
    Fault(Context),
    /// A command switched the outputs off and discarded the calibration.
    Stopped,
}

/// Whether the outputs may be on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outputs {
    /// The motor's power bridge must be off, and the commanded torque zero.
    Off,
    /// The motor's power bridge may be on.
    On,
}

/// Commands that a person or the desktop sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Starts a calibration, from `Boot` or `Stopped`.
    Calibrate,
    /// Switches the outputs on, from `Ready`.
    Arm,
    /// Switches the outputs off and keeps the calibration.
    Disarm,
    /// Switches the outputs off and discards the calibration. The only way out of a fault.
    Stop,
}

/// An event for the state machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// A control tick without any other event.
    Tick,
    /// A fault was detected.
    Fault(Context),
    /// The calibration succeeded.
    Calibrated,
    /// A person or the desktop sent a command.
    Command(Command),
}

/// The state machine that decides whether the outputs may be on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Machine {
    state: State,
}

impl Machine {
    /// The state machine just after power-on, in `Boot`.
    #[must_use]
    pub const fn new() -> Self {
        Self { state: State::Boot }
    }

    /// A state machine in a given state, to restore or examine it.
    #[must_use]
    pub const fn at(state: State) -> Self {
        Self { state }
    }

    /// State of the device.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether the outputs may be on in the present state.
    #[must_use]
    pub const fn outputs(&self) -> Outputs {
        match self.state {
            State::Calibrating | State::Armed => Outputs::On,
            State::Boot | State::Ready | State::Fault(_) | State::Stopped => Outputs::Off,
        }
    }

    /// The stored fault; `None` outside the state `Fault`.
    #[must_use]
    pub const fn fault(&self) -> Option<Context> {
        match self.state {
            State::Fault(context) => Some(context),
            _ => None,
        }
    }

    /// Handles one event. Returns whether the state changed. A command that does not change the state was not allowed, or was
    /// `Stop` in the state `Stopped`.
    pub fn handle(&mut self, event: Event) -> bool {
        let next = match (self.state, event) {
            // The first fault is the cause and stays.
            (State::Fault(context), Event::Fault(_)) => State::Fault(context),
            (_, Event::Fault(context)) => State::Fault(context),
            (State::Boot | State::Stopped, Event::Command(Command::Calibrate)) => {
                State::Calibrating
            }
            (State::Calibrating, Event::Calibrated) => State::Ready,
            (State::Ready, Event::Command(Command::Arm)) => State::Armed,
            (State::Armed, Event::Command(Command::Disarm)) => State::Ready,
            (_, Event::Command(Command::Stop)) => State::Stopped,
            (state, _) => state,
        };
        let changed = next != self.state;
        self.state = next;
        changed
    }

    /// Handles all events of one tick and returns whether the outputs may be on. The fault comes first, so no command of the same
    /// tick can arm the device despite the fault.
    pub fn tick(
        &mut self,
        fault: Option<Context>,
        calibrated: bool,
        command: Option<Command>,
    ) -> Outputs {
        if let Some(context) = fault {
            // A command `Stop` in the tick of a fault is ignored, because it would clear the fault before anyone read it. The
            // sender has to repeat the command.
            self.handle(Event::Fault(context));
            return self.outputs();
        }
        // Command and end of calibration both apply to the state at the beginning of the tick. A command does not use a calibration
        // that ends in the same tick, and the end of a calibration does not apply to one that a command begins. (A proof found that
        // `Arm` sent while calibrating would arm the device in the tick in which the calibration ended.)
        let calibrating = self.state == State::Calibrating;
        if let Some(command) = command {
            self.handle(Event::Command(command));
        }
        if calibrated && calibrating {
            self.handle(Event::Calibrated);
        }
        self.outputs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_on_the_wire_come_back() {
        for code in FaultCode::ALL {
            assert_eq!(FaultCode::from_wire(code.to_wire()), Some(code));
        }
        assert_eq!(FaultCode::from_wire(0), None);
        let next = FaultCode::ALL.len() as u8 + 1;
        assert_eq!(FaultCode::from_wire(next), None);
    }

    #[test]
    fn the_way_to_armed_and_out_of_a_fault() {
        let mut machine = Machine::new();
        let fault = Context {
            code: FaultCode::EncoderSilent,
            tick: 7,
            value: -1,
        };
        assert_eq!(machine.tick(None, false, Some(Command::Arm)), Outputs::Off);
        assert_eq!(
            machine.tick(None, false, Some(Command::Calibrate)),
            Outputs::On
        );
        assert_eq!(
            machine.tick(None, true, Some(Command::Arm)),
            Outputs::Off,
            "not in the tick in which the calibration ends"
        );
        assert_eq!(machine.tick(None, false, Some(Command::Arm)), Outputs::On);
        assert_eq!(
            machine.tick(Some(fault), true, Some(Command::Stop)),
            Outputs::Off
        );
        assert_eq!(machine.fault(), Some(fault));
        for command in [Command::Arm, Command::Calibrate, Command::Disarm] {
            assert_eq!(machine.tick(None, true, Some(command)), Outputs::Off);
            assert_eq!(machine.fault(), Some(fault));
        }
        machine.tick(None, false, Some(Command::Stop));
        assert_eq!(machine.state(), State::Stopped);
        assert_eq!(machine.tick(None, true, Some(Command::Arm)), Outputs::Off);
    }

    #[test]
    fn a_calibration_lasts_until_it_has_ended() {
        let mut machine = Machine::new();
        machine.tick(None, false, Some(Command::Calibrate));
        for _ in 0..3 {
            machine.tick(None, false, None);
            assert_eq!(machine.state(), State::Calibrating);
        }
        // The end of an earlier calibration does not end a calibration that a command starts in the same tick.
        let mut other = Machine::new();
        other.tick(None, true, Some(Command::Calibrate));
        assert_eq!(other.state(), State::Calibrating);
        machine.tick(None, true, None);
        assert_eq!(machine.state(), State::Ready);
    }
}
