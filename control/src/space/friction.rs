//! Friction of the surface (thesis §4.6): a spring across the normal that sticks to an anchor on the surface. The anchor slides
//! when the spring's force exceeds `μ_s` times the normal force `f_n`; the friction is then `μ_k` times the normal force.
//!
//! ```text
//! z = across the normal (x - anchor)      F = -k z      stick:  |k z| <= μ_s f_n      slide:  z cut to |k z| = μ_k f_n
//! ```
//!
//! **Stick does not creep.** While the spring sticks on a flat surface, the anchor is constant. `z` then depends on the position
//! alone, and no rounding errors add up.
//!
//! **It is passive with the device's own damping `b`.** The spring `k` stores `V = k z²/2`. For a displacement `Δ`, a tick in
//! stick takes `k z·Δ` from the hand and `V` grows by `k z·Δ + k Δ²/2`. The difference is the energy leak of a sampled spring. A
//! device that damps `c = b/T >= k/2` (`T` is the control period) dissipates `c Δ²`. A cut only shortens `z`. When the normal
//! turns, `z` and the anchor are first projected into the new tangent plane, which also shortens `z`. So from the first touch on,
//! over any path, the energy that `F` takes from the hand plus `Σ c |Δx|²` is at least `V >= 0`. [`FrictionSettings::friction`]
//! refuses a `k` above `2 b/T`. Rounding adds at most the force times four steps of the position format per tick.
//!
//! Settings with `μ_k > μ_s` would stop a sliding point and release a resting one, so they are refused.

use super::number::Spatial;
use super::touch::Touch;
use super::unit::LengthUnit;
use super::vector::{Direction, Vector};
use crate::{Compliance, Force, Position, Si, Stiffness};
use core::fmt;

/// Coefficients of the friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction<N: Spatial> {
    /// Stiffness of the spring that holds the hand's point to its anchor on the surface.
    pub stiffness: Stiffness<N>,
    /// Largest stretch of the spring for each newton of normal force before the point slides: static friction coefficient over
    /// stiffness.
    pub static_reach: Compliance<N>,
    /// Stretch of the spring for each newton of normal force while the point slides: kinetic friction coefficient over stiffness.
    /// At most `static_reach`.
    pub kinetic_reach: Compliance<N>,
}

/// Memory of the friction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionState<N: Spatial> {
    /// Whether the hand's point (HIP) slides.
    pub sliding: bool,
    /// The stretch of the spring: the vector from the anchor to the hand's point (HIP), without its part along the normal.
    pub stretch: Vector<Position<N>>,
    /// Anchor of the friction spring on the surface; `None` without contact.
    pub contact: Option<Hold<N>>,
}

/// Anchor of the friction spring on the surface, with position and normal of the last tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold<N: Spatial> {
    /// The end of the spring on the surface, which does not move while the spring sticks.
    pub anchor: Vector<Position<N>>,
    /// Position of the hand's point (HIP) in the last tick.
    pub last: Vector<Position<N>>,
    /// Normal of the surface in the last tick.
    pub normal: Direction<N>,
}

impl<N: Spatial> Friction<N> {
    /// Runs one control period: takes the normal force, returns the friction on the hand's point (HIP). Without a normal force
    /// there is no contact, and the memory is cleared.
    #[inline]
    pub fn tick(
        &self,
        state: &mut FrictionState<N>,
        touch: &Touch<N>,
        pressed: Force<N>,
    ) -> Vector<Force<N>> {
        if pressed <= Force::zero() {
            *state = FrictionState::default();
            return Vector::default();
        }
        let mut anchor = self.anchor(state, touch);
        let mut stretch = touch.normal.across(touch.at - anchor);
        let mut sliding = state.sliding || stretch.is_longer(self.static_reach * pressed);
        if sliding {
            let reach = self.kinetic_reach * pressed;
            if stretch.is_longer(reach) {
                stretch = stretch.shortened(stretch.length_up(), reach);
                anchor = touch.at - stretch;
            } else {
                // The spring sticks again at three quarters of the sliding stretch, so that a slightly uneven press does not make
                // the point slide again at once.
                sliding = stretch.is_longer(Position(N::three_quarters(reach.0)));
            }
        }
        *state = FrictionState {
            sliding,
            stretch,
            contact: Some(Hold {
                anchor,
                last: touch.at,
                normal: touch.normal,
            }),
        };
        stretch.map(|z| Force::zero() - (self.stiffness * z).towards_zero())
    }

    /// Position of the spring's anchor, projected into the tangent plane of this tick.
    #[inline]
    fn anchor(&self, state: &FrictionState<N>, touch: &Touch<N>) -> Vector<Position<N>> {
        let Some(hold) = &state.contact else {
            return touch.at;
        };
        if hold.normal == touch.normal {
            return hold.anchor;
        }
        // Projecting the stretch into the tangent plane never makes it longer.
        hold.last - touch.normal.across(state.stretch)
    }
}

/// Settings of the friction, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrictionSettings {
    /// Stiffness of the spring while the point sticks, N/m; above 0 and at most twice the device's damping over the control period.
    pub stiffness: Si,
    /// Static friction coefficient `μ_s`, 0 to 10.
    pub static_coefficient: Si,
    /// Kinetic friction coefficient `μ_k`, 0 to `μ_s`.
    pub kinetic_coefficient: Si,
}

/// Why the settings of friction are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrictionError {
    /// The stiffness is not above 0, or is too large for the device's damping; N/m.
    Stiffness {
        /// The given stiffness, N/m.
        stiffness: Si,
        /// Largest allowed stiffness, N/m: twice the device's damping over the control period.
        most: Si,
    },
    /// The friction coefficients are not `0 <= kinetic <= static <= 10`.
    Coefficients {
        /// Static friction coefficient.
        static_coefficient: Si,
        /// Kinetic friction coefficient.
        kinetic_coefficient: Si,
    },
    /// A coefficient does not fit the number format.
    OutOfFormat {
        /// The value that does not fit, in the device's unit of length.
        value: Si,
        /// Name of the number format.
        format: &'static str,
    },
}

impl fmt::Display for FrictionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stiffness { stiffness, most } => write!(
                f,
                "friction.stiffness = {stiffness:.3} N/m is outside 0 to 2 b/T = {most:.3} N/m, what the device's damping answers for"
            ),
            Self::Coefficients {
                static_coefficient,
                kinetic_coefficient,
            } => write!(
                f,
                "friction.kinetic_coefficient = {kinetic_coefficient:.4} and friction.static_coefficient = {static_coefficient:.4}: they must be 0 <= kinetic <= static <= 10"
            ),
            Self::OutOfFormat { value, format } => write!(
                f,
                "friction.stiffness: its coefficient {value:.6} does not fit the number format {format}"
            ),
        }
    }
}

impl FrictionSettings {
    /// Computes the coefficients, in the given unit of length, for a device with a control rate in Hz and a trusted damping in
    /// N·s/m.
    ///
    /// # Errors
    /// A setting is outside its range or its number format.
    pub fn friction<N: Spatial>(
        &self,
        unit: LengthUnit,
        rate_hz: u32,
        damping: Si,
    ) -> Result<Friction<N>, FrictionError> {
        let most = damping
            .saturating_mul(Si::saturating_from_num(rate_hz))
            .saturating_mul(Si::const_from_int(2));
        if self.stiffness <= Si::ZERO || self.stiffness > most {
            return Err(FrictionError::Stiffness {
                stiffness: self.stiffness,
                most,
            });
        }
        let (least, most) = (self.kinetic_coefficient, self.static_coefficient);
        if least < Si::ZERO || least > most || most > Si::const_from_int(10) {
            return Err(FrictionError::Coefficients {
                static_coefficient: most,
                kinetic_coefficient: least,
            });
        }
        let stiffness = unit.per_length(self.stiffness);
        let refused = |value| FrictionError::OutOfFormat {
            value,
            format: N::NAME,
        };
        let reach = |coefficient: Si| {
            let value = if stiffness > Si::ZERO {
                coefficient.saturating_div(stiffness)
            } else {
                Si::MAX
            };
            N::ratio(value).map(Compliance).ok_or(refused(value))
        };
        Ok(Friction {
            stiffness: N::gain(stiffness)
                .map(Stiffness)
                .ok_or(refused(stiffness))?,
            static_reach: reach(most)?,
            kinetic_reach: reach(least)?,
        })
    }
}
