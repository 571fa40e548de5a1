//! A certificate for a wall: is the loop of law, plant, delay and hand stable, for every hand of a family?
//!
//! The loop's matrix from one sample to the next is exact where law and plant are linear: [`plant`] derives the mechanical side,
//! [`law`] the laws, [`estimator`] a state estimator between the two, [`sector`] what may switch between two linear phases.
//! [`hands`] says for whom. Equations (1) to (16) are numbered through these files.
//!
//! **Stable** is said of a hand where every lasting phase decays faster than [`SLOWEST_PER_S`] (with dry friction of a hundredth of
//! the press, which ends a decay, faster than [`SLOWEST_WITH_FRICTION_PER_S`]) and is stable while a reading is taken up to
//! [`ROUNDING_GAIN`] times, where rounding moves the rest by less than [`ROUNDING_RMS_COUNTS`], every gain between the phases is stable, the
//! loan covers the press, and the first contact is slow enough for the sampler. The gains between the phases are tried one by one
//! where the law's bounds change them with the amplitude; where a law changes its gain with the direction of the motion, (16) must
//! hold. **Unstable** where a phase in which the law stays grows by more than [`FASTEST_GROWTH_PER_S`], and dry friction could not hold most
//! of the depth of the press. **Undecided** is everything else; the certificate gives the cause. The matrices are exact; the limits around them
//! are judgement, set on random runs of [`campaign`].

pub mod campaign;
pub mod contact;
pub mod estimator;
pub mod hands;
pub mod law;
pub mod margins;
mod not_covered;
pub mod plant;
pub mod sector;
pub mod state_space;
#[cfg(test)]
mod tests;

use contact::Contact;
use hands::Family;
use law::Switching;
use margins::Margins;
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;
use touchstone_world::plant::Hand;

/// Slowest decay that still is called stable, 1/s.
pub const SLOWEST_PER_S: f64 = 1.0;
/// Slowest decay that still is called stable where dry friction ends it, 1/s.
pub const SLOWEST_WITH_FRICTION_PER_S: f64 = 0.3;
/// Least dry friction that ends a decay, of the press.
pub const ENDING_FRICTION: f64 = 0.01;
/// How far a press may swing beyond its torque before it rests, where no dry friction ends it: its energy is five times as much.
pub const OVERSHOOT: f64 = 2.236;
/// Growth from which on a motion is called unstable, 1/s.
pub const FASTEST_GROWTH_PER_S: f64 = 0.25;
/// Largest gain of rounding to the nearest count on a sinusoid of four counts peak to peak or more, by its describing function.
pub const ROUNDING_GAIN: f64 = 1.05;
/// Largest motion from rounding, root mean square, counts: four counts peak to peak, the threshold of a limit cycle, are five times it.
pub const ROUNDING_RMS_COUNTS: f64 = 0.8;
/// Largest `T sqrt(k_de/J)` of a first contact at `k_de` that is called stable without delay; less by half with a tick of it.
pub const FIRST_CONTACT_PER_TICK: f64 = 0.8;

/// What a certificate says. The order is from good to bad.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Comes to rest.
    Stable,
    /// The matrix does not decide.
    Undecided,
    /// Grows.
    Unstable,
}

impl Verdict {
    /// In lower case.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Stable => "stable",
            Verdict::Undecided => "undecided",
            Verdict::Unstable => "unstable",
        }
    }
}

/// What is to be certified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// For which hands.
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

/// A phase of the law in one hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseReport {
    /// Its name.
    pub phase: &'static str,
    /// Largest magnitude of an eigenvalue.
    pub radius: f64,
    /// How fast its slowest motion dies out, 1/s.
    pub decay_per_s: f64,
    /// That motion's frequency, Hz.
    pub frequency_hz: f64,
}

/// One hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HandReport {
    /// `scene`, a grip, `worst of all`, or `nobody`.
    pub name: String,
    /// Inertia, damping, stiffness, pad's damping, pad's stiffness, SI; absent: nobody holds the device.
    pub parameters: Option<[f64; 5]>,
    /// What is said of it.
    pub verdict: Verdict,
    /// Why not stable.
    pub causes: Vec<String>,
    /// Every phase, the first contact last.
    pub phases: Vec<PhaseReport>,
    /// Largest eigenvalue over the lasting phases.
    pub radius: f64,
    /// How fast the slowest motion dies out, 1/s.
    pub decay_per_s: f64,
    /// That motion's frequency, Hz.
    pub frequency_hz: f64,
    /// Largest radius while a reading is taken 1 to [`ROUNDING_GAIN`] times.
    pub radius_rounded: f64,
    /// Motion from rounding to a count at rest, root mean square, counts; absent without an encoder or a stable loop.
    pub rounding_rms_counts: Option<f64>,
    /// Most motion from rounding that there can be, counts.
    pub rounding_most_counts: Option<f64>,
    /// Largest radius over gains between the phases.
    pub radius_between: f64,
    /// Least cosine of (16); above 0: whatever way the gain changes is covered. Absent where it does not, or an end is unstable.
    pub switching: Option<f64>,
    /// Amplitude below which dry friction stops a motion that would grow without it, rad; 0 without friction.
    pub friction_holds_rad: f64,
}

/// The certificate of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// The scene.
    pub scene: String,
    /// The worst over the hands that can press; nobody's device is only pushed out.
    pub verdict: Verdict,
    /// `k_de`, N·m/rad.
    pub k_desired: f64,
    /// `T sqrt(k_de/J)`.
    pub stiffness_per_tick: f64,
    /// Every hand.
    pub hands: Vec<HandReport>,
    /// Index of the worst hand in `hands`.
    pub worst: usize,
    /// Margins over all hands in `hands` that can press.
    pub margins: Option<Margins>,
    /// What the certificate says nothing of.
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
            holders.push(("worst of all".to_owned(), Some(hand)));
        }
    }
    if options.family != Family::Own || holders.is_empty() {
        holders.push(("nobody".to_owned(), None));
    }
    let hands: Vec<_> = holders
        .iter()
        .map(|(name, hand)| report(&contact, name, hand.as_ref()))
        .collect();
    let pressing = |report: &&HandReport| report.parameters.is_some() || hands.len() == 1;
    let verdict = hands
        .iter()
        .filter(pressing)
        .map(|report| report.verdict)
        .max()
        .unwrap_or(Verdict::Undecided);
    let worst = (0..hands.len())
        .filter(|&index| pressing(&&hands[index]))
        .max_by(|&a, &b| {
            (hands[a].verdict, hands[a].radius)
                .partial_cmp(&(hands[b].verdict, hands[b].radius))
                .unwrap_or(std::cmp::Ordering::Equal)
        })
        .unwrap_or(0);
    let margins = options.margins.then(|| {
        let pressing: Vec<_> = holders.iter().filter_map(|(_, hand)| *hand).collect();
        margins::of(scene, &contact, &pressing)
    });
    Ok(Certificate {
        scene: scene.name.clone(),
        verdict,
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

/// What is said of one hand.
#[must_use]
pub fn report(contact: &Contact, name: &str, hand: Option<&Hand>) -> HandReport {
    let rate_hz = 1.0 / contact.clock.period_s;
    let (mode, phase) = contact.worst(hand);
    let mut phases: Vec<_> = contact
        .phases
        .lasting
        .iter()
        .map(|phase| (phase.name, phase.law.clone()))
        .collect();
    if let Some(stiffness) = contact.phases.first_contact {
        phases.push((
            "first contact, k_de",
            law::LinearLaw::spring(stiffness, 0.0),
        ));
    }
    let plant = contact.plant(hand);
    let phases = phases
        .into_iter()
        .filter_map(|(phase, law)| {
            let mode =
                state_space::Mode::dominant(&plant.as_ref()?.closed_by(&contact.law(&law), 1.0));
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
    let rounding = contact.count_rad.and_then(|_| contact.rounding(hand));
    let radius_rounded = if contact.count_rad.is_some() {
        contact.radius_at_gain(hand, ROUNDING_GAIN).max(mode.radius)
    } else {
        mode.radius
    };
    let mut report = HandReport {
        name: name.to_owned(),
        parameters: hand.map(hands::parameters),
        verdict: Verdict::Stable,
        causes: Vec::new(),
        phases,
        radius: mode.radius,
        decay_per_s: mode.decay_per_s(rate_hz),
        frequency_hz: mode.frequency_hz(rate_hz),
        radius_rounded,
        radius_between: contact.radius_between(hand),
        rounding_rms_counts: rounding.map(|(rms, _)| rms),
        rounding_most_counts: rounding.map(|(_, most)| most),
        switching,
        friction_holds_rad: friction_holds(contact, hand, &mode),
    };
    judge(contact, &mut report, phase);
    report
}

/// Amplitude at which dry friction takes as much as the loop gives: with the describing function of friction, `4 F/(π ω A)`, in
/// place of the damping that just makes the loop stable.
fn friction_holds(contact: &Contact, hand: Option<&Hand>, mode: &state_space::Mode) -> f64 {
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

fn judge(contact: &Contact, report: &mut HandReport, phase: &str) {
    let mut found: Vec<(Verdict, String)> = Vec::new();
    let mut say = |verdict, cause| found.push((verdict, cause));
    let friction = contact
        .device
        .friction
        .map_or(0.0, |friction| friction.kinetic);
    let ends = contact
        .press_n_m
        .is_some_and(|press| friction >= ENDING_FRICTION * press);
    let slowest = if ends {
        SLOWEST_WITH_FRICTION_PER_S
    } else {
        SLOWEST_PER_S
    };
    if report.decay_per_s < -FASTEST_GROWTH_PER_S {
        let what = format!("{phase}: grows at {:.3} Hz", report.frequency_hz);
        let held = report.friction_holds_rad;
        // Without a press that is known, anything beyond two counts.
        let enough = contact.press_n_m.map_or_else(
            || 2.0 * contact.count_rad.unwrap_or(0.0),
            |press| 0.8 * press / contact.k_desired,
        );
        if contact.phases.clamps.is_some() {
            say(
                Verdict::Undecided,
                format!("{what}, the law's clamp decides"),
            );
        } else if held > 0.0 && held >= enough {
            say(
                Verdict::Undecided,
                format!("{what}, dry friction stops it below {held:.2e} rad"),
            );
        } else {
            say(Verdict::Unstable, what);
        }
    } else if report.decay_per_s < slowest {
        say(
            Verdict::Undecided,
            format!("{phase}: decays at {:.2} /s only", report.decay_per_s),
        );
    }
    if report.decay_per_s >= slowest {
        if report.radius_rounded >= 1.0 {
            say(
                Verdict::Undecided,
                "rounding to counts may keep it oscillating".to_owned(),
            );
        }
        if contact.count_rad.is_some()
            && report
                .rounding_rms_counts
                .is_none_or(|rms| rms > ROUNDING_RMS_COUNTS)
        {
            say(
                Verdict::Undecided,
                "rounding to counts moves it by more than counts".to_owned(),
            );
        }
        if report.radius_between >= 1.0 {
            say(
                Verdict::Undecided,
                "a gain between the law's phases is not stable".to_owned(),
            );
        }
        if contact.phases.by_direction && report.switching.is_none_or(|cosine| cosine <= 0.0) {
            say(
                Verdict::Undecided,
                "a gain that changes with the direction of the motion is not covered".to_owned(),
            );
        }
        if let (Some(most), Some(press)) = (contact.phases.loan_covers_n_m, contact.press_n_m)
            && press * if ends { 1.0 } else { OVERSHOOT } > most
        {
            say(
                Verdict::Undecided,
                format!(
                    "the loan covers torques up to {most:.3} N·m, which the press may swing beyond"
                ),
            );
        }
        let ticks = contact.clock.delay_s / contact.clock.period_s;
        let limit = FIRST_CONTACT_PER_TICK / (1.0 + ticks);
        if contact.phases.first_contact.is_some() && per_tick(contact) > limit {
            say(
                Verdict::Undecided,
                format!("first contact: T sqrt(k_de/J) is above {limit:.2}"),
            );
        }
    }
    report.verdict = found
        .iter()
        .map(|(verdict, _)| *verdict)
        .max()
        .unwrap_or(Verdict::Stable);
    report.causes = found.into_iter().map(|(_, cause)| cause).collect();
}
