//! What is measured of a run, named once for table, page, `results.json` and its schema. A measure more is one row more.

use super::quantity::{grouped, significant, with_unit};
use touchstone_sim::run::record::Summary;

/// One measure.
pub struct Measure {
    /// Name in `results.json`: the field of [`Summary`].
    pub field: &'static str,
    /// Name for people.
    pub words: &'static str,
    /// SI unit; `1` is a plain count.
    pub unit: &'static str,
    /// Meaning, in the schema.
    pub meaning: &'static str,
    /// Its number; `None` where it does not apply.
    pub value: fn(&Summary) -> Option<f64>,
    /// The number as people read it.
    pub shown: fn(&Summary, f64) -> String,
}

macro_rules! measures {
    ($($field:ident, $words:literal, $unit:literal, $meaning:literal, $value:expr, $shown:expr;)*) => {
        /// Every measure, in the order in which people read them.
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
    k_first_contact, "on first contact", "N·m/rad",
        "slope of force over measured penetration up to the first reversal",
        |s| s.k_first_contact, of_desired;
    limit_cycle_peak_to_peak, "limit cycle, peak to peak", "rad",
        "largest motion of the device in the last quarter of a hold",
        |s| s.limit_cycle_peak_to_peak, in_counts;
    settle_time, "settled after", "s",
        "from the start of the hold until the force stays within 5 % of the desired one",
        |s| s.settle_time, |_, x| with_unit(x, "s", 3);
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

/// Numbers that a run was made under: field, unit, meaning.
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

/// What a run came to, in words and rounded numbers; `results.json` has all digits.
pub fn facts(s: &Summary) -> Vec<(&'static str, String)> {
    let fact = |m: &Measure| (m.value)(s).map(|value| (m.words, (m.shown)(s, value)));
    MEASURES.iter().filter_map(fact).collect()
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
