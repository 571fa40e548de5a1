//! One demand on one run, and its result.

use touchstone_sim::run::record::Summary;

/// One demand on one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// The run's [`name`].
    pub run: String,
    /// The option that made the demand.
    pub option: &'static str,
    /// The demanded value.
    pub wanted: String,
    /// The measured value.
    pub came: String,
    /// Whether the demand is met.
    pub met: bool,
}

/// A name that distinguishes a run from others of the same command.
pub fn name(run: &Summary) -> String {
    let counts = run.encoder_counts_per_rev.map_or_else(
        || "exact position".to_owned(),
        |counts| format!("{counts} counts"),
    );
    format!(
        "{}: {}, {} N·m/rad, grip {}, {counts}",
        run.scene,
        run.word(),
        run.k_desired,
        run.grip
    )
}
