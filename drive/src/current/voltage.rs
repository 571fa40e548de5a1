//! Drive by voltage instead of current, for a board that measures no current.
//!
//! ```text
//! v = R i*       L di/dt = v - R i - e       e_q = ψ p ω,  ψ = k_t/(3/2 p)
//! ```
//!
//! Here `i*` is the requested current, `i` the true one, `e` the back-EMF, and `ψ` the flux linkage. `ω` is the speed of the shaft,
//! `k_t` the torque constant, `p` the number of pole pairs.
//!
//! **The back-EMF is not compensated.** So the torque is not `k_t i*` but, with the winding's pole `R/L` (`s`: Laplace variable),
//!
//! ```text
//! τ = (k_t i* - b ω)/(1 + s L/R)        b = k_t ψ p/R = k_t²/(3/2 R)
//! ```
//!
//! The damping `b` comes from the motor itself, without an encoder, a filter or a delay. Like a resistor across the winding it
//! takes energy for any `R` and `ψ`. Compensating the back-EMF would be a positive feedback of an estimated speed, `+b̂ ω̂`,
//! which is late by at least a control period. If `b̂` is a third too large, a negative damping remains. With the small gimbal
//! motor this damping is -1.1e-4 N·m·s/rad, twelve times the damping of its bearings. A knob that is let go then speeds up.
//!
//! The current is calculated from the voltage given, the encoder's speed and the settings: `i = (v - e)/R`. This value has the
//! same relative error as `R`. The trip current and the heat model of the windings use this current. So they do not protect
//! against a wrong `R`, a shorted phase or an open one. The driver's own protection does, and reports by its error line. See
//! docs/voltage-mode.md.

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

/// Coefficients of the drive by voltage, computed once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoltageStage {
    /// Resistance `R` of the winding, V/A.
    ohms: I16F16,
    /// Conductance `1/R` of the winding, A/V.
    amps_per_volt: I16F16,
    /// Back-EMF in V at a speed of one electrical turn per PWM period.
    back_emf: Volts,
}

/// The constant `2π/(3/2)`, for the back-EMF from the torque constant.
const TWO_PI_OVER_THREE_HALVES: Si = Si::lit("4.188790205");

impl VoltageStage {
    /// Coefficients for a motor on a board; `None` if the board measures its currents.
    ///
    /// # Errors
    /// The back-EMF does not fit its fixed-point format.
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
            // The conductance is at most 100 A/V, because the settings require at least 0.01 ohm.
            amps_per_volt: narrow(quotient(Si::ONE, motor.resistance_ohm)),
            back_emf: narrow(back_emf),
        }))
    }
}

impl CurrentLoop {
    /// Runs a PWM period in which the bridge is on and the motor is driven by voltage, unless a check fails.
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
        // `advance` is in 2^-32 turns.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::current::{CurrentCommand, CurrentMode};
    use crate::{Device, DeviceSettings, wire};
    use touchstone_protocol::Board;

    /// A loop on the board without current sensors after one PWM period that drives the current `share` (d and q). `share` and
    /// `trip_share` are in quarters of the current limit; `bus` is the code of the bus voltage.
    fn after(share: [i32; 2], bus: u16, trip_share: i32) -> CurrentLoop {
        let board = Board::NucleoG474reSimplefocMini;
        let mut settings = DeviceSettings::defaults(board);
        settings.motor.resistance_ohm = Si::lit("5.53");
        settings.motor.inductance_h = Si::lit("0.00105");
        settings.motor.torque_constant_n_m_per_a = Si::lit("0.0565");
        settings.law.force_limit_n_m = Si::lit("0.045");
        let device = Device::new(&settings, wire::hardware(board)).unwrap();
        let mut current = CurrentLoop::new(device.current_config());
        let limit = current.config.limit;
        current.config.trip = limit * trip_share / 4;
        let [d, q] = share.map(|share| limit * share / 4);
        let command = CurrentCommand {
            mode: CurrentMode::Drive,
            tick: 1,
            current: Dq { d, q },
            ..CurrentCommand::OFF
        };
        current.tick(&CurrentSample {
            bus,
            command,
            ..CurrentSample::default()
        });
        current
    }

    const HIGH: u16 = 3_000;

    #[test]
    fn a_current_beyond_the_limit_is_driven_as_the_limit_in_both_directions() {
        for (beyond, at) in [([12, 0], [4, 0]), ([-12, 0], [-4, 0]), ([0, -12], [0, -4])] {
            let [beyond, at] = [beyond, at].map(|share| after(share, HIGH, 8).report.voltage);
            assert_eq!(beyond, at);
            assert_ne!(at, Dq::ZERO);
        }
    }

    #[test]
    fn a_low_bus_shortens_the_vector_and_is_counted() {
        let needs = after([4, 4], HIGH, 8).report.voltage;
        let low = (1..HIGH).find(|bus| after([0, 0], *bus, 8).longest() >= needs.d);
        let low = low.unwrap();
        let current = after([4, 4], low, 8);
        let [d, q, longest] = [
            current.report.voltage.d,
            current.report.voltage.q,
            current.longest(),
        ]
        .map(|volts| volts.to_num::<f64>());
        // `other_side` rounds the d component down to 1/1,024 V, so the vector may be longer by as much.
        let most = longest + 1.0 / 1_024.0;
        assert!(d > 0.0 && d.hypot(q) <= most, "{d} {q} {longest}");
        assert_eq!(current.report.saturated, 1);
        // The d axis alone is shortened, too.
        assert_eq!(after([4, 0], low / 2, 8).report.saturated, 1);
        assert_eq!(after([4, 0], HIGH, 8).report.saturated, 0);
    }

    #[test]
    fn a_current_on_either_axis_trips() {
        for share in [[4, 0], [-4, 0], [0, 4], [0, -4]] {
            assert_eq!(after(share, HIGH, 3).report.trips, 1, "{share:?}");
            assert_eq!(after(share, HIGH, 8).report.trips, 0, "{share:?}");
        }
    }
}
