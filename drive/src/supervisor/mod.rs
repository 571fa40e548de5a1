//! The supervisor: checks for faults.
//!
//! At the beginning of each control period (tick) it compares all readings with their limits. The first broken limit becomes the
//! fault of the period. The fault machine switches the outputs off in the same period and latches the fault with its context. Power
//! and sensors are checked from the command to calibrate until the next stop, since parts that are off may be unpowered or
//! disconnected.
//!
//! | checked in | faults |
//! |---|---|
//! | this module | break input, gate driver, deadline |
//! | [`power`] | bus voltage, temperature (with derating below the fault) |
//! | [`shaft`] | encoder silent, parity and CRC, own error, jump, overspeed |
//! | [`share`] | too many bad readings, in a row or not |
//! | [`stuck`] | encoder stuck while armed |
//! | [`motion`] | a fast oscillation, and a run of the shaft against the motor's torque |
//! | [`model`] | a motor whose current does not match its voltage by the settings |
//! | [`heat`] | a motor that is too hot by the model of its windings (with derating below the fault) |
//! | [`stop`] | stop button, silence of the computer |
//! | [`crate::current`] | over-current, stale command, break: the current loop has already switched off and reports why |
//! | [`crate::calibration`] | calibration, current sensors, encoder stuck while calibrating |
//! | [`crate::reset`] | watchdog, brown-out, panic: after the reset that they caused |
//!
//! Limits that reduce the force without a fault have codes of their own, [`touchstone_protocol::Limits`].

pub mod heat;
pub mod model;
pub mod motion;
pub mod power;
pub mod shaft;
pub mod share;
pub mod stop;
pub mod stuck;

use crate::current::CurrentReport;
use crate::hardware::Hardware;
use crate::input::ControlInput;
use crate::settings::DriveKind;
use crate::timing::TickTiming;
use heat::{Heat, HeatConfig};
use model::{Model, ModelConfig};
use motion::Motion;
use power::{Power, PowerConfig};
use shaft::{Seen, Shaft, ShaftConfig};
use share::Share;
use stop::{Asked, AskedConfig};
use stuck::{Stuck, StuckConfig};
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::FaultCode;

/// A fault's code, and the value for the fault's context.
pub type Found = (FaultCode, i32);

/// The limits of all checks, computed once from the settings.
#[derive(Debug, Clone, Copy)]
pub struct SupervisorConfig {
    shaft: ShaftConfig,
    /// Limits of power stage, stuck encoder and motor heat; `None` for an analogue drive, whose power stage is external.
    motor: Option<(PowerConfig, StuckConfig, HeatConfig)>,
    /// Coefficients of the check of the motor's voltages; `None` if no currents are measured.
    model: Option<ModelConfig>,
    asked: AskedConfig,
    /// Length of a control period in processor cycles.
    period: u32,
}

impl SupervisorConfig {
    /// Computes the limits of all checks from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let rate = settings.timing.rate_hz.max(1);
        let motor = (
            PowerConfig::new(settings, hardware),
            StuckConfig::new(settings),
            HeatConfig::new(settings),
        );
        Self {
            shaft: ShaftConfig::new(settings, hardware),
            motor: (settings.drive.kind == DriveKind::ThreePhase).then_some(motor),
            model: if settings.drive.kind == DriveKind::ThreePhase {
                ModelConfig::new(settings, hardware)
            } else {
                None
            },
            asked: AskedConfig::new(settings),
            period: hardware.core_hz / rate,
        }
    }

    /// Whether a bus voltage is within its limits; always true for an external power stage.
    #[cfg(feature = "large")]
    #[must_use]
    pub fn takes_supply(&self, bus: crate::Volts) -> bool {
        self.motor.is_none_or(|(power, ..)| power.takes(bus))
    }

    /// Coefficients of the checks of the encoder's readings and of the shaft's speed.
    #[must_use]
    pub const fn shaft(&self) -> &ShaftConfig {
        &self.shaft
    }
}

/// The supervisor's memory from one control period to the next.
#[derive(Debug, Clone, Copy)]
pub struct Supervisor {
    shaft: Shaft,
    share: Share,
    stuck: Stuck,
    motion: Motion,
    model: Model,
    heat: Heat,
    asked: Asked,
    trips: u8,
    missed: u16,
    watched: bool,
}

/// Result of the checks in a control period.
#[derive(Debug, Clone, Copy)]
pub struct Verdict {
    /// The first fault found; `None` if all limits are kept.
    pub fault: Option<Found>,
    /// The encoder count, continued over the encoder's wrap; `None` if the reading was bad.
    pub count: Option<i64>,
    /// Fraction of the current limit that the temperatures of power stage and motor allow, in 1/65,536.
    pub derating: u32,
}

/// The device's present state, as far as it decides which checks apply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Watch {
    /// Whether readings outside their limits are faults in this state.
    pub watched: bool,
    /// Whether the outputs may be on in this state.
    pub may_be_on: bool,
    /// Whether the control law drove the motor in the previous control period.
    pub driven: bool,
    /// Whether the encoder's second reading in the previous control period, at the change of force, is missing.
    pub untold: bool,
    /// Whether the electrical angle falls when the encoder count rises.
    pub against: bool,
}

impl Default for Supervisor {
    fn default() -> Self {
        Self::new()
    }
}

impl Supervisor {
    /// The supervisor's memory before the first control period.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shaft: Shaft::new(),
            share: Share::new(),
            stuck: Stuck::new(),
            motion: Motion::new(),
            model: Model::new(),
            heat: Heat::cold(),
            asked: Asked::new(),
            trips: 0,
            missed: 0,
            watched: false,
        }
    }

    /// Assumes that the motor is as hot as it may be, because the processor was off for an unknown time.
    pub const fn motor_may_be_hot(&mut self, config: &SupervisorConfig) {
        if let Some((_, _, heat)) = &config.motor {
            self.heat = Heat::unknown(heat);
        }
    }

    /// Prepares for another configuration: clears the memory of the shaft's motion. The current loop's counters and the motor's
    /// heat are kept.
    pub const fn restart(&mut self) {
        self.shaft = Shaft::new();
        self.stuck = Stuck::new();
        self.motion = Motion::new();
        self.share = Share::new();
        self.model = Model::new();
    }

    /// The motion of the shaft, as the encoder measures it.
    #[must_use]
    pub const fn shaft(&self) -> &Shaft {
        &self.shaft
    }

    /// Checks all readings of a control period.
    pub fn inspect(
        &mut self,
        config: &SupervisorConfig,
        input: &ControlInput,
        watch: Watch,
    ) -> Verdict {
        let Watch {
            watched,
            may_be_on,
            driven,
            untold,
            against,
        } = watch;
        let report = &input.current;
        let seen = self
            .shaft
            .read(&config.shaft, input.encoder, watched, driven && untold);
        let (count, shaft_fault) = match seen {
            Seen::Good { count, .. } => (Some(count), None),
            Seen::Bad => (None, None),
            Seen::Fault(code, value) => (None, Some((code, value))),
        };
        let stuck_fault = match (&config.motor, seen) {
            (Some((_, stuck, _)), Seen::Good { moved, .. }) if driven => {
                self.stuck.update(stuck, moved, report)
            }
            _ => {
                self.stuck = Stuck::new();
                None
            }
        };
        let share_fault = if watched {
            // If the second reading of the previous control period is missing, this period's first reading counts as bad too. That
            // must not add to the sum of bad first readings.
            let bad = count.is_none() && !(driven && untold);
            self.share.update(bad, driven.then_some(untold))
        } else {
            self.share = Share::new();
            None
        };
        let motion_fault = if driven {
            self.shaft
                .motion_fault(&config.shaft, &mut self.motion, report, against)
        } else {
            // A bad reading between two good ones ends neither an oscillation nor a runaway.
            if !may_be_on {
                self.motion = Motion::new();
            }
            None
        };
        let model_fault = match &config.model {
            Some(model) if driven => {
                let speed = self.shaft.speed(&config.shaft);
                let along = if against {
                    speed.saturating_neg()
                } else {
                    speed
                };
                let found = self.model.update(model, along, report);
                // If the count does not move at all, a stuck encoder is the more likely cause.
                let code = if self.stuck.is_suspected() {
                    FaultCode::EncoderStuck
                } else {
                    FaultCode::MotorModel
                };
                found.map(|beyond| (code, beyond))
            }
            _ => {
                // A bad reading between two good ones does not reset the model.
                if !may_be_on {
                    self.model = Model::new();
                }
                None
            }
        };
        let (power_fault, derating) = match &config.motor {
            Some((power, ..)) => Power::inspect(power, report),
            None => (None, 1 << 16),
        };
        let (heat_fault, left) = match &config.motor {
            Some((.., heat)) => self.heat.update(heat, report),
            None => (None, 1 << 16),
        };
        let asked_fault = self.asked.update(&config.asked, input, may_be_on);
        let loop_fault = self.look_at_loop(config, input.timing, report);
        // Updated in every state, so that events outside the watched states are not reported later.
        let before = self.watched;
        self.watched = watched;
        let fault = break_fault(input)
            .or(loop_fault.filter(|_| before))
            .or(power_fault)
            .or(asked_fault)
            .or(heat_fault)
            .or(shaft_fault)
            .or(share_fault)
            .or(stuck_fault)
            .or(model_fault)
            .or(motion_fault);
        Verdict {
            fault: fault.filter(|_| watched),
            count,
            derating: derating.min(left),
        }
    }

    /// Checks the current loop's report and the control interrupt's deadlines for the time since the last control period.
    fn look_at_loop(
        &mut self,
        config: &SupervisorConfig,
        timing: TickTiming,
        report: &CurrentReport,
    ) -> Option<Found> {
        let tripped = report.trips != self.trips;
        let missed = report.missed.wrapping_sub(self.missed);
        self.trips = report.trips;
        self.missed = report.missed;
        let trip = report.trip.filter(|_| tripped);
        if let Some(trip) = trip {
            return Some((trip.code, trip.value));
        }
        if missed != 0 {
            return Some((FaultCode::DeadlineMiss, i32::from(missed)));
        }
        // The control interrupt began half a period late, or had not finished when the next one was due.
        if timing.lateness > config.period / 2 {
            return Some((FaultCode::DeadlineMiss, cycles(timing.lateness)));
        }
        if timing.duration > config.period.saturating_sub(timing.lateness) {
            return Some((FaultCode::DeadlineMiss, cycles(timing.duration)));
        }
        None
    }
}

fn cycles(cycles: u32) -> i32 {
    i32::try_from(cycles).unwrap_or(i32::MAX)
}

fn break_fault(input: &ControlInput) -> Option<Found> {
    // A gate driver with a fault line pulls the break by that line. Then the driver's error is the more exact cause.
    if input.gate_driver_error {
        Some((FaultCode::GateDriver, 0))
    } else if input.hardware_break {
        Some((FaultCode::HardwareBreak, 0))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Amps;
    use crate::encoder::EncoderReading;
    use crate::hardware::IHM08M1;

    /// Inputs of a board without faults, with this current and this code of the power stage's thermistor.
    fn input(amperes: f64, temperature: u16) -> ControlInput {
        let mut current = CurrentReport {
            temperature,
            ..CurrentReport::default()
        };
        current.current.q = Amps::from_num(amperes);
        ControlInput {
            encoder: EncoderReading::Silent,
            current,
            command: None,
            hardware_break: false,
            gate_driver_error: false,
            stop_button: false,
            host_heard: false,
            timing: TickTiming::default(),
        }
    }

    #[test]
    fn a_hot_power_stage_and_a_hot_motor_each_reduce_the_current_limit() {
        let settings = DeviceSettings::default();
        let config = SupervisorConfig::new(&settings, &IHM08M1);
        let power = PowerConfig::new(&settings, &IHM08M1);
        let heat = HeatConfig::new(&settings);
        let watch = Watch {
            watched: true,
            may_be_on: true,
            driven: false,
            untold: false,
            against: false,
        };
        let code_of = |celsius: u8| {
            let reached = |code: &u16| {
                let now = IHM08M1.thermistor.celsius(*code);
                now.is_some_and(|now| now >= crate::Celsius::from_num(celsius))
            };
            (0..4_096).find(reached).expect("in the thermistor's table")
        };
        // The power stage is derated from 70 °C on, the windings once the running mean of the squared current is above 0.392 A².
        for (amperes, celsius, by) in [
            (0.0, 25, [false, false]),
            (0.0, 80, [true, false]),
            (0.68, 25, [false, true]),
            (0.68, 72, [true, true]),
            (0.65, 85, [true, true]),
        ] {
            let now = input(amperes, code_of(celsius));
            let (mut supervisor, mut windings) = (Supervisor::new(), Heat::cold());
            let (mut given, mut of_motor) = (0, 0);
            for _ in 0..100_000 {
                given = supervisor.inspect(&config, &now, watch).derating;
                of_motor = windings.update(&heat, &now.current).1;
            }
            let of_stage = Power::inspect(&power, &now.current).1;
            assert_eq!([of_stage < 1 << 16, of_motor < 1 << 16], by, "{amperes} A");
            assert_eq!(given, of_stage.min(of_motor), "{amperes} A, {celsius} °C");
        }
    }
}
