//! Drives the motor for a motor measurement after a calibration. The computer calculates the motor's values from the recorded data
//! (`touchstone_lab::identify::motor`).
//!
//! ```text
//! Low -> High -> 4 x (Brake -> Push -> Coast) -> Brake -> done
//! ```
//!
//! 1. A current vector turns far faster than the rotor can follow, first with half of the calibration's current, then with all of
//!    it. In the frame that turns with the current the voltage is constant: `ΔV/ΔI = R + jωL`. The voltage lost in dead time is the
//!    same at both currents and cancels out.
//! 2. A quarter of the calibration's current pushes the shaft up to a speed, in both directions. After each push the bridge is
//!    off, and the knob coasts. The voltage of a push rises with the speed in proportion to the flux; the motion gives inertia,
//!    damping and friction.
//!
//! Every stage ends after a fixed number of control periods. A push that does not bring the shaft to an eighth of the wanted
//! speed is a failure.

use crate::Amps;
use crate::angle::Angle;
use crate::calibration::Reason;
use crate::command::Rotor;
use crate::current::{CurrentCommand, CurrentMode};
use crate::hardware::Hardware;
use crate::timing::periods_per_tick;
use crate::transform::Dq;
use crate::units::{narrow, product, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::{DeviceSettings, MeasuringPart};

/// Angle by which the fast field turns per PWM period, 2^-32 turns: a sixty-third of a turn, which is 317 Hz at 20 kHz. The effect
/// of dead time repeats every sixth of a turn. The number of PWM periods in a control period has only the prime factors 2 and 5. So
/// the field's angle per control period is no multiple of a sixth of a turn, and the readings average the effect.
pub const FAST_FIELD: u32 = u32::MAX / 63;
/// Number of pushes of the shaft: one in each direction to the full speed, then one in each direction to a third of it.
const PUSHES: u8 = 4;

/// Coefficients of a motor measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasurementConfig {
    /// Whether the user has requested a measurement.
    pub(crate) wanted: bool,
    current: Amps,
    /// Rise per control period of the fast field's current, A.
    current_step: Amps,
    /// Angle by which the fast field turns per control period, 2^-32 turns.
    field_per_tick: u32,
    /// Control periods for which the fast field's current is held once it has reached its value.
    hold: u32,
    push: Amps,
    /// Speeds at which a fast and a slow push of the shaft end, rad/s.
    speeds: [I16F16; 2],
    /// Braking current per speed, A·s/rad.
    brake: I16F16,
    /// Control periods without a change of the encoder count after which the shaft counts as at rest.
    rest: u32,
    /// Longest time of a push, a coast or a brake, in control periods.
    longest: u32,
}

impl MeasurementConfig {
    /// Computes the coefficients of a motor measurement from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let rate = settings.timing.rate_hz.max(1);
        let of = |value: Si, parts: i64| quotient(value, Si::const_from_int(parts));
        let current: Amps = narrow(settings.calibration.current_a);
        let hold = (rate / 2).max(1);
        let step = current.to_bits() / i32::try_from(hold).unwrap_or(i32::MAX);
        // Half of the speed at which the device switches off. That leaves room for the speed that a push adds until it is detected.
        let speed = of(settings.limits.max_speed_rad_per_s, 2);
        let push = of(settings.calibration.current_a, 4);
        Self {
            wanted: settings.calibration.measures,
            current,
            current_step: Amps::from_bits(step.max(1)),
            field_per_tick: FAST_FIELD
                .wrapping_mul(u32::from(periods_per_tick(settings, hardware))),
            hold,
            push: narrow(push),
            speeds: [narrow(speed), narrow(of(speed, 3))],
            brake: narrow(quotient(push, of(speed, 8))),
            rest: (rate / 10).max(2),
            longest: rate.saturating_mul(3),
        }
    }
}

/// Progress of a motor measurement after a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measuring {
    /// The measurement continues; holds the command for the current loop.
    Running(CurrentCommand),
    /// The measurement is done.
    Done,
    /// The measurement failed; holds the reason.
    Failed(Reason),
}

/// The state of a running motor measurement.
#[derive(Debug, Clone, Copy)]
pub struct Measurement {
    config: MeasurementConfig,
    part: MeasuringPart,
    /// Control periods since the present part of the measurement began.
    ticks: u32,
    /// Control periods since the encoder count last changed.
    still: u32,
    last: i64,
    current: Amps,
    /// Angle of the fast rotating field, 2^-32 electrical turns.
    field: u32,
    /// Number of pushes of the shaft that are over.
    pushes: u8,
}

impl Measurement {
    /// Begins a measurement with the shaft at this encoder count.
    #[must_use]
    pub const fn new(config: MeasurementConfig, count: i64) -> Self {
        Self {
            config,
            part: MeasuringPart::Low,
            ticks: 0,
            still: 0,
            last: count,
            current: Amps::ZERO,
            field: 0,
            pushes: 0,
        }
    }

    /// The part of the measurement that runs, for example a push or a coast.
    #[must_use]
    pub const fn part(&self) -> MeasuringPart {
        self.part
    }

    /// Runs one control period of the measurement. Takes the unwrapped encoder count, the shaft's speed and the rotor's angle.
    ///
    /// In a control period without a good encoder reading the caller does not call this function: the outputs are off.
    pub fn tick(&mut self, count: i64, speed: I16F16, rotor: &Rotor) -> Measuring {
        self.ticks = self.ticks.saturating_add(1);
        self.still = if count == self.last {
            self.still.saturating_add(1)
        } else {
            0
        };
        self.last = count;
        match self.part {
            MeasuringPart::Low => {
                self.turn(rotor.tick, self.config.current / 2, MeasuringPart::High)
            }
            MeasuringPart::High => self.turn(rotor.tick, self.config.current, MeasuringPart::Brake),
            MeasuringPart::Brake => self.brake(speed, rotor),
            MeasuringPart::Push => self.push(speed, rotor),
            _ => self.coast(rotor.tick),
        }
    }

    fn enter(&mut self, part: MeasuringPart) {
        self.part = part;
        self.ticks = 0;
        self.still = 0;
    }

    /// Turns the fast field by one control period. Its current is first raised, then held until the part `next` begins.
    fn turn(&mut self, tick: u32, current: Amps, next: MeasuringPart) -> Measuring {
        if self.current < current {
            self.current = self
                .current
                .saturating_add(self.config.current_step)
                .min(current);
            self.ticks = 0;
        } else if self.ticks >= self.config.hold {
            self.enter(next);
        }
        self.field = self.field.wrapping_add(self.config.field_per_tick);
        Measuring::Running(CurrentCommand {
            tick,
            mode: CurrentMode::Drive,
            angle: Angle((self.field >> 16) as u16),
            // The cast is exact: a sixty-third of 2^32 is below 2^31.
            advance: FAST_FIELD as i32,
            current: Dq {
                d: self.current,
                q: Amps::ZERO,
            },
        })
    }

    /// Runs one control period of braking, until the shaft is at rest.
    fn brake(&mut self, speed: I16F16, rotor: &Rotor) -> Measuring {
        if self.still >= self.config.rest || self.ticks >= self.config.longest {
            if self.pushes >= PUSHES {
                return Measuring::Done;
            }
            self.enter(MeasuringPart::Push);
            return self.push(speed, rotor);
        }
        let most = self.config.push;
        let along = Amps::from_bits(product(speed.to_bits(), self.config.brake.to_bits(), 16));
        let along = along.min(most).max(most.saturating_neg());
        Measuring::Running(rotor.along(along.saturating_neg()))
    }

    fn push(&mut self, speed: I16F16, rotor: &Rotor) -> Measuring {
        let [fast, slow] = self.config.speeds;
        let wanted = if self.pushes < PUSHES / 2 { fast } else { slow };
        let is_over = self.ticks >= self.config.longest;
        if speed.saturating_abs() >= wanted || is_over {
            // A hand holds the shaft, or its friction is larger than the push.
            if speed.saturating_abs() < Amps::from_bits(wanted.to_bits() >> 3) {
                return Measuring::Failed(Reason::Held);
            }
            self.pushes = self.pushes.saturating_add(1);
            self.enter(MeasuringPart::Coast);
            return off(rotor.tick);
        }
        let push = self.config.push;
        Measuring::Running(rotor.along(if self.pushes & 1 == 0 {
            push
        } else {
            push.saturating_neg()
        }))
    }

    fn coast(&mut self, tick: u32) -> Measuring {
        if self.still >= self.config.rest || self.ticks >= self.config.longest {
            self.enter(MeasuringPart::Brake);
        }
        off(tick)
    }
}

/// A control period of the measurement with the bridge off, as a command for the current loop.
const fn off(tick: u32) -> Measuring {
    Measuring::Running(CurrentCommand {
        tick,
        ..CurrentCommand::OFF
    })
}
