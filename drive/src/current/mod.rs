//! One PWM period of field-oriented control, at 20 kHz: takes phase currents, gives compare values.
//!
//! The loop follows the [`CurrentCommand`] of the last control period and needs nothing else from the control interrupt. It
//! switches off by itself in four cases: a current is too large, the hardware break acts, the command is older than two control
//! periods, or the loop is too slow for the timer. It reports its measurements in a [`CurrentReport`].
//!
//! Compare values act on average a whole PWM period after the sample from which they are calculated. So the voltage is turned ahead
//! by the rotor's motion in a period ([`ACTS_AFTER_PERIODS`]).
//!
//! On a board that measures no current the two current controllers are left out. The voltage is the winding's resistance times the
//! requested current. The file `voltage.rs` describes the disadvantages.

mod interface;
mod offsets;
#[cfg(feature = "voltage")]
mod voltage;

pub use interface::{
    BridgeCommand, CurrentCommand, CurrentMode, CurrentOutput, CurrentReport, CurrentSample, Trip,
};
pub use offsets::Offsets;
#[cfg(feature = "voltage")]
pub use voltage::VoltageStage;

use crate::angle::Angle;
use crate::modulation::Modulator;
use crate::pi::{Pi, PiGains};
use crate::transform::{AlphaBeta, Dq, Rotation};
use crate::units::{clamp_i32, milli, product};
use crate::{Amps, Volts};
use offsets::OffsetSums;
use touchstone_protocol::FaultCode;

/// Coefficients of the current loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurrentConfig {
    /// Gains of the current controllers, the same for d and q.
    pub gains: PiGains,
    /// The timer's range for space-vector modulation.
    pub modulator: Modulator,
    /// Result of [`Modulator::share`], stored because it takes a division.
    pub voltage_share: i32,
    /// Current in A per code of the analogue-to-digital converter, with 28 fractional bits. It is negative for shunts below the
    /// low-side transistors whose amplifiers do not invert.
    pub amps_per_code: i32,
    /// Bus voltage in V per code of the analogue-to-digital converter.
    pub volts_per_code: Volts,
    /// Largest current that the loop drives through the motor, A.
    pub limit: Amps,
    /// Current of a phase, or length of the current vector, in A, at which the loop switches off (trips).
    pub trip: Amps,
    /// Number of PWM periods in a control period.
    pub periods_per_tick: u16,
    /// PWM periods from the start of a control period until the encoder is read a second time; 0 for no second reading.
    pub read_at: u16,
    /// Calculates a voltage from the requested current, on a board that measures no current; `None` on other boards.
    #[cfg(feature = "voltage")]
    pub voltage: Option<VoltageStage>,
}

/// PWM periods from a sample to the middle of the time in which the compare values calculated from it act.
///
/// The currents are sampled while the timer's counter is at its top, with all low sides on. The compare values are written while it
/// counts down; a later write makes a late period ([`CurrentSample::late`]). The timer loads them at the bottom, half a period
/// after the sample. They act until the next bottom. The middle of that time is the top in between, a whole period after the
/// sample.
pub const ACTS_AFTER_PERIODS: u32 = 1;

/// This number of PWM periods in a row with late compare values is a fault. A single late period is harmless: the current changes
/// little in 50 µs. A processor that is too slow for the loop is late in every period.
const LATE_IN_A_ROW: u8 = 3;
/// The current loop: its coefficients and memory.
#[derive(Debug, Clone, Copy)]
pub struct CurrentLoop {
    config: CurrentConfig,
    d: Pi,
    q: Pi,
    /// PWM periods since the last control period began.
    phase: u16,
    /// PWM periods since the encoder reading from which the present command was computed.
    age: u32,
    last_tick: u32,
    /// Number of PWM periods in a row whose compare values were written too late.
    late: u8,
    sums: OffsetSums,
    tripped: bool,
    report: CurrentReport,
}

impl CurrentLoop {
    /// A loop that is off and whose sensors' offsets are not measured yet.
    #[must_use]
    pub fn new(config: CurrentConfig) -> Self {
        Self {
            config,
            d: Pi::default(),
            q: Pi::default(),
            phase: 0,
            age: 0,
            last_tick: 0,
            late: 0,
            sums: OffsetSums::EMPTY,
            tripped: false,
            report: CurrentReport::default(),
        }
    }

    /// Sets other coefficients while the bridge is off. Counters go on, and the sensors' offsets must be measured again.
    pub fn reconfigure(&mut self, config: CurrentConfig) {
        let report = CurrentReport {
            offsets: None,
            ..self.report
        };
        *self = Self {
            tripped: self.tripped,
            last_tick: self.last_tick,
            report,
            ..Self::new(config)
        };
    }

    /// Runs one PWM period: takes the samples, returns the command for the bridge.
    pub fn tick(&mut self, sample: &CurrentSample) -> CurrentOutput {
        let command = &sample.command;
        let config = &self.config;
        self.report.periods = self.report.periods.wrapping_add(1);
        self.phase = self.phase.wrapping_add(1);
        let pend_control = self.phase >= config.periods_per_tick;
        let config_read_at = config.read_at;
        if pend_control {
            self.phase = 0;
        }
        let fresh = command.tick != self.last_tick;
        if fresh {
            self.last_tick = command.tick;
            // The command's encoder reading was made when its control period began. If the next control period begins now, that was
            // a whole period ago.
            self.age = if pend_control {
                u32::from(config.periods_per_tick)
            } else {
                u32::from(self.phase)
            };
        } else {
            self.age = self.age.saturating_add(1);
        }
        // When a control period begins, the command of the previous one is one period old. If the command is older, the previous
        // control period did not finish.
        if pend_control && self.age > u32::from(config.periods_per_tick) {
            self.report.missed = self.report.missed.wrapping_add(1);
        }
        self.report.bus = Volts::from_bits(clamp_i32(
            i64::from(sample.bus) * i64::from(config.volts_per_code.to_bits()),
        ));
        self.report.temperature = sample.temperature;

        if sample.hardware_break {
            self.trip(FaultCode::HardwareBreak, 0);
        }
        let bridge = match command.mode {
            CurrentMode::Off | CurrentMode::Offsets => {
                if fresh && !sample.hardware_break {
                    self.tripped = false;
                }
                self.rest(sample);
                BridgeCommand::Off
            }
            CurrentMode::Drive => {
                self.sums = OffsetSums::EMPTY;
                self.drive(sample)
            }
        };
        CurrentOutput {
            bridge,
            pend_control,
            reads_change: self.phase == config_read_at && !pend_control,
            is_stale: self.is_stale(),
        }
    }

    /// Report of the last PWM period to the control interrupt. It is returned by reference, because a copy would take a tenth of
    /// the period's instructions.
    #[must_use]
    pub const fn report(&self) -> &CurrentReport {
        &self.report
    }

    /// Whether the command is older than two control periods.
    const fn is_stale(&self) -> bool {
        self.age > 2 * self.config.periods_per_tick as u32
    }

    fn trip(&mut self, code: FaultCode, value: i32) {
        // Keeps the first cause until it is cleared, as the fault machine does.
        if !self.tripped {
            self.tripped = true;
            self.report.trips = self.report.trips.wrapping_add(1);
            self.report.trip = Some(Trip { code, value });
        }
    }

    /// Runs a PWM period with the bridge off.
    fn rest(&mut self, sample: &CurrentSample) {
        self.late = 0;
        self.d.reset();
        self.q.reset();
        self.report.current = Dq::ZERO;
        self.report.voltage = Dq::ZERO;
        if sample.command.mode == CurrentMode::Offsets {
            if self.sums.count == 0 {
                self.report.offsets = None;
            }
            if self.report.offsets.is_none() {
                self.report.offsets = self.sums.add(sample.phase_a, sample.phase_b);
            }
        } else {
            self.sums = OffsetSums::EMPTY;
        }
    }

    /// Runs a PWM period with the bridge on, unless a check fails.
    fn drive(&mut self, sample: &CurrentSample) -> BridgeCommand {
        let config = self.config;
        let command = &sample.command;
        #[cfg(feature = "voltage")]
        if let Some(stage) = &config.voltage {
            return self.drive_by_voltage(stage, sample);
        }
        let Some(offsets) = self.report.offsets else {
            return BridgeCommand::Off;
        };
        let amps = |code: u16, offset: u16| {
            let difference = (i32::from(code) << Offsets::BITS) - i32::from(offset);
            // Converts 28 + 4 fractional bits to 16.
            Amps::from_bits(product(
                difference,
                config.amps_per_code,
                28 + Offsets::BITS - 16,
            ))
        };
        let (a, b) = (
            amps(sample.phase_a, offsets.a),
            amps(sample.phase_b, offsets.b),
        );
        let c = a.saturating_add(b).saturating_neg();
        let vector = AlphaBeta::from_phases(a, b);
        let trip = u64::from(config.trip.to_bits().max(0).unsigned_abs());
        // The largest phase current is what a person would measure. The vector's length also shows a current that two phases share.
        let largest = a
            .saturating_abs()
            .max(b.saturating_abs())
            .max(c.saturating_abs());
        if largest > config.trip || vector.square() > trip * trip {
            self.trip(FaultCode::OverCurrent, milli(largest));
        }
        if self.must_be_off(sample) {
            return BridgeCommand::Off;
        }

        let moved = |periods: u32| moved(command, periods);
        let current = Rotation::of(command.angle.plus(moved(self.age))).park(vector);
        let error = |wanted: Amps, is: Amps| {
            let limit = config.limit;
            wanted
                .min(limit)
                .max(limit.saturating_neg())
                .saturating_sub(is)
        };
        let longest = self.longest();
        let (v_d, short_d) =
            self.d
                .tick(&config.gains, error(command.current.d, current.d), longest);
        let (v_q, short_q) = self.q.tick(
            &config.gains,
            error(command.current.q, current.q),
            other_side(longest, v_d),
        );
        if short_d || short_q {
            self.report.saturated = self.report.saturated.wrapping_add(1);
        }
        self.report.current = current;
        self.give(command, Dq { d: v_d, q: v_q })
    }

    /// Whether the bridge must be off. Trips if the command is too old, or if the processor was late in [`LATE_IN_A_ROW`] PWM periods
    /// in a row. Also true if a check has tripped before.
    #[inline(always)]
    fn must_be_off(&mut self, sample: &CurrentSample) -> bool {
        if sample.late {
            self.late = self.late.saturating_add(1);
            if self.late >= LATE_IN_A_ROW {
                self.trip(FaultCode::DeadlineMiss, i32::from(self.late));
            }
        } else {
            self.late = 0;
        }
        if self.is_stale() {
            self.trip(FaultCode::StaleCommand, clamp_i32(i64::from(self.age)));
        }
        if self.tripped {
            self.d.reset();
            self.q.reset();
            self.report.current = Dq::ZERO;
            self.report.voltage = Dq::ZERO;
        }
        self.tripped
    }

    /// Length in V of the longest voltage vector that the bridge can make at the present bus voltage.
    #[inline(always)]
    fn longest(&self) -> Volts {
        Volts::from_bits(product(
            self.report.bus.to_bits(),
            self.config.voltage_share,
            16,
        ))
        .max(Volts::ZERO)
    }

    /// Turns a voltage from the command's frame to the electrical angle that the rotor has when the voltage acts; returns the
    /// compare values.
    #[inline(always)]
    fn give(&mut self, command: &CurrentCommand, voltage: Dq) -> BridgeCommand {
        self.report.voltage = voltage;
        let acts = moved(command, self.age.saturating_add(ACTS_AFTER_PERIODS));
        let vector = Rotation::of(command.angle.plus(acts)).back(voltage);
        BridgeCommand::On(self.config.modulator.duties(vector, self.report.bus))
    }
}

/// Electrical angle by which the rotor turns in this number of PWM periods, by the speed in the command.
#[inline(always)]
fn moved(command: &CurrentCommand, periods: u32) -> Angle {
    // Converts 2^-32 turns to 2^-16 turns.
    Angle(((i64::from(command.advance) * i64::from(periods)) >> 16) as u16)
}

/// `√(length² - side²)`: the largest voltage on the q axis if the vector is at most `length` long and `side` is its d component.
/// Rounded down to 1/1,024 V; for lengths below 64 V.
fn other_side(length: Volts, side: Volts) -> Volts {
    let short =
        |v: Volts| u32::from(u16::try_from(v.saturating_abs().to_bits() >> 6).unwrap_or(u16::MAX));
    let (length, side) = (short(length), short(side));
    // Both values are below 2^16, so their squares fit into 32 bits.
    let root = (length * length).saturating_sub(side * side).isqrt();
    Volts::from_bits(clamp_i32(i64::from(root) << 6))
}

#[cfg(test)]
mod tests;
