//! One PWM period: phase currents in, compare values out. Field-oriented control at 20 kHz.
//!
//! The loop obeys a mailbox, the [`CurrentCommand`] of the last control tick, and trusts nothing else of the slower levels. It
//! switches off by itself when a current is too large, when the hardware break pulled, when the command is older than two
//! control periods, or when it is itself too slow for the timer. What it saw goes back in a [`CurrentReport`].
//!
//! Compare values act on average a whole period after the sample they are made of: the voltage is turned by a period of the
//! rotor's motion ([`ACTS_AFTER_PERIODS`]).
//!
//! On a board that measures no current the two controllers are left out, and the voltage is `R` times what was asked for: the file
//! `voltage.rs`, which says what is lost by it.

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

/// Coefficients of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurrentConfig {
    /// Controller gains, the same for d and q.
    pub gains: PiGains,
    /// Modulator of the timer.
    pub modulator: Modulator,
    /// [`Modulator::share`], which takes a division.
    pub voltage_share: i32,
    /// A per code with 28 fractional bits; negative where the amplifier inverts.
    pub amps_per_code: i32,
    /// V of the bus per code.
    pub volts_per_code: Volts,
    /// Largest current ever held.
    pub limit: Amps,
    /// Current of a phase, or length of the vector, at which the loop trips.
    pub trip: Amps,
    /// PWM periods in a control period.
    pub periods_per_tick: u16,
    /// PWM periods from a control tick until the encoder is read once more; 0: it is not.
    pub read_at: u16,
    /// Computes a voltage from the wanted current, where no current is measured.
    #[cfg(feature = "voltage")]
    pub voltage: Option<VoltageStage>,
}

/// From a sample to the middle of the time in which the compare values made of it act, PWM periods.
///
/// The currents are sampled while the counter is at its top, with all low sides on. The compare values are written on the way
/// down, in time or it is a late period ([`CurrentSample::late`]), and taken over by the timer's update at the bottom, half a
/// period after the sample. They act from that bottom to the next, around the top between them: a whole period after the sample.
pub const ACTS_AFTER_PERIODS: u32 = 1;

/// How many late periods in a row are a fault. A single one is noise: the current moves little in 50 us, and the cause
/// is over. A processor that is too slow for the loop is late in every period.
const LATE_IN_A_ROW: u8 = 3;
/// The loop with its memory.
#[derive(Debug, Clone, Copy)]
pub struct CurrentLoop {
    config: CurrentConfig,
    d: Pi,
    q: Pi,
    /// Periods since the last control tick was pended.
    phase: u16,
    /// Periods since the encoder reading that the command is made of.
    age: u32,
    last_tick: u32,
    /// Late periods in a row.
    late: u8,
    sums: OffsetSums,
    tripped: bool,
    report: CurrentReport,
}

impl CurrentLoop {
    /// A loop that is off and does not know its sensors' offsets yet.
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

    /// Takes other coefficients while the bridge is off: counters go on, the sensors' offsets are forgotten.
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

    /// Runs one PWM period.
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
            // Its encoder was read when the tick was pended. In the very period that pends the next, that was a whole tick ago.
            self.age = if pend_control {
                u32::from(config.periods_per_tick)
            } else {
                u32::from(self.phase)
            };
        } else {
            self.age = self.age.saturating_add(1);
        }
        // At the moment of pending, the command of the tick before is one control period old, or that tick did not end.
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

    /// Report of the last period for the control tick. By reference, since a copy would be a tenth of the period's
    /// instructions.
    #[must_use]
    pub const fn report(&self) -> &CurrentReport {
        &self.report
    }

    /// Whether the command is older than two control periods.
    const fn is_stale(&self) -> bool {
        self.age > 2 * self.config.periods_per_tick as u32
    }

    fn trip(&mut self, code: FaultCode, value: i32) {
        // The first cause until it is cleared, as in the fault machine.
        if !self.tripped {
            self.tripped = true;
            self.report.trips = self.report.trips.wrapping_add(1);
            self.report.trip = Some(Trip { code, value });
        }
    }

    /// A period with the bridge off.
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

    /// A period with the bridge on, unless something is wrong.
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
            // 28 + 4 fractional bits to 16.
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
        // The largest of the phases is what a person would measure; the vector sees what two phases hide from the third.
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

    /// Whether the command or the processor is too late, or something tripped: then nothing is driven.
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

    /// The longest vector of voltages at this bus.
    #[inline(always)]
    fn longest(&self) -> Volts {
        Volts::from_bits(product(
            self.report.bus.to_bits(),
            self.config.voltage_share,
            16,
        ))
        .max(Volts::ZERO)
    }

    /// The compare values of a voltage in the frame of the command, turned to where the rotor is when they act.
    #[inline(always)]
    fn give(&mut self, command: &CurrentCommand, voltage: Dq) -> BridgeCommand {
        self.report.voltage = voltage;
        let acts = moved(command, self.age.saturating_add(ACTS_AFTER_PERIODS));
        let vector = Rotation::of(command.angle.plus(acts)).back(voltage);
        BridgeCommand::On(self.config.modulator.duties(vector, self.report.bus))
    }
}

/// How far the rotor turns in a number of PWM periods.
#[inline(always)]
fn moved(command: &CurrentCommand, periods: u32) -> Angle {
    // 2^-32 turns to 2^-16.
    Angle(((i64::from(command.advance) * i64::from(periods)) >> 16) as u16)
}

/// `√(length² - side²)`: the voltage that the limit on the vector's length leaves to the q axis, rounded down to
/// 1/1,024 V; for lengths up to 63 V.
fn other_side(length: Volts, side: Volts) -> Volts {
    let short =
        |v: Volts| u32::from(u16::try_from(v.saturating_abs().to_bits() >> 6).unwrap_or(u16::MAX));
    let (length, side) = (short(length), short(side));
    // Both below 2^16, so the squares fit.
    let root = (length * length).saturating_sub(side * side).isqrt();
    Volts::from_bits(clamp_i32(i64::from(root) << 6))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sides_stay_in_the_circle() {
        let v = |x: f64| Volts::from_num(x);
        assert!((other_side(v(13.0), v(5.0)) - v(12.0)).abs() < v(0.002));
        assert_eq!(other_side(v(5.0), v(-5.0)), Volts::ZERO);
        assert_eq!(other_side(v(5.0), v(6.0)), Volts::ZERO);
        assert!(other_side(Volts::MAX, Volts::MIN) == Volts::ZERO);
    }
}
