//! One demand of an option such as `--expect` on one simulation run, and whether the run meets it.

use touchstone_sim::run::record::Summary;

/// The values of a simulation run that a demand can be about.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// A name that distinguishes the run from the others of the same command.
    pub name: String,
    /// Name of the run's verdict.
    pub verdict: &'static str,
    /// Why the run could not be judged; `None` if it was.
    pub not_judged: Option<String>,
    /// Deepest true penetration, rad; `None` on three axes.
    pub penetration_max: Option<f64>,
    /// Displayed stiffness, N·m/rad; `None` if the run has none, for instance because the knob left the wall.
    pub k_displayed: Option<f64>,
    /// Most energy that the hand got beyond what it gave, J.
    pub energy_out: f64,
}

impl Subject {
    /// Name of the verdict, followed by the reason if the run could not be judged.
    pub fn verdict_and_why(&self) -> String {
        match &self.not_judged {
            Some(why) => format!("{}: {why}", self.verdict),
            None => self.verdict.to_owned(),
        }
    }
}

impl From<&Summary> for Subject {
    fn from(run: &Summary) -> Self {
        Self {
            name: name(run),
            verdict: run.verdict_name(),
            not_judged: run.not_judged.clone(),
            penetration_max: Some(run.penetration_max),
            k_displayed: run.k_displayed,
            energy_out: run.energy_out,
        }
    }
}

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
    /// Why the run was not judged; `None` if it was.
    pub not_judged: Option<String>,
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
