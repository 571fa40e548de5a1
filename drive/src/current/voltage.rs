//! A voltage in place of a current, for a board that measures none.
//!
//! ```text
//! v = R i*       L di/dt = v - R i - e       e_q = ψ ω,  ψ = k_t/(3/2 p)
//! ```
//!
//! **The back-EMF is not compensated.** So the torque is not `k_t i*` but, with the pole `R/L`,
//!
//! ```text
//! τ = (k_t i* - b ω)/(1 + s L/R)        b = k_t ψ p/R = k_t²/(3/2 R)
//! ```
//!
//! a damping that the motor itself provides, without an encoder, a filter or a delay: it takes energy whatever `R` and `ψ` are, as a
//! winding with a resistance does. To compensate it would be a positive feedback of an estimated speed, `+b̂ ω̂`, late by a tick and
//! more. Where `b̂` is a third too large, what is left is a negative damping: with the small gimbal motor -1.1e-4 N·m·s/rad, twelve
//! times what its bearings take, and a knob that is let go speeds up by itself.
//!
//! What nobody measures is computed, from the voltage given, the encoder's speed and the settings: `i = (v - e)/R`. It is as wrong as
//! `R` is. What is compared with it, the trip current and the model of the windings' heat, is no protection against a wrong `R`, a
//! shorted phase or an open one. Those are the driver's own, by its line. See docs/voltage-mode.md.

use super::{BridgeCommand, CurrentLoop, CurrentSample, other_side};
use crate::hardware::Hardware;
use crate::settings::{MotorSettings, out_of_format};
use crate::transform::Dq;
use crate::units::{milli, narrow, product, quotient};
use crate::{Amps, Volts};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::FaultCode;
use touchstone_protocol::settings::SettingsError;

/// Coefficients, computed once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoltageStage {
    /// `R`, V/A.
    ohms: I16F16,
    /// `1/R`, A/V.
    amps_per_volt: I16F16,
    /// `ψ ω` for an electrical turn in a PWM period, V.
    back_emf: Volts,
}

/// The constant `2π/(3/2)`.
const TWO_PI_OVER_THREE_HALVES: Si = Si::lit("4.188790205");

impl VoltageStage {
    /// Coefficients for a motor on a board; `None` if the board measures its currents.
    ///
    /// # Errors
    /// A back-EMF that does not fit.
    pub fn new(motor: &MotorSettings, hardware: &Hardware) -> Result<Option<Self>, SettingsError> {
        if !hardware.gives_voltage() {
            return Ok(None);
        }
        let turns_per_s = Si::saturating_from_num(hardware.pwm_hz);
        let pairs = Si::saturating_from_num(motor.pole_pairs.max(1));
        let flux_over_turn = quotient(
            motor
                .torque_constant_n_m_per_a
                .saturating_mul(TWO_PI_OVER_THREE_HALVES),
            pairs,
        );
        let back_emf = flux_over_turn.saturating_mul(turns_per_s);
        if narrow(back_emf) == Volts::MAX {
            return Err(out_of_format("motor.torque_constant_n_m_per_a", back_emf));
        }
        Ok(Some(Self {
            ohms: narrow(motor.resistance_ohm),
            // At most 100: a resistance is 0.01 ohm and more.
            amps_per_volt: narrow(quotient(Si::ONE, motor.resistance_ohm)),
            back_emf: narrow(back_emf),
        }))
    }
}

impl CurrentLoop {
    /// A period with the bridge on, unless something is wrong.
    pub(super) fn drive_by_voltage(
        &mut self,
        stage: &VoltageStage,
        sample: &CurrentSample,
    ) -> BridgeCommand {
        let command = &sample.command;
        let most = self.config.limit;
        let asked = |wanted: Amps| {
            let within = wanted.min(most).max(most.saturating_neg());
            Volts::from_bits(product(within.to_bits(), stage.ohms.to_bits(), 16))
        };
        let within = |v: Volts, most: Volts| v.min(most).max(most.saturating_neg());
        let (v_d, v_q) = (asked(command.current.d), asked(command.current.q));
        let longest = self.longest();
        let d = within(v_d, longest);
        let q = within(v_q, other_side(longest, d));
        if d != v_d || q != v_q {
            self.report.saturated = self.report.saturated.wrapping_add(1);
        }
        // A whole turn is 2^32.
        let back_emf = Volts::from_bits(product(stage.back_emf.to_bits(), command.advance, 32));
        let amps =
            |v: Volts| Amps::from_bits(product(v.to_bits(), stage.amps_per_volt.to_bits(), 16));
        let current = Dq {
            d: amps(d),
            q: amps(q.saturating_sub(back_emf)),
        };
        let length = current.d.saturating_abs().max(current.q.saturating_abs());
        if length > self.config.trip {
            self.trip(FaultCode::OverCurrent, milli(length));
        }
        if self.must_be_off(sample) {
            return BridgeCommand::Off;
        }
        self.report.current = current;
        self.give(command, Dq { d, q })
    }
}
