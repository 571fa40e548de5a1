//! Low-side shunts, their amplifiers and the converter: currents to codes.

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

    /// The code for a current.
    #[must_use]
    pub fn code(&self, current_a: f64) -> u16 {
        let exact = self.offset_code + current_a / self.amps_per_code;
        // The cast saturates and takes NaN to 0.
        (exact.round().clamp(0.0, f64::from(self.full_scale))) as u16
    }
}
