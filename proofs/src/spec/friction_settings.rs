//! Specification of `FrictionSettings::friction`: the coefficients that follow from a user's settings. Read it beside the header of
//! `control/src/space/friction.rs`.

use super::Int;
use super::settings::{ONE, between, gain_fits, gain_of, over, signal_fits, signal_of, times};

/// Settings of the friction as integers, in units of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Stiffness of the friction's spring, N/m.
    pub stiffness: Int,
    /// Coefficient of static friction.
    pub fixed: Int,
    /// Coefficient of kinetic friction.
    pub kinetic: Int,
}

/// The friction's coefficients: stiffness of its spring, and how far the spring stretches per newton of normal force before and
/// while it slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Friction {
    /// Stiffness of the friction's spring, in the number format of stiffnesses.
    pub stiffness: Int,
    /// Static friction: largest stretch per newton of normal force (coefficient divided by stiffness), in the number format of
    /// ratios.
    pub fixed: Int,
    /// Kinetic friction: stretch per newton of normal force (coefficient divided by stiffness), in the number format of ratios.
    pub kinetic: Int,
}

/// The friction's coefficients in a unit of length of which `per_metre` make a metre, for a device with a control rate in Hz and a
/// damping. `None` unless the stiffness is above 0 and at most twice the damping per tick, the coefficients are `0 <= kinetic <=
/// fixed <= 10`, and all results fit.
#[must_use]
pub fn made(set: &Settings, per_metre: Int, rate: Int, damping: Int) -> Option<Friction> {
    let most = times(times(damping, rate * ONE), 2 * ONE);
    let fits = between(1, set.stiffness, most)
        && between(0, set.kinetic, set.fixed)
        && set.fixed <= 10 * ONE;
    if !fits {
        return None;
    }
    let stiffness = over(set.stiffness, per_metre * ONE);
    let (fixed, kinetic) = (over(set.fixed, stiffness), over(set.kinetic, stiffness));
    let fits = gain_fits(stiffness) && signal_fits(fixed) && signal_fits(kinetic);
    fits.then(|| Friction {
        stiffness: gain_of(stiffness),
        fixed: signal_of(fixed),
        kinetic: signal_of(kinetic),
    })
}
