//! Simulated slow presses, for walls on which simulated touches do not show enough. A slow press excites an offset of the law that
//! decays slowly, and uses more of the energy that the law may give out beyond what it took.

use super::contact::Contact;
use super::touch::hold_s;
use crate::scene_hand::of_plant;
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::record::Verdict;
use touchstone_sim::run::terms::Terms;
use touchstone_sim::scene::{Grip, MotionSpec, Number, RampAndHold, Scene};
use touchstone_world::plant::Hand;

/// Durations of the simulated presses, from rest outside the wall to the full push, s: one brisk, two slow. The validation campaign
/// presses in 0.3 s.
pub(super) const RAMPS_S: [f64; 3] = [0.12, 0.5, 1.5];

/// Least and largest motion at the end of the hold, peak to peak, over presses with the ramps of `RAMPS_S`. Both are multiples of
/// a limit cycle's threshold (four encoder counts). A press with the verdict unstable counts as infinite.
///
/// The simulation includes encoder counts, dry friction and the law's energy loan, but not the energy guard.
///
/// # Errors
/// The control law does not accept the scene's settings.
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
