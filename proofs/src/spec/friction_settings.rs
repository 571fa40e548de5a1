//! What `FrictionSettings::friction` makes of a person's settings, beside the header of `control/src/space/friction.rs`.

use super::Int;
use super::settings::{ONE, between, gain_fits, gain_of, over, signal_fits, signal_of, times};

/// Settings, counts of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Stiffness, N/m.
    pub stiffness: Int,
    /// Fixed: `μ_s`.
    pub fixed: Int,
    /// Kinetic: `μ_k`.
    pub kinetic: Int,
}

/// Stiffness, a gain, and how far it stretches for a newton before it slides and while it does, ratios.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Friction {
    /// Stiffness: `k`.
    pub stiffness: Int,
    /// Fixed: `μ_s/k`.
    pub fixed: Int,
    /// Kinetic: `μ_k/k`.
    pub kinetic: Int,
}

/// The friction in a unit, given how many of them are a metre, for a device with a rate, Hz, and a damping: `0 < k <=
/// 2 b/T`, `0 <= μ_k <= μ_s <= 10`, and all coefficients must fit.
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
