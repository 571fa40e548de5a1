//! Slow presses, which are simulated where touches do not show enough. A slow press stirs an offset that dies out
//! slowly, and borrows more of a loan than a touch does.

use super::contact::Contact;
use super::touch::{hold_s, of_plant};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::record::Verdict;
use touchstone_sim::run::terms::Terms;
use touchstone_sim::scene::{Grip, MotionSpec, Number, RampAndHold, Scene};
use touchstone_world::plant::Hand;

/// Times from rest outside to the full push, s: brisk, and slow. The campaigns press in 0.3 s.
pub(super) const RAMPS_S: [f64; 3] = [0.12, 0.5, 1.5];

/// How presses of these ramps end: the least and the largest motion in the last part of the hold, peak to peak, over what counts as a limit
/// cycle; infinite where the wall throws the device out. With counts, dry friction and the loan that there is; without the guard.
///
/// # Errors
/// Settings that the law cannot take.
pub fn ends(scene: &Scene, contact: &Contact, hand: &Hand) -> Result<[f64; 2]> {
    let mut pressed = scene.clone();
    pressed.operator.grip = Grip::Custom;
    pressed.operator.hand = Some(of_plant(hand));
    pressed.law.number = Number::F64;
    pressed.law.guard.on = false;
    let limit_rad = Terms::of(scene).limit_cycle_rad;
    let mut found = [f64::INFINITY, 0.0_f64];
    for ramp_s in RAMPS_S {
        let press = RampAndHold {
            push_torque_n_m: contact.played_press_n_m,
            ramp_s,
            hold_s: hold_s(contact),
            ..RampAndHold::default()
        };
        pressed.timing.duration_s = press.start_s + press.ramp_s + press.hold_s;
        pressed.operator.motion = MotionSpec::RampAndHold(press);
        let summary = run::run(&pressed, false)?.summary;
        let motion = match summary.verdict {
            Verdict::Unstable => f64::INFINITY,
            _ => summary.limit_cycle_peak_to_peak.unwrap_or(0.0) / limit_rad,
        };
        found = [found[0].min(motion), found[1].max(motion)];
    }
    Ok(found)
}
