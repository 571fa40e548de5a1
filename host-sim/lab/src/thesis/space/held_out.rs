//! Checks the tuned law on walls that were not used to choose its settings: random directions, positions, hands, pushes, inertias,
//! dampings and delays.
//!
//! The scorecards of [`super::tuned`] are for walls that influenced the choice of the settings. Here each wall has a random normal
//! through a random point, a hand between the light and the firm one, and a push of 4 to 9 N. Inertia and damping are up to a fifth
//! off; the delay is 0, 0.1 or 0.5 of a control period. A fifth of the walls are a ball, with a hand that is stiff enough to stay
//! on the ball.

use super::RATE_HZ;
use super::held_out_cause::HeldOutCause;
use super::held_out_draw::hand;
pub use super::held_out_draw::{Drawn, drawn};
use super::mechanism::Mechanism;
use super::pressed::PressedWall;
use super::tuned_wall::OMEGA3_WALL;
use crate::scorecard::direction::DirectionFigures;
use crate::scorecard::in_turn::DEEDS;
use crate::scorecard::measure::{Limits, Measure, is_beyond};
use crate::thesis::claims::{Claim, Outcome};
use rayon::prelude::*;
use serde::Serialize;
use touchstone_control::{EstimatorSettings, Settings, SettingsError};

/// Number of random walls in a check.
pub const DRAWS: usize = 200;

/// A random wall with its results.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOutCell {
    /// The wall, its hand and its device.
    pub drawn: Drawn,
    /// The scorecard's measures of the wall. The torque ripple has no limit here.
    pub found: DirectionFigures,
    /// Magnitude of the largest force vector that the law requested of the motors, N.
    pub longest_n: f64,
    /// Why a measure of the wall is beyond its limit: the first deviation (push, delay, damping, inertia) whose removal alone brings
    /// all measures within their limits, or [`HeldOutCause::NoneAlone`]. `None` if no measure is beyond its limit.
    pub cause: Option<HeldOutCause>,
    limits: Limits,
}

impl HeldOutCell {
    /// Simulates a wall with all actions of the hand.
    fn played(
        drawn: Drawn,
        law: &Settings,
        estimator: &EstimatorSettings,
    ) -> Result<Self, SettingsError> {
        let wall = PressedWall {
            surface: drawn.surface,
            law: *law,
            estimator: Some(*estimator),
            mechanism: Mechanism::Cartesian,
            deviation: drawn.deviation,
            hand: hand(drawn.grip),
            push_n: drawn.push_n,
        };
        let (mut found, mut longest_n) = (DirectionFigures::NONE, 0.0_f64);
        for deed in DEEDS {
            let (next, force_n) = wall.played_with_force(deed)?;
            found = found.worst(&next);
            longest_n = longest_n.max(force_n);
        }
        Ok(Self {
            drawn,
            found,
            longest_n,
            cause: None,
            limits: Limits::new(drawn.is_late(), f64::INFINITY),
        })
    }

    /// Simulates a wall. If a measure is beyond its limit, the wall is simulated again with one change at a time, to find the
    /// cause.
    fn explained(
        drawn: Drawn,
        law: &Settings,
        estimator: &EstimatorSettings,
    ) -> Result<Self, SettingsError> {
        let mut cell = Self::played(drawn, law, estimator)?;
        if cell.fails().is_empty() {
            return Ok(cell);
        }
        let may = |cause: &HeldOutCause| *cause != HeldOutCause::MotorsLimit || cell.is_at_limit();
        let mut found = HeldOutCause::NoneAlone;
        for cause in HeldOutCause::TRIED.into_iter().filter(may) {
            let mended = Self::played(cause.mended(&drawn), law, estimator)?;
            if mended.fails().is_empty() {
                found = cause;
                break;
            }
        }
        cell.cause = Some(found);
        Ok(cell)
    }

    /// Whether the requested force reached the limit of the motors.
    #[must_use]
    pub fn is_at_limit(&self) -> bool {
        self.longest_n >= (1.0 - 1e-3) * Mechanism::Cartesian.force_n()
    }

    /// Measures that are beyond their limits, each with its value divided by the limit.
    #[must_use]
    pub fn fails(&self) -> Vec<(Measure, f64)> {
        let shares = self.found.figures.shares(&self.limits);
        let all = Measure::ALL.into_iter().zip(shares);
        all.filter(|(_, share)| is_beyond(*share)).collect()
    }
}

/// Results of a check of the tuned law on random walls.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// Seed of the random walls.
    pub seed: u64,
    /// Results of every random wall.
    pub cells: Vec<HeldOutCell>,
}

/// The largest value of a measure over all walls, with the wall that has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstOfAll {
    /// The measure of the scorecard to which the values belong.
    pub measure: Measure,
    /// The largest value; `None` if it is infinite, for example because the run diverged.
    pub value: Option<f64>,
    /// Median of the measure over all walls; `None` if it is infinite.
    pub median: Option<f64>,
    /// Number of random walls on which the measure is beyond its limit.
    pub beyond: usize,
    /// Description of the wall with the largest value.
    pub wall: String,
}

impl HeldOut {
    /// Simulates the shipped settings of [`super::tuned`] on the random walls that a seed generates.
    ///
    /// # Errors
    /// The control law does not accept its settings.
    pub fn played(seed: u64, count: usize) -> Result<Self, SettingsError> {
        let force_n = Mechanism::Cartesian.force_n();
        let law = OMEGA3_WALL.settings(RATE_HZ, force_n);
        Self::with(seed, count, &law, &OMEGA3_WALL.estimator())
    }

    /// Simulates other law settings on the random walls that a seed generates.
    ///
    /// # Errors
    /// The errors of [`Self::played`].
    pub fn with(
        seed: u64,
        count: usize,
        law: &Settings,
        estimator: &EstimatorSettings,
    ) -> Result<Self, SettingsError> {
        let cell = |drawn: &Drawn| HeldOutCell::explained(*drawn, law, estimator);
        let cells: Result<Vec<_>, SettingsError> =
            drawn(seed, count).par_iter().map(cell).collect();
        Ok(Self {
            seed,
            cells: cells?,
        })
    }

    /// The largest value of each measure over all walls.
    #[must_use]
    pub fn worst(&self) -> Vec<WorstOfAll> {
        let of = |measure: Measure| {
            let mut sorted: Vec<(f64, &Drawn)> = self
                .cells
                .iter()
                .map(|cell| (cell.found.figures.get(measure), &cell.drawn))
                .collect();
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
            let finite = |value: f64| value.is_finite().then_some(value);
            let beyond = |cell: &&HeldOutCell| cell.fails().iter().any(|it| it.0 == measure);
            WorstOfAll {
                measure,
                value: sorted.last().and_then(|it| finite(it.0)),
                median: sorted.get(sorted.len() / 2).and_then(|it| finite(it.0)),
                beyond: self.cells.iter().filter(beyond).count(),
                wall: sorted.last().map_or_else(String::new, |it| it.1.text()),
            }
        };
        Measure::ALL.map(of).to_vec()
    }

    /// Number of walls with a measure beyond its limit.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.cells
            .iter()
            .filter(|cell| !cell.fails().is_empty())
            .count()
    }

    /// Number of failed walls with this cause.
    #[must_use]
    pub fn failed_by(&self, cause: HeldOutCause) -> usize {
        let same = |cell: &&HeldOutCell| cell.cause == Some(cause);
        self.cells.iter().filter(same).count()
    }

    /// The causes of the failed walls in words, each with its number of walls; "none" if no wall failed.
    #[must_use]
    pub fn causes(&self) -> String {
        let all = HeldOutCause::TRIED
            .into_iter()
            .chain([HeldOutCause::NoneAlone]);
        let counted = all.map(|cause| (self.failed_by(cause), cause));
        let named: Vec<String> = counted
            .filter(|(count, _)| *count > 0)
            .map(|(count, cause)| format!("{count} for {}", cause.text()))
            .collect();
        match named.is_empty() {
            true => "none".to_owned(),
            false => named.join(", "),
        }
    }

    /// Longest settling time of a press over all walls, s: until the depth stays within 5 % of the ideal depth. `None` if a press
    /// never settled.
    #[must_use]
    pub fn settle_s(&self) -> Option<f64> {
        self.cells
            .iter()
            .map(|cell| cell.found.settle_s)
            .try_fold(0.0, |most: f64, settle| settle.map(|s| most.max(s)))
    }

    /// The result of the check as a claim, for the list of claims.
    #[must_use]
    pub fn claim(&self) -> Claim {
        let worst = self.worst();
        let shown: Vec<String> = worst
            .iter()
            .filter(|it| it.measure != Measure::RippleRmsNM)
            .map(|it| {
                let (heading, factor) = it.measure.heading();
                let value = it
                    .value
                    .map_or("lost".to_owned(), |value| format!("{:.3}", factor * value));
                match it.beyond {
                    0 => format!("{heading} {value}"),
                    beyond => format!("{heading} {value} ({beyond} beyond)"),
                }
            })
            .collect();
        Claim {
            name: "tuned-held-out",
            source: "simulation",
            statement: "the tuned law is within every limit of the wall's scorecard on walls, hands and devices that its setting was not chosen on",
            outcome: match self.failed() == 0 && !self.cells.is_empty() {
                true => Outcome::Reproduced,
                false => Outcome::NotReproduced,
            },
            measured: format!(
                "seed {}: {} of {} walls within, of the others {}; worst {}",
                self.seed,
                self.cells.len() - self.failed(),
                self.cells.len(),
                self.causes(),
                shown.join(", ")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::held_out_draw::{BALL_EACH, DELAYS_TICKS, PUSHES_N, most_on_ball_n};
    use super::super::mechanism::Deviation;
    use super::super::pressed::PressedSurface;
    use super::drawn as drawn_of;
    use super::*;

    #[test]
    fn a_seed_draws_other_walls_than_those_that_the_setting_was_chosen_on() {
        let walls = drawn(7, DRAWS);
        assert_eq!(walls, drawn(7, DRAWS));
        assert_ne!(walls, drawn(8, DRAWS));
        assert_eq!(walls.len(), DRAWS);
        let balls = walls
            .iter()
            .filter(|it| matches!(it.surface, PressedSurface::Ball(_)));
        assert_eq!(balls.count(), DRAWS / BALL_EACH);
        for wall in &walls {
            let normal = wall.surface.normal();
            let length: f64 = normal.iter().map(|n| n * n).sum();
            assert!((length - 1.0).abs() < 1e-12);
            for at in super::super::tuned::NORMALS {
                let cosine: f64 = (0..3).map(|i| at.normal[i] * normal[i]).sum();
                assert!(cosine < 1.0 - 1e-6, "{}", wall.text());
            }
            assert!(wall.push_n >= PUSHES_N.0.min(most_on_ball_n(&hand(1.0))));
        }
        for ticks in DELAYS_TICKS {
            assert!(walls.iter().any(|it| it.deviation.delay_ticks == ticks));
        }
    }

    /// Checks on a few random walls that the shipped settings fail on fewer walls than settings with a wrong estimator delay.
    #[test]
    fn a_sample_of_the_check() {
        let found = HeldOut::played(1, 10).expect("settings");
        println!("{}", found.claim().measured);
        let law = OMEGA3_WALL.settings(RATE_HZ, Mechanism::Cartesian.force_n());
        let lost = EstimatorSettings {
            delay_s: touchstone_control::Si::from_num(0.004),
            ..OMEGA3_WALL.estimator()
        };
        let lost = HeldOut::with(1, 10, &law, &lost).expect("settings");
        assert!(lost.failed() > 5, "{}", lost.claim().measured);
        assert!(found.failed() < lost.failed(), "{}", found.claim().measured);
    }

    /// Checks that the causes of three walls beyond their limits are found. The first wall has a push beyond the motors' force,
    /// the second a delay with which a hand gets energy out. No single change explains the third.
    #[test]
    fn a_wall_beyond_a_limit_has_its_cause() {
        // With the pulse at the touch no wall gives energy to the hand, so this test has no pulse.
        let mut law = OMEGA3_WALL.settings(RATE_HZ, Mechanism::Cartesian.force_n());
        law.impact.momentum = touchstone_control::Si::ZERO;
        let drawn = Drawn {
            surface: PressedSurface::Plane([0.0; 3], [0.0, 0.6, 0.8]),
            grip: 0.3,
            push_n: 8.0,
            deviation: Deviation::NONE,
        };
        let cause = |drawn: Drawn, estimator: &EstimatorSettings| {
            let cell = HeldOutCell::explained(drawn, &law, estimator).expect("settings");
            assert_eq!(cell.cause.is_some(), !cell.fails().is_empty());
            cell.cause
        };
        let told = OMEGA3_WALL.estimator();
        assert_eq!(cause(drawn, &told), None);
        let pushed = Drawn {
            push_n: 9.0,
            ..drawn
        };
        assert_eq!(cause(pushed, &told), Some(HeldOutCause::MotorsLimit));
        // The only wall of four seeds on which the hand gets energy.
        let gives = |it: &Drawn| {
            it.grip > 0.96 && (7.2..7.4).contains(&it.push_n) && it.deviation.damping < 0.81
        };
        let late = drawn_of(3, DRAWS).into_iter().find(gives).expect("drawn");
        assert_eq!(cause(late, &told), Some(HeldOutCause::Delay));
        let lost = EstimatorSettings {
            delay_s: touchstone_control::Si::from_num(0.004),
            ..told
        };
        assert_eq!(cause(drawn, &lost), Some(HeldOutCause::NoneAlone));
    }
}
