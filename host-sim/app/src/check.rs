//! One demand of an option such as `--expect` on one simulation run, and whether the run meets it.

use touchstone_sim::run::record::Summary;

/// One demand on one simulation run, with the measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Name of the simulation run, from [`name`].
    pub run: String,
    /// The command-line option that made the demand.
    pub option: &'static str,
    /// The demanded value or limit, as text.
    pub wanted: String,
    /// The value that the run gave, as text.
    pub came: String,
    /// Whether the run meets the demand.
    pub met: bool,
}

/// A name that distinguishes a simulation run from other runs of the same command.
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
