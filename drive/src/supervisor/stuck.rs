//! An encoder that always says the same.
//!
//! A shaft at rest gives a constant reading too, so a constant reading alone says nothing, and the noise of a magnetic encoder
//! is filtered away in some. But a motor that turns makes a voltage: what the current loop gives beyond `R i` is back-EMF,
//! whatever the angle is that it believes in, for the length of a vector does not depend on the frame. So: the count has
//! not moved at all while the voltage says that the shaft turns, for 10 ms without a break.
//!
//! The voltage must exceed 1 V (dead time, rounding), half of `R |i|` (a winding that is 100 K warmer has 39 % more resistance)
//! and the back-EMF of a speed at which a good encoder would have counted several times. A stuck encoder on a slower shaft is
//! not seen until it turns faster. Meanwhile the wall's force stays constant, as does the field: the motor holds like a
//! stepper and does not run away.

use super::Found;
use crate::Volts;
use crate::current::CurrentReport;
use crate::transform::Dq;
use crate::units::{milli, narrow, product, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::FaultCode;

/// Coefficients.
#[derive(Debug, Clone, Copy)]
pub struct StuckConfig {
    resistance_ohm: I16F16,
    /// Voltage that rest may show.
    least: Volts,
    /// Ticks without a break.
    ticks: u32,
}

impl StuckConfig {
    /// Computes it from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings) -> Self {
        let motor = &settings.motor;
        // Speed at which 8 counts pass in 10 ms, at least 5 rad/s: 2π · 8/(counts · 0.01 s).
        let counts = Si::saturating_from_num(settings.encoder.counts_per_rev);
        let speed = quotient(const { Si::lit("5026.548") }, counts).max(const { Si::lit("5") });
        // k_t = 3/2 p λ, and the back-EMF's amplitude is p λ ω.
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
}

/// How long it has looked so.
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

    /// Whether it looked so in the last tick.
    #[must_use]
    pub const fn is_suspected(&self) -> bool {
        self.ticks != 0
    }

    /// Takes a tick in which the motor was driven.
    pub fn update(
        &mut self,
        config: &StuckConfig,
        moved: i64,
        report: &CurrentReport,
    ) -> Option<Found> {
        let Dq { d, q } = report.current;
        let drop =
            |i: I16F16| Volts::from_bits(product(config.resistance_ohm.to_bits(), i.to_bits(), 16));
        let beyond = |v: Volts, i: I16F16| v.saturating_sub(drop(i)).saturating_abs();
        // The larger part is at least 0.7 of the vector and never more than it.
        let emf = beyond(report.voltage.d, d).max(beyond(report.voltage.q, q));
        let doubt = drop(d.saturating_abs().saturating_add(q.saturating_abs()));
        let excess = emf
            .saturating_sub(config.least)
            .saturating_sub(Volts::from_bits(doubt.to_bits() >> 1));
        if moved != 0 || excess <= Volts::ZERO {
            self.ticks = 0;
            return None;
        }
        self.ticks = self.ticks.saturating_add(1);
        (self.ticks >= config.ticks).then_some((FaultCode::EncoderStuck, milli(excess)))
    }
}
