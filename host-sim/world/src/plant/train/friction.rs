//! Dry friction of the shaft: its kinds and their levels.

/// Dry friction in one direction of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// In motion, N·m; zero or more.
    pub kinetic: f64,
    /// Largest at rest, N·m; at least the kinetic one.
    pub breakaway: f64,
}

/// LuGre friction (Canudas de Wit, Olsson, Åström and Lischinsky, IEEE TAC 40(3) 419, 1995): bristles with a deflection `z`,
/// `z' = v - s0 |v| z / g(v)` and `F = s0 z + s1 z'`, with `g` as [`Friction::Dry`]'s level. Its viscous part is the device's
/// damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuGre {
    /// Stiffness of the bristles `s0`, N·m/rad; above zero.
    pub stiffness: f64,
    /// Damping of the bristles `s1`, N·m·s/rad; zero or more.
    pub damping: f64,
    /// `g` for fast motion, above zero, and for slow; in positive and in negative motion.
    pub directions: [Sliding; 2],
    /// Velocity at which `g` has come down to `1/e` of the way, rad/s, above zero; absent: it is that of fast motion.
    pub stribeck: Option<f64>,
}

/// Friction at the shaft.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Friction {
    /// No friction.
    #[default]
    None,
    /// Set-valued at rest; in motion `kinetic + (breakaway - kinetic) exp(-(v/stribeck)^2)`, or `kinetic` alone.
    Dry {
        /// Levels for positive and for negative motion.
        directions: [Sliding; 2],
        /// Stribeck's velocity, rad/s; absent: the break-away torque is for rest alone.
        stribeck: Option<f64>,
    },
    /// Friction modelled by bristles.
    Bristles(LuGre),
}

/// Stribeck's curve.
#[inline(always)]
pub(super) fn level(sliding: &Sliding, stribeck: Option<f64>, velocity: f64) -> f64 {
    let Some(stribeck) = stribeck else {
        return sliding.kinetic;
    };
    let share = velocity / stribeck;
    sliding.kinetic + (sliding.breakaway - sliding.kinetic) * libm::exp(-share * share)
}
