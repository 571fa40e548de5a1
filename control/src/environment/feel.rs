//! The parts of a knob's feel besides walls, detents and torque profile: a spring to a centre, viscous and dry friction, a click,
//! and an added inertia.
//!
//! ```text
//! distance from the centre ----> spring           \
//! displacement in a tick ------> viscous friction   \
//!                          ----> dry friction        > sum
//!                          ----> inertia            |
//! distance from a position ----> click              /
//! ```
//!
//! This sum is added to the forces of walls, detents and profile, before the force limit and the energy guard. All parts
//! calculate with differences of positions, so they are the same after any number of turns. For a motion mirrored at 0 they give
//! the negative forces, bit for bit.
//!
//! A texture needs no part of its own: it is a [torque profile](super::profile) with many copies in a turn.

use super::detents::Ring;
use super::inertia::{Dragged, InertiaSettings};
use super::refused::{Refused, within};
pub use super::viscous::{Viscous, ViscousSettings};
use super::{Reading, Spacing, ratio};
use crate::quotient::over;
use crate::{Compliance, Force, Number, Position, Settings, Si};

/// Settings of the parts of a feel; an absent part gives no force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FeelSettings {
    /// A spring that pulls the device to a centre position.
    pub spring: Option<CentreSettings>,
    /// Friction in proportion to the speed.
    pub viscous: Option<ViscousSettings>,
    /// Friction whose size does not depend on the speed, also at rest.
    pub dry: Option<DrySettings>,
    /// A short pulse when the device crosses one of many positions.
    pub click: Option<ClickSettings>,
    /// A virtual mass that the device drags.
    pub inertia: Option<InertiaSettings>,
}

/// Settings of a spring to a centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CentreSettings {
    /// Position at which the spring gives no force, rad (m).
    pub centre: Si,
    /// Stiffness, N·m/rad (N/m), 0 to 100.
    pub stiffness: Si,
    /// Largest force, N·m (N), 0 to the force limit. Further from the centre the force stays at this value.
    pub strength: Si,
}

/// Settings of rendered dry friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DrySettings {
    /// Friction while the device slides, N·m (N), 0 to the force limit.
    pub strength: Si,
    /// Distance that the device moves from rest until it slides, rad (m), 0.001 to 1. Over that distance friction is a spring.
    pub stretch: Si,
}

/// Settings of a click.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClickSettings {
    /// Distance between the positions that click when the device crosses them.
    pub spacing: Spacing,
    /// One of these positions, rad (m).
    pub centre: Si,
    /// Force of the pulse, N·m (N), 0 to the force limit: first against the motion, then for as long with the motion.
    pub strength: Si,
    /// Length of the pulse, s, 0.001 to 0.1. The pulse lasts at least two ticks.
    pub duration_s: Si,
}

impl FeelSettings {
    /// Checks the settings and computes the coefficients, for a device with the control law's settings.
    ///
    /// # Errors
    /// A setting is outside its range.
    #[cold]
    pub fn feel<N: Number>(&self, settings: &Settings) -> Result<Feel<N>, Refused> {
        let limit = settings.force_limit;
        Ok(Feel {
            spring: self.spring.map(|it| it.spring(limit)).transpose()?,
            viscous: self.viscous.map(|it| it.viscous(settings)).transpose()?,
            dry: self.dry.map(|it| it.dry(limit)).transpose()?,
            click: self.click.map(|it| it.click(settings)).transpose()?,
            inertia: match &self.inertia {
                Some(it) => {
                    let beside = self.viscous.map_or(Si::ZERO, |it| it.damping);
                    Some(it.rendered(settings, beside)?)
                }
                None => None,
            },
        })
    }
}

impl CentreSettings {
    /// Checks the settings and computes the coefficients; `limit` is the force limit.
    ///
    /// # Errors
    /// A setting is outside its range.
    pub fn spring<N: Number>(&self, limit: Si) -> Result<Centre<N>, Refused> {
        const STIFFNESS: &str = "environment.spring.stiffness_n_m_per_rad";
        const STRENGTH: &str = "environment.spring.strength_n_m";
        let stiffest = const { Si::lit("100") };
        within(STIFFNESS, self.stiffness, Si::ZERO, stiffest)?;
        within(STRENGTH, self.strength, Si::ZERO, limit)?;
        Ok(Centre {
            centre: self.centre,
            spring: Elastic {
                stiffness: Compliance(ratio::<N>(STIFFNESS, self.stiffness)?),
                most: Force(N::saturating_signal(self.strength)),
            },
        })
    }
}

impl DrySettings {
    /// Checks the settings and computes the coefficients; `limit` is the force limit.
    ///
    /// # Errors
    /// A setting is outside its range.
    pub fn dry<N: Number>(&self, limit: Si) -> Result<Dry<N>, Refused> {
        const STRENGTH: &str = "environment.dry_friction.strength_n_m";
        const STRETCH: &str = "environment.dry_friction.stretch_rad";
        let (least, most) = const { (Si::lit("0.001"), Si::ONE) };
        within(STRENGTH, self.strength, Si::ZERO, limit)?;
        within(STRETCH, self.stretch, least, most)?;
        let stiffness = over(self.strength, self.stretch);
        Ok(Dry {
            spring: Elastic {
                stiffness: Compliance(ratio::<N>(STRENGTH, stiffness)?),
                most: Force(N::saturating_signal(self.strength)),
            },
            reach: Position(N::saturating_signal(self.stretch)),
            stretch: Position::zero(),
        })
    }
}

impl ClickSettings {
    /// Checks the settings and computes the coefficients.
    ///
    /// # Errors
    /// A setting is outside its range.
    fn click<N: Number>(&self, settings: &Settings) -> Result<(Ring, Click<N>), Refused> {
        let ring = Ring::new(self.spacing, self.centre).map_err(|refused| match refused {
            Refused::PerTurn(per_turn) => Refused::Part {
                path: "environment.click.per_rev",
                value: Si::saturating_from_num(per_turn),
                least: Si::ONE,
                most: Si::saturating_from_num(super::detents::MOST),
            },
            _ => Refused::Part {
                path: "environment.click.pitch_rad",
                value: match self.spacing {
                    Spacing::Pitch(pitch) => pitch,
                    Spacing::PerTurn(_) => Si::ZERO,
                },
                least: super::detents::FINEST,
                most: super::detents::COARSEST,
            },
        })?;
        let (strength, length) = (self.strength, self.duration_s);
        let (shortest, longest) = const { (Si::lit("0.001"), Si::lit("0.1")) };
        let limit = settings.force_limit;
        within("environment.click.strength_n_m", strength, Si::ZERO, limit)?;
        within("environment.click.duration_s", length, shortest, longest)?;
        // At most 5,000 ticks (0.05 s at 100,000 Hz), which fits 16 bits.
        let half = length.saturating_mul(Si::saturating_from_num(settings.rate_hz)) / 2;
        let click = Click {
            pulse: Force(N::saturating_signal(strength)),
            half: half.saturating_to_num::<u16>().max(1),
            side: None,
            upward: false,
            left: 0,
        };
        Ok((ring, click))
    }
}

/// The parts of a feel, with their memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feel<N: Number> {
    spring: Option<Centre<N>>,
    viscous: Option<Viscous<N>>,
    dry: Option<Dry<N>>,
    click: Option<(Ring, Click<N>)>,
    inertia: Option<Dragged<N>>,
}

impl<N: Number> Feel<N> {
    /// Distance from the nearest position that clicks, in units of 2^-32 of the distance between two; 0 without clicks.
    #[inline(always)]
    pub fn beyond(&self, at: &impl Reading<N>) -> i32 {
        self.click.as_ref().map_or(0, |(ring, _)| ring.beyond(at))
    }

    /// Runs one control period: takes the result of [`Feel::beyond`], the position rounded to steps of the number format, and the
    /// displacement since the last tick. Returns the sum of all parts, against `+x`.
    pub fn tick(&mut self, beyond: i32, now: Si, moved: Position<N>) -> Force<N> {
        let mut sum = Force::zero();
        if let Some(centre) = &self.spring {
            let way = N::saturating_signal(now.saturating_sub(centre.centre));
            sum = centre.spring.force(Position(way));
        }
        if let Some(viscous) = &mut self.viscous {
            sum = sum + viscous.tick(moved);
        }
        if let Some(dry) = &mut self.dry {
            sum = sum + dry.tick(moved);
        }
        if let Some((_, click)) = &mut self.click {
            sum = sum + click.tick(beyond);
        }
        if let Some(inertia) = &mut self.inertia {
            sum = sum + inertia.drag(moved);
        }
        sum
    }

    /// Clears the memory, when the force is switched on.
    pub fn forget(&mut self) {
        if let Some(viscous) = &mut self.viscous {
            viscous.force = Force::zero();
        }
        if let Some(dry) = &mut self.dry {
            dry.stretch = Position::zero();
        }
        if let Some((_, click)) = &mut self.click {
            (click.side, click.left) = (None, 0);
        }
        if let Some(inertia) = &mut self.inertia {
            inertia.let_go();
        }
    }
}

/// A spring whose force stays at its largest value beyond some stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic<N: Number> {
    /// Stiffness, N·m/rad (N/m), stored in the number format of a compliance, which has finer steps than that of a stiffness.
    pub stiffness: Compliance<N>,
    /// Largest force.
    pub most: Force<N>,
}

impl<N: Number> Elastic<N> {
    /// The force at a stretch, of the same sign.
    #[inline]
    #[must_use]
    pub fn force(&self, stretch: Position<N>) -> Force<N> {
        Force(N::scale(self.stiffness.0, stretch.0)).within(self.most)
    }
}

/// A spring to a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Centre<N: Number> {
    centre: Si,
    /// The spring from the centre to the device.
    pub spring: Elastic<N>,
}

/// Rendered dry friction (Dahl's model as a spring that slips): a spring to an anchor, which the device drags along when the
/// stretch would exceed a set distance.
///
/// The force depends on displacements alone, so there is no chatter at rest. Around a closed path the friction only takes energy.
/// The energy guard counts the energy that sampling adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dry<N: Number> {
    /// The spring from the anchor to the device.
    pub spring: Elastic<N>,
    /// Largest stretch; a device that moves further drags the anchor along.
    pub reach: Position<N>,
    /// Distance of the device from the anchor.
    pub stretch: Position<N>,
}

impl<N: Number> Dry<N> {
    /// Runs one control period: takes the displacement since the last tick, returns the force against the motion.
    #[inline]
    pub fn tick(&mut self, moved: Position<N>) -> Force<N> {
        let stretch = self.stretch + moved;
        self.stretch = stretch.min(self.reach).max(Position::zero() - self.reach);
        self.spring.force(self.stretch)
    }
}

/// A click: a short pulse when the device crosses a position. Its first half acts against the motion, its second half with it, so
/// that the device keeps its momentum.
///
/// A position clicks again only after the device has moved away from it by at least a quarter of the distance to the next
/// position. So a device that rests or trembles on a position is quiet. A device that moves more than that quarter in a tick may
/// make no click.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Click<N: Number> {
    /// Force in either half of the pulse.
    pub pulse: Force<N>,
    /// Ticks in either half of the pulse.
    pub half: u16,
    /// Whether the device approaches the nearest position from below; `None` at the start and after a click there.
    pub side: Option<bool>,
    /// Whether the last crossing was towards larger positions.
    pub upward: bool,
    /// Remaining ticks of the pulse.
    pub left: u32,
}

/// A quarter of the distance between two positions, in units of 2^-32 of that distance.
const QUARTER: u32 = 1 << 30;

impl<N: Number> Click<N> {
    /// Runs one control period: takes the distance from the nearest position, in units of 2^-32 of the distance between two.
    /// Returns the pulse, against `+x`.
    #[inline]
    pub fn tick(&mut self, beyond: i32) -> Force<N> {
        if beyond.unsigned_abs() >= QUARTER {
            // Exactly halfway neither position is nearer, so `side` stays as it is. Then mirrored motions have mirrored clicks.
            if beyond != i32::MIN {
                self.side = Some(beyond < 0);
            }
        } else if let Some(below) = self.side
            && if below { beyond >= 0 } else { beyond <= 0 }
        {
            self.side = None;
            self.upward = below;
            self.left = u32::from(self.half).wrapping_mul(2);
        }
        if self.left == 0 {
            return Force::zero();
        }
        let first = self.left > u32::from(self.half);
        self.left = self.left.wrapping_sub(1);
        if first == self.upward {
            self.pulse
        } else {
            -self.pulse
        }
    }
}
