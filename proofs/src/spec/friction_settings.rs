//! Specification of `FrictionSettings::friction`: the coefficients that follow from a user's settings. Read it beside the header of
//! `control/src/space/friction.rs`.

use super::Int;
use super::settings::{ONE, between, gain_fits, gain_of, over, signal_fits, signal_of, times};

/// Settings of the friction as integers, in units of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Stiffness, N/m.
    pub stiffness: Int,
    /// Coefficient of static friction, `μ_s`.
    pub fixed: Int,
    /// Coefficient of kinetic friction, `μ_k`.
    pub kinetic: Int,
}

/// The friction's stiffness as a gain. Also how far it stretches per newton before and while it slides, as ratios.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Friction {
    /// Stiffness `k`, in the format of gains.
    pub stiffness: Int,
    /// Static friction: `μ_s/k`, in the format of ratios.
    pub fixed: Int,
    /// Kinetic friction: `μ_k/k`, in the format of ratios.
    pub kinetic: Int,
}

/// The friction in a unit of length of which `per_metre` make a metre, for a device with a control rate in Hz and a damping. `None`
/// unless `0 < k <= 2 b/T`, `0 <= μ_k <= μ_s <= 10` and all coefficients fit.
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
