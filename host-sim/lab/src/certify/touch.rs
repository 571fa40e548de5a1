//! Simulated touches: the motion of a device that bounces between a wall and the hand.
//!
//! Several laws start a contact as a spring of the requested stiffness until the motion turns, and only then behave as the
//! matrices describe. Bounces are therefore simulated. The pad of a hand at rest presses the device against the wall. The device
//! meets the wall at various moments of the tick (control period), comes out, and is pressed back. If the device returns more
//! slowly each time, the bounces decay, and the matrices decide.
//!
//! If the matrices do not decide, touches are simulated to the end of the press, with encoder counts, dry friction and the law's
//! energy loan: [`ends`].

use super::contact::Contact;
use super::judge::JUDGED_AFTER;
use crate::scene_hand::of_plant;
use touchstone_sim::error::Result;
use touchstone_sim::run::mechanics::Standing;
use touchstone_sim::run::terms::Terms;
use touchstone_sim::run::{self, Recorder, Tick, plan};
use touchstone_sim::scene::{Grip, MotionSpec, Number, RestPath, Scene};
use touchstone_world::plant::Hand;

/// Number of moments within a tick (control period) at which simulated devices cross the surface.
const PHASES: u32 = 12;
/// Speeds of the simulated touches, as multiples of the speed that carries the device as deep as the press.
const SPEEDS: [f64; 4] = [1.0, 1.5, 2.5, 4.0];

/// Duration of a bounce simulation, as a number of the device's oscillations on the wall. It is at least `TICKS` ticks.
const SWINGS: f64 = 8.0 * RETURNS as f64;
const TICKS: f64 = 400.0;

/// Number of returns to the wall that are simulated per touch.
const RETURNS: u32 = 4;

/// Speeds of the touches that are simulated to their end, as multiples of the speed that carries the device as deep as the press.
/// They are few, because each takes a whole hold. The three are a slow touch, one as deep as the press, and one that comes out of
/// the wall.
const SPEEDS_TO_THE_END: [f64; 3] = [0.2, 1.0, 3.0];
const PHASES_TO_THE_END: u32 = 4;
/// Duration of the hold in a scene without one, and the longest hold that is simulated, s.
const HOLD_S: f64 = 2.0;
const LONGEST_HOLD_S: f64 = 20.0;

/// Duration for which a press is held, s.
pub(super) fn hold_s(contact: &Contact) -> f64 {
    contact.hold_s.unwrap_or(HOLD_S).min(LONGEST_HOLD_S)
}

/// Recorder of the range of the device's motion at the end of a run.
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
            // `min` and `max` ignore NaN.
            self.ends_rad = if angle.is_nan() {
                [f64::NAN; 2]
            } else {
                [least.min(angle), most.max(angle)]
            };
        }
        self.ticks += 1;
    }
}

/// Recorder of the moment when the device leaves the wall, and of its speed when it returns.
struct Bounce {
    surface_rad: f64,
    held: bool,
    inside: bool,
    was_inside: bool,
    returns: u32,
    /// Speed of the last counted return to the wall, rad/s. Without a hand, which would bring the device back, the speed at which
    /// the device left.
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

/// A device at the wall's surface, with the pad of a hand at rest pressing it in.
struct Touched {
    scene: Scene,
    /// `ahead_rad`: compression of the pad; `beyond_rad`: stretch of the spring that holds the hand; both in rad.
    ahead_rad: f64,
    beyond_rad: f64,
    period_s: f64,
    /// Speed that carries the device as deep as the press, rad/s.
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
        // The push compresses the pad and stretches the spring that holds the hand at its rest point.
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

    /// Simulates a touch for `ticks` ticks, or until `done` returns true. The device starts with `share` times
    /// [`Self::speed_rad_per_s`], at the distance from the wall that it covers in the fraction `before` of a tick. The simulation
    /// runs in pieces of 64 ticks, because most bounces end early.
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

/// Moments within a tick at which the surface is crossed, as fractions of the tick.
fn phases(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |phase| (f64::from(phase) + 0.5) / f64::from(count))
}

/// Largest ratio, over all simulated touches, of a bounce's return speed to the speed of the touch before. For each touch it is
/// the geometric mean over `RETURNS` returns.
///
/// A touch with fewer returns counts as 0, one whose simulation diverges as infinite. Without a hand, the return speed is the
/// speed at which the device first leaves the wall.
///
/// # Errors
/// The control law does not accept the scene's settings.
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

/// Least and largest motion at the end of a pressing hand's touches, peak to peak, as multiples of a limit cycle's threshold (four
/// encoder counts).
///
/// Each touch is simulated to the end of a hold as long as the scene's; the last quarter is judged, as in a run. A press that
/// begins with a light touch is simulated at that torque too, because a hand that pushes less holds the device in the wall less
/// firmly.
///
/// # Errors
/// The control law does not accept the scene's settings.
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

/// Energy that the control law gives out in the scene's press beyond what it took, divided by the scene's limit of the loan. The
/// press is simulated with a loan without limit. `None` without a loan, a press or a hand.
///
/// # Errors
/// The control law does not accept the scene's settings.
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

/// Limit of the law's energy loan (energy given out beyond what it took) that is larger than any press can use, J.
const ENDLESS_J: f64 = 1e3;
