//! Results of a press and of an oscillating hand at a wall, in three simulated grips (light, medium, firm).

use crate::scorecard::cases::{CASES, Deed, GRIPS, Programme};
use crate::scorecard::figures;
use crate::scorecard::measure::Measure;
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::record::Verdict;
use touchstone_sim::scene::Scene;

/// Largest accepted deviation of the stiffness at rest from the requested stiffness, as a fraction.
pub const RESTING: f64 = 0.05;
/// Largest accepted deviation of force over penetration from the requested stiffness for an oscillating hand, as a fraction.
pub const MODULUS: f64 = 0.15;
/// Largest accepted phase of force over penetration for an oscillating hand, degrees.
pub const PHASE_DEG: f64 = 15.0;

/// Results of a press and an oscillating hand, the worst of three simulated grips (light, medium, firm).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Outcome {
    /// Verdict on the worst press of the three simulated grips (light, medium, firm).
    pub ended: Verdict,
    /// Largest deviation of the stiffness at rest from the requested one, as a fraction; absent if a press does not come to rest.
    pub displayed_error: Option<f64>,
    /// Deviation of force over penetration from the requested stiffness for an oscillating hand, as a fraction; absent if the knob
    /// left the wall.
    pub modulus_error: Option<f64>,
    /// Phase of force over penetration for an oscillating hand, degrees.
    pub phase_deg: Option<f64>,
}

impl Outcome {
    /// Simulates presses and an oscillating hand with a scene's device and law, and evaluates them.
    ///
    /// # Errors
    /// The control law does not accept its settings.
    pub fn of(scene: &Scene) -> Result<Self> {
        let programme = Programme::of(scene);
        let (felt, _) = figures(scene, &programme, &CASES[0], false)?;
        let finite = |measure| Some(felt.get(measure)).filter(|value| value.is_finite());
        let mut outcome = Self {
            ended: Verdict::Passive,
            displayed_error: Some(0.0),
            modulus_error: finite(Measure::ModulusError),
            phase_deg: finite(Measure::PhaseDeg),
        };
        for grip in GRIPS {
            let run = run::run(&programme.scene(scene, grip, Deed::Press), false)?.summary;
            let own = run
                .k_displayed
                .filter(|_| at_rest(run.verdict))
                .map(|k| (k / scene.wall.k_desired_n_m_per_rad - 1.0).abs());
            outcome.displayed_error = outcome.displayed_error.zip(own).map(|(a, b)| a.max(b));
            outcome.ended = outcome.ended.max(run.verdict);
        }
        Ok(outcome)
    }

    /// Whether a press comes to rest in every grip, at any stiffness.
    #[must_use]
    pub fn ends_at_rest(&self) -> bool {
        at_rest(self.ended)
    }

    /// Whether a press comes to rest in every grip, at a stiffness within the fraction [`RESTING`] of the requested one.
    #[must_use]
    pub fn rests(&self) -> bool {
        self.displayed_error.is_some_and(|error| error <= RESTING)
    }

    /// Whether force over penetration of an oscillating hand is within [`MODULUS`] and [`PHASE_DEG`] of the requested stiffness up
    /// to 4 Hz, in every grip.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.modulus_error.is_some_and(|error| error <= MODULUS)
            && self.phase_deg.is_some_and(|phase| phase <= PHASE_DEG)
    }

    /// The results in one line of text: what fails, if anything does.
    #[must_use]
    pub fn words(&self) -> String {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let resting = match self.displayed_error {
            None => "a press does not come to rest".to_owned(),
            Some(error) => format!(
                "a press rests at k_de within {} (limit {})",
                percent(error),
                percent(RESTING)
            ),
        };
        let moving = match self.modulus_error.zip(self.phase_deg) {
            None => "a moving hand leaves the wall".to_owned(),
            Some((error, phase)) => format!(
                "a moving hand feels k_de within {} and {phase:.1}° (limits {} and {PHASE_DEG}°)",
                percent(error),
                percent(MODULUS)
            ),
        };
        format!("{resting}; {moving}")
    }

    /// Whether press and oscillating hand are both within their limits.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.rests() && self.moves()
    }
}

fn at_rest(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Passive | Verdict::Active)
}
