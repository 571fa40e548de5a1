//! The effects that a certificate does not cover.

use touchstone_sim::run::effects::EFFECTS;
use touchstone_sim::scene::Scene;

use super::contact::Contact;
use super::law::Clamp;
use super::press::RAMPS_S;

/// Names of simulated effects that the certificate covers, or that it mentions elsewhere.
const COVERED: [&str; 9] = [
    "encoder",
    "delay",
    "torque-limit",
    "amplifier-steps",
    "friction",
    "hand",
    "velocity-filtered",
    "velocity-kalman",
    "velocity-kalman-acceleration",
];

/// Lists everything that the certificate of a scene does not cover, one sentence each.
pub(super) fn list(scene: &Scene, contact: &Contact) -> Vec<String> {
    let mut list = vec![
        "hands outside the family, and hands that push back on purpose".to_owned(),
        "loss of contact in the middle of an oscillation, and how hard a wall throws back"
            .to_owned(),
        format!(
            "presses with other ramp times than the simulated ones, {RAMPS_S:?} s, where an offset decays slowly"
        ),
        "force limits: a law or drive at its limit is softer than the linear model".to_owned(),
        "compliance between encoder and hand, cogging, noise, a wrong torque constant".to_owned(),
        format!(
            "rounding inside the law ({}); rounding of readings and torques but for its gain and mean square",
            touchstone_control::Choice::word(scene.law.number)
        ),
    ];
    let beyond: Vec<&str> = EFFECTS
        .iter()
        .filter(|effect| (effect.is_named)(scene) && !COVERED.contains(&effect.name))
        .map(|effect| effect.name)
        .collect();
    if !beyond.is_empty() {
        list.push(format!(
            "effects of the scene that the linear model does not include: {}",
            beyond.join(", ")
        ));
    }
    if scene.law.guard.on {
        list.push(
            "the energy guard: where it gives less force, the wall is a softer one".to_owned(),
        );
    }
    if contact.current_loop_hz.is_none() {
        list.push("a current loop: the torque follows its command at once".to_owned());
    }
    if contact.device.friction.is_some() {
        list.push(
            "dry friction: left out of the linear model, where it would only damp".to_owned(),
        );
    }
    match contact.phases.clamps {
        Some(Clamp::Tdpa) => {
            list.push("the law's passivity control: the spring alone is certified".to_owned())
        }
        Some(Clamp::Fba) => {
            list.push("the law's force bound: the spring alone is certified".to_owned())
        }
        None => {}
    }
    if contact.phases.first_contact.is_some() {
        list.push(
            "first contact at k_de: judged by how fast a bounce comes back, as it ends at the first turn"
                .to_owned(),
        );
        list.push(
            "the passivity control at the virtual mass, where the credit is spent".to_owned(),
        );
    }
    list
}
