//! The motion of a device that bounces between a wall and the hand.
//!
//! Several laws meet a touch with the spring `k_de` until the motion turns, and only then with what the matrices describe. So
//! bounces are played instead. The device is pressed against the wall by the pad of a hand at rest, meets it at
//! every phase of the tick, comes out, and is pressed back. It is thrown out of the wall at all only where it moves by more than the
//! press' depth; where from such speeds on it returns slower and slower, bounces die away and the lasting phases decide.
//!
//! Where they do not decide either, touches are played to the end of the press, with counts, dry friction, loan and all: [`ends`].

use super::contact::Contact;
use super::judge::JUDGED_AFTER;
use touchstone_sim::error::Result;
use touchstone_sim::run::mechanics::Standing;
use touchstone_sim::run::terms::Terms;
use touchstone_sim::run::{self, Recorder, Tick, plan};
use touchstone_sim::scene::{self, Grip, MotionSpec, Number, RestPath, Scene};
use touchstone_world::plant::Hand;

/// Phases of the tick at which the surface is crossed.
const PHASES: u32 = 12;
/// Speeds, of the one that carries the device as far as the press is deep.
const SPEEDS: [f64; 4] = [1.0, 1.5, 2.5, 4.0];
/// Press that is taken where the scene has none, N·m.
pub(super) const PRESS_N_M: f64 = 0.1;
/// Swings of the device on `k_de` that are waited for, and ticks at least.
const SWINGS: f64 = 8.0 * RETURNS as f64;
const TICKS: f64 = 400.0;

/// Returns that are waited for.
const RETURNS: u32 = 4;

/// Touches that are played to their end: fewer, as each takes a whole hold. A slow one, one as deep as the press, one that comes out.
const SPEEDS_TO_THE_END: [f64; 3] = [0.2, 1.0, 3.0];
const PHASES_TO_THE_END: u32 = 4;
/// How long a scene without a hold is waited for, and any at most, s.
const HOLD_S: f64 = 2.0;
const LONGEST_HOLD_S: f64 = 20.0;

/// How long a press is held, s.
pub(super) fn hold_s(contact: &Contact) -> f64 {
    contact.hold_s.unwrap_or(HOLD_S).min(LONGEST_HOLD_S)
}

/// Watches how far the device still moves at the end.
struct Rest {
    from: u64,
    ticks: u64,
    ends_rad: [f64; 2],
}

impl Recorder for Rest {
    fn record(&mut self, tick: &Tick) {
        if self.ticks >= self.from {
            let angle = tick.angle_after_rad;
            let [least, most] = self.ends_rad;
            // `min` and `max` pass over what is no number.
            self.ends_rad = if angle.is_nan() {
                [f64::NAN; 2]
            } else {
                [least.min(angle), most.max(angle)]
            };
        }
        self.ticks += 1;
    }
}

/// Watches for the first exit and for the returns after it.
struct Bounce {
    surface_rad: f64,
    held: bool,
    inside: bool,
    was_inside: bool,
    returns: u32,
    /// Speed of the last return to the wall; the exit speed where no hand brings the device back.
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

/// A device at the surface, the pad of a hand at rest pressing it in.
struct Touched {
    scene: Scene,
    /// The pad's compression, and what holds the hand behind it, rad.
    ahead_rad: f64,
    beyond_rad: f64,
    period_s: f64,
    /// Speed that carries the device as far as the press is deep.
    speed_rad_per_s: f64,
}

impl Touched {
    fn of(scene: &Scene, contact: &Contact, hand: Option<&Hand>, push_n_m: f64) -> Self {
        let mut bare = scene.clone();
        bare.operator.grip = hand.map_or(Grip::None, |_| Grip::Custom);
        bare.operator.hand = hand.map(of_plant);
        bare.operator.motion = MotionSpec::None;
        bare.law.number = Number::F64;
        bare.law.guard.on = false;
        // The pad pressed together by the push, and the hand held where it is by its own rest point.
        let by = |stiffness: fn(&Hand) -> f64| {
            hand.map(stiffness)
                .filter(|stiffness| *stiffness > 0.0)
                .map_or(0.0, |stiffness| push_n_m / stiffness)
        };
        let natural = (contact.k_desired / contact.device.inertia).sqrt();
        Self {
            scene: bare,
            ahead_rad: by(|hand| hand.pad_stiffness),
            beyond_rad: by(|hand| hand.stiffness),
            period_s: contact.clock.period_s,
            speed_rad_per_s: push_n_m / contact.k_desired * natural,
        }
    }

    /// Simulates contact from a share of that speed and a share of a tick's way before the wall. It runs in pieces, as
    /// most bounces are out after a few ticks, for this many ticks or until `done`.
    fn play<R: Recorder>(
        &self,
        (share, before): (f64, f64),
        ticks: u64,
        recorder: &mut R,
        done: impl Fn(&R) -> bool,
    ) -> Result<()> {
        let speed = share * self.speed_rad_per_s;
        let start = self.scene.wall.surface_rad - before * speed * self.period_s;
        let hand_rad = start + self.ahead_rad;
        let mut control = plan::control(&self.scene)?;
        let mut mechanics = plan::mechanics(
            &self.scene,
            Standing {
                velocity_rad_per_s: speed,
                hand_rad,
                ..Standing::together(start, 0.0)
            },
        )?;
        let mut from = 0;
        while from < ticks && !done(recorder) {
            let to = ticks.min(from + 64);
            mechanics.advance(
                control.as_mut(),
                &RestPath::still(hand_rad + self.beyond_rad),
                from..to,
                self.period_s,
                Some(&mut *recorder),
            );
            from = to;
        }
        Ok(())
    }
}

/// Moments within a tick, as shares of it, at which the surface is crossed.
fn phases(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |phase| (f64::from(phase) + 0.5) / f64::from(count))
}

/// Largest speed of a return over that of the touch before, on the mean of `RETURNS`; 0 where the device stays inside
/// or outside; infinite where a run diverges. Without a hand: the exit speed.
///
/// # Errors
/// Settings that the law cannot have.
pub fn bounce(scene: &Scene, contact: &Contact, hand: Option<&Hand>) -> Result<f64> {
    let push_n_m = contact.played_press_n_m;
    let touched = Touched::of(scene, contact, hand, push_n_m);
    let (period_s, inertia) = (contact.clock.period_s, contact.device.inertia);
    let swing_ticks = std::f64::consts::TAU * (inertia / contact.k_desired).sqrt() / period_s;
    let ticks = (SWINGS * swing_ticks).max(TICKS) as u64;
    let mut most = 0.0_f64;
    for share in SPEEDS {
        for before in phases(PHASES) {
            let mut bounce = Bounce {
                surface_rad: scene.wall.surface_rad,
                held: hand.is_some(),
                inside: false,
                was_inside: false,
                returns: 0,
                speed: None,
            };
            touched.play((share, before), ticks, &mut bounce, |bounce| {
                bounce.speed.is_some()
            })?;
            let back = bounce.speed.unwrap_or(0.0);
            most = most.max(if back.is_nan() {
                f64::INFINITY
            } else {
                let times = if hand.is_some() { RETURNS } else { 1 };
                let speed = share * touched.speed_rad_per_s;
                (back / speed).powf(1.0 / f64::from(times))
            });
        }
    }
    Ok(most)
}

/// How touches of a hand that presses on end: the least and the largest remaining motion, peak to peak, over what
/// counts as a limit cycle.
///
/// Each is simulated to the end of a hold as long as the scene's, of which the last quarter counts, as in a run. A
/// press that begins with a light touch is held there too: a hand that pushes less keeps the device in the wall less.
///
/// # Errors
/// Settings that the law cannot have.
pub fn ends(scene: &Scene, contact: &Contact, hand: &Hand) -> Result<[f64; 2]> {
    let ticks = (hold_s(contact) / contact.clock.period_s).ceil().max(TICKS) as u64;
    let limit_rad = Terms::of(scene).limit_cycle_rad;
    let mut found = [f64::INFINITY, 0.0_f64];
    let press_n_m = contact.played_press_n_m;
    for push_n_m in [Some(press_n_m), contact.touch_n_m].into_iter().flatten() {
        let touched = Touched::of(scene, contact, Some(hand), push_n_m);
        for share in SPEEDS_TO_THE_END {
            for before in phases(PHASES_TO_THE_END) {
                let mut rest = Rest {
                    from: (ticks as f64 * JUDGED_AFTER) as u64,
                    ticks: 0,
                    ends_rad: [f64::INFINITY, f64::NEG_INFINITY],
                };
                touched.play((share, before), ticks, &mut rest, |_| false)?;
                let motion = (rest.ends_rad[1] - rest.ends_rad[0]) / limit_rad;
                let motion = if motion.is_nan() {
                    f64::INFINITY
                } else {
                    motion
                };
                found = [found[0].min(motion), found[1].max(motion)];
            }
        }
    }
    Ok(found)
}

/// How much a press borrows if the loan is unlimited, over the real loan: the scene's press is simulated with it.
/// `None` without a loan or a press.
///
/// # Errors
/// Settings that the law cannot have.
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

/// An energy larger than any press borrows.
const ENDLESS_J: f64 = 1e3;

/// A hand that holds no place pushes through a spring so soft, N·m/rad, that it is a force.
const LEAST_STIFFNESS: f64 = 2e-3;

/// The hand of a plant in the form in which a scene writes it.
#[must_use]
pub fn of_plant(hand: &Hand) -> scene::Hand {
    scene::Hand {
        inertia_kg_m2: hand.inertia,
        damping_n_m_s_per_rad: hand.damping,
        stiffness_n_m_per_rad: hand.stiffness.max(LEAST_STIFFNESS),
        pad_damping_n_m_s_per_rad: hand.pad_damping,
        pad_stiffness_n_m_per_rad: hand.pad_stiffness,
    }
}
