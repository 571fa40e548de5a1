//! Constants of each board's analogue parts, without pins: the conversion of readings to volts and amperes. Each board's file
//! states the source of each number.

mod b_g431b_esc1;
mod ihm08m1;
mod ihm16m1;
mod simplefoc_mini;

pub use b_g431b_esc1::B_G431B_ESC1;
pub use ihm08m1::IHM08M1;
pub use ihm16m1::IHM16M1;
pub use simplefoc_mini::SIMPLEFOC_MINI;

use crate::modulation::Modulator;
use crate::thermistor::Thermistor;
use crate::units::clamp_i32;
use touchstone_control::Si;

/// A board's power stage. Readings are codes of the analogue-to-digital converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hardware {
    /// PWM rate, which is also the rate of the current loop, Hz.
    pub pwm_hz: u32,
    /// Processor clock, Hz: the rate of the cycles in [`crate::timing`].
    pub core_hz: u32,
    /// The timer's compare value at which a phase is always high. The timer counts up and down, so it is `core_hz / (2 pwm_hz)`.
    pub timer_top: u16,
    /// Timer counts for which a phase's low side must be on so that its shunt can be sampled: dead time, settling, conversion.
    pub sampling_counts: u16,
    /// Whether the board measures the motor's currents. If not, the motor is driven by voltage ([`crate::current`]), and
    /// `amps_per_code` and the three constants `offset_…` have no meaning.
    pub senses_current: bool,
    /// Current into the motor in A per code of the analogue-to-digital converter. It is negative for shunts below the low-side
    /// transistors with amplifiers that do not invert. A current into the motor comes from ground, so it pulls the shunt's upper
    /// end below ground.
    pub amps_per_code: Si,
    /// Bus voltage in V per code of the analogue-to-digital converter.
    pub volts_per_code: Si,
    /// Code of the analogue-to-digital converter at zero current, calculated from the schematic.
    pub offset_code: u16,
    /// Largest allowed difference between a measured offset and `offset_code`, in codes of the analogue-to-digital converter.
    pub offset_tolerance: u16,
    /// Largest allowed difference between two readings at zero current, in codes of the analogue-to-digital converter.
    pub offset_spread: u16,
    /// Largest current limit that settings may have on this board, A: the range of the sensors, less a reserve.
    pub current_max_a: Si,
    /// Lowest bus voltage at which the gate drivers work, V.
    pub bus_min_v: Si,
    /// Highest bus voltage that the board allows, V.
    pub bus_max_v: Si,
    /// Highest allowed temperature of the power stage, degrees Celsius.
    pub temperature_max_c: Si,
    /// The temperature sensor; [`Thermistor::NONE`] if the board has none.
    pub thermistor: Thermistor,
}

/// Timer counts, at 170 MHz, for which a phase's low side must be on so that its shunt can be sampled. The low side turns on a dead
/// time after the compare value, the amplifier settles, and the sample is taken 20 counts before the middle of the on-time.
const fn sampling_counts(dead_time_ns: u16, settling_ns: u16) -> u16 {
    const LEAD: u32 = 20;
    let ns = dead_time_ns as u32 + settling_ns as u32;
    let before = (ns * 170).div_ceil(1_000) + LEAD;
    // The result fits into 16 bits for all arguments: it is at most 2 · 22,283.
    2 * before as u16
}

impl Hardware {
    /// The space-vector modulator for this board's timer.
    #[must_use]
    pub const fn modulator(&self) -> Modulator {
        Modulator {
            top: self.timer_top,
            // The low side is on around the timer's top, while the counter is above the compare value, going up and going down.
            longest: self.timer_top.saturating_sub(self.sampling_counts / 2),
        }
    }

    /// Whether the motor is driven by voltage because the board has no current sensors. In a program for boards with sensors only,
    /// the compiler evaluates this.
    #[inline(always)]
    #[must_use]
    pub const fn gives_voltage(&self) -> bool {
        cfg!(feature = "voltage") && !self.senses_current
    }

    /// Current in A per code of the analogue-to-digital converter, with 28 fractional bits.
    #[must_use]
    pub const fn amps_per_code_bits(&self) -> i32 {
        clamp_i32(self.amps_per_code.to_bits() >> 4)
    }
}
