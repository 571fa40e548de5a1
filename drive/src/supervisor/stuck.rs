//! Detects an encoder whose reading is stuck at one value.
//!
//! A shaft at rest gives a constant reading too, and some magnetic encoders filter their noise away. So a constant reading alone
//! proves nothing. But a motor that turns generates a voltage: the current loop's voltage beyond `R i` is back-EMF. The length of
//! that voltage vector does not depend on the electrical angle that the loop assumes. So the encoder counts as stuck if for 10 ms
//! without a break the count has not moved at all while the voltage shows that the shaft turns.
//!
//! The voltage must exceed the sum of three terms: 1 V, for dead time and rounding; half of `R (|i_d| + |i_q|)`, because a
//! winding that is 100 K warmer has 39 % more resistance; and the back-EMF of a speed at which a good encoder would have counted
//! several times. A stuck encoder on a slower shaft is not detected until the shaft turns faster. Meanwhile the wall's force and
//! the motor's field stay constant: the motor holds its position like a stepper motor and does not run away.

use super::Found;
use crate::Volts;
use crate::current::CurrentReport;
use crate::transform::Dq;
use crate::units::{milli, narrow, product, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::FaultCode;

/// Coefficients of the check for a stuck encoder.
#[derive(Debug, Clone, Copy)]
pub struct StuckConfig {
    resistance_ohm: I16F16,
    /// Largest voltage beyond `R i` that does not yet show a motion, V: 1 V for dead time and rounding, and the back-EMF of the
    /// slowest speed that the check detects.
    least: Volts,
    /// Number of control periods in a row in which the encoder must look stuck before this is a fault.
    ticks: u32,
}

impl StuckConfig {
    /// Computes the coefficients of the check from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings) -> Self {
        let motor = &settings.motor;
        // Speed at which 8 counts pass in 10 ms, at least 5 rad/s: 2π · 8/(counts · 0.01 s).
        let counts = Si::saturating_from_num(settings.encoder.counts_per_rev);
        let speed = quotient(const { Si::lit("5026.548") }, counts).max(const { Si::lit("5") });
        // With pole pairs p and flux linkage λ the torque constant is k_t = 3/2 p λ, and the amplitude of the back-EMF is p λ ω.
        let flux = motor
            .torque_constant_n_m_per_a
            .saturating_mul(const { Si::lit("0.666666667") });
        let least = flux.saturating_mul(speed).saturating_add(Si::ONE);
        Self {
            resistance_ohm: narrow(motor.resistance_ohm),
            least: narrow(least),
            ticks: (settings.timing.rate_hz / 100).max(2),
        }
    }

    /// Coefficients that do not come from settings: the winding's resistance in ohm, the largest voltage beyond `R i` that does not
    /// yet show a motion, and the number of suspect control periods in a row that raise the fault. Proofs take any.
    #[must_use]
    pub const fn from_limits(resistance_ohm: I16F16, least: Volts, ticks: u32) -> Self {
        Self {
            resistance_ohm,
            least,
            ticks,
        }
    }
}

/// The time for which the encoder has looked stuck, in control periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stuck {
    ticks: u32,
}

impl Default for Stuck {
    fn default() -> Self {
        Self::new()
    }
}

impl Stuck {
    /// The state in which nothing points to a stuck encoder.
    #[must_use]
    pub const fn new() -> Self {
        Self { ticks: 0 }
    }

    /// The state after this number of control periods in a row in which the encoder looked stuck; proofs begin with any number.
    #[must_use]
    pub const fn suspected_for(ticks: u32) -> Self {
        Self { ticks }
    }

    /// Number of control periods in a row in which the encoder looked stuck.
    #[must_use]
    pub const fn suspected_ticks(&self) -> u32 {
        self.ticks
    }

    /// Whether the encoder looked stuck in the last control period.
    #[must_use]
    pub const fn is_suspected(&self) -> bool {
        self.ticks != 0
    }

    /// Takes a control period in which the motor was driven; returns the fault, if there is one.
    pub fn update(
        &mut self,
        config: &StuckConfig,
        moved: i64,
        report: &CurrentReport,
    ) -> Option<Found> {
        if moved != 0 {
            self.ticks = 0;
            return None;
        }
        let Dq { d, q } = report.current;
        let drop =
            |i: I16F16| Volts::from_bits(product(config.resistance_ohm.to_bits(), i.to_bits(), 16));
        let beyond = |v: Volts, i: I16F16| v.saturating_sub(drop(i)).saturating_abs();
        // The larger component is used in the place of the vector's length: it is at least 0.7 times the length and never more
        // than the length.
        let emf = beyond(report.voltage.d, d).max(beyond(report.voltage.q, q));
        let doubt = drop(d.saturating_abs().saturating_add(q.saturating_abs()));
        let excess = emf
            .saturating_sub(config.least)
            .saturating_sub(Volts::from_bits(doubt.to_bits() >> 1));
        if excess <= Volts::ZERO {
            self.ticks = 0;
            return None;
        }
        self.ticks = self.ticks.saturating_add(1);
        (self.ticks >= config.ticks).then_some((FaultCode::EncoderStuck, milli(excess)))
    }
}
