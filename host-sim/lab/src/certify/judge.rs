//! Derives the verdict for one hand from the matrices' results, and defines the limits that decide the verdict.

use super::Verdict;
use super::contact::Contact;
use super::law::OFFSET_UPDATED;
use serde::Serialize;

/// Slowest decay of a motion that is called stable, 1/s, in a scene without a hold. With a hold, the motion must decay within the
/// fraction [`DECAYS_WITHIN`] of the hold.
pub const SLOWEST_PER_S: f64 = 1.0;
/// Fraction of a press' hold within which a motion, decaying as its eigenvalue says, must fall below [`LEFT_COUNTS`]. The rest of
/// the hold is left for bounces and other phases of the control law.
pub const DECAYS_WITHIN: f64 = 0.5;
/// Fraction of a hold after which the simulation judges whether the knob rests.
pub const JUDGED_AFTER: f64 = 0.75;
/// Largest fraction of the law's energy loan (energy that it may give out beyond what it took) that a press may use.
pub const LOAN_USED: f64 = 1.0;
/// Rate of exponential growth above which a motion is called unstable, 1/s.
pub const FASTEST_GROWTH_PER_S: f64 = 0.25;
/// Largest gain of rounding to the nearest encoder count, by its describing function, for a sinusoid of four counts or more peak to
/// peak.
pub const ROUNDING_GAIN: f64 = 1.05;
/// Largest motion caused by rounding that is called stable, root mean square, encoder counts. The threshold of a limit cycle, four
/// counts peak to peak, is nine times this motion.
pub const ROUNDING_RMS_COUNTS: f64 = 0.45;
/// Limit for calling a wall stable: the largest ratio of a bounce's return speed to the speed of its touch, over all moments of
/// touch within a tick. Up to this ratio bounces decay.
pub const BOUNCE: f64 = 1.0;
/// Limit for calling a wall unstable: ratio of a bounce's return speed to the speed of its touch.
pub const BOUNCE_GROWS: f64 = 1.7;
/// Stiffest wall that is called stable: angle in rad by which the device's oscillation on the wall advances per control period. The
/// validation runs go up to this value. On a stiffer wall a device may rest after every simulated touch and yet keep bouncing after
/// a harder one.
pub const STIFFEST_PER_TICK: f64 = 1.0;
/// Amplitude of a motion below which the knob counts as at rest, encoder counts.
pub const LEFT_COUNTS: f64 = 1.5;

/// Largest motion at the end of all simulated touches and presses that counts as rest, as a fraction of a limit cycle's threshold
/// (four encoder counts).
pub const RESTS: f64 = 0.5;
/// Largest motion at the end of simulated touches that counts as rest if the matrices alone have called the wall stable. It is a
/// fraction of a limit cycle's threshold (four encoder counts).
pub const RESTS_AS_SAID: f64 = 0.75;
/// A wall is called unstable if the motion at the end of every simulated touch and press is at least this multiple of a limit
/// cycle's threshold (four encoder counts).
pub const MOVES: f64 = 1.5;

/// Results for one linear phase of the control law with one hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseReport {
    /// Name of the control law's linear phase.
    pub phase: &'static str,
    /// Largest magnitude of an eigenvalue of the loop in this phase; the loop is stable below 1.
    pub radius: f64,
    /// Rate at which the slowest motion of this phase decays, 1/s; negative if it grows.
    pub decay_per_s: f64,
    /// Frequency of the loop's slowest motion, Hz.
    pub frequency_hz: f64,
}

/// Results and verdict for one hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HandReport {
    /// Name of the hand: `scene` with the grip's name, a grip, `worst of all`, or `nobody`.
    pub name: String,
    /// Inertia, damping, stiffness, pad damping and pad stiffness of the hand, SI units; absent if nobody holds the device.
    pub parameters: Option<[f64; 5]>,
    /// Verdict for this hand.
    pub verdict: Verdict,
    /// Reasons why the verdict is not "stable", and which of them the simulations decided.
    pub causes: Vec<String>,
    /// Results of every linear phase of the control law, with dry friction counted as damping where
    /// [`Self::decay_with_friction_per_s`] has a value. The phase of the first contact, in which the law is a spring, comes last.
    pub phases: Vec<PhaseReport>,
    /// Largest magnitude of an eigenvalue over the linear phases in which the control law can stay, without dry friction; the
    /// loop is stable below 1.
    pub radius: f64,
    /// Rate at which the loop's slowest motion decays without dry friction, 1/s; negative if it grows.
    pub decay_per_s: f64,
    /// Rate at which the loop's slowest motion decays, 1/s, with dry friction counted as damping for an oscillation of
    /// [`SWING`](super::contact::SWING) times the press' depth. `None` without dry friction or a press, or if the motion does not
    /// oscillate.
    pub decay_with_friction_per_s: Option<f64>,
    /// Frequency of the loop's slowest motion, Hz.
    pub frequency_hz: f64,
    /// Largest magnitude of an eigenvalue with measured penetrations multiplied by 1 or by [`ROUNDING_GAIN`]. Dry friction counts
    /// as in `phases`. Without an encoder it is `radius`.
    pub radius_rounded: f64,
    /// Motion that rounding to counts causes at rest, root mean square, counts; absent without an encoder or a stable loop.
    pub rounding_rms_counts: Option<f64>,
    /// Largest possible motion at rest that rounding to encoder counts causes, counts.
    pub rounding_most_counts: Option<f64>,
    /// Largest magnitude of an eigenvalue over the gains between the control law's linear phases, with dry friction as in
    /// `phases`; 0 for a law without such gains.
    pub radius_between: f64,
    /// Smallest cosine in the circle criterion, equation (16) in `sector.rs`. Above 0 the loop is stable for any sequence of gains
    /// between two phases. Absent if the law has no such gain, or an end of its range is unstable.
    pub switching: Option<f64>,
    /// Largest ratio of the speed at which the device returns to the wall after a bounce to the speed of the touch before.
    pub bounce: f64,
    /// Energy that the control law gives out in the press beyond what it took, as a fraction of the largest energy that it may
    /// lend; `None` without a loan or a press.
    pub loan_used: Option<f64>,
    /// Least and largest motion at the end of the simulated touches, as multiples of a limit cycle's threshold (four encoder
    /// counts).
    pub ends: Option<[f64; 2]>,
    /// Least and largest motion at the end of simulated slow presses, as multiples of a limit cycle's threshold (four encoder
    /// counts). Presses are simulated if an offset of the law decays too slowly, or if a press uses more than the energy that the
    /// law may lend.
    pub presses: Option<[f64; 2]>,
    /// Amplitude below which dry friction stops a motion that would grow without friction, rad; 0 without friction, or if no
    /// motion grows.
    pub friction_holds_rad: f64,
    /// Whether the slowest motion is that of the law's offset (shift of the wall's surface), which decays too slowly. A slow press
    /// excites it more than a touch.
    #[serde(skip)]
    pub stirred_by_ramp: bool,
}

/// Sets a report's verdict and causes; `phase` is the name of the phase with the slowest motion.
pub(super) fn judge(contact: &Contact, report: &mut HandReport, phase: &str) {
    let mut found: Vec<(Verdict, String)> = Vec::new();
    let mut say = |verdict, cause| found.push((verdict, cause));
    // If the hold's duration is known, the motion has to decay below `LEFT_COUNTS` within the hold.
    let dies = |decay_per_s: f64| match (contact.swing_counts(), contact.hold_s) {
        (Some(swing), Some(hold_s)) => {
            decay_per_s > 0.0 && swing * (-decay_per_s * DECAYS_WITHIN * hold_s).exp() < LEFT_COUNTS
        }
        _ => decay_per_s >= SLOWEST_PER_S,
    };
    // Dry friction may end a motion that decays slowly. A motion that grows without friction is not accepted here: friction would
    // end it only below the assumed amplitude.
    let dies_out = dies(report.decay_per_s)
        || report.decay_per_s > 0.0 && report.decay_with_friction_per_s.is_some_and(dies);
    if dies_out {
        // The motion decays, by itself or by dry friction.
    } else if report.decay_per_s < -FASTEST_GROWTH_PER_S {
        let what = format!("{phase}: grows at {:.3} Hz", report.frequency_hz);
        let held = report.friction_holds_rad;
        // Amplitude up to which friction must stop the motion: four fifths of the press' depth, or two counts without a press.
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
                "rounding to counts moves it by more than a few counts".to_owned(),
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
                format!("a bounce returns with {back:.2} of its speed"),
            );
        }
    }
    if let Some(used) = report.loan_used.filter(|used| *used > LOAN_USED) {
        say(
            Verdict::Undecided,
            format!("the press uses {used:.2} of the energy credit"),
        );
    }
    report.verdict = found
        .iter()
        .map(|(verdict, _)| *verdict)
        .max()
        .unwrap_or(Verdict::Stable);
    report.causes = found.into_iter().map(|(_, cause)| cause).collect();
}

/// Changes the verdict "stable" to "undecided" for a wall that is stiffer than those on which the certificates were validated.
pub(super) fn within_reach(report: &mut HandReport, stiffness_per_tick: f64) {
    if report.verdict == Verdict::Stable && stiffness_per_tick > STIFFEST_PER_TICK {
        report.verdict = Verdict::Undecided;
        report.causes.push(format!(
            "T sqrt(k_de/J) is {stiffness_per_tick:.2}, but certificates were tested against runs only up to {STIFFEST_PER_TICK}"
        ));
    }
}

/// Whether slow presses have to be simulated, because they may excite motions that a touch does not excite.
pub(super) fn asks_for_presses(report: &HandReport) -> bool {
    report.stirred_by_ramp || report.loan_used.is_some_and(|used| used > LOAN_USED)
}

/// Sets the verdict from the ends of simulated touches and slow presses if the matrices decided nothing, and checks a verdict
/// "stable" against the simulations. If some simulations come to rest and others do not, the verdict is undecided.
pub(super) fn settle(report: &mut HandReport, touches: [f64; 2], presses: Option<[f64; 2]>) {
    (report.ends, report.presses) = (Some(touches), presses);
    let [mut least, mut most] = touches;
    let (mut each, mut all) = ("touch that was played", "touches that were played");
    if let Some(ends) = presses {
        (least, most) = (least.min(ends[0]), most.max(ends[1]));
        (each, all) = (
            "touch and slow press that was simulated",
            "touches and slow presses that were simulated",
        );
    }
    let said = report.verdict == Verdict::Stable;
    let rests = if said { RESTS_AS_SAID } else { RESTS };
    // If the motion grows without dry friction, a few presses that come to rest do not prove that all do.
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
