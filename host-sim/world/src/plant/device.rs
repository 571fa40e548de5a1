//! A simulated device: one inertia, viscous damping, and optional dry friction.

/// A device with one axis. Units are those of a knob; those of a translational axis follow in brackets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Device {
    /// Inertia `J` of everything that turns with the knob, kg·m² (kg); above zero.
    pub inertia: f64,
    /// Viscous damping `b` of the device to ground, N·m·s/rad (N·s/m); zero or more.
    ///
    /// It is the damping of the device alone. The thesis' damping `c_i`, found by feel, includes the fingertip's damping, see
    /// [`super::Hand`].
    pub damping: f64,
    /// Dry friction of the device to ground; `None` for a device without dry friction.
    pub friction: Option<Coulomb>,
}

/// Coulomb friction with a separate level at rest (Amontons–Coulomb).
///
/// While the device turns, the friction torque is `kinetic` against the motion. At rest it balances all other torques on the device
/// up to `breakaway` inclusive. A larger torque sets the device in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// Friction torque in motion `F_k`, N·m (N); zero or more.
    pub kinetic: f64,
    /// Largest friction torque at rest `F_s`, N·m (N); at least `kinetic`.
    pub breakaway: f64,
}

/// The error for a plant parameter that is out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{field} is {value}, it must be {needs}")]
pub struct Invalid {
    /// Name of the field in its struct.
    pub field: &'static str,
    /// The refused value.
    pub value: f64,
    /// The accepted range, in words.
    pub needs: &'static str,
}

impl Device {
    /// Checks that every field is in the range that the field's comment gives.
    ///
    /// # Errors
    /// [`Invalid`] names the first field out of range.
    pub fn validate(&self) -> Result<(), Invalid> {
        positive("inertia", self.inertia)?;
        not_negative("damping", self.damping)?;
        self.friction.map_or(Ok(()), |friction| friction.validate())
    }

    /// Dry friction of the device, for steppers that need it.
    ///
    /// # Errors
    /// [`Invalid`] for a device without friction.
    pub(super) fn required_friction(&self) -> Result<Coulomb, Invalid> {
        self.friction.ok_or(Invalid {
            field: "friction",
            value: f64::NAN,
            needs: "given for a stepper with Coulomb friction",
        })
    }
}

impl Coulomb {
    /// Checks that every field is in the range that the field's comment gives.
    ///
    /// # Errors
    /// [`Invalid`] names the first field out of range.
    pub fn validate(&self) -> Result<(), Invalid> {
        not_negative("kinetic", self.kinetic)?;
        not_negative("breakaway", self.breakaway)?;
        if self.breakaway < self.kinetic {
            return Err(Invalid {
                field: "breakaway",
                value: self.breakaway,
                needs: "at least kinetic",
            });
        }
        Ok(())
    }
}

pub(crate) fn positive(field: &'static str, value: f64) -> Result<(), Invalid> {
    // A subnormal inertia has no finite reciprocal.
    let ok = value.is_normal() && value > 0.0;
    ok.then_some(()).ok_or(Invalid {
        field,
        value,
        needs: "finite and above zero",
    })
}

pub(crate) fn not_negative(field: &'static str, value: f64) -> Result<(), Invalid> {
    let ok = value.is_finite() && value >= 0.0;
    ok.then_some(()).ok_or(Invalid {
        field,
        value,
        needs: "finite and zero or more",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOB: Device = Device {
        inertia: 1e-4,
        damping: 5e-4,
        friction: Some(Coulomb {
            kinetic: 2e-3,
            breakaway: 2e-3,
        }),
    };

    #[test]
    fn each_field_out_of_range_is_named() {
        assert_eq!(KNOB.validate(), Ok(()));
        for inertia in [0.0, -1e-4, f64::NAN, f64::INFINITY, 1e-310] {
            let field = Device { inertia, ..KNOB }.validate().unwrap_err().field;
            assert_eq!(field, "inertia", "{inertia}");
        }
        for damping in [-1e-9, f64::NAN, f64::INFINITY] {
            let field = Device { damping, ..KNOB }.validate().unwrap_err().field;
            assert_eq!(field, "damping", "{damping}");
        }
        for (kinetic, stat, field) in [
            (-1e-3, 1e-3, "kinetic"),
            (1e-3, f64::NAN, "breakaway"),
            (2e-3, 1e-3, "breakaway"),
        ] {
            let friction = Coulomb {
                kinetic,
                breakaway: stat,
            };
            let device = Device {
                friction: Some(friction),
                ..KNOB
            };
            assert_eq!(device.validate().unwrap_err().field, field);
        }
        assert_eq!(
            Device {
                friction: None,
                damping: 0.0,
                ..KNOB
            }
            .validate(),
            Ok(())
        );
    }

    #[test]
    fn the_message_says_what_to_mend() {
        let error = Device {
            inertia: -1.0,
            ..KNOB
        }
        .validate()
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "inertia is -1, it must be finite and above zero"
        );
    }
}
