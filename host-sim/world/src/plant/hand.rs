//! The simulated operator: a hand that holds the device through a fingertip's pad.

use super::device::{Invalid, not_negative, positive};

/// A hand, modelled as one mass. The fingertip pad (spring and damper) joins it to the device, and a spring joins it to a moving
/// rest point.
///
/// The pad is needed for realism. A hand rigidly on the device would add its damping of about 1e-3 N·m·s/rad to the knob's 4e-4 and
/// make every wall of the thesis stable. With the pad in between, the device is alone with the wall at high frequency. The
/// disadvantage is a second mass with two states.
///
/// The rest point `r` is the angle to which the person wants to move the hand. It is held during a control period (zero-order
/// hold), like the torque. Voluntary motion has frequencies up to about 10 Hz, so at a control rate of 1 kHz the steps of the
/// rest point are small. The energy balance includes the steps' work on the spring (see [`super::Stepper::stored_energy_j`]). The
/// damper `b_h` acts from the hand to ground and not to the rest point, because a held `r` has no velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hand {
    /// Inertia `J_h` of the hand about the knob's axis, kg·m² (kg); above zero.
    pub inertia: f64,
    /// Damping `b_h` of the hand to ground, N·m·s/rad (N·s/m); zero or more.
    pub damping: f64,
    /// Stiffness `k_h` of the hand to its rest point, N·m/rad (N/m); zero or more.
    pub stiffness: f64,
    /// Damping `b_p` of the pad between device and hand, N·m·s/rad (N·s/m); zero or more.
    pub pad_damping: f64,
    /// Stiffness `k_p` of the pad between device and hand, N·m/rad (N/m); zero or more.
    pub pad_stiffness: f64,
}

/// Square of the radius of 15 mm at which fingers grip a knob, m². It converts stiffness in N/m to N·m/rad, and mass in kg to
/// kg·m².
const GRIP_RADIUS_SQUARED_M2: f64 = 2.25e-4;

/// Makes a grip of a knob from mass, damping and stiffness at the fingertip. Only the pad's damping is already rotary, N·m·s/rad,
/// see [`MEDIUM`].
const fn grip(
    mass_kg: f64,
    damping_n_s_per_m: f64,
    stiffness_n_per_m: f64,
    pad_stiffness_n_per_m: f64,
    pad_damping: f64,
) -> Hand {
    Hand {
        inertia: mass_kg * GRIP_RADIUS_SQUARED_M2,
        damping: damping_n_s_per_m * GRIP_RADIUS_SQUARED_M2,
        stiffness: stiffness_n_per_m * GRIP_RADIUS_SQUARED_M2,
        pad_damping,
        pad_stiffness: pad_stiffness_n_per_m * GRIP_RADIUS_SQUARED_M2,
    }
}

/// A light touch of a knob at a radius of 15 mm: hand 0.1 kg, 1 N·s/m, 30 N/m, fingertip pad 300 N/m. Chosen, not measured, see
/// [`MEDIUM`].
pub const LIGHT: Hand = grip(0.1, 1.0, 30.0, 300.0, 0.33e-4);

/// An ordinary grip of a knob at a radius of 15 mm: hand 0.3 kg, 3 N·s/m, 100 N/m, fingertip pad 700 N/m.
///
/// **Chosen, not measured.** Mass, damping and stiffness are within the range of hand models in the literature. The pad's damping
/// follows from the thesis. The thesis found its damping `c_i` of 5e-4 N·m·s/rad by feel, with a finger on the knob, so `c_i` is
/// the sum of device and fingertip. With 4e-4 N·m·s/rad for the knob, 1e-4 is left for the pad of this grip. The pads of the other
/// two grips have the ratios of published values, which grow with the force of the grip.
pub const MEDIUM: Hand = grip(0.3, 3.0, 100.0, 700.0, 1.0e-4);

/// A firm grip of a knob at a radius of 15 mm: hand 0.8 kg, 5.5 N·s/m, 300 N/m, fingertip pad 2000 N/m. Chosen, not measured, see
/// [`MEDIUM`].
pub const FIRM: Hand = grip(0.8, 5.5, 300.0, 2000.0, 3.3e-4);

impl Hand {
    /// Checks that every field is in the range that the field's comment gives.
    ///
    /// # Errors
    /// [`Invalid`] names the first field out of range.
    pub fn validate(&self) -> Result<(), Invalid> {
        positive("hand.inertia", self.inertia)?;
        not_negative("hand.damping", self.damping)?;
        not_negative("hand.stiffness", self.stiffness)?;
        not_negative("hand.pad_damping", self.pad_damping)?;
        not_negative("hand.pad_stiffness", self.pad_stiffness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grips_are_valid_and_grow() {
        for hand in [LIGHT, MEDIUM, FIRM] {
            assert_eq!(hand.validate(), Ok(()));
        }
        for pair in [LIGHT, MEDIUM, FIRM].windows(2) {
            assert!(pair[0].inertia < pair[1].inertia);
            assert!(pair[0].pad_stiffness < pair[1].pad_stiffness);
            assert!(pair[0].pad_damping < pair[1].pad_damping);
        }
    }

    #[test]
    fn medium_grip_and_thesis_knob_sum_to_the_thesis_damping() {
        let knob = 4e-4;
        assert!((knob + MEDIUM.pad_damping - 5e-4).abs() < 1e-18);
    }

    #[test]
    fn linear_values_are_converted_with_the_square_of_the_radius() {
        assert!((MEDIUM.inertia - 6.75e-5).abs() < 1e-18);
        assert!((MEDIUM.stiffness - 0.0225).abs() < 1e-15);
        assert!((FIRM.pad_stiffness - 0.45).abs() < 1e-15);
        assert!((LIGHT.damping - 2.25e-4).abs() < 1e-18);
    }
}
