//! Limits for the matrices' results, and the verdict on a hand by them.

use super::Verdict;
use super::contact::Contact;
use super::law::OFFSET_UPDATED;
use serde::Serialize;

/// Slowest decay that still is called stable where the scene has no hold in which it must end, 1/s.
pub const SLOWEST_PER_S: f64 = 1.0;
/// Share of a hold by which a decay must have ended for the matrices to call it stable: bounces and a law's other phases take the rest.
pub const DECAYS_WITHIN: f64 = 0.5;
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
pub const BOUNCE: f64 = 1.0;
/// Growth of bounces from which on a wall is called unstable.
pub const BOUNCE_GROWS: f64 = 1.7;
/// Largest `T sqrt(k_de/J)` of a wall that is called stable. The campaigns draw walls up to it. Beyond it, a device
/// may come to rest from every simulated touch and yet go on bouncing after a harder one.
pub const STIFFEST_PER_TICK: f64 = 1.0;
/// Amplitude of a motion that still is rest, counts.
pub const LEFT_COUNTS: f64 = 1.5;

/// Largest motion at the end of everything that is played, over a limit cycle's, that is called rest.
pub const RESTS: f64 = 0.5;
/// The limit that applies where the matrices alone have called it stable.
pub const RESTS_AS_SAID: f64 = 0.75;
/// Least motion at the end of every such touch, over a limit cycle's, that is called none.
pub const MOVES: f64 = 1.5;

/// A phase of the law in one hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseReport {
    /// Name of the phase.
    pub phase: &'static str,
    /// Largest magnitude of an eigenvalue.
    pub radius: f64,
    /// How fast its slowest motion dies out, 1/s.
    pub decay_per_s: f64,
    /// Frequency of the slowest motion, Hz.
    pub frequency_hz: f64,
}

/// The report on one hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HandReport {
    /// `scene`, a grip, `worst of all`, or `nobody`.
    pub name: String,
    /// Inertia, damping, stiffness, pad's damping, pad's stiffness, SI; absent: nobody holds the device.
    pub parameters: Option<[f64; 5]>,
    /// The verdict.
    pub verdict: Verdict,
    /// Why not stable.
    pub causes: Vec<String>,
    /// Every phase, the first contact last.
    pub phases: Vec<PhaseReport>,
    /// Largest eigenvalue over the lasting phases.
    pub radius: f64,
    /// How fast the slowest motion dies out, 1/s.
    pub decay_per_s: f64,
    /// The same decay with dry friction as damping: what friction takes from a swing of
    /// [`SWING`](super::contact::SWING) times the press' depth; `None` without either.
    pub decay_with_friction_per_s: Option<f64>,
    /// Frequency of the slowest motion, Hz.
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
    /// The most that the press borrows, as a share of the loan; `None` without a loan or a press.
    pub loan_used: Option<f64>,
    /// Least and largest motion at the end of the touches that were played, over what counts as a limit cycle.
    pub ends: Option<[f64; 2]>,
    /// The same for slow presses, where an offset dies out too slowly or a press borrows more than the loan.
    pub presses: Option<[f64; 2]>,
    /// Amplitude below which dry friction stops a motion that would grow without it, rad; 0 without friction.
    pub friction_holds_rad: f64,
    /// Whether a motion is left that a press which comes slowly stirs more than a touch: that of an offset, which dies out too slowly.
    #[serde(skip)]
    pub stirred_by_ramp: bool,
}

/// Gives a report its verdict and causes; `phase` is that of its slowest motion.
pub(super) fn judge(contact: &Contact, report: &mut HandReport, phase: &str) {
    let mut found: Vec<(Verdict, String)> = Vec::new();
    let mut say = |verdict, cause| found.push((verdict, cause));
    // In a hold that is known: to less than what is seen.
    let dies = |decay_per_s: f64| match (contact.swing_counts(), contact.hold_s) {
        (Some(swing), Some(hold_s)) => {
            decay_per_s > 0.0 && swing * (-decay_per_s * DECAYS_WITHIN * hold_s).exp() < LEFT_COUNTS
        }
        _ => decay_per_s >= SLOWEST_PER_S,
    };
    // Dry friction may end what decays. What grows without it ends only if it never swings further than was reckoned with.
    let dies_out = dies(report.decay_per_s)
        || report.decay_per_s > 0.0 && report.decay_with_friction_per_s.is_some_and(dies);
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
        report.stirred_by_ramp = phase == OFFSET_UPDATED;
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
    if let Some(used) = report.loan_used.filter(|used| *used > LOAN_USED) {
        say(
            Verdict::Undecided,
            format!("the press borrows {used:.2} of the loan"),
        );
    }
    report.verdict = found
        .iter()
        .map(|(verdict, _)| *verdict)
        .max()
        .unwrap_or(Verdict::Stable);
    report.causes = found.into_iter().map(|(_, cause)| cause).collect();
}

/// Withdraws "stable" for a wall that is stiffer than the certificates were validated for.
pub(super) fn within_reach(report: &mut HandReport, stiffness_per_tick: f64) {
    if report.verdict == Verdict::Stable && stiffness_per_tick > STIFFEST_PER_TICK {
        report.verdict = Verdict::Undecided;
        report.causes.push(format!(
            "T sqrt(k_de/J) is {stiffness_per_tick:.2}, and certificates were held against runs up to {STIFFEST_PER_TICK} only"
        ));
    }
}

/// Whether slow presses have to be simulated, since they do what no touch shows.
pub(super) fn asks_for_presses(report: &HandReport) -> bool {
    report.stirred_by_ramp || report.loan_used.is_some_and(|used| used > LOAN_USED)
}

/// Decides what the matrices left open, by how simulated touches and slow presses end, and checks what the matrices
/// called stable against them. Where some come to rest and some do not, the verdict is undecided.
pub(super) fn settle(report: &mut HandReport, touches: [f64; 2], presses: Option<[f64; 2]>) {
    (report.ends, report.presses) = (Some(touches), presses);
    let [mut least, mut most] = touches;
    let (mut each, mut all) = ("touch that was played", "touches that were played");
    if let Some(ends) = presses {
        (least, most) = (least.min(ends[0]), most.max(ends[1]));
        (each, all) = (
            "touch and slow press that was played",
            "touches and slow presses that were played",
        );
    }
    let said = report.verdict == Verdict::Stable;
    let rests = if said { RESTS_AS_SAID } else { RESTS };
    // A few presses do not speak for all where the law by itself grows, and dry friction alone holds it.
    let shown = presses.is_some() && report.decay_per_s > 0.0;
    if most <= rests && (shown || !asks_for_presses(report)) {
        if said {
            return;
        }
        report.verdict = Verdict::Stable;
        report.causes.push(format!(
            "but every {each} comes to rest: at most {most:.2} of a limit cycle is left"
        ));
    } else if least >= MOVES {
        report.verdict = Verdict::Unstable;
        report.causes.push(format!(
            "and no {each} comes to rest: at least {least:.1} of a limit cycle is left"
        ));
    } else {
        report.verdict = Verdict::Undecided;
        report.causes.push(format!(
            "{all} leave {least:.2} to {most:.2} of a limit cycle"
        ));
    }
}
