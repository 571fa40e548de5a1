//! Rendered viscous friction: a part of a feel, and what drags the mass of a rendered inertia.

use super::ratio;
use super::refused::{Refused, within};
use crate::quotient::over;
use crate::{Compliance, Force, Number, Position, Ratio, Settings, Si};

const TWO_PI: Si = Si::lit("6.2831853072");

/// Settings of rendered viscous friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViscousSettings {
    /// Damping, N·m·s/rad (N·s/m), from 0. The largest value depends on inertia and delay: see [`ViscousSettings::most`].
    pub damping: Si,
    /// Bandwidth of the low-pass filter of first order through which the velocity passes, Hz, 5 to 500.
    pub bandwidth_hz: Si,
}

impl ViscousSettings {
    /// The largest damping, N·m·s/rad (N·s/m), for a device with these settings: `J/(4 (T + delay + 1/(2π p)))` with the inertia
    /// `J`, the delay of the state estimator, the control period `T` and the filter's bandwidth `p`.
    ///
    /// A damper whose force acts late by the time `τ` makes a free inertia oscillate if its damping is `J/τ` or more. A quarter of
    /// that is also safe for a device of half the inertia: there the filter alone gives a damping ratio of 0.7.
    #[must_use]
    pub fn most(&self, settings: &Settings) -> Si {
        let rate = Si::saturating_from_num(settings.rate_hz);
        let late = over(Si::ONE, rate)
            .saturating_add(settings.estimator.delay_s)
            .saturating_add(over(Si::ONE, self.bandwidth_hz.saturating_mul(TWO_PI)));
        over(
            settings.estimator.inertia,
            late.saturating_mul(Si::const_from_int(4)),
        )
    }

    /// Checks the settings and computes the coefficients.
    ///
    /// # Errors
    /// A setting is outside its range.
    pub fn viscous<N: Number>(&self, settings: &Settings) -> Result<Viscous<N>, Refused> {
        const DAMPING: &str = "environment.damper.damping_n_m_s_per_rad";
        const BANDWIDTH: &str = "environment.damper.bandwidth_hz";
        let (slowest, fastest) = const { (Si::lit("5"), Si::lit("500")) };
        within(BANDWIDTH, self.bandwidth_hz, slowest, fastest)?;
        within(DAMPING, self.damping, Si::ZERO, self.most(settings))?;
        let rate = Si::saturating_from_num(settings.rate_hz);
        let pole = self.bandwidth_hz.saturating_mul(TWO_PI);
        let kept = over(Si::ONE, Si::ONE.saturating_add(over(pole, rate)));
        let per_way = self.damping.saturating_mul(pole).saturating_mul(kept);
        Ok(Viscous {
            kept: Ratio(ratio::<N>(BANDWIDTH, kept)?),
            per_way: Compliance(ratio::<N>(DAMPING, per_way)?),
            most: Force(N::saturating_signal(settings.force_limit)),
            force: Force::zero(),
        })
    }
}

/// Rendered viscous friction, `f(n) = a f(n-1) + (1-a) b Δ/T`: a damper `b` behind a low-pass filter.
///
/// The filter's memory is the force. Both products round towards zero, so the force of a device at rest ends at exactly zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscous<N: Number> {
    /// The part `a` of the last force that remains after a tick.
    pub kept: Ratio<N>,
    /// Force per displacement in a tick, `(1-a) b/T`, N·m/rad (N/m).
    pub per_way: Compliance<N>,
    /// The force limit.
    pub most: Force<N>,
    /// Force of the last tick.
    pub force: Force<N>,
}

impl<N: Number> Viscous<N> {
    /// Runs one control period: takes the displacement since the last tick, returns the force against the motion.
    #[inline]
    pub fn tick(&mut self, moved: Position<N>) -> Force<N> {
        let kept = self.kept.share_of_force(self.force);
        let news = Force(N::scale(self.per_way.0, moved.0));
        self.force = (kept + news).within(self.most);
        self.force
    }
}
