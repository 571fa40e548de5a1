//! Friction of the surface (thesis §4.6): a spring across the normal that sticks to an anchor and lets go at `μ_s` times the
//! normal force, then slides at `μ_k`.
//!
//! ```text
//! z = across the normal (x - anchor)      F = -k z      stick:  |k z| <= μ_s f_n      slide:  z cut to |k z| = μ_k f_n
//! ```
//!
//! **Stick does not creep.** While it sticks on a surface that does not turn, the anchor is a constant: `z` is a function of the position alone, and
//! nothing is summed up.
//!
//! **It is passive with the device's own damping.** With `V = k z²/2` a tick in stick takes `k z·Δ` and `V` grows by
//! `k z·Δ + k Δ²/2`: the difference is the leak of a sampled spring, and a device that damps `c = b/T >= k/2` takes `c Δ²`. A cut only shortens
//! `z`. Where the normal turns, `z` is first laid into the new tangent plane, which shortens it as well, and the anchor with
//! it. So `Σ (F taken + c |Δx|²) >= V >= 0` from the first touch on, over any path; [`FrictionSettings::friction`] refuses a `k` above
//! `2 b/T`. What rounding adds is at most four quanta of displacement times the force a tick.
//!
//! `μ_k > μ_s` would stop what slides and release what rests; it is refused.

use super::number::Spatial;
use super::touch::Touch;
use super::unit::LengthUnit;
use super::vector::{Direction, Vector};
use crate::settings::Si;
use crate::{Compliance, Force, Position, Stiffness};
use core::fmt;

/// Friction's coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction<N: Spatial> {
    /// Stiffness of the spring across the normal.
    pub stiffness: Stiffness<N>,
    /// `μ_s/k`: how far it stretches a newton of normal force before it slides.
    pub static_reach: Compliance<N>,
    /// `μ_k/k`: how far while it slides; at most the static one.
    pub kinetic_reach: Compliance<N>,
}

/// What friction remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionState<N: Spatial> {
    /// Whether it slides.
    pub sliding: bool,
    /// The stretch of the spring: from the anchor to the HIP, across the normal.
    pub stretch: Vector<Position<N>>,
    /// The hold on the surface while there is contact.
    pub contact: Option<Hold<N>>,
}

/// Where the spring is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold<N: Spatial> {
    /// The end that does not move in stick.
    pub anchor: Vector<Position<N>>,
    /// The HIP in the last tick.
    pub last: Vector<Position<N>>,
    /// The normal of the last tick.
    pub normal: Direction<N>,
}

impl<N: Spatial> Friction<N> {
    /// Runs one control period: takes a normal force, returns the friction on the HIP. Without a normal force there is
    /// no contact, and the memory is cleared.
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
                // It holds again when it is pushed back: with room for a press that is not quite even.
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

    /// Where the spring is held.
    #[inline]
    fn anchor(&self, state: &FrictionState<N>, touch: &Touch<N>) -> Vector<Position<N>> {
        let Some(hold) = &state.contact else {
            return touch.at;
        };
        if hold.normal == touch.normal {
            return hold.anchor;
        }
        // Never longer than it was.
        hold.last - touch.normal.across(state.stretch)
    }
}

/// Friction as a person sets it, SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrictionSettings {
    /// Stiffness of stick, N/m; above 0, at most `2 b/T`.
    pub stiffness: Si,
    /// `μ_s`, 0 to 10.
    pub static_coefficient: Si,
    /// `μ_k`, 0 to `μ_s`.
    pub kinetic_coefficient: Si,
}

/// Why friction's settings are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionError {
    /// A stiffness that the device's damping does not answer for, or none; N/m.
    Stiffness {
        /// The stiffness as it was set.
        stiffness: Si,
        /// Largest allowed stiffness: `2 b/T`.
        most: Si,
    },
    /// Coefficients that are not `0 <= kinetic <= static <= 10`.
    Coefficients {
        /// Static coefficient: `μ_s`.
        static_coefficient: Si,
        /// Kinetic coefficient: `μ_k`.
        kinetic_coefficient: Si,
    },
    /// A coefficient that does not fit the number format.
    OutOfFormat {
        /// The value in the device's length unit.
        value: Si,
        /// The format.
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
    /// The coefficients for a device with a rate in Hz and a trusted damping in N·s/m.
    ///
    /// # Errors
    /// A setting that is outside its range or its number format.
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
