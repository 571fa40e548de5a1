//! The two current controllers, for the d and q axes: proportional and integral, with an integrator that cannot wind up.
//!
//! A winding obeys `L di/dt = v - R i - e`, with inductance `L`, resistance `R`, voltage `v` and back-EMF `e`. With the gains `k_p
//! = ω L` and `k_i = ω R` the controller's zero cancels the winding's pole, and the loop is a first-order lag of bandwidth `ω`. The
//! integrator contains the voltage limit; `i*` is the requested current, `s` the integral, `T` the PWM period:
//!
//! ```text
//! v  = limited(k_p (i* - i) + s)
//! s' = s + (R T/L) (v - s)
//! ```
//!
//! Below the limit this is the usual sum, `s' = s + k_i T (i* - i)`. At the limit `s` follows the real voltage with the winding's
//! own time constant. So when the limit is left, `s` is the voltage of the resistance: there is no wind-up and no tail (Hanus'
//! conditioned controller). Because `s'` is a weighted mean of `s` and `v`, it never exceeds the larger of the limit and its
//! earlier value. If the bus voltage falls, `s` follows.

use crate::settings::out_of_format;
use crate::units::{clamp_i32, narrow, product, quotient, share_of};
use crate::{Amps, Volts};
use fixed::types::I16F16;
use touchstone_control::Si;
use touchstone_protocol::settings::SettingsError;

/// Gains of a current controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PiGains {
    /// Proportional gain in V/A: bandwidth `ω` (rad/s) times inductance `L`.
    pub proportional: I16F16,
    /// Fraction (in 1/65,536) by which the integral approaches the voltage in a PWM period `T`: `R T/L`, with the winding's
    /// resistance `R` and inductance `L`.
    pub share: u16,
}

/// The constant `2π`.
const TWO_PI: Si = Si::lit("6.283185307");

impl PiGains {
    /// Gains of zero, for a loop that never drives a motor.
    pub const NONE: Self = Self {
        proportional: I16F16::ZERO,
        share: 0,
    };

    /// Gains from resistance and inductance of a winding (phase to star point), the bandwidth, and the loop's rate.
    ///
    /// # Errors
    /// A gain does not fit its fixed-point format: the inductance is so large or so small that a PWM period does not resolve the
    /// winding.
    #[inline]
    pub fn new(
        resistance_ohm: Si,
        inductance_h: Si,
        bandwidth_hz: Si,
        loop_rate_hz: Si,
    ) -> Result<Self, SettingsError> {
        let proportional = bandwidth_hz
            .saturating_mul(TWO_PI)
            .saturating_mul(inductance_h);
        let share = quotient(quotient(resistance_ohm, inductance_h), loop_rate_hz);
        let gain = narrow(proportional);
        if gain <= I16F16::ZERO || gain == I16F16::MAX {
            return Err(out_of_format("motor.inductance_h", proportional));
        }
        let bits = share.to_bits() >> 16;
        match u16::try_from(bits) {
            Ok(share) if share > 0 => Ok(Self {
                proportional: gain,
                share,
            }),
            _ => Err(out_of_format("motor.resistance_ohm", share)),
        }
    }
}

/// Memory of one current controller: its integral in V, which settles at the voltage of the winding's resistance and back-EMF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pi {
    integral: Volts,
}

impl Pi {
    /// A controller with a given integral, V.
    #[must_use]
    pub const fn of(integral: Volts) -> Self {
        Self { integral }
    }

    /// The controller's integral, V.
    #[must_use]
    pub const fn integral(&self) -> Volts {
        self.integral
    }

    /// Runs one PWM period: takes the error of the current, returns a voltage within `-limit..=limit` and whether the limit acted.
    #[inline]
    pub fn tick(&mut self, gains: &PiGains, error: Amps, limit: Volts) -> (Volts, bool) {
        let wanted = Volts::from_bits(product(gains.proportional.to_bits(), error.to_bits(), 16))
            .saturating_add(self.integral);
        let given = wanted.min(limit).max(limit.saturating_neg());
        let way = i64::from(given.to_bits()) - i64::from(self.integral.to_bits());
        // Rounded to the nearest step, so that small errors are not lost in one direction only.
        let step = share_of(way, gains.share);
        self.integral = Volts::from_bits(clamp_i32(i64::from(self.integral.to_bits()) + step));
        (given, given != wanted)
    }

    /// Clears the integral, for a period in which the bridge is off.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
