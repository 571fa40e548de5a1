//! The states that decide whether the outputs may be on.
//!
//! ```text
//! Boot -> Calibrating -> Ready -> Armed
//!              \           \        \      any fault
//!               +-----------+--------+--------------> Fault(context) -> Stopped -> Calibrating
//! ```
//!
//! Outputs may be on in `Calibrating` and `Armed` only. A fault is latched with its context: later faults do not overwrite the
//! first, which is the cause, and only an explicit command leaves it, to `Stopped`. From there the way back to `Armed` leads
//! through a calibration. A fault is taken in every state, before any command of the same tick.

/// Why the outputs were switched off. The numbers go over the wire and never change; a code that is no longer used
/// keeps its number.
///
/// [`Context::value`] has the measured value, in the unit given here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum FaultCode {
    /// Phase current, or the current vector, above its limit; mA.
    OverCurrent = 1,
    /// Bus voltage above its limit; mV.
    OverVoltage = 2,
    /// Bus voltage below its limit; mV.
    UnderVoltage = 3,
    /// Power stage too hot, or its sensor broken or shorted; 0.1 degrees Celsius.
    OverTemperature = 4,
    /// The encoder did not answer, several times in a row; how many times.
    EncoderSilent = 5,
    /// The encoder moved further in one tick than the shaft can; counts.
    EncoderJump = 6,
    /// A control tick began too late, took too long, or was left out; cycles of lateness, cycles of the tick, or ticks left out.
    DeadlineMiss = 7,
    /// The hardware break input pulled; 0.
    HardwareBreak = 8,
    /// The gate driver reported an error; 0.
    GateDriver = 9,
    /// Calibration found no plausible result; the reason's number.
    CalibrationFailed = 10,
    /// Stored settings are damaged or were refused; 0.
    SettingsInvalid = 11,
    /// The watchdog reset the processor; 0 for the independent, 1 for the window watchdog.
    Watchdog = 12,
    /// The shaft turned faster than allowed; mrad/s.
    OverSpeed = 13,
    /// The encoder's words failed their parity or check sum, several times in a row; the raw word.
    EncoderCheck = 14,
    /// The motor's voltage says that it turns, the encoder says that it does not; the voltage's excess, mV. While
    /// calibrating: the field turned and the encoder did not; counts moved.
    EncoderStuck = 15,
    /// The encoder itself reports an error (magnet too weak, too strong, track lost, framing), several times in a row; the raw
    /// word.
    EncoderStatus = 16,
    /// The current loop got no new command for two control periods; periods of the current loop.
    StaleCommand = 17,
    /// The supply fell below what the processor needs; the value is 0.
    BrownOut = 18,
    /// The program panicked; where, as its record says.
    Panic = 19,
    /// The current sensors' resting values are implausible; the worst of them, counts of the converter.
    CurrentSensor = 20,
    /// By the model of its windings the motor is too hot; the mean square of its current in ‰ of what it bears for ever.
    MotorHot = 21,
    /// No message came from the desktop for too long while the outputs may be on; ms.
    HostSilent = 22,
    /// The board's stop button was pressed; 0.
    StopButton = 23,
    /// Too large a share of the encoder's readings is bad, in a row or not; 1: those of the ticks, 2: those at the change of force.
    EncoderUnsteady = 24,
    /// The motor does not answer its voltage as the motor of the settings would: a slipped alignment or a false
    /// current. Value: mV beyond what is allowed.
    MotorModel = 25,
}

impl FaultCode {
    /// All fault codes.
    pub const ALL: [Self; 25] = [
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
    ];

    /// The fault that a number on the wire stands for.
    #[must_use]
    pub fn from_wire(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number).checked_sub(1)?).copied()
    }

    /// The number on the wire.
    #[must_use]
    pub const fn to_wire(self) -> u8 {
        self as u8
    }
}

/// The record of a fault: the first cause, not what followed from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Context {
    /// The code of the fault.
    pub code: FaultCode,
    /// Tick in which it was seen.
    pub tick: u32,
    /// The measured value that broke the limit, in the unit given at the code.
    pub value: i32,
}

/// State of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// Power is on, nothing is known yet.
    #[default]
    Boot,
    /// Encoder and current offsets are being found; the outputs move the shaft.
    Calibrating,
    /// Calibrated, outputs off.
    Ready,
    /// The control law drives the outputs.
    Armed,
    /// Switched off for a reason.
    Fault(Context),
    /// Switched off by command; calibration is forgotten.
    Stopped,
}

/// What may be done with the outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outputs {
    /// Bridge off, command zero.
    Off,
    /// Bridge on.
    On,
}

/// Commands of a person or the desktop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Start a calibration, from `Boot` (self-test over) or `Stopped`.
    Calibrate,
    /// Switch the outputs on.
    Arm,
    /// Switch the outputs off, keep the calibration.
    Disarm,
    /// Switch off and forget; the only way out of a fault.
    Stop,
}

/// What happened in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// A tick without an event.
    Tick,
    /// A fault was seen.
    Fault(Context),
    /// The calibration succeeded.
    Calibrated,
    /// A command came in.
    Command(Command),
}

/// The fault machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Machine {
    state: State,
}

impl Machine {
    /// The state just after power-on.
    #[must_use]
    pub const fn new() -> Self {
        Self { state: State::Boot }
    }

    /// The machine in a given state, for restoring or examining it.
    #[must_use]
    pub const fn at(state: State) -> Self {
        Self { state }
    }

    /// State of the device.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// What may be done with the outputs now.
    #[must_use]
    pub const fn outputs(&self) -> Outputs {
        match self.state {
            State::Calibrating | State::Armed => Outputs::On,
            State::Boot | State::Ready | State::Fault(_) | State::Stopped => Outputs::Off,
        }
    }

    /// The latched fault.
    #[must_use]
    pub const fn fault(&self) -> Option<Context> {
        match self.state {
            State::Fault(context) => Some(context),
            _ => None,
        }
    }

    /// Handles one event. Returns whether it had an effect, so that a command that is not allowed can be answered so.
    pub fn handle(&mut self, event: Event) -> bool {
        let next = match (self.state, event) {
            // The first cause stays.
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

    /// Takes everything of one tick: the fault first, so that no command of the same tick can arm past it.
    pub fn tick(
        &mut self,
        fault: Option<Context>,
        calibrated: bool,
        command: Option<Command>,
    ) -> Outputs {
        if let Some(context) = fault {
            // A stop in the tick of a fault would hide the fault: it has to be asked for again.
            self.handle(Event::Fault(context));
            return self.outputs();
        }
        // Both meet the state that the tick began with: a command does not count on a calibration that ends in the same
        // tick, nor a calibration's end on a command that begins it. (A proof found `Arm` sent while calibrating: it armed
        // the device in the very tick in which the calibration ended.)
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
        assert_eq!(FaultCode::from_wire(26), None);
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
        // What ends in the tick in which another one begins is not that one.
        let mut other = Machine::new();
        other.tick(None, true, Some(Command::Calibrate));
        assert_eq!(other.state(), State::Calibrating);
        machine.tick(None, true, None);
        assert_eq!(machine.state(), State::Ready);
    }
}
