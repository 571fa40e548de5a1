//! A certificate for a wall: is the loop of law, plant, delay and hand stable, for every hand of a family?
//!
//! The loop's matrix from one sample to the next is exact where law and plant are linear: [`plant`] derives the mechanical side,
//! [`law`] the laws, [`estimator`] a state estimator between the two, [`sector`] what may switch between two linear phases.
//! [`hands`] says for whom. Equations (1) to (16) are numbered through these files.
//!
//! **Stable** is said of a hand where every lasting phase decays faster than [`judge::SLOWEST_PER_S`], or in time for the hold
//! where the scene has one (with the damping that dry friction is to a swing of the press) and is stable while a reading is taken up to [`judge::ROUNDING_GAIN`] times,
//! where rounding moves the rest by less than [`judge::ROUNDING_RMS_COUNTS`], every gain between the phases is stable, bounces die away and the
//! press borrows less than the loan. The gains between the phases are tried one by one
//! where the law's bounds change them with the amplitude. Where a law changes its gain with the direction of the motion, (16) must
//! hold. **Unstable** where a phase in which the law stays grows by more than [`judge::FASTEST_GROWTH_PER_S`], and dry friction could not hold most
//! of the depth of the press, or where bounces grow. Of everything else, and of what
//! would be called stable, touches are played to
//! their end, as a matrix knows neither what comes between two phases nor a device that leaves the wall and comes back: **stable** where all come to rest, **unstable** where none does, **undecided** where some do. The certificate gives the cause. The
//! matrices are exact. Bounces, loan and ends are no matrices: [`touch`] plays them. The limits around it all are judgement, set on random runs of
//! [`campaign`].

pub mod campaign;
pub mod contact;
mod damped;
pub mod estimator;
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
    /// The wall comes to rest.
    Stable,
    /// The matrix does not decide.
    Undecided,
    /// Grows.
    Unstable,
}

impl Verdict {
    /// The verdict in lower case.
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
pub struct Options {
    /// The hands for which it is stable.
    pub family: Family,
    /// Whether margins are looked for, which takes most of the time.
    pub margins: bool,
    /// Bandwidth of a current loop, Hz; absent: the torque follows its command at once, as in a run.
    pub current_loop_hz: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            family: Family::All,
            margins: true,
            current_loop_hz: None,
        }
    }
}

/// The certificate of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// The scene.
    pub scene: String,
    /// The worst verdict over the scene's hand and the grips; without any hand, that of the free device.
    pub verdict: Verdict,
    /// The verdict for the hypothetical hand that is worst in the whole family; `None` where it was not searched.
    pub every_hand: Option<Verdict>,
    /// `k_de`, N·m/rad.
    pub k_desired: f64,
    /// `T sqrt(k_de/J)`.
    pub stiffness_per_tick: f64,
    /// Every hand.
    pub hands: Vec<HandReport>,
    /// Index in `hands` of the one that `verdict` is of.
    pub worst: usize,
    /// Margins over the scene's hand and the grips.
    pub margins: Option<Margins>,
    /// Effects that the certificate does not cover.
    pub not_covered: Vec<String>,
}

/// Certifies a scene.
///
/// # Errors
/// Settings that the law cannot take.
pub fn certify(scene: &Scene, options: &Options) -> Result<Certificate> {
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
            // A law that clamps or switches by direction may yet do what no touch here has shown.
            let shown = contact.phases.clamps.is_none() && !contact.phases.by_direction;
            // Nor do matrices say what happens between phases, or where a device leaves the wall and comes back.
            let alone = report.verdict == Verdict::Unstable;
            if let (Some(hand), true, false) = (hand, shown, alone) {
                let touches = touch::ends(scene, &contact, hand)?;
                // Where a touch does not rest, a press does not change that.
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
    // A device that nobody holds is only pushed out.
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

/// `T sqrt(k_de/J)`.
fn per_tick(contact: &Contact) -> f64 {
    contact.clock.period_s * (contact.k_desired / contact.device.inertia).sqrt()
}
