//! What becomes of a device that bounces between a wall and the hand.
//!
//! Several laws meet a touch with the spring `k_de` until the motion turns, and only then with what the matrices describe. So
//! bounces are played instead: the device is pressed against the wall by the pad of a hand at rest, meets it at
//! every phase of the tick, comes out, and is pressed back. It is thrown out of the wall at all only where it moves by more than the
//! press' depth; where from such speeds on it returns slower and slower, bounces die away and the lasting phases decide.

use super::contact::Contact;
use touchstone_sim::error::Result;
use touchstone_sim::run::mechanics::Standing;
use touchstone_sim::run::{self, Recorder, Tick, plan};
use touchstone_sim::scene::{self, Grip, MotionSpec, Number, RestPath, Scene};
use touchstone_world::plant::Hand;

/// Phases of the tick at which the surface is crossed.
const PHASES: u32 = 12;
/// Speeds, of the one that carries the device as far as the press is deep.
const SPEEDS: [f64; 4] = [1.0, 1.5, 2.5, 4.0];
/// Press that is taken where the scene has none, N·m.
const PRESS_N_M: f64 = 0.1;
/// Swings of the device on `k_de` that are waited for, and ticks at least.
const SWINGS: f64 = 8.0 * RETURNS as f64;
const TICKS: f64 = 400.0;

/// Returns that are waited for.
const RETURNS: u32 = 4;

/// Watches for the first exit and for the returns after it.
struct Bounce {
    surface_rad: f64,
    held: bool,
    inside: bool,
    was_inside: bool,
    returns: u32,
    /// Speed of the last return to the wall; of the exit where nobody brings the device back.
    speed: Option<f64>,
}

impl Recorder for Bounce {
    fn record(&mut self, tick: &Tick) {
        let inside = tick.angle_after_rad > self.surface_rad;
        let speed = tick.velocity_after_rad_per_s;
        if inside && !self.inside && self.was_inside {
            self.returns += 1;
            if self.returns == RETURNS {
                self.speed = Some(speed);
            }
        }
        if !inside && self.inside && !self.held {
            self.speed.get_or_insert(-speed);
        }
        self.was_inside |= inside;
        self.inside = inside;
    }
}

/// Largest speed of a return over that of the touch before, on the mean of `RETURNS`; 0 where the device stays inside or outside. Infinite where a run leaves all
/// numbers. For nobody's device: the speed with which it is thrown out.
///
/// # Errors
/// Settings that the law cannot take.
pub fn bounce(scene: &Scene, contact: &Contact, hand: Option<&Hand>) -> Result<f64> {
    let mut bare = scene.clone();
    bare.operator.grip = hand.map_or(Grip::None, |_| Grip::Custom);
    bare.operator.hand = hand.map(of_plant);
    bare.operator.motion = MotionSpec::None;
    bare.law.number = Number::F64;
    bare.law.guard.on = false;
    let (period_s, inertia) = (contact.clock.period_s, contact.device.inertia);
    let natural = (contact.k_desired / inertia).sqrt();
    let push = contact.press_n_m.unwrap_or(PRESS_N_M);
    let depth = push / contact.k_desired;
    let surface = scene.wall.surface_rad;
    let swing_ticks = std::f64::consts::TAU * (inertia / contact.k_desired).sqrt() / period_s;
    let ticks = (SWINGS * swing_ticks).max(TICKS) as u64;
    // The pad pressed together by the push, and the hand held where it is by its own rest point.
    let by = |stiffness: fn(&Hand) -> f64| {
        hand.map(stiffness)
            .filter(|stiffness| *stiffness > 0.0)
            .map_or(0.0, |stiffness| push / stiffness)
    };
    let (ahead, beyond) = (by(|hand| hand.pad_stiffness), by(|hand| hand.stiffness));
    let mut most = 0.0_f64;
    for share in SPEEDS {
        let speed = share * depth * natural;
        for phase in 0..PHASES {
            let before = (f64::from(phase) + 0.5) / f64::from(PHASES);
            let start = surface - before * speed * period_s;
            let mut control = plan::control(&bare)?;
            let mut mechanics = plan::mechanics(
                &bare,
                Standing {
                    velocity_rad_per_s: speed,
                    hand_rad: start + ahead,
                    ..Standing::together(start, 0.0)
                },
            )?;
            let mut bounce = Bounce {
                surface_rad: surface,
                held: hand.is_some(),
                inside: false,
                was_inside: false,
                returns: 0,
                speed: None,
            };
            // In pieces: most are out after a few ticks.
            let mut from = 0;
            while from < ticks && bounce.speed.is_none() {
                let to = ticks.min(from + 64);
                mechanics.advance(
                    control.as_mut(),
                    &RestPath::still(start + ahead + beyond),
                    from..to,
                    period_s,
                    Some(&mut bounce),
                );
                from = to;
            }
            let back = bounce.speed.unwrap_or(0.0);
            most = most.max(if back.is_nan() {
                f64::INFINITY
            } else {
                let times = if hand.is_some() { RETURNS } else { 1 };
                (back / speed).powf(1.0 / f64::from(times))
            });
        }
    }
    Ok(most)
}

/// What a press borrows of a loan without end, over the loan that there is: the scene's press is played with it. Absent without a loan or
/// a press.
///
/// # Errors
/// Settings that the law cannot take.
pub fn loan_used(scene: &Scene, contact: &Contact, hand: Option<&Hand>) -> Result<Option<f64>> {
    let loan_j = scene.law.energy_credit_j;
    if contact.phases.loan_covers_n_m.is_none() || contact.press_n_m.is_none() || hand.is_none() {
        return Ok(None);
    }
    let mut lent = scene.clone();
    lent.operator.grip = Grip::Custom;
    lent.operator.hand = hand.map(of_plant);
    lent.law.energy_credit_j = ENDLESS_J;
    lent.law.number = Number::F64;
    lent.law.guard.on = false;
    let least = run::run(&lent, false)?.summary.energy_observed_min;
    Ok(least.map(|least| (-least).max(0.0) / loan_j))
}

/// More than any press borrows.
const ENDLESS_J: f64 = 1e3;

/// A hand that holds no place pushes through a spring so soft, N·m/rad, that it is a force.
const LEAST_STIFFNESS: f64 = 2e-3;

fn of_plant(hand: &Hand) -> scene::Hand {
    scene::Hand {
        inertia_kg_m2: hand.inertia,
        damping_n_m_s_per_rad: hand.damping,
        stiffness_n_m_per_rad: hand.stiffness.max(LEAST_STIFFNESS),
        pad_damping_n_m_s_per_rad: hand.pad_damping,
        pad_stiffness_n_m_per_rad: hand.pad_stiffness,
    }
}
