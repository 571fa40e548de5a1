//! How a fault tampers with readings and bridge, between the simulated motor and the firmware's code.

use super::broken::{Host, Memory, Motor};
use super::encoder::{Encoder, Memory as EncoderMemory};
use crate::knob::Tamper;
use crate::random::Random;
use touchstone_drive::{ControlInput, CurrentSample, EncoderReading};
use touchstone_world::motor::Drive;

/// What breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Breaks {
    /// Nothing: the run with which the others are compared.
    Nothing,
    /// The encoder.
    Encoder(Encoder),
    /// The current sensor of phase A (0) or B (1).
    Sensor(usize, Sensor),
    /// The bridge or its driver.
    Bridge(Bridge),
    /// The motor, its wires, or what it turns.
    Motor(Motor),
    /// Supply, and the sensors of supply and temperature.
    Supply(Supply),
    /// The computer.
    Host(Host),
    /// The data that the board stores for its next start. The board restarts with them, and is calibrated and armed again.
    Memory(Memory),
    /// The timing of the control ticks.
    Timing(Timing),
}

/// A current sensor's fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sensor {
    /// The sensor gives its value at zero current.
    Rests,
    /// The sensor keeps its value.
    Frozen,
    /// The sensor's gain is this many percent of the right one.
    Gain(i32),
    /// The sensor reads too much, by this percentage of the trip current.
    Offset(i32),
    /// The sensor is at the end of its range.
    Saturated,
    /// Noise with a root mean square of this percentage of the current limit.
    Noise(i32),
    /// The sensor is exchanged with the other one.
    Exchanged,
}

/// A fault of the bridge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bridge {
    /// A leg stays at this fraction of the supply voltage while the others switch.
    Leg(usize, f64),
    /// All legs are off, and no signal reports it.
    Dead,
    /// The driver's fault line (on boards without one, the break) reports a fault.
    Line,
    /// The fault line always reports that there is no fault.
    LineGood,
    /// Two phases are shorted, which driver or comparator detect in the next PWM period.
    Short,
    /// The dead time is this fraction of the PWM period.
    DeadTime(f64),
}

/// A fault of the supply or of a slow sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Supply {
    /// The voltage goes to this fraction of what it was, within this many ticks.
    To(f64, u32),
    /// The voltage is at this fraction of what it was for this many ticks.
    Dip(f64, u32),
    /// The sensor reads this fraction of the voltage.
    Reads(f64),
    /// The sensor keeps its value, and the voltage goes to this fraction of what it was.
    Frozen(f64),
    /// The temperature sensor gives this code.
    Thermistor(u16),
}

/// A fault of the timing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Timing {
    /// Every tick comes this many PWM periods late, and the processor measures the delay.
    Late(u32),
    /// The same, but the processor measures no unusual delay.
    LateUntold(u32),
    /// One of this many ticks is left out.
    Misses(u32),
    /// One tick is left out.
    MissesOnce,
    /// No further tick comes.
    Hangs,
    /// One of this many ticks runs twice.
    Twice(u32),
    /// The current loop is late in one of this many PWM periods.
    LateLoop(u32),
    /// The processor's clock is slower by this factor, so that everything takes longer.
    Clock(f64),
}

/// Properties of the board that [`Broken`] uses.
#[derive(Debug, Clone, Copy)]
pub struct Analogue {
    /// Supply voltage, V.
    pub bus_v: f64,
    /// The current sensors' codes at zero current.
    pub rest: [f64; 2],
    /// Current per code, A.
    pub amps_per_code: f64,
    /// Current limit, A.
    pub limit_a: f64,
    /// Trip current, A.
    pub trip_a: f64,
    /// PWM compare value at which a leg is at the supply voltage during the whole period.
    pub top: u16,
    /// Whether the driver has a fault line of its own.
    pub has_line: bool,
}

/// A knob with one broken part.
#[derive(Debug, Clone)]
pub struct Broken {
    /// What breaks.
    pub breaks: Breaks,
    /// Whether the part is broken now.
    pub is_broken: bool,
    /// Number of ticks since the part broke.
    pub ticks: u32,
    analogue: Analogue,
    encoder: EncoderMemory,
    frozen: Option<u16>,
    periods: u32,
    random: Random,
}

impl Broken {
    /// A knob whose part is not broken yet.
    #[must_use]
    pub fn new(analogue: Analogue) -> Self {
        Self {
            breaks: Breaks::Nothing,
            is_broken: false,
            ticks: 0,
            analogue,
            encoder: EncoderMemory::default(),
            frozen: None,
            periods: 0,
            random: Random::new(48),
        }
    }

    const fn now(&self) -> Breaks {
        if self.is_broken {
            self.breaks
        } else {
            Breaks::Nothing
        }
    }

    fn current(&mut self, phase: usize, sensor: Sensor, codes: [u16; 2]) -> u16 {
        let Analogue {
            rest,
            amps_per_code,
            limit_a,
            trip_a,
            ..
        } = self.analogue;
        let (code, rest) = (f64::from(codes[phase]), rest[phase]);
        let percent = |percent: i32| f64::from(percent) / 100.0;
        let says = match sensor {
            Sensor::Rests => rest,
            Sensor::Frozen => f64::from(*self.frozen.get_or_insert(codes[phase])),
            Sensor::Gain(gain) => rest + (code - rest) * percent(gain),
            Sensor::Offset(share) => code + percent(share) * trip_a / amps_per_code,
            Sensor::Saturated => 4_095.0,
            Sensor::Noise(share) => {
                let sum: f64 = (0..12).map(|_| self.random.real()).sum();
                code + percent(share) * limit_a / amps_per_code * sum / 2.0
            }
            Sensor::Exchanged => f64::from(codes[1 - phase]),
        };
        says.round().clamp(0.0, 4_095.0) as u16
    }
}

impl Tamper for Broken {
    fn sample(&mut self, _: u32, sample: &mut CurrentSample) {
        self.periods = self.periods.wrapping_add(1);
        let codes = [sample.phase_a, sample.phase_b];
        match self.now() {
            Breaks::Sensor(_, Sensor::Exchanged) => {
                (sample.phase_a, sample.phase_b) = (codes[1], codes[0]);
            }
            Breaks::Sensor(0, sensor) => sample.phase_a = self.current(0, sensor, codes),
            Breaks::Sensor(phase, sensor) => sample.phase_b = self.current(phase, sensor, codes),
            Breaks::Bridge(Bridge::Short) => sample.hardware_break = true,
            Breaks::Bridge(Bridge::Line) if !self.analogue.has_line => sample.hardware_break = true,
            Breaks::Supply(Supply::Reads(share)) => {
                sample.bus = (f64::from(sample.bus) * share).round() as u16;
            }
            Breaks::Supply(Supply::Frozen(_)) => {
                sample.bus = *self.frozen.get_or_insert(sample.bus);
            }
            Breaks::Supply(Supply::Thermistor(code)) => sample.temperature = code,
            Breaks::Timing(Timing::LateLoop(every)) => {
                sample.late = self.periods.is_multiple_of(every);
            }
            _ => {}
        }
    }

    fn input(&mut self, _: u32, input: &mut ControlInput) -> bool {
        self.ticks += u32::from(self.is_broken);
        let n = self.ticks;
        match self.now() {
            Breaks::Encoder(encoder) => {
                let says = encoder.falsified(&mut self.encoder, n, false, input.encoder);
                input.encoder = says.unwrap_or(EncoderReading::Silent);
                true
            }
            Breaks::Bridge(Bridge::Line | Bridge::Short) if self.analogue.has_line => {
                input.gate_driver_error = true;
                true
            }
            Breaks::Host(Host::Silent) => {
                input.host_heard = false;
                true
            }
            Breaks::Timing(Timing::LateUntold(_)) => {
                input.timing.lateness = 40;
                true
            }
            Breaks::Timing(Timing::Misses(every)) => !n.is_multiple_of(every),
            Breaks::Timing(Timing::MissesOnce) => n != 1,
            Breaks::Timing(Timing::Hangs) => false,
            _ => true,
        }
    }

    fn change(&mut self, _: u32, reading: EncoderReading) -> Option<EncoderReading> {
        let Breaks::Encoder(encoder) = self.now() else {
            return Some(reading);
        };
        encoder.falsified(&mut self.encoder, self.ticks, true, reading)
    }

    fn bus_v(&mut self, _: u32) -> f64 {
        let share = match self.now() {
            Breaks::Supply(Supply::To(share, ticks)) => {
                1.0 + (share - 1.0) * (f64::from(self.ticks) / f64::from(ticks)).min(1.0)
            }
            Breaks::Supply(Supply::Dip(share, ticks)) if self.ticks < ticks => share,
            Breaks::Supply(Supply::Frozen(share)) => share,
            _ => 1.0,
        };
        self.analogue.bus_v * share
    }

    fn bridge(&mut self, _: u32, drive: Drive) -> Drive {
        match (self.now(), drive) {
            (Breaks::Bridge(Bridge::Leg(leg, share)), Drive::On(mut duties)) => {
                duties[leg] = (f64::from(self.analogue.top) * share) as u16;
                Drive::On(duties)
            }
            (Breaks::Bridge(Bridge::Dead), _) => Drive::Off,
            _ => drive,
        }
    }

    fn when(&mut self, _: u32) -> (u32, u32) {
        match self.now() {
            Breaks::Timing(Timing::Late(late) | Timing::LateUntold(late)) => (late, 1),
            Breaks::Timing(Timing::Twice(every)) if self.ticks.is_multiple_of(every) => (0, 2),
            _ => (0, 1),
        }
    }
}
