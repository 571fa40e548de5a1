//! The limits around the matrices, and what is said of a hand by them.

use super::Verdict;
use super::contact::Contact;
use serde::Serialize;

/// Slowest decay that still is called stable, 1/s.
pub const SLOWEST_PER_S: f64 = 1.0;
/// Slowest decay that still is called stable where dry friction ends it, 1/s.
pub const SLOWEST_WITH_FRICTION_PER_S: f64 = 0.3;
/// Least dry friction that ends a decay, of the press.
pub const ENDING_FRICTION: f64 = 0.01;
/// Share of a hold after which its rest is judged.
pub const JUDGED_AFTER: f64 = 0.75;
/// Largest share of its loan that a press may borrow.
pub const LOAN_USED: f64 = 1.0;
/// Growth from which on a motion is called unstable, 1/s.
pub const FASTEST_GROWTH_PER_S: f64 = 0.25;
/// Largest gain of rounding to the nearest count on a sinusoid of four counts peak to peak or more, by its describing function.
pub const ROUNDING_GAIN: f64 = 1.05;
/// Largest motion from rounding, root mean square, counts: four counts peak to peak, the threshold of a limit cycle, are nine times it.
pub const ROUNDING_RMS_COUNTS: f64 = 0.45;
/// Largest speed of a bounce's return over that of its touch, over all phases of the tick, that is called stable: bounces, which meet
/// every phase, die away.
pub const BOUNCE: f64 = 1.1;
/// The same from which on it is called unstable.
pub const BOUNCE_GROWS: f64 = 1.7;
/// Amplitude of a motion that still is rest, counts.
pub const LEFT_COUNTS: f64 = 2.0;

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
    /// The same with what dry friction takes from a swing of [`SWING`](super::contact::SWING) times the press' depth, as damping; absent without either.
    pub decay_with_friction_per_s: Option<f64>,
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
    /// Largest speed of a bounce's return over that of its touch.
    pub bounce: f64,
    /// What the press borrows at most, of the loan; absent without a loan or a press.
    pub loan_used: Option<f64>,
    /// Amplitude below which dry friction stops a motion that would grow without it, rad; 0 without friction.
    pub friction_holds_rad: f64,
}

/// Gives a report its verdict and causes; `phase` is that of its slowest motion.
pub(super) fn judge(contact: &Contact, report: &mut HandReport, phase: &str) {
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
    // Or slowly, but to less than what is seen before the hold's last quarter, by which a run is judged.
    let in_time = contact.swing_counts().is_some_and(|swing| {
        let hold_s = contact.hold_s.unwrap_or(0.0);
        report.decay_per_s > 0.0
            && swing * (-report.decay_per_s * JUDGED_AFTER * hold_s).exp() < LEFT_COUNTS
    });
    let dies_out = report.decay_per_s >= slowest
        || in_time
        || report
            .decay_with_friction_per_s
            .is_some_and(|decay| decay >= SLOWEST_PER_S);
    if dies_out {
        // By itself, or by dry friction.
    } else if report.decay_per_s < -FASTEST_GROWTH_PER_S {
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
    } else {
        say(
            Verdict::Undecided,
            format!("{phase}: decays at {:.2} /s only", report.decay_per_s),
        );
    }
    if dies_out {
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
        if let Some(used) = report.loan_used.filter(|used| *used > LOAN_USED) {
            say(
                Verdict::Undecided,
                format!("the press borrows {used:.2} of the loan"),
            );
        }
        if report.bounce > BOUNCE {
            let back = report.bounce;
            say(
                if back > BOUNCE_GROWS {
                    Verdict::Unstable
                } else {
                    Verdict::Undecided
                },
                format!("a bounce comes back with {back:.2} of its speed"),
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
