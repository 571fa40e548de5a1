//! The list of measures of a run, used by table, page, `results.json` and its schema. A new measure needs one new entry here.

use super::quantity::{grouped, significant, with_unit};
use touchstone_sim::run::record::Summary;

/// A measure of a run, with its names, unit and value.
pub struct Measure {
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
    /// Formats the measure's value for readers.
    pub shown: fn(&Summary, f64) -> String,
}

macro_rules! measures {
    ($($field:ident, $words:literal, $unit:literal, $meaning:literal, $value:expr, $shown:expr;)*) => {
        /// Every measure, in the order in which readers see them.
        pub const MEASURES: &[Measure] = &[$(Measure {
            field: stringify!($field),
            words: $words,
            unit: $unit,
            meaning: $meaning,
            value: $value,
            shown: $shown,
        }),*];
    };
}

measures! {
    k_displayed, "displayed stiffness", "N·m/rad",
        "mean force over mean penetration at the end of the hold; null without a hold or where the wall was lost",
        |s| s.k_displayed, of_desired;
    rate_hardness, "rate-hardness", "N·m/rad",
        "slope of true force over true penetration in the first contact, until the motion turns or for 20 ms (thesis (1.5))",
        |s| s.rate_hardness, of_desired;
    extended_rate_hardness, "extended rate-hardness", "N·m/rad",
        "largest rise of the force within a millisecond over the largest speed, in the first contact (Han and Choi 2010), of true force and true motion",
        |s| s.extended_rate_hardness, |_, x| with_unit(x, "N·m/rad", 3);
    touch_torque_n_m, "torque in the first 5 ms", "N·m",
        "largest torque of the motor within five milliseconds of entering the wall for the first time; null where it was not reached",
        |s| s.touch_torque_n_m, |_, x| with_unit(x, "N·m", 3);
    peak_penetration_ratio, "deepest penetration over F/k_de", "1",
        "deepest true penetration over that of a wall of the desired stiffness under the same push; 1 is ideal",
        |s| s.peak_penetration_ratio, |_, x| significant(x, 3);
    settle_from_ramp_end_s, "settled after the ramp", "s",
        "from the end of the press' ramp until force over penetration stays within 5 % of the desired stiffness; 0 where it had settled before",
        |s| s.settle_from_ramp_end_s, |_, x| with_unit(x, "s", 3);
    ripple_rms_n_m, "ripple, tick to tick", "N·m",
        "rms difference of the force from tick to tick, over the second half of the press or the hand's oscillation",
        |s| s.ripple_rms_n_m, |_, x| with_unit(x, "N·m", 2);
    ripple_above_50_hz_rms_n_m, "ripple above 50 Hz", "N·m",
        "rms of the force above 50 Hz, over the same time as ripple_rms_n_m",
        |s| s.ripple_above_50_hz_rms_n_m, |_, x| with_unit(x, "N·m", 2);
    release_speed_rad_per_s, "fastest outward after release", "rad/s",
        "largest outward speed after the hand has let go",
        |s| s.release_speed_rad_per_s, |_, x| with_unit(x, "rad/s", 3);
    release_excursion_rad, "thrown out by", "rad",
        "largest distance outside the wall after the hand has let go",
        |s| s.release_excursion_rad, |_, x| with_unit(x, "rad", 3);
    energy_out_worst_window_j, "given to the hand, worst window", "J",
        "most energy that the hand got out of the device in any window of time: wall, device's losses and device's motion",
        |s| Some(s.energy_out_worst_window_j), |_, x| with_unit(x, "J", 3);
    energy_out_wall_worst_window_j, "given by the wall, worst window", "J",
        "most energy that the wall's port gave in any window of time",
        |s| Some(s.energy_out_wall_worst_window_j), |_, x| with_unit(x, "J", 3);
    guard_account_min_j, "lowest account of the guard", "J",
        "lowest account of the energy guard, negative after overspeed; null without a guard",
        |s| s.guard_account_min_j, |_, x| with_unit(x, "J", 3);
    guard_limited_ticks, "ticks limited by the guard", "1",
        "control periods in which the energy guard passed less force than the law commanded; null without a guard",
        |s| s.guard_limited_ticks.map(|n| n as f64), |_, x| significant(x, 3);
    guard_tripped_s, "guard switched the force off after", "s",
        "time at which the energy guard switched the force off, because of overspeed or at the end of the position range; null if it did not",
        |s| s.guard_tripped_s, |_, x| with_unit(x, "s", 3);
    limit_cycle_peak_to_peak, "motion at rest, peak to peak", "rad",
        "largest motion of the device in the last quarter of a hold",
        |s| s.limit_cycle_peak_to_peak, in_counts;
    settle_time, "settled after the first touch", "s",
        "from the first touch until force over penetration stays within 5 % of the desired stiffness",
        |s| s.settle_time, |_, x| with_unit(x, "s", 3);
    penetration_max, "deepest penetration", "rad",
        "deepest true penetration of the wall; null for a run whose values overflowed",
        |s| s.penetration_max.is_finite().then_some(s.penetration_max), |_, x| with_unit(x, "rad", 3);
    energy_out, "given to the user from the start", "J",
        "most that the user's port ever gave beyond what it had taken from the start on",
        |s| Some(s.energy_out), |_, x| with_unit(x, "J", 3);
    force_max, "largest force", "N·m",
        "largest force command",
        |s| Some(s.force_max), |_, x| with_unit(x, "N·m", 3);
    energy_true_min, "lowest energy, wall's port", "J",
        "lowest true energy of the wall's port; negative: the wall gave energy away",
        |s| Some(s.energy_true_min), |_, x| with_unit(x, "J", 3);
    energy_user_min, "at the user's port", "J",
        "lowest true energy of the user's port: the wall's and what the device dissipated",
        |s| Some(s.energy_user_min), |_, x| with_unit(x, "J", 3);
    energy_observed_min, "as observed", "J",
        "lowest energy that the law's own observer reported; null for a law without one",
        |s| s.energy_observed_min, |_, x| with_unit(x, "J", 3);
    contact_ticks, "in contact", "1",
        "ticks with a force from the wall",
        |s| Some(s.contact_ticks as f64), |s, x| format!("{} of {} ticks", grouped(x), grouped(s.ticks as f64));
}

/// Settings of a run that are numbers, each with field, unit and meaning.
pub const SETTINGS: &[(&str, &str, &str)] = &[
    ("k_desired", "N·m/rad", "desired stiffness k_de of the wall"),
    (
        "encoder_counts_per_rev",
        "1/rev",
        "counts of the encoder a revolution; null for an exact position",
    ),
    ("rate_hz", "Hz", "control rate"),
    ("ticks", "1", "ticks that were simulated"),
];

/// Results of a run as texts with rounded numbers, for readers; `results.json` has all digits.
pub fn facts(s: &Summary) -> Vec<(&'static str, String)> {
    let fact = |m: &Measure| (m.value)(s).map(|value| (m.words, (m.shown)(s, value)));
    let why = s.not_judged.as_ref().map(|why| ("why", why.clone()));
    why.into_iter()
        .chain(MEASURES.iter().filter_map(fact))
        .collect()
}

fn of_desired(s: &Summary, k: f64) -> String {
    format!(
        "{} ({} % of k_de)",
        with_unit(k, "N·m/rad", 3),
        significant(100.0 * k / s.k_desired, 3)
    )
}

fn in_counts(s: &Summary, angle: f64) -> String {
    let counts = s
        .encoder_counts_per_rev
        .map(|per_rev| angle / std::f64::consts::TAU * per_rev);
    let counts = counts.map_or(String::new(), |c| {
        let c = if c < 0.05 {
            "0".into()
        } else {
            significant(c, 2)
        };
        format!(" ({c} counts)")
    });
    with_unit(angle, "rad", 3) + &counts
}
