//! Compares the scorecard of a board with that of the simulator (called "desktop" here) for the same scene.
//!
//! [`programme_csv`] writes the motion of the hand for a test stand, emulated or real. The test stand's recording of board and
//! shaft, [`BoardRecording`], is evaluated by the same code as a simulated run. Every measure is the worst of the grips on both
//! sides, as in a scorecard.
//!
//! The position of the wall's surface within an encoder count is random, and a law that works on counts reacts to it. The desktop's
//! measures are therefore computed for eight positions within a count. Their range is called scatter; differences within the
//! scatter have no meaning. A ninth value of the same distribution lies outside the range of eight in two of nine cases. A board
//! that was recorded at several positions has its own scatter, and the two ranges should overlap. The ranges of eight and of four
//! values of one distribution do not overlap in 0.4 % of cases.

mod recording;
#[cfg(test)]
mod tests;

pub use recording::BoardRecording;

use super::cases::{Deed, GRIPS, Programme};
use super::measure::Measure;
use super::watch::{Seen, seen, seen_of};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write as _;
use touchstone_report::csv::decimal;
use touchstone_sim::error::Result;
use touchstone_sim::scene::{Grip, RestPath, Scene};

/// Frequencies at which the hand oscillates, Hz. They include those of a scorecard and go up to the limit of hands.
pub const FREQUENCIES_HZ: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// Frequencies of the scorecard's oscillations, Hz.
const OWN_HZ: [f64; 3] = [1.0, 2.0, 4.0];
/// Largest difference of a measure between board and simulator that counts as agreement, as a fraction of the simulator's value.
pub const SAME: f64 = 0.1;

/// Names of all actions of the hand, as in the tables.
#[must_use]
pub fn deed_words() -> Vec<String> {
    let moves = FREQUENCIES_HZ.into_iter().map(Deed::Move);
    std::iter::once(Deed::Press)
        .chain(moves)
        .map(deed_word)
        .collect()
}

/// Actions of the hand for a board's scorecard.
#[must_use]
pub fn board_programme(scene: &Scene) -> Programme {
    Programme {
        frequencies_hz: FREQUENCIES_HZ.to_vec(),
        ..Programme::of(scene)
    }
}

/// Name of an action in the tables.
#[must_use]
pub fn deed_word(deed: Deed) -> String {
    match deed {
        Deed::Press => "press".to_owned(),
        Deed::Move(frequency_hz) => format!("move-{frequency_hz}"),
    }
}

/// The hand's motion as CSV: its rest point in every control period, for every grip and action of the hand. If `named` is not
/// empty, only the actions in `named` are written.
///
/// # Errors
/// The scene does not allow one of the motions.
pub fn programme_csv(scene: &Scene, grips: &[Grip], named: &[String]) -> Result<String> {
    let programme = board_programme(scene);
    let surface = scene.wall.surface_rad;
    let mut text = String::from("grip,deed,time_s,surface_rad,rest_rad\n");
    for grip in grips {
        let is_named = |deed: &Deed| named.is_empty() || named.contains(&deed_word(*deed));
        for deed in programme.deeds().filter(is_named) {
            let scene = programme.scene(scene, *grip, deed);
            let path = RestPath::from_scene(&scene)?;
            for tick in 0..scene.timing.ticks() {
                let time_s = tick as f64 * scene.timing.period_s();
                // Writing into a string cannot fail.
                let _ = writeln!(
                    text,
                    "{},{},{},{},{}",
                    grip.name(),
                    deed_word(deed),
                    decimal(time_s),
                    decimal(surface),
                    decimal(path.rest_rad(time_s))
                );
            }
        }
    }
    Ok(text)
}

/// A scorecard measure of the board, compared with that of the simulator (`desktop`).
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FigureBeside {
    /// Name of the measure for programs, with its unit.
    pub key: &'static str,
    /// Heading of the measure for readers, and the factor from its SI value to the displayed value.
    #[serde(skip)]
    pub heading: (&'static str, f64),
    /// Grip of the measurement; absent for the worst of all grips, as in a scorecard.
    pub grip: Option<&'static str>,
    /// Frequency of an oscillating hand, Hz; absent for measures without oscillation.
    pub frequency_hz: Option<f64>,
    /// Value in the simulator (`desktop`); absent if it is infinite, for example because the knob left the wall.
    pub desktop: Option<f64>,
    /// Value on the board; absent if it is infinite.
    pub board: Option<f64>,
    /// Lowest and highest value in the simulator, for positions of the wall's surface within one encoder count. Absent if the wall
    /// does not hold the device at one of the positions.
    pub scatter: Option<(f64, f64)>,
    /// Lowest and highest value on the board, if it was recorded with several positions of the wall's surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub board_scatter: Option<(f64, f64)>,
}

impl FigureBeside {
    /// Difference of the board's value from the simulator's, as a fraction of the simulator's; `None` if one of the values is
    /// missing.
    #[must_use]
    pub fn apart(&self) -> Option<f64> {
        let (desktop, board) = self.desktop.zip(self.board)?;
        (desktop != board)
            .then(|| (board - desktop) / desktop.abs())
            .or(Some(0.0))
    }

    /// Range of the simulator's values while the wall's surface moves within one encoder count. Smaller differences have no
    /// meaning.
    #[must_use]
    pub fn resolution(&self) -> Option<f64> {
        self.scatter.map(|(low, high)| high - low)
    }

    /// Whether the values of simulator and board are both at most [`Self::resolution`] in magnitude; false if one of the three is
    /// missing.
    #[must_use]
    pub fn is_unresolved(&self) -> bool {
        let both = [self.desktop, self.board].into_iter();
        let small = |value: Option<f64>| value.zip(self.resolution());
        both.map(small)
            .all(|it| it.is_some_and(|(value, resolution)| value.abs() <= resolution))
    }

    /// Whether the ranges of board and simulator overlap. A board with one recording counts as a range of zero width.
    #[must_use]
    pub fn is_in_scatter(&self) -> bool {
        let board = self.board_scatter.or(self.board.map(|it| (it, it)));
        let both = board.zip(self.scatter);
        both.is_some_and(|(board, desktop)| board.0 <= desktop.1 && desktop.0 <= board.1)
    }

    /// Whether the values of board and simulator differ by at most the fraction `share`, or are both at most
    /// [`Self::resolution`]. Two missing values count as equal.
    #[must_use]
    pub fn holds(&self, share: f64) -> bool {
        match self.apart() {
            Some(apart) => apart.abs() <= share || self.is_unresolved(),
            None => self.desktop.is_none() && self.board.is_none(),
        }
    }
}

/// Comparison of a board's scorecard with that of the simulator.
#[derive(Debug, Clone, Serialize)]
pub struct BoardCard {
    /// The grips that were recorded.
    pub grips: Vec<&'static str>,
    /// Number of recorded control periods (ticks).
    pub ticks: usize,
    /// Number of recordings of the board, each with the wall's surface at another position within an encoder count.
    pub places: usize,
    /// The scorecard's measures: first the worst of the grips, then those of each grip.
    pub figures: Vec<FigureBeside>,
    /// Amplitude ratio and phase of force over penetration for an oscillating hand, grip by grip.
    pub moved: Vec<FigureBeside>,
}

impl BoardCard {
    /// All measures in which board and simulator differ by more than the fraction `share`, including those of an oscillating hand.
    pub fn apart(&self, share: f64) -> impl Iterator<Item = &FigureBeside> {
        let own = self.figures.iter().filter(|it| it.grip.is_none());
        own.chain(&self.moved).filter(move |it| !it.holds(share))
    }

    /// Measures in which board and simulator differ by more than the fraction `share`, and by more than the position of the wall's
    /// surface within an encoder count explains.
    pub fn beyond(&self, share: f64) -> impl Iterator<Item = &FigureBeside> {
        self.apart(share).filter(|it| !it.is_in_scatter())
    }
}

/// Number of positions of the wall's surface within an encoder count that are simulated; the first is the scene's own.
const PLACES: usize = 8;

/// One action of the hand with one grip: the simulated runs for each position of the wall's surface, and the board's recordings.
struct Pair {
    grip: Grip,
    deed: Deed,
    desktop: [Seen; PLACES],
    board: Vec<Seen>,
}

/// Compares a board's recordings with the simulated scorecard of a scene. The first recording gives the board's measures. Further
/// recordings of the same actions, with the wall's surface elsewhere within an encoder count, give the range of the measures.
///
/// # Errors
/// A recording belongs to another scene or has other actions than the first one, or the law does not accept its settings.
pub fn board_card(scene: &Scene, recordings: &[BoardRecording]) -> Result<BoardCard> {
    let programme = board_programme(scene);
    let deeds = GRIPS
        .into_iter()
        .flat_map(|grip| programme.deeds().map(move |deed| (grip, deed)));
    let mut ticks = 0;
    let mut played = Vec::new();
    for (grip, deed) in deeds {
        let mut board = Vec::new();
        for (index, recording) in recordings.iter().enumerate() {
            let of_deed = programme.scene(&recording.scene(scene)?, grip, deed);
            // A short recording has fewer actions, but each of them is complete.
            if let Some(of_board) = recording.ticks(&of_deed, grip, deed)? {
                ticks += of_board.len();
                board.push(seen_of(&of_deed, deed, &of_board));
            }
            if board.len() != index + 1 && !board.is_empty() {
                let problem = format!(
                    "{}, {}: not in all recordings",
                    grip.name(),
                    deed_word(deed)
                );
                return Err(recording.wrong(problem));
            }
        }
        if !board.is_empty() {
            played.push((grip, deed, board));
        }
    }
    if let ([], Some(recording)) = (&played[..], recordings.first()) {
        return Err(recording.wrong("contains no action of the scorecard's programme"));
    }
    let count_rad = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
    let places: Vec<Scene> = (0..PLACES)
        .map(|place| {
            let mut scene = scene.clone();
            scene.wall.surface_rad += count_rad * place as f64 / PLACES as f64;
            scene
        })
        .collect();
    let pairs: Vec<Pair> = played
        .par_iter()
        .map(|(grip, deed, board)| {
            let mut desktop = [board[0]; PLACES];
            for (seen_there, scene) in desktop.iter_mut().zip(&places) {
                *seen_there = seen(&programme.scene(scene, *grip, *deed), *deed)?;
            }
            Ok(Pair {
                grip: *grip,
                deed: *deed,
                desktop,
                board: board.clone(),
            })
        })
        .collect::<Result<_>>()?;
    let grips: Vec<&'static str> = GRIPS
        .into_iter()
        .filter(|grip| pairs.iter().any(|pair| pair.grip == *grip))
        .map(Grip::name)
        .collect();
    let mut figures = of_grip(&pairs, None);
    for grip in &grips {
        figures.extend(of_grip(&pairs, Some(grip)));
    }
    Ok(BoardCard {
        grips,
        ticks,
        places: recordings.len(),
        figures,
        moved: pairs.iter().flat_map(moved).collect(),
    })
}

/// Name of a measure, and the actions of the hand over which its worst value is taken.
struct ComparedFigure {
    key: &'static str,
    heading: (&'static str, f64),
    deeds: fn(Deed) -> bool,
}

/// Compares the worst value of a measure over some actions in the simulator with that on the board.
fn figure(
    pairs: &[Pair],
    grip: Option<&'static str>,
    asked: &ComparedFigure,
    of: impl Fn(&Seen) -> f64,
) -> FigureBeside {
    let is_asked =
        |pair: &&Pair| (asked.deeds)(pair.deed) && grip.is_none_or(|grip| pair.grip.name() == grip);
    let worst = |side: &dyn Fn(&Pair) -> Seen| {
        let values = pairs.iter().filter(is_asked).map(|pair| of(&side(pair)));
        values.reduce(f64::max).filter(|value| value.is_finite())
    };
    let desktop: Vec<Option<f64>> = (0..PLACES)
        .map(|place| worst(&|pair| pair.desktop[place]))
        .collect();
    FigureBeside {
        key: asked.key,
        heading: asked.heading,
        grip,
        frequency_hz: None,
        desktop: desktop[0],
        board: worst(&|pair| pair.board[0]),
        scatter: scatter(&desktop),
        board_scatter: several(
            &(0..pairs.first().map_or(0, |pair| pair.board.len()))
                .map(|place| worst(&|pair| pair.board[place]))
                .collect::<Vec<_>>(),
        ),
    }
}

/// Range from the lowest to the highest value, if all values exist.
fn scatter(values: &[Option<f64>]) -> Option<(f64, f64)> {
    let mut all = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values {
        let value = (*value)?;
        all = (all.0.min(value), all.1.max(value));
    }
    Some(all)
}

/// Lowest and highest of a board's values; `None` for a single recording.
fn several(values: &[Option<f64>]) -> Option<(f64, f64)> {
    (values.len() > 1).then(|| scatter(values)).flatten()
}

fn is_press(deed: Deed) -> bool {
    deed == Deed::Press
}

fn is_own(deed: Deed) -> bool {
    match deed {
        Deed::Press => true,
        Deed::Move(frequency_hz) => OWN_HZ.contains(&frequency_hz),
    }
}

fn of_grip(pairs: &[Pair], grip: Option<&'static str>) -> Vec<FigureBeside> {
    let measured = |key, measure: Measure| {
        let asked = ComparedFigure {
            key,
            heading: measure.heading(),
            deeds: is_own,
        };
        figure(pairs, grip, &asked, |seen| seen.figures.get(measure))
    };
    let beside = |key, heading, deeds, of: fn(&Seen) -> f64| {
        let asked = ComparedFigure {
            key,
            heading,
            deeds,
        };
        figure(pairs, grip, &asked, of)
    };
    vec![
        measured("peak_penetration_ratio", Measure::PeakPenetrationRatio),
        beside(
            "settle_from_ramp_end_s",
            ("settle ms", 1e3),
            is_press,
            |seen| {
                let settle = seen.beside.settle_from_ramp_end_s;
                settle.unwrap_or(f64::INFINITY)
            },
        ),
        measured("stiffness_error", Measure::StiffnessError),
        measured("stiffness_error_held", Measure::StiffnessErrorHeld),
        measured("stiffness_error_release", Measure::StiffnessErrorRelease),
        measured("ripple_rms_n_m", Measure::RippleRmsNM),
        beside(
            "release_speed_rad_per_s",
            ("release rad/s", 1.0),
            is_press,
            |seen| seen.beside.release_speed_rad_per_s,
        ),
        beside(
            "energy_out_worst_window_j",
            ("in a window mJ", 1e3),
            is_own,
            |seen| seen.beside.energy_out_worst_window_j,
        ),
        measured("energy_out_j", Measure::EnergyOutJ),
    ]
}

/// Amplitude ratio and phase of force over penetration for an oscillating hand.
fn moved(pair: &Pair) -> Vec<FigureBeside> {
    let Deed::Move(frequency_hz) = pair.deed else {
        return Vec::new();
    };
    let of = |key, heading, get: fn(&Seen) -> Option<f64>| {
        let desktop = pair.desktop.each_ref().map(get);
        FigureBeside {
            key,
            heading,
            grip: Some(pair.grip.name()),
            frequency_hz: Some(frequency_hz),
            desktop: desktop[0],
            board: get(&pair.board[0]),
            scatter: scatter(&desktop),
            board_scatter: several(&pair.board.iter().map(get).collect::<Vec<_>>()),
        }
    };
    vec![
        of("modulus_n_m_per_rad", ("|F/x| N·m/rad", 1.0), |seen| {
            Some(seen.met?.modulus_n_m_per_rad)
        }),
        of("phase_deg", ("phase °", 1.0), |seen| {
            Some(seen.met?.phase_deg)
        }),
    ]
}
