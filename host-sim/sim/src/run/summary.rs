//! The measures of a run: one table, with one row for each. Summary, `results.json` with its schema and units, tables, pages, sweep
//! and the comparison with earlier results follow from it.

use super::judge::{Judge, Judged};
use super::measure::DynamicStiffness;
use super::verdict::Verdict;
use crate::scene::Scene;
use Shown::{Digits, InCounts, OfDesired, OfTicks};
use Worse::{Less, More};
use serde::Serialize;
use touchstone_control::{Choice as _, LawKind};

/// A measure of a run: its names, its unit, and how it is read, shown and compared.
#[derive(Debug, Clone, Copy)]
pub struct Measure {
    place: u16,
    /// Name of the measure in `results.json`: the name of the field in [`Summary`].
    pub field: &'static str,
    /// Name of the measure for readers.
    pub words: &'static str,
    /// SI unit; `1` for a number without unit.
    pub unit: &'static str,
    /// Meaning of the measure, for the schema.
    pub meaning: &'static str,
    /// The measure's value in SI units; `None` if the measure does not apply.
    pub value: fn(&Summary) -> Option<f64>,
    /// How readers see the value.
    pub shown: Shown,
    /// How the measure is compared with that of an earlier run; `None` if it is not.
    pub worse: Option<Worse>,
}

/// How a measure's value is shown to readers.
#[derive(Debug, Clone, Copy)]
pub enum Shown {
    /// With its unit and this number of significant digits.
    Digits(usize),
    /// With the share of the desired stiffness.
    OfDesired,
    /// With the number of encoder counts.
    InCounts,
    /// As a part of all ticks.
    OfTicks,
}

/// Whether a smaller or a larger value counts as worse, with an absolute tolerance in the measure's unit for values near zero.
/// Stiffness and ratio have none.
///
/// Angles: a hundredth of a count of the finest encoder in the shipped scenes. Energies: a thousandth of the energy that a press of
/// 0.1 N·m stores in a wall of 5 N·m/rad. Torques: a ten-thousandth of 0.1 N·m. Times: one control period at 1 kHz. Speed: the
/// tolerance of an angle per such period.
///
/// The rate-hardness is not compared: a touch that ends within three control periods has none, and that touch is the hardest.
#[derive(Debug, Clone, Copy)]
pub enum Worse {
    /// Smaller is worse.
    Less(f64),
    /// Larger is worse.
    More(f64),
}

/// A field of the summary that a row of the table can have.
trait Number {
    fn number(&self) -> Option<f64>;
}

impl Number for f64 {
    fn number(&self) -> Option<f64> {
        Some(*self)
    }
}

impl Number for u64 {
    fn number(&self) -> Option<f64> {
        Some(*self as f64)
    }
}

impl<T: Number> Number for Option<T> {
    fn number(&self) -> Option<f64> {
        self.as_ref().and_then(Number::number)
    }
}

macro_rules! measures {
    (@value $field:ident) => { |s| s.$field.number() };
    (@value $field:ident $value:expr) => { $value };
    ($(
        $(#[$doc:meta])* $field:ident: $type:ty = $of:expr
        $(=> $place:literal, $words:literal, $unit:literal, $shown:expr, $worse:expr, $meaning:literal $(, $value:expr)?)?;
    )*) => {
        /// Measures of one run, in SI units. `None` means that the measure does not apply, for example because the scene has no hold.
        #[derive(Debug, Clone, Serialize)]
        pub struct Summary {
            /// Name of the scene.
            pub scene: String,
            /// Control law of the scene.
            #[serde(serialize_with = "crate::scene::word")]
            pub law: LawKind,
            /// Name of the run in tables and figures in place of the law's name, for a report that compares two settings of one
            /// law. The name in results files is that of [`Summary::word`].
            #[serde(skip)]
            pub shown_as: Option<&'static str>,
            /// Number format of the law: `fixed32`, `fixed16`, `f32` or `f64`.
            pub number: String,
            /// Stiffness `k_de` that the wall should display, N·m/rad.
            pub k_desired: f64,
            /// Grip: `none`, `light`, `medium`, `firm` or `custom`.
            pub grip: String,
            /// Encoder counts per revolution; `None` for an exact position.
            pub encoder_counts_per_rev: Option<f64>,
            /// Control rate, Hz.
            pub rate_hz: u32,
            /// Verdict on the run, such as passive or unstable.
            pub verdict: Verdict,
            /// Reason why the run could not be judged; `None` if it was judged.
            pub not_judged: Option<String>,
            $($(#[$doc])* $(#[doc = concat!($meaning, "; unit `", $unit, "`")])? pub $field: $type,)*
        }

        impl Summary {
            /// Collects the measures of a run from the judge that observed it.
            #[must_use]
            pub fn of(scene: &Scene, judge: &Judge) -> Self {
                let judged = judge.judged();
                Self {
                    scene: scene.name.clone(),
                    law: scene.law.kind,
                    shown_as: None,
                    number: scene.law.number.word().to_owned(),
                    k_desired: scene.wall.k_desired_n_m_per_rad,
                    grip: scene.operator.grip.name().to_owned(),
                    encoder_counts_per_rev: scene.encoder.as_ref().map(|encoder| encoder.counts_per_rev),
                    rate_hz: scene.timing.rate_hz,
                    verdict: judged.verdict,
                    not_judged: judged.not_judged.map(|why| why.to_string()),
                    $($field: {
                        let of: fn(&Judged) -> $type = $of;
                        of(&judged)
                    },)*
                }
            }

            /// Summary of a run in which nothing was measured.
            #[must_use]
            pub fn without_measures(law: LawKind, k_desired: f64, verdict: Verdict) -> Self {
                Self {
                    scene: String::new(),
                    law,
                    shown_as: None,
                    number: String::new(),
                    k_desired,
                    grip: String::new(),
                    encoder_counts_per_rev: None,
                    rate_hz: 0,
                    verdict,
                    not_judged: None,
                    $($field: Default::default(),)*
                }
            }
        }

        /// Every measure that is a number, in the order in which readers see them.
        pub const MEASURES: &[Measure] = &in_order([$($(Measure {
            place: $place,
            field: stringify!($field),
            words: $words,
            unit: $unit,
            meaning: $meaning,
            value: measures!(@value $field $($value)?),
            shown: $shown,
            worse: $worse,
        },)?)*]);
    };
}

// Rows are in the order of the keys in `results.json`. In a row: field and type, its value; place among the measures that readers
// see, name for readers, unit, how the value is shown and compared, and meaning.
measures! {
    k_displayed: Option<f64> = |j| j.k_displayed()
        => 10, "displayed stiffness", "N·m/rad", OfDesired, Some(Less(0.0)),
        "mean force over mean penetration at the end of the hold; null without a hold or where the wall was lost";
    rate_hardness: Option<f64> = |j| j.of_wall(j.judge.felt.hardness.n_m_per_rad())
        => 20, "rate-hardness", "N·m/rad", OfDesired, None,
        "slope of true force over true penetration in the first contact, until the motion turns or for 20 ms (thesis (1.5))";
    extended_rate_hardness: Option<f64> = |j| j.of_wall(j.judge.felt.rise.n_m_per_rad())
        => 30, "extended rate-hardness", "N·m/rad", Digits(3), Some(Less(0.0)),
        "largest rise of the force within a millisecond over the largest speed, in the first contact (Han and Choi 2010), of true force and true motion";
    touch_torque_n_m: Option<f64> = |j| j.of_wall(j.judge.felt.rise.torque_n_m())
        => 40, "torque in the first 5 ms", "N·m", Digits(3), Some(Less(1e-5)),
        "largest torque of the motor within five milliseconds of entering the wall for the first time; null where it was not reached";
    peak_penetration_ratio: Option<f64> = |j| {
        let terms = &j.judge.terms;
        j.of_wall(terms.press).map(|press| j.judge.felt.peak.ratio(press.push_n_m, terms.k_desired))
    }
        => 50, "deepest penetration over F/k_de", "1", Digits(3), Some(More(0.0)),
        "deepest true penetration over that of a wall of the desired stiffness under the same push; 1 is ideal";
    /// Dynamic stiffness, the ratio of force to penetration, while the hand moves rhythmically inside the wall. Empty if the hand
    /// does not move rhythmically or leaves the wall.
    dynamic_stiffness: Vec<DynamicStiffness> = |j| {
        j.judge.felt.response.and_then(|response| response.stiffness()).into_iter().collect()
    };
    ripple_rms_n_m: Option<f64> = |j| j.judge.felt.ripple.tick_to_tick_rms_n_m()
        => 70, "ripple, tick to tick", "N·m", Digits(2), Some(More(1e-5)),
        "rms difference of the force from tick to tick, over the second half of the press or the hand's oscillation";
    ripple_above_50_hz_rms_n_m: Option<f64> = |j| j.judge.felt.ripple.above_50_hz_rms_n_m()
        => 80, "ripple above 50 Hz", "N·m", Digits(2), None,
        "rms of the force above 50 Hz, over the same time as ripple_rms_n_m";
    release_speed_rad_per_s: Option<f64> = |j| j.judge.felt.release.map(|release| release.speed_rad_per_s())
        => 90, "fastest outward after release", "rad/s", Digits(3), Some(More(1.6e-3)),
        "largest outward speed after the hand has let go";
    // Measured from the wall's surface, so it needs the main wall.
    release_excursion_rad: Option<f64> = |j| j.of_wall(j.judge.felt.release).map(|release| release.excursion_rad())
        => 100, "thrown out by", "rad", Digits(3), Some(More(1.6e-6)),
        "largest distance outside the wall after the hand has let go";
    limit_cycle_peak_to_peak: Option<f64> = |j| j.peak_to_peak
        => 160, "motion at rest, peak to peak", "rad", InCounts, Some(More(1.6e-6)),
        "largest motion of the device in the last quarter of a hold";
    energy_true_min: f64 = |j| j.judge.energy_true_min
        => 210, "lowest energy, wall's port", "J", Digits(3), None,
        "lowest true energy of the wall's port; negative: the wall gave energy away";
    energy_user_min: f64 = |j| j.judge.energy_user_min
        => 220, "at the user's port", "J", Digits(3), None,
        "lowest true energy of the user's port: the wall's and what the device dissipated";
    energy_out: f64 = |j| j.judge.energy_out()
        => 190, "given to the user from the start", "J", Digits(3), Some(More(1e-6)),
        "most that the user's port ever gave beyond what it had taken from the start on";
    energy_observed_min: Option<f64> = |j| Some(j.judge.energy_observed_min).filter(|lowest| lowest.is_finite())
        => 230, "as observed", "J", Digits(3), None,
        "lowest energy that the law's own observer reported; null for a law without one";
    energy_out_worst_window_j: f64 = |j| j.judge.felt.hand_window.worst_j()
        => 110, "given to the hand, worst window", "J", Digits(3), Some(More(1e-6)),
        "most energy that the hand got out of the device in any window of time: wall, device's losses and device's motion";
    energy_out_wall_worst_window_j: f64 = |j| j.judge.felt.wall_window.worst_j()
        => 120, "given by the wall, worst window", "J", Digits(3), None,
        "most energy that the wall's port gave in any window of time";
    guard_account_min_j: Option<f64> = |j| j.judge.guard.map(|guard| guard.account_min_j)
        => 130, "lowest account of the guard", "J", Digits(3), None,
        "lowest account of the energy guard, negative after overspeed; null without a guard";
    guard_limited_ticks: Option<u64> = |j| j.judge.guard.map(|guard| guard.limited_ticks)
        => 140, "ticks limited by the guard", "1", Digits(3), None,
        "control periods in which the energy guard passed less force than the law commanded; null without a guard";
    guard_tripped_s: Option<f64> = |j| {
        j.judge.guard.and_then(|guard| guard.tripped_tick).map(|tick| j.seconds(tick))
    }
        => 150, "guard switched the force off after", "s", Digits(3), None,
        "time at which the energy guard switched the force off, because of overspeed or at the end of the position range; null if it did not";
    /// Time from which a wall was off, s, because the device was deeper inside it than the number format of positions reaches.
    /// `None` if it never was.
    #[serde(skip)]
    wall_off_s: Option<f64> = |j| j.judge.beyond_reach_tick.map(|tick| j.seconds(tick));
    settle_time: Option<f64> = |j| j.settled().map(|s| j.seconds(s.from_first_touch))
        => 170, "settled after the first touch", "s", Digits(3), None,
        "from the first touch until force over penetration stays within 5 % of the desired stiffness";
    settle_from_ramp_end_s: Option<f64> = |j| j.settled().map(|s| j.seconds(s.from_ramp_end))
        => 60, "settled after the ramp", "s", Digits(3), Some(More(1e-3)),
        "from the end of the press' ramp until force over penetration stays within 5 % of the desired stiffness; 0 where it had settled before";
    penetration_max: f64 = |j| j.penetration_max_rad()
        => 180, "deepest penetration", "rad", Digits(3), Some(More(1.6e-6)),
        "deepest true penetration of the wall; null for a run whose values overflowed",
        |s| Some(s.penetration_max).filter(|deepest| deepest.is_finite());
    force_max: f64 = |j| j.judge.force_max
        => 200, "largest force", "N·m", Digits(3), None,
        "largest force command";
    /// Number of ticks (control periods) that were simulated.
    ticks: u64 = |j| j.judge.terms.ticks;
    contact_ticks: u64 = |j| j.judge.contact_ticks
        => 240, "in contact", "1", OfTicks, None,
        "ticks with a force from the wall";
}

/// Sorts the rows by their place. The compiler sorts, so that the table is a constant.
const fn in_order<const N: usize>(mut rows: [Measure; N]) -> [Measure; N] {
    let mut sorted = 1;
    while sorted < N {
        let mut at = sorted;
        while at > 0 && rows[at - 1].place >= rows[at].place {
            assert!(
                rows[at - 1].place > rows[at].place,
                "two measures have the same place"
            );
            let row = rows[at];
            rows[at] = rows[at - 1];
            rows[at - 1] = row;
            at -= 1;
        }
        sorted += 1;
    }
    rows
}

impl Summary {
    /// Name of the run in results and file names: the law's name as in `--law`, or the name that a report gives the run, in lower
    /// case.
    #[must_use]
    pub fn word(&self) -> String {
        match self.shown_as {
            Some(name) => name.to_lowercase(),
            None => self.law.word().to_owned(),
        }
    }

    /// A note on a wall that was off in the run, because the device was too deep inside it; `None` if none was.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        self.wall_off_s.map(|from_s| {
            format!(
                "a wall is off from {from_s:.3} s on, because the device is deeper inside it than law.number = {} can express; move the wall, or choose another number format",
                self.number
            )
        })
    }

    /// Name of the run's verdict.
    #[must_use]
    pub const fn verdict_name(&self) -> &'static str {
        self.verdict.name()
    }

    /// Name of the verdict, with the reason if the run could not be judged.
    #[must_use]
    pub fn verdict_and_why(&self) -> String {
        match &self.not_judged {
            Some(why) => format!("{}: {why}", self.verdict_name()),
            None => self.verdict_name().to_owned(),
        }
    }
}
