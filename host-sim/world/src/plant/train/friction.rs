//! Models of dry friction at the motor's shaft.

/// Levels of dry friction in one direction of motion: sliding and at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Friction torque in motion, N·m; zero or more.
    pub kinetic: f64,
    /// Largest friction torque at rest, N·m; at least `kinetic`.
    pub breakaway: f64,
}

/// LuGre friction (Canudas de Wit, Olsson, Åström and Lischinsky, IEEE TAC 40(3) 419, 1995): elastic bristles with a deflection
/// `z`.
///
/// The model is `z' = v - s0 |v| z / g(v)` and `F = s0 z + s1 z'`. `v` is the velocity, `F` the friction torque, `s0` and `s1` are
/// stiffness and damping of the bristles. `g` is the friction level over velocity as in [`Friction::Dry`]. The model's viscous part
/// is left to the device's damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuGre {
    /// Stiffness of the bristles `s0`, N·m/rad; above zero.
    pub stiffness: f64,
    /// Damping of the bristles `s1`, N·m·s/rad; zero or more.
    pub damping: f64,
    /// Levels of the friction torque for positive and for negative motion: `kinetic` (above zero) for fast motion, `breakaway` for
    /// slow motion.
    pub directions: [Sliding; 2],
    /// Stribeck velocity, rad/s, above zero. There the friction has fallen from `breakaway` towards `kinetic` until `1/e` of the
    /// difference is left. `None`: the friction is `kinetic` at every velocity.
    pub stribeck: Option<f64>,
}

/// The model of dry friction at the shaft.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Friction {
    /// No friction.
    #[default]
    None,
    /// Dry friction that holds the shaft at rest up to `breakaway`. In motion its torque is `kinetic + (breakaway - kinetic)
    /// exp(-(v/stribeck)^2)` at the velocity `v`, or `kinetic` without a Stribeck velocity.
    Dry {
        /// Friction levels for positive and for negative motion.
        directions: [Sliding; 2],
        /// Stribeck velocity, rad/s; `None`: the break-away torque applies at rest only.
        stribeck: Option<f64>,
    },
    /// Dry friction modelled by elastic bristles (LuGre model).
    Bristles(LuGre),
}

/// Friction torque at a velocity, N·m, by Stribeck's curve from `breakaway` to `kinetic`.
#[inline(always)]
pub(super) fn level(sliding: &Sliding, stribeck: Option<f64>, velocity: f64) -> f64 {
    let Some(stribeck) = stribeck else {
        return sliding.kinetic;
    };
    let share = velocity / stribeck;
    sliding.kinetic + (sliding.breakaway - sliding.kinetic) * libm::exp(-share * share)
}
