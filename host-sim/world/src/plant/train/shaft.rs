//! Torques at the motor's shaft that are not linear: friction of several kinds, cogging, imbalance.

use super::bristles;
use super::friction::{Friction, Sliding, level};

/// A torque that goes with the angle, `-A sin(n x + phi)`: cogging has `n` periods a turn, a weight out of the axis has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// `A`, N·m.
    pub amplitude: f64,
    /// `n`, above zero.
    pub per_rev: f64,
    /// `phi`, rad.
    pub phase: f64,
}

impl Harmonic {
    /// The cogging torque at an angle, N·m along the positive direction.
    #[inline(always)]
    #[must_use]
    pub fn torque(&self, angle: f64) -> f64 {
        -self.amplitude * libm::sin(self.per_rev * angle + self.phase)
    }

    /// The cogging's potential, J.
    fn potential_j(&self, angle: f64) -> f64 {
        -self.amplitude / self.per_rev * libm::cos(self.per_rev * angle + self.phase)
    }
}

/// Torques at the shaft that are not linear.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shaft {
    /// Friction of the shaft.
    pub friction: Friction,
    /// Torques that go with its angle.
    pub harmonics: Vec<Harmonic>,
}

/// What friction does during a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opposed {
    /// Against the positive direction, N·m.
    pub torque: f64,
    /// Whether the shaft is at rest at the substep's end.
    pub rests: bool,
}

impl Shaft {
    /// Whether nothing acts that is not linear.
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        self.friction == Friction::None && self.harmonics.is_empty()
    }

    /// Torque of cogging and imbalance at an angle, N·m along the positive direction.
    #[inline(always)]
    pub(super) fn turned_by(&self, angle: f64) -> f64 {
        self.harmonics
            .iter()
            .map(|harmonic| harmonic.torque(angle))
            .sum()
    }

    /// Potential of cogging and imbalance, J.
    pub(super) fn potential_j(&self, angle: f64) -> f64 {
        self.harmonics
            .iter()
            .map(|harmonic| harmonic.potential_j(angle))
            .sum()
    }

    /// Energy in the bristles, J.
    pub(super) fn bristle_energy_j(&self, bristle: f64) -> f64 {
        match &self.friction {
            Friction::Bristles(lugre) => 0.5 * lugre.stiffness * bristle * bristle,
            Friction::None | Friction::Dry { .. } => 0.0,
        }
    }

    /// Friction over a substep that begins and, without friction, would end with these velocities; `response` is the change of the
    /// latter by a held torque.
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

/// The torque for which the velocity at the substep's end and the torque agree (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto,
/// IEEE T-RO 22(6) 1176, 2006), with an exact response of the velocity.
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
    // Whoever turns round comes to rest on the way, and has to break away again.
    if before * free <= 0.0 && stopping.abs() <= sliding.breakaway {
        return Opposed {
            torque: stopping,
            rests: true,
        };
    }
    // The level at the substep's mean velocity, of which the level at its start gives the end.
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
