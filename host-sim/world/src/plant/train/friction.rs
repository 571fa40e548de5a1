//! Models of dry friction at the shaft.

/// Levels of dry friction in one direction of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Friction torque in motion, N·m; zero or more.
    pub kinetic: f64,
    /// Largest friction torque at rest, N·m; at least the kinetic one.
    pub breakaway: f64,
}

/// LuGre friction (Canudas de Wit, Olsson, Åström and Lischinsky, IEEE TAC 40(3) 419, 1995): elastic bristles with a deflection
/// `z`.
///
/// `z' = v - s0 |v| z / g(v)` and `F = s0 z + s1 z'`, where `g` is the level of friction as in [`Friction::Dry`]. The model's
/// viscous part is the device's damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuGre {
    /// Stiffness of the bristles `s0`, N·m/rad; above zero.
    pub stiffness: f64,
    /// Damping of the bristles `s1`, N·m·s/rad; zero or more.
    pub damping: f64,
    /// Levels of `g`: `kinetic` for fast motion (above zero), `breakaway` for slow motion; for positive and for negative motion.
    pub directions: [Sliding; 2],
    /// Stribeck velocity, at which `g` has fallen to `1/e` of the way from slow to fast motion, rad/s, above zero. `None`: `g` is
    /// the level of fast motion everywhere.
    pub stribeck: Option<f64>,
}

/// The model of dry friction at the shaft.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Friction {
    /// No friction.
    #[default]
    None,
    /// Set-valued friction at rest. In motion its torque is `kinetic + (breakaway - kinetic) exp(-(v/stribeck)^2)`, or `kinetic`
    /// without a Stribeck velocity.
    Dry {
        /// Friction levels for positive and for negative motion.
        directions: [Sliding; 2],
        /// Stribeck velocity, rad/s; `None`: the break-away torque applies at rest only.
        stribeck: Option<f64>,
    },
    /// Friction by elastic bristles (LuGre).
    Bristles(LuGre),
}

/// Friction torque at a velocity by Stribeck's curve, N·m.
#[inline(always)]
pub(super) fn level(sliding: &Sliding, stribeck: Option<f64>, velocity: f64) -> f64 {
    let Some(stribeck) = stribeck else {
        return sliding.kinetic;
    };
    let share = velocity / stribeck;
    sliding.kinetic + (sliding.breakaway - sliding.kinetic) * libm::exp(-share * share)
}
