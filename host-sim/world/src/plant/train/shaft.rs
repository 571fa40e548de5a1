//! Nonlinear torques at the motor's shaft: dry friction of several models, cogging, imbalance.

use super::bristles;
use super::friction::{Friction, Sliding, level};

/// A torque that depends on the shaft angle `x`: `-A sin(n x + phi)`, with amplitude `A`, periods per turn `n` and phase `phi`.
/// Cogging has many periods per turn, an eccentric weight has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// Amplitude of the torque, N·m.
    pub amplitude: f64,
    /// Number of periods per turn, above zero.
    pub per_rev: f64,
    /// Phase at angle 0, rad.
    pub phase: f64,
}

impl Harmonic {
    /// The torque at a shaft angle in the positive direction, N·m.
    #[inline(always)]
    #[must_use]
    pub fn torque(&self, angle: f64) -> f64 {
        -self.amplitude * libm::sin(self.per_rev * angle + self.phase)
    }

    /// Potential energy that belongs to the torque, at a shaft angle, J.
    fn potential_j(&self, angle: f64) -> f64 {
        -self.amplitude / self.per_rev * libm::cos(self.per_rev * angle + self.phase)
    }
}

/// The nonlinear torques at the motor's shaft.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shaft {
    /// The model of dry friction at the shaft.
    pub friction: Friction,
    /// Torques of cogging and imbalance over the shaft angle; they are added.
    pub harmonics: Vec<Harmonic>,
}

/// Dry friction over a substep: its torque, and whether it stops the shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opposed {
    /// Friction torque against the positive direction, N·m.
    pub torque: f64,
    /// Whether the shaft is at rest at the substep's end.
    pub rests: bool,
}

impl Shaft {
    /// Whether the shaft has no nonlinear torque.
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        self.friction == Friction::None && self.harmonics.is_empty()
    }

    /// Sum of the torques of cogging and imbalance at a shaft angle, N·m, in the positive direction.
    #[inline(always)]
    pub(super) fn turned_by(&self, angle: f64) -> f64 {
        self.harmonics
            .iter()
            .map(|harmonic| harmonic.torque(angle))
            .sum()
    }

    /// Potential energy of cogging and imbalance at a shaft angle, J.
    pub(super) fn potential_j(&self, angle: f64) -> f64 {
        self.harmonics
            .iter()
            .map(|harmonic| harmonic.potential_j(angle))
            .sum()
    }

    /// Elastic energy of the LuGre friction's bristles at a deflection in rad, J.
    pub(super) fn bristle_energy_j(&self, bristle: f64) -> f64 {
        match &self.friction {
            Friction::Bristles(lugre) => 0.5 * lugre.stiffness * bristle * bristle,
            Friction::None | Friction::Dry { .. } => 0.0,
        }
    }

    /// Computes dry friction over a substep, from the shaft's velocity at its start and the velocity at its end without friction.
    /// `response` is the change of the end velocity per held torque.
    #[inline(always)]
    pub(super) fn opposed_by(
        &self,
        velocities: [f64; 2],
        response: f64,
        bristle: &mut f64,
        substep_s: f64,
    ) -> Option<Opposed> {
        match &self.friction {
            Friction::None => None,
            Friction::Dry {
                directions,
                stribeck,
            } => Some(dry(directions, *stribeck, velocities, response)),
            Friction::Bristles(lugre) => Some(Opposed {
                torque: bristles::advance(lugre, velocities, response, bristle, substep_s),
                rests: false,
            }),
        }
    }
}

/// Friction torque that is consistent with the velocity at the substep's end (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto, IEEE
/// T-RO 22(6) 1176, 2006). The response of the velocity to the torque is exact.
#[inline(always)]
fn dry(
    directions: &[Sliding; 2],
    stribeck: Option<f64>,
    [before, free]: [f64; 2],
    response: f64,
) -> Opposed {
    let stopping = free / response;
    let sliding = &directions[usize::from(stopping < 0.0)];
    let slides = |torque: f64| Opposed {
        torque: torque.copysign(stopping),
        rests: false,
    };
    // A shaft that reverses comes to rest on the way and has to break away again.
    if before * free <= 0.0 && stopping.abs() <= sliding.breakaway {
        return Opposed {
            torque: stopping,
            rests: true,
        };
    }
    // The friction level at the substep's mean velocity. A first pass with the level at the start gives the velocity at the end.
    let first = level(sliding, stribeck, before).copysign(stopping);
    let torque = level(
        sliding,
        stribeck,
        before - 0.5 * response * first + 0.5 * (free - before),
    );
    if stopping.abs() <= torque {
        Opposed {
            torque: stopping,
            rests: true,
        }
    } else {
        slides(torque)
    }
}
