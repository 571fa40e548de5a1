//! Scorecards of the tuned law in three degrees of freedom, direction by direction. The thesis does not have this law.
//!
//! The device is an omega.3, nominal or varied: half and double mass and damping, coarser counts, delayed commands. Each of three
//! hands presses and moves along each axis in both senses, and along directions between the axes. A ball is left out, because a
//! hand whose stiffness is below the push divided by the ball's radius slides off the ball with any law. Measures and limits are
//! those of [`crate::scorecard`]; the torque ripple has no limit here.

use super::mechanism::{Deviation, Mechanism};
use super::pressed::{PressedSurface, PressedWall};
use super::tuned_wall::TunedWall;
use crate::identify::lever::PRESS_SHARE;
use crate::scorecard::cases::{CASES, Case};
use crate::scorecard::direction::DirectionFigures;
use crate::scorecard::in_turn::DEEDS;
use crate::scorecard::measure::{Limits, Measure, is_beyond};
use crate::thesis::claims::{Claim, Outcome};
use rayon::prelude::*;
use touchstone_control::SettingsError;
use touchstone_world::plant::{FIRM_TRANSLATION, Hand, LIGHT_TRANSLATION, MEDIUM_TRANSLATION};

/// The hands; every measure is the worst over them.
pub const HANDS: [Hand; 3] = [LIGHT_TRANSLATION, MEDIUM_TRANSLATION, FIRM_TRANSLATION];

/// A direction in which the hand presses a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalOfWall {
    /// Name of the direction for readers.
    pub name: &'static str,
    /// Outward unit normal of the pressed surface.
    pub normal: [f64; 3],
}

const fn plane(name: &'static str, normal: [f64; 3]) -> NormalOfWall {
    NormalOfWall { name, normal }
}

/// All directions that are examined.
pub const NORMALS: [NormalOfWall; 9] = [
    plane("+x", [1.0, 0.0, 0.0]),
    plane("-x", [-1.0, 0.0, 0.0]),
    plane("+y", [0.0, 1.0, 0.0]),
    plane("-y", [0.0, -1.0, 0.0]),
    plane("+z", [0.0, 0.0, 1.0]),
    plane("-z", [0.0, 0.0, -1.0]),
    plane("(2, -3, 6)/7", [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0]),
    plane("(-6, 2, -3)/7", [-6.0 / 7.0, 2.0 / 7.0, -3.0 / 7.0]),
    plane("(1, 2, 2)/3", [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]),
];

/// The law and the device that are simulated in every direction.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Played {
    mechanism: Mechanism,
    tuned: TunedWall,
    rate_hz: u32,
    /// Whether the law uses the state estimator; otherwise it uses differences of position counts.
    estimated: bool,
}

impl Played {
    fn as_tuned(mechanism: Mechanism, rate_hz: u32) -> Self {
        Self {
            mechanism,
            tuned: TunedWall::of(mechanism, rate_hz),
            rate_hz,
            estimated: true,
        }
    }

    /// The wall in a direction; the hand presses it with two thirds of the largest force.
    fn wall(&self, at: &NormalOfWall) -> PressedWall {
        let force_n = self.mechanism.force_n();
        PressedWall {
            surface: PressedSurface::Plane([0.0; 3], at.normal),
            law: self.tuned.settings(self.rate_hz, force_n),
            estimator: self.estimated.then(|| self.tuned.estimator()),
            mechanism: self.mechanism,
            deviation: Deviation::NONE,
            hand: FIRM_TRANSLATION,
            push_n: PRESS_SHARE * force_n,
        }
    }

    /// Whether this wall must work on the device; a very stiff wall need not work on all devices.
    fn is_asked(&self, case: &Case) -> bool {
        let per_s = (self.tuned.k_desired_n_per_m / self.tuned.axis_kg).sqrt();
        let per_tick = per_s / f64::from(self.rate_hz);
        case.is_asked(per_tick)
    }
}

/// Scorecard for one direction: the results of every device.
#[derive(Debug, Clone)]
pub struct DirectionCard {
    /// The direction of the wall's normal.
    pub at: NormalOfWall,
    /// Results of every device, the worst of three hands: name of the device, measures and limits.
    pub cells: Vec<(&'static str, DirectionFigures, Limits)>,
}

impl DirectionCard {
    /// Worst value of each measure over all devices.
    #[must_use]
    pub fn worst(&self) -> DirectionFigures {
        self.cells
            .iter()
            .fold(DirectionFigures::NONE, |worst, (_, cell, _)| {
                worst.worst(cell)
            })
    }

    /// Every measure beyond its limit, with the name of the device.
    #[must_use]
    pub fn fails(&self) -> Vec<(&'static str, Measure)> {
        let mut fails = Vec::new();
        for (case, cell, limits) in &self.cells {
            let shares = Measure::ALL.into_iter().zip(cell.figures.shares(limits));
            fails.extend(
                shares
                    .filter(|(_, share)| is_beyond(*share))
                    .map(|(m, _)| (*case, m)),
            );
        }
        fails
    }
}

/// Simulates the presses and motions in each direction at a control rate.
///
/// # Errors
/// The control law does not accept its settings; it accepts those of a [`TunedWall`].
pub fn cards(
    mechanism: Mechanism,
    rate_hz: u32,
    normals: &[NormalOfWall],
) -> Result<Vec<DirectionCard>, SettingsError> {
    cards_of(&Played::as_tuned(mechanism, rate_hz), normals)
}

/// Makes the scorecards of any law and device.
fn cards_of(
    played: &Played,
    normals: &[NormalOfWall],
) -> Result<Vec<DirectionCard>, SettingsError> {
    let cases: Vec<&Case> = CASES.iter().filter(|case| played.is_asked(case)).collect();
    normals
        .par_iter()
        .map(|at| {
            let cell = |case: &&Case| {
                let mut worst = DirectionFigures::NONE;
                for hand in HANDS {
                    let wall = PressedWall {
                        deviation: Deviation::of(case.change),
                        hand,
                        ..played.wall(at)
                    };
                    for what in DEEDS {
                        worst = worst.worst(&wall.played(what)?);
                    }
                }
                // The ripple has no limit.
                Ok((case.name, worst, Limits::new(case.is_late(), f64::INFINITY)))
            };
            let cells: Result<Vec<_>, SettingsError> = cases.par_iter().map(cell).collect();
            Ok(DirectionCard {
                at: *at,
                cells: cells?,
            })
        })
        .collect()
}

/// The claim that the law is within its limits in all directions.
#[must_use]
pub fn claim(mechanism: Mechanism, cards: &[DirectionCard]) -> Claim {
    let worst = cards.iter().fold(DirectionFigures::NONE, |worst, card| {
        worst.worst(&card.worst())
    });
    let fails: Vec<String> = cards
        .iter()
        .flat_map(|card| {
            let name = card.at.name;
            let fail = move |(case, measure): (&str, Measure)| {
                format!("{name}, {case}: {}", measure.heading().0)
            };
            card.fails().into_iter().map(fail)
        })
        .collect();
    let get = |measure| worst.figures.get(measure);
    let figures = format!(
        "{} directions, worst of {} devices in three hands: peak {:.3}, settled {}, held {:.1} %, letting go {:.1} %, |F/x| {:.1} %, {:.1}°",
        cards.len(),
        cards.first().map_or(0, |card| card.cells.len()),
        get(Measure::PeakPenetrationRatio),
        worst
            .settle_s
            .map_or("never".to_owned(), |s| format!("{s:.3} s")),
        100.0 * get(Measure::StiffnessErrorHeld),
        100.0 * get(Measure::StiffnessErrorRelease),
        100.0 * get(Measure::ModulusError),
        get(Measure::PhaseDeg),
    );
    Claim {
        name: "tuned-every-direction",
        source: "simulation",
        statement: match mechanism {
            Mechanism::Cartesian => {
                "the tuned law on estimated states is within every limit of the wall's scorecard in each normal direction, at 25 N/mm and 1 kHz"
            }
            Mechanism::Delta => {
                "a law that was tuned for the mechanism is within every limit of the wall's scorecard in each normal direction, at 2.5 N/mm and 1 kHz"
            }
        },
        outcome: if fails.is_empty() && !cards.is_empty() {
            Outcome::Reproduced
        } else {
            Outcome::NotReproduced
        },
        measured: match fails.first() {
            None => figures,
            Some(first) => format!(
                "{figures}; {} beyond their limit, first {first}",
                fails.len()
            ),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::space::RATE_HZ;

    #[track_caller]
    fn holds(mechanism: Mechanism, rate_hz: u32, normals: &[NormalOfWall]) {
        let cards = cards(mechanism, rate_hz, normals).expect("settings");
        for card in &cards {
            let (name, worst) = (card.at.name, card.worst());
            println!(
                "{name} at {rate_hz} Hz: {worst:?}, fails {:?}",
                card.fails()
            );
        }
        let claim = claim(mechanism, &cards);
        println!("{}", claim.measured);
        assert_eq!(claim.outcome, Outcome::Reproduced, "{}", claim.measured);
        // No direction is missing, and each has results for devices.
        assert!(
            cards.len() == normals.len()
                && cards.iter().all(|card| card.cells.len() == CASES.len())
        );
    }

    #[test]
    fn the_tuned_law_is_within_every_limit_in_each_direction() {
        holds(Mechanism::Cartesian, RATE_HZ, &NORMALS);
    }

    /// Checks that two sets of settings together cover the control rates of the omega.3.
    #[test]
    fn the_tuned_law_is_within_every_limit_at_other_rates() {
        for rate_hz in [1500, 2000, 4000] {
            holds(Mechanism::Cartesian, rate_hz, &NORMALS[4..7]);
        }
    }

    /// Checks that the delta mechanism's settings are within the limits on the nominal delta, and that the omega.3's settings are
    /// not.
    #[test]
    fn a_delta_is_within_every_limit_by_a_law_of_its_own() {
        holds(Mechanism::Delta, RATE_HZ, &NORMALS[..4]);
        let omegas = Played {
            tuned: TunedWall::of(Mechanism::Cartesian, RATE_HZ),
            ..Played::as_tuned(Mechanism::Delta, RATE_HZ)
        };
        let omegas = cards_of(&omegas, &NORMALS[4..5]).expect("settings");
        let fails = omegas[0].fails();
        assert!(
            fails.iter().any(|(case, _)| *case == CASES[0].name),
            "{fails:?}"
        );
    }

    /// Checks that the law needs the state estimator: with differences of position counts it is beyond its limits.
    #[test]
    fn on_measured_states_it_is_not() {
        let played = Played {
            estimated: false,
            ..Played::as_tuned(Mechanism::Cartesian, RATE_HZ)
        };
        let cards = cards_of(&played, &NORMALS[4..5]).expect("settings");
        let claim = claim(Mechanism::Cartesian, &cards);
        assert_eq!(claim.outcome, Outcome::NotReproduced);
    }
}
