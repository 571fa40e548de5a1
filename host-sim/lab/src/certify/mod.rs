//! Stability certificates: is the loop of law, plant, delay and hand stable for every hand of a set?
//!
//! The loop's matrix from one sample to the next is exact where law and plant are linear. [`plant`] derives the mechanical side,
//! [`law`] the control laws, [`estimator`] a state estimator between plant and law, [`sector`] the change between two linear phases
//! of a law. [`hands`] has the set of hands. Equations (1) to (16) are numbered through these modules.
//!
//! The matrices call a loop with a hand **stable** if all of these conditions hold:
//!
//! - Every phase in which the law can stay decays faster than [`judge::SLOWEST_PER_S`], or within the hold if the scene has one.
//!   Dry friction counts as damping for an oscillation as large as the press.
//! - The loop is also stable while readings are multiplied by [`judge::ROUNDING_GAIN`]. Rounding to counts can act like such a
//!   gain.
//! - Rounding to counts moves a knob at rest by less than [`judge::ROUNDING_RMS_COUNTS`].
//! - The loop is stable at every gain between the phases. Gains that depend on the amplitude are tried one by one; if a gain
//!   depends on the direction of the motion, the circle criterion (16) must hold.
//! - Bounces decay, and the press uses no more energy than the enhanced law's loan.
//!
//! The loop is called **unstable** if a bounce returns with more than [`judge::BOUNCE_GROWS`] times the speed of the touch, or if
//! the motion grows in a phase in which the law stays. The growth counts if it is faster than [`judge::FASTEST_GROWTH_PER_S`] and
//! dry friction could not stop the motion at an amplitude of four fifths of the press' depth.
//!
//! Matrices do not describe the change between phases, nor a device that leaves the wall and returns. Therefore touches are
//! simulated to their end, unless the matrices say unstable, or the law reduces its force by energy or changes a gain by
//! direction. The verdict is **stable** if all simulations come to rest, **unstable** if none does, **undecided** if only some
//! do. The certificate gives the cause. The matrices are exact. Bounces, the law's energy loan and touches are simulated by
//! [`touch`]. The limits of [`judge`] were chosen by experience with the random runs of [`campaign`].

pub mod campaign;
pub mod contact;
mod damped;
pub mod estimator;
pub mod feel;
pub mod hand_report;
pub mod hands;
pub mod judge;
pub mod law;
pub mod linear_law;
pub mod margins;
mod not_covered;
pub mod plant;
pub mod press;
pub mod sector;
pub mod state_space;
#[cfg(test)]
mod tests;
pub mod touch;

use contact::Contact;
use hand_report::{Played, report};
use hands::Family;
use judge::{HandReport, RESTS, asks_for_presses, settle, within_reach};
use margins::Margins;
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;
use touchstone_world::plant::Hand;

/// Verdict of a certificate, from good to bad.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// A press on the wall comes to rest.
    Stable,
    /// Neither the matrices nor the simulations decide.
    Undecided,
    /// A motion grows, or bounces out of the wall grow.
    Unstable,
}

impl Verdict {
    /// Name of the verdict in lower case, for results files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Stable => "stable",
            Verdict::Undecided => "undecided",
            Verdict::Unstable => "unstable",
        }
    }
}

/// Options of a certificate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CertifyOptions {
    /// The set of hands that is examined.
    pub family: Family,
    /// Whether stability margins are calculated, which takes most of the time.
    pub margins: bool,
    /// Bandwidth of the current controller, Hz; absent if the torque follows its command at once, as in simulated runs.
    pub current_loop_hz: Option<f64>,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self {
            family: Family::All,
            margins: true,
            current_loop_hz: None,
        }
    }
}

/// Stability certificate of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// Name of the scene.
    pub scene: String,
    /// Worst verdict over the scene's hand and the three simulated grips (light, medium, firm). Without any hand, the verdict for
    /// the free device.
    pub verdict: Verdict,
    /// Verdict for the worst hand whose parameters are within [`hands::RANGES`]; `None` if it was not searched.
    pub every_hand: Option<Verdict>,
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Stiffness of the wall as the angle in rad by which the device's oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
    /// Results for every examined hand.
    pub hands: Vec<HandReport>,
    /// Index in `hands` of the hand that determines `verdict`.
    pub worst: usize,
    /// Stability margins over the scene's hand and the three simulated grips (light, medium, firm); `None` if they were not
    /// requested.
    pub margins: Option<Margins>,
    /// Effects that the certificate does not cover, one sentence each.
    pub not_covered: Vec<String>,
}

/// Computes the stability certificate of a scene.
///
/// # Errors
/// The control law does not accept the scene's settings.
pub fn certify(scene: &Scene, options: &CertifyOptions) -> Result<Certificate> {
    let mut contact = Contact::of(scene)?;
    contact.current_loop_hz = options.current_loop_hz;
    let mut holders: Vec<(String, Option<Hand>)> = Vec::new();
    if let Some(hand) = touchstone_sim::run::plan::hand(scene) {
        holders.push((
            format!("scene ({})", scene.operator.grip.name()),
            Some(hand),
        ));
    }
    if options.family != Family::Own {
        for (name, hand) in hands::GRIPS {
            if holders.iter().all(|(_, other)| *other != Some(hand)) {
                holders.push((name.to_owned(), Some(hand)));
            }
        }
        if options.family == Family::All {
            let (hand, _) = hands::worst(|hand| contact.radius(Some(hand)));
            holders.push((hands::HYPOTHETICAL.to_owned(), Some(hand)));
        }
    }
    if options.family != Family::Own || holders.is_empty() {
        holders.push(("nobody".to_owned(), None));
    }
    let hands: Vec<HandReport> = holders
        .iter()
        .map(|(name, hand)| {
            let played = Played {
                bounce: touch::bounce(scene, &contact, hand.as_ref())?,
                loan_used: touch::loan_used(scene, &contact, hand.as_ref())?,
            };
            let mut report = report(&contact, name, hand.as_ref(), played);
            // A law that reduces its force by energy, or changes its gain by direction, may behave as no simulated touch has
            // shown.
            let shown = contact.phases.clamps.is_none() && !contact.phases.by_direction;
            // Matrices do not describe what happens between phases, or when a device leaves the wall and comes back.
            let alone = report.verdict == Verdict::Unstable;
            if let (Some(hand), true, false) = (hand, shown, alone) {
                let touches = touch::ends(scene, &contact, hand)?;
                // If a touch does not come to rest, presses need not be simulated.
                let presses = (asks_for_presses(&report) && touches[1] <= RESTS)
                    .then(|| press::ends(scene, &contact, hand))
                    .transpose()?;
                settle(&mut report, touches, presses);
            }
            within_reach(&mut report, per_tick(&contact));
            Ok(report)
        })
        .collect::<Result<_>>()?;
    let every_hand = hands
        .iter()
        .find(|report| report.name == hands::HYPOTHETICAL)
        .map(|report| report.verdict);
    // Without a hand the wall only pushes the device out.
    let counts =
        |report: &HandReport| report.name != hands::HYPOTHETICAL && report.parameters.is_some();
    let worst = (0..hands.len())
        .filter(|&index| hands.len() == 1 || counts(&hands[index]))
        .max_by(|&a, &b| {
            (hands[a].verdict, hands[a].radius)
                .partial_cmp(&(hands[b].verdict, hands[b].radius))
                .unwrap_or(std::cmp::Ordering::Equal)
        })
        .unwrap_or(0);
    let margins = options.margins.then(|| {
        let pressing: Vec<_> = holders
            .iter()
            .filter(|(name, _)| name != hands::HYPOTHETICAL)
            .filter_map(|(_, hand)| *hand)
            .collect();
        margins::of(scene, &contact, &pressing)
    });
    Ok(Certificate {
        scene: scene.name.clone(),
        verdict: hands
            .get(worst)
            .map_or(Verdict::Undecided, |report| report.verdict),
        every_hand,
        k_desired: contact.k_desired,
        stiffness_per_tick: per_tick(&contact),
        hands,
        worst,
        margins,
        not_covered: not_covered::list(scene, &contact),
    })
}

/// Angle in rad by which the device's oscillation on the wall advances per control period `T`: `T sqrt(k_de/J)`, with requested
/// stiffness `k_de` and inertia `J`.
fn per_tick(contact: &Contact) -> f64 {
    contact.clock.period_s * (contact.k_desired / contact.device.inertia).sqrt()
}
