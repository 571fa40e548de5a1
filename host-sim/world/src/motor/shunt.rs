//! Current sensors: shunt resistors between the lower transistors and ground, their amplifiers, and the analogue-to-digital
//! converter (ADC), which turns currents into codes.

/// Reference voltage of the analogue-to-digital converters, V.
const REFERENCE_V: f64 = 3.3;

/// The current sensor of one phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shunt {
    /// Current into the motor per code of the analogue-to-digital converter, A; negative if the code falls with the current.
    pub amps_per_code: f64,
    /// ADC code at zero current. On a real board it lies between two codes, so it is not an integer.
    pub offset_code: f64,
    /// Largest code of the analogue-to-digital converter.
    pub full_scale: u16,
}

impl Shunt {
    /// A current sensor with a 12-bit converter.
    #[must_use]
    pub const fn bits12(amps_per_code: f64, offset_code: f64) -> Self {
        Self {
            amps_per_code,
            offset_code,
            full_scale: 4_095,
        }
    }

    /// A current sensor with a shunt below the lower transistor, a non-inverting amplifier, and a 12-bit ADC. A current into the
    /// motor flows from ground through the shunt and pulls the shunt's upper end below ground, so it lowers the code.
    #[must_use]
    pub const fn low_side(shunt_ohm: f64, gain: f64, offset_code: f64) -> Self {
        Self::bits12(-REFERENCE_V / 4_096.0 / (shunt_ohm * gain), offset_code)
    }

    /// ADC code for a current into the motor in A, limited to the range of the converter.
    #[must_use]
    pub fn code(&self, current_a: f64) -> u16 {
        let exact = self.offset_code + current_a / self.amps_per_code;
        // The cast saturates and converts NaN to 0.
        (exact.round().clamp(0.0, f64::from(self.full_scale))) as u16
    }
}
