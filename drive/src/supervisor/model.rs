//! Detects a motor whose voltages do not fit its currents by the settings: the alignment slipped, or a current sensor is wrong.
//!
//! ```text
//! r_d = v_d - R i_d + ω_e L i_q        a_d = 1/2 V + R |i_q|/16 + ψ |ω|/4
//! r_q = v_q - R i_q - ψ ω              a_q = 1 V + R (|i_d| + |i_q|)/2 + ψ |ω|/2   ψ = k_t/(3/2)
//! ```
//!
//! Here `v` is the voltage and `i` the current on the axes d and q, `R` and `L` are resistance and inductance of the windings. `ω`
//! is the shaft's speed, `ω_e` the electrical speed, `k_t` the torque constant, `ψ` the flux linkage times the number of pole
//! pairs.
//!
//! `r` is the part of the voltage that the motor's equations do not explain, and `a` the largest such part of a good motor. `3/2
//! r` times the current is the power that is not explained: `3/2 (v·i - R i²)` less the commanded torque times the speed,
//! separately for each axis. Only the equation of the q axis depends much on the windings' resistance, which is known only to
//! within a third. A voltage on the d axis shows an error of the angle.
//!
//! The limit `a` allows:
//!
//! - windings 100 K warmer (39 % more resistance), and an error of 10 % beside it;
//! - ±30 % of the torque constant, and 20 % of the speed, which is late;
//! - on the `d` axis an alignment 14 electrical degrees off, and gains of the sensors that differ by 6 %;
//! - as constants: dead time (0.3 V at 24 V and 500 ns), rounding, and `L di/dt` (0.5 V for a step of 2 A in the small motor).
//!
//! Both `r` and `a` go through the same first-order low-pass filter, with a time constant of 10 to 20 ms. The filter is linear and
//! has positive weights: if `|r| <= a` holds in each control period, it also holds after the filter, so there is no alarm.
//!
//! The check does not detect an error while the shaft hardly turns and the current is the commanded one, since no power is missing
//! then. A board that measures no current calculates it by the same equations, so there the check is left out.

use crate::current::CurrentReport;
use crate::hardware::Hardware;
use crate::units::{clamp_i32, milli, narrow, product, quotient};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::DeviceSettings;

/// Coefficients of the check of the motor's voltages.
#[derive(Debug, Clone, Copy)]
pub struct ModelConfig {
    ohms: I16F16,
    /// Flux linkage times pole pairs: back-EMF per speed of the shaft, V·s/rad.
    flux: I16F16,
    /// Inductance `L` times the number of pole pairs `p`, H.
    henries: I16F16,
    /// Time constant of the low-pass filter in control periods, as a power of two.
    over_log2: u32,
}

impl ModelConfig {
    /// Computes the coefficients from validated settings; `None` for a board that measures no current.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Option<Self> {
        let motor = &settings.motor;
        let pairs = Si::saturating_from_num(motor.pole_pairs);
        hardware.senses_current.then(|| Self {
            ohms: narrow(motor.resistance_ohm),
            flux: narrow(quotient(
                motor.torque_constant_n_m_per_a,
                const { Si::lit("1.5") },
            )),
            henries: narrow(motor.inductance_h.saturating_mul(pairs)),
            over_log2: (settings.timing.rate_hz / 50).max(1).ilog2(),
        })
    }

    /// Coefficients for proofs: resistance in ohm; flux linkage in V·s/rad and inductance in H, both times the pole pairs.
    /// `over_log2` is the base-2 logarithm of the filter's time constant in control periods, up to 24.
    #[must_use]
    pub const fn from_motor(ohms: I16F16, flux: I16F16, henries: I16F16, over_log2: u32) -> Self {
        Self {
            ohms,
            flux,
            henries,
            over_log2,
        }
    }
}

/// Memory of the low-pass filters of the voltages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Model {
    /// Decaying sums of the unexplained voltage `r` and of the allowed voltage `a` on each axis: `r_d`, `a_d`, `r_q`, `a_q`.
    /// Divided by `2^over_log2` they are the filtered voltages, V with 16 fractional bits.
    sums: [i64; 4],
}

impl Model {
    /// The memory before the first control period: all sums are zero.
    #[must_use]
    pub const fn new() -> Self {
        Self { sums: [0; 4] }
    }

    /// The memory with these decaying sums of `r_d`, `a_d`, `r_q` and `a_q`; proofs begin with any.
    #[must_use]
    pub const fn from_filter_sums(sums: [i64; 4]) -> Self {
        Self { sums }
    }

    /// The decaying sums of `r_d`, `a_d`, `r_q` and `a_q`; divided by the filter's time constant in control periods they are V with 16
    /// fractional bits.
    #[must_use]
    pub const fn filter_sums(&self) -> [i64; 4] {
        self.sums
    }

    /// Takes a control period in which the control law drove the motor. `speed`, in rad/s, is positive if the electrical angle
    /// rises. Returns by how much the filtered unexplained voltage exceeds the allowed one, mV; `None` if it does not.
    pub fn update(
        &mut self,
        config: &ModelConfig,
        speed: I16F16,
        report: &CurrentReport,
    ) -> Option<i32> {
        let (i, v) = (report.current, report.voltage);
        let times = |a: I16F16, b: I16F16| i64::from(product(a.to_bits(), b.to_bits(), 16));
        let (drop_d, drop_q) = (times(config.ohms, i.d), times(config.ohms, i.q));
        let emf = times(config.flux, speed);
        let cross = times(
            I16F16::from_bits(product(config.henries.to_bits(), speed.to_bits(), 16)),
            i.q,
        );
        // All terms have 32 bits, so no sum comes near 2^63.
        let now = [
            i64::from(v.d.to_bits()) - drop_d + cross,
            (1 << 15) + (drop_q.abs() >> 4) + (emf.abs() >> 2),
            i64::from(v.q.to_bits()) - drop_q - emf,
            (1 << 16) + ((drop_d.abs() + drop_q.abs()) >> 1) + (emf.abs() >> 1),
        ];
        for (sum, now) in self.sums.iter_mut().zip(now) {
            *sum += now - (*sum >> config.over_log2);
        }
        let [r_d, a_d, r_q, a_q] = self.sums;
        let beyond = (r_d.abs() - a_d).max(r_q.abs() - a_q) >> config.over_log2;
        (beyond > 0).then(|| {
            let volts = I16F16::from_bits(clamp_i32(beyond));
            milli(volts)
        })
    }
}
