//! Random walls on three axes, with their hands and devices.

use super::RADIUS_MM;
use super::mechanism::Deviation;
use super::pressed::PressedSurface;
use crate::random_device::Random;
use crate::scorecard::cases::LATE_TICKS;
use touchstone_world::plant::{FIRM_TRANSLATION, Hand, LIGHT_TRANSLATION};

/// One of this many walls is a ball.
pub(super) const BALL_EACH: usize = 5;
/// Largest distance along each axis of a plane's random point from the centre of the workspace, m.
const FURTHEST_M: f64 = 0.03;
pub(super) const PUSHES_N: (f64, f64) = (4.0, 9.0);
pub(super) const DELAYS_TICKS: [f64; 3] = [0.0, 0.1, 0.5];
/// Largest push on a ball, as a fraction of the push at which the hand slides off. The hand slides off at the ball's radius times
/// the hand's stiffness across the push.
const BALL_SHARE: f64 = 0.6;

/// A random wall with its hand and device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// The surface that the hand presses.
    pub surface: PressedSurface,
    /// Grip between the light (0) and the firm hand (1), on a logarithmic scale.
    pub grip: f64,
    /// Force of the press, N.
    pub push_n: f64,
    /// How the device differs from its nominal values, as factors and a delay.
    pub deviation: Deviation,
}

/// The hand at the position `grip` between the light hand (0) and the firm hand (1).
pub(super) fn hand(grip: f64) -> Hand {
    let between = |light: f64, firm: f64| light * (firm / light).powf(grip);
    let (light, firm) = (LIGHT_TRANSLATION, FIRM_TRANSLATION);
    Hand {
        inertia: between(light.inertia, firm.inertia),
        damping: between(light.damping, firm.damping),
        stiffness: between(light.stiffness, firm.stiffness),
        pad_damping: between(light.pad_damping, firm.pad_damping),
        pad_stiffness: between(light.pad_stiffness, firm.pad_stiffness),
    }
}

/// Stiffness of a hand with its fingertip pad across the direction of the push, N/m.
fn across(hand: &Hand) -> f64 {
    1.0 / (1.0 / hand.stiffness + 1.0 / hand.pad_stiffness)
}

/// Largest push with which the simulated hand presses a ball, N. The hand slides off above the ball's radius times the hand's
/// stiffness across the push.
pub(super) fn most_on_ball_n(hand: &Hand) -> f64 {
    BALL_SHARE * 1e-3 * RADIUS_MM * across(hand)
}

impl Drawn {
    fn next(random: &mut Random, ball: bool) -> Self {
        let mut within = |(low, high): (f64, f64)| low + (high - low) * random.unit();
        // Evenly distributed over the sphere of directions.
        let (up, turn) = (within((-1.0, 1.0)), within((0.0, std::f64::consts::TAU)));
        let flat = (1.0 - up * up).sqrt();
        let normal = [flat * turn.cos(), flat * turn.sin(), up];
        let place = [0; 3].map(|_| within((-FURTHEST_M, FURTHEST_M)));
        let fifth = (0.8, 1.2);
        let deviation = Deviation {
            inertia: within(fifth),
            damping: within(fifth),
            counts: 1.0,
            delay_ticks: DELAYS_TICKS[(within((0.0, 3.0)) as usize).min(2)],
        };
        let (grip, push_n) = (within((0.0, 1.0)), within(PUSHES_N));
        if ball {
            let most = most_on_ball_n(&hand(1.0));
            return Self {
                surface: PressedSurface::Ball(normal),
                grip: 1.0,
                push_n: push_n.min(most),
                deviation,
            };
        }
        Self {
            surface: PressedSurface::Plane(place, normal),
            grip,
            push_n,
            deviation,
        }
    }

    /// Description of the wall for readers.
    #[must_use]
    pub fn text(&self) -> String {
        let [x, y, z] = self.surface.normal();
        let what = match self.surface {
            PressedSurface::Plane(..) => "plane",
            PressedSurface::Ball(_) => "ball",
        };
        format!(
            "{what} ({x:.2}, {y:.2}, {z:.2}), grip {:.2}, {:.1} N, inertia {:.2}, damping {:.2}, delay {}",
            self.grip,
            self.push_n,
            self.deviation.inertia,
            self.deviation.damping,
            self.deviation.delay_ticks
        )
    }

    pub(super) fn is_late(&self) -> bool {
        self.deviation.delay_ticks >= LATE_TICKS
    }
}

/// The random walls that a seed generates.
#[must_use]
pub fn drawn(seed: u64, count: usize) -> Vec<Drawn> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|i| Drawn::next(&mut random, i % BALL_EACH == BALL_EACH - 1))
        .collect()
}
