//! One demand on one run, and what came of it.

use touchstone_control::Choice as _;
use touchstone_sim::run::record::Summary;

/// One demand on one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// The run, as [`name`] tells it.
    pub run: String,
    /// Option that asked.
    pub option: &'static str,
    /// What it asked for.
    pub wanted: String,
    /// What the run gave.
    pub came: String,
    /// Whether that is as asked.
    pub met: bool,
}

/// What tells a run from others of the same command.
pub fn name(run: &Summary) -> String {
    let counts = run.encoder_counts_per_rev.map_or_else(
        || "exact position".to_owned(),
        |counts| format!("{counts} counts"),
    );
    format!(
        "{}: {}, {} N·m/rad, grip {}, {counts}",
        run.scene,
        run.law.word(),
        run.k_desired,
        run.grip
    )
}
