//! Measures of a run as texts for readers, and the settings that `results.json` repeats. The table of measures is
//! [`touchstone_sim::run::summary`].

use super::quantity::{grouped, significant, with_unit};
use touchstone_sim::run::record::Summary;
use touchstone_sim::run::summary::Shown;
pub use touchstone_sim::run::summary::{MEASURES, Measure};

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
    let fact = |m: &Measure| (m.value)(s).map(|value| (m.words, shown(m, s, value)));
    let why = s.not_judged.as_ref().map(|why| ("why", why.clone()));
    why.into_iter()
        .chain(MEASURES.iter().filter_map(fact))
        .collect()
}

fn shown(measure: &Measure, s: &Summary, value: f64) -> String {
    match measure.shown {
        Shown::Digits(digits) if measure.unit == "1" => significant(value, digits),
        Shown::Digits(digits) => with_unit(value, measure.unit, digits),
        Shown::OfDesired => of_desired(s, value),
        Shown::InCounts => in_counts(s, value),
        Shown::OfTicks => format!("{} of {} ticks", grouped(value), grouped(s.ticks as f64)),
    }
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
