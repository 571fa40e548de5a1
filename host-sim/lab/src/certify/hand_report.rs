//! Builds the report on a loop with one hand: the eigenvalues of each phase, and results that the matrices do not contain.

use super::contact::Contact;
use super::contact::SWING;
use super::judge::{HandReport, PhaseReport, ROUNDING_GAIN, judge};
use super::law::Switching;
use super::linear_law::LinearLaw;
use super::state_space::Mode;
use super::{Verdict, hands, sector};
use touchstone_world::plant::Hand;

/// Results of simulated touches and presses, which the matrices do not describe, see [`super::touch`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Played {
    /// Largest ratio of the speed at which the device returns to the wall after a bounce to the speed of the touch before.
    pub bounce: f64,
    /// Energy that the control law gives out in the press beyond what it took, as a fraction of the largest energy that it may
    /// lend; `None` without a loan or a press.
    pub loan_used: Option<f64>,
}

/// Makes the report on one hand, with its verdict.
#[must_use]
pub fn report(contact: &Contact, name: &str, hand: Option<&Hand>, played: Played) -> HandReport {
    let rate_hz = 1.0 / contact.clock.period_s;
    let (mode, phase) = contact.worst(hand);
    let damped = with_friction(contact, &mode);
    let decay_with_friction_per_s = damped
        .as_ref()
        .map(|damped| damped.worst(hand).0.decay_per_s(rate_hz));
    // The phases, the rounding gain and the gains between phases are examined with dry friction counted as damping.
    let undamped = contact;
    let contact = damped.as_ref().unwrap_or(contact);
    let mut phases: Vec<_> = contact
        .phases
        .lasting
        .iter()
        .map(|phase| (phase.name, phase.law.clone()))
        .collect();
    if let Some(stiffness) = contact.phases.first_contact {
        phases.push(("first contact, k_de", LinearLaw::spring(stiffness, 0.0)));
    }
    let plant = contact.plant(hand);
    let phases = phases
        .into_iter()
        .filter_map(|(phase, law)| {
            let mode = Mode::dominant(&plant.as_ref()?.closed_by(&contact.law(&law), 1.0));
            Some(PhaseReport {
                phase,
                radius: mode.radius,
                decay_per_s: mode.decay_per_s(rate_hz),
                frequency_hz: mode.frequency_hz(rate_hz),
            })
        })
        .collect();
    let switching = match &contact.phases.switching {
        Switching::Never => None,
        Switching::Between(ends) => plant.as_ref().and_then(|plant| {
            let [from, to] = ends
                .each_ref()
                .map(|law| plant.closed_by(&contact.law(law), 1.0));
            sector::least_cosine(&from, &to)
        }),
    };
    let rounding = contact
        .count_rad
        .and_then(|_| undamped.rounding(hand).or_else(|| contact.rounding(hand)));
    let radius_rounded = match contact.count_rad {
        Some(_) => contact
            .radius_at_gain(hand, ROUNDING_GAIN)
            .max(contact.radius(hand)),
        None => mode.radius,
    };
    let mut report = HandReport {
        name: name.to_owned(),
        parameters: hand.map(hands::parameters),
        verdict: Verdict::Stable,
        causes: Vec::new(),
        phases,
        radius: mode.radius,
        decay_per_s: mode.decay_per_s(rate_hz),
        decay_with_friction_per_s,
        frequency_hz: mode.frequency_hz(rate_hz),
        radius_rounded,
        radius_between: contact.radius_between(hand),
        rounding_rms_counts: rounding.map(|(rms, _)| rms),
        rounding_most_counts: rounding.map(|(_, most)| most),
        switching,
        bounce: played.bounce,
        loan_used: played.loan_used,
        ends: None,
        presses: None,
        friction_holds_rad: friction_holds(undamped, hand, &mode),
        stirred_by_ramp: false,
    };
    judge(undamped, &mut report, phase);
    report
}

/// Replaces the dry friction of a contact by viscous damping, for an oscillation at the frequency of `mode` and with [`SWING`]
/// times the press' depth. The damping is the describing function `4 F/(π ω A)` of a friction torque `F`, frequency `ω` and
/// amplitude `A`; friction damps a smaller oscillation more. `None` without dry friction or a press, or if the motion of `mode`
/// does not oscillate.
fn with_friction(contact: &Contact, mode: &Mode) -> Option<Contact> {
    let friction = contact.device.friction?;
    let swing = SWING * contact.press_n_m? / contact.k_desired;
    let speed = mode.angle_rad / contact.clock.period_s;
    (speed > 0.0).then(|| {
        contact.with_damping(4.0 * friction.kinetic / (std::f64::consts::PI * speed * swing))
    })
}

/// Amplitude in rad below which dry friction stops the growing oscillation `mode`. At that amplitude the describing function of
/// friction, `4 F/(π ω A)`, equals the additional damping that just makes the loop stable. `F` is the friction torque, `ω` the
/// frequency and `A` the amplitude. 0 if the motion does not grow or does not oscillate, or if no tried damping makes the loop
/// stable.
fn friction_holds(contact: &Contact, hand: Option<&Hand>, mode: &Mode) -> f64 {
    let Some(friction) = contact.device.friction.filter(|_| mode.radius >= 1.0) else {
        return 0.0;
    };
    let stable = |damping: f64| contact.with_damping(damping).radius(hand) < 1.0;
    let unit = contact.device.damping.max(1e-9);
    let Some(enough) = (0..40)
        .map(|step| 1e-3 * unit * 1.5_f64.powi(step))
        .find(|&damping| stable(damping))
    else {
        return 0.0;
    };
    let speed = mode.angle_rad / contact.clock.period_s;
    if speed > 0.0 {
        4.0 * friction.kinetic / (std::f64::consts::PI * speed * enough)
    } else {
        0.0
    }
}
