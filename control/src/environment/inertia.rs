//! Rendered inertia: the part of a knob's feel that makes the device heavier to speed up and to slow down.
//!
//! The force of a mass needs the acceleration, which an encoder gives late and in steps. This part needs no acceleration: it
//! **drags a virtual mass** behind the device by a damper `b`, with the force `f = b (v - u)` for velocities `v` of the device
//! and `u` of the mass. Let `y` be the distance by which the device is ahead of that mass, and `p` the bandwidth in rad/s. With a
//! mass `m = b/p` the distance is a high-pass of the displacement, `y' = v - p y`, and the force is `b y'`. The part adds the
//! mechanical impedance `m p s/(s + p)` to the device: that of the mass `m` for motions slower than `p`, that of the damper for
//! faster ones. At no frequency is the force larger than that of the damper `b` alone.
//!
//! A damper to a free mass has no source of energy. The energy that sampling and delay add is bounded as for
//! [viscous friction](super::ViscousSettings::most), and the energy guard counts it.
//!
//! At constant speed the mass has the device's speed, `y` is constant, and the force is 0. A device at rest has a force of exactly
//! 0 once `y` has decayed.

use super::refused::{Refused, within};
use super::viscous::{Viscous, ViscousSettings};
use crate::quotient::over;
use crate::{Force, Number, Position, Ratio, Settings, Si};

/// Path of the inertia in a scene.
const INERTIA: &str = "environment.inertia.inertia_kg_m2";
/// Path of the bandwidth in a scene.
const BANDWIDTH: &str = "environment.inertia.bandwidth_hz";

/// Bandwidth of the low-pass filter of the drag, Hz: that of viscous friction by default.
const FILTER_HZ: Si = Si::lit("100");

/// Settings of rendered inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InertiaSettings {
    /// The virtual mass, kg·m² (kg), from 0. The largest value depends on the device: see [`InertiaSettings::heaviest`].
    pub inertia: Si,
    /// Bandwidth, Hz, 5 to 30. Slower motions feel the mass, faster ones only the damper that drags it.
    pub bandwidth_hz: Si,
}

impl InertiaSettings {
    /// The largest virtual mass, kg·m² (kg), for a device with these settings. `beside` is the damping of the viscous friction
    /// that the device renders as well. The damper that drags the mass and that friction together are at most the largest viscous
    /// friction behind the same filter, `J/(4 (T + delay + 1/(2π 100 Hz)))`; the mass is the damper over `2π` times the
    /// bandwidth.
    #[must_use]
    pub fn heaviest(&self, settings: &Settings, beside: Si) -> Si {
        let damper = ViscousSettings {
            damping: Si::ZERO,
            bandwidth_hz: FILTER_HZ,
        };
        let left = damper.most(settings).saturating_sub(beside).max(Si::ZERO);
        over(left, self.bandwidth_hz.saturating_mul(Si::TAU))
    }

    /// Checks the settings and computes the coefficients. `beside` is the damping of the rendered viscous friction.
    ///
    /// # Errors
    /// A setting is outside its range.
    pub fn rendered<N: Number>(
        &self,
        settings: &Settings,
        beside: Si,
    ) -> Result<Dragged<N>, Refused> {
        let (lowest, highest) = const { (Si::lit("5"), Si::lit("30")) };
        within(BANDWIDTH, self.bandwidth_hz, lowest, highest)?;
        let heaviest = self.heaviest(settings, beside);
        within(INERTIA, self.inertia, Si::ZERO, heaviest)?;
        let pole = self.bandwidth_hz.saturating_mul(Si::TAU);
        let rate = Si::saturating_from_num(settings.rate_hz);
        let kept = over(Si::ONE, Si::ONE.saturating_add(over(pole, rate)));
        let too_large = Refused::PartOfFormat {
            path: INERTIA,
            value: self.inertia,
        };
        let mut damper = ViscousSettings {
            damping: Si::ZERO,
            bandwidth_hz: FILTER_HZ,
        };
        // Rounding alone could raise the damping above its largest value.
        damper.damping = self.inertia.saturating_mul(pole).min(damper.most(settings));
        Ok(Dragged {
            kept: Ratio(N::ratio(kept).ok_or(too_large)?),
            ahead: Position::zero(),
            damper: damper.viscous(settings).map_err(|_| too_large)?,
        })
    }
}

/// A virtual mass that the device drags behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dragged<N: Number> {
    /// The part of the distance to the mass that remains after a tick.
    pub kept: Ratio<N>,
    /// Distance by which the device is ahead of the mass.
    pub ahead: Position<N>,
    /// The damper between device and mass, behind its filter.
    pub damper: Viscous<N>,
}

impl<N: Number> Dragged<N> {
    /// Runs one control period: takes the displacement since the last tick, returns the force against the device's motion
    /// relative to the mass.
    ///
    /// The product rounds towards zero, so the distance of a device at rest ends at exactly zero.
    #[inline]
    pub fn drag(&mut self, moved: Position<N>) -> Force<N> {
        let before = self.ahead;
        self.ahead = self.kept * before + moved;
        self.damper.tick(self.ahead - before)
    }

    /// Clears the memory, when the force is switched on.
    pub(super) fn let_go(&mut self) {
        self.ahead = Position::zero();
        self.damper.force = Force::zero();
    }
}
