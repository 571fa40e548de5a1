//! Low-side shunts, their amplifiers and the converter: currents to codes.

/// Reference of the converters, V.
const REFERENCE_V: f64 = 3.3;

/// One phase's current sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shunt {
    /// Current into the motor per code, A; negative where the amplifier inverts.
    pub amps_per_code: f64,
    /// Code without current; a real one lies between two.
    pub offset_code: f64,
    /// Largest code.
    pub full_scale: u16,
}

impl Shunt {
    /// A 12-bit converter.
    #[must_use]
    pub const fn bits12(amps_per_code: f64, offset_code: f64) -> Self {
        Self {
            amps_per_code,
            offset_code,
            full_scale: 4_095,
        }
    }

    /// A 12-bit converter behind an amplifier that does not invert, and a shunt below the lower transistor. A current into the motor
    /// comes from ground through that shunt and pulls its upper end below ground: it lowers the code.
    #[must_use]
    pub const fn low_side(shunt_ohm: f64, gain: f64, offset_code: f64) -> Self {
        Self::bits12(-REFERENCE_V / 4_096.0 / (shunt_ohm * gain), offset_code)
    }

    /// The code for a current.
    #[must_use]
    pub fn code(&self, current_a: f64) -> u16 {
        let exact = self.offset_code + current_a / self.amps_per_code;
        // The cast saturates and takes NaN to 0.
        (exact.round().clamp(0.0, f64::from(self.full_scale))) as u16
    }
}
