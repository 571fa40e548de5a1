//! The set of hands for which a certificate holds.
//!
//! A hand is a mass behind a fingertip pad as in [`touchstone_world::plant::Hand`], at a knob gripped at a radius of 15 mm. The
//! ranges below are values at the fingertip, from published figures where there are any:
//!
//! - mass of the hand 0.1 to 1 kg: teleoperation studies use 0.1 kg to 1 kg, a study of force bounding 0.8 kg
//! - damping 1 to 10 N·s/m: reported for a delta.3; 5.5 N·s/m in the study of force bounding
//! - stiffness 0 to 300 N/m; at 0 the hand pushes with a force instead of holding a position
//! - stiffness of the finger pad 300 to 2000 N/m; its damping 0.15 to 1.5 N·s/m is this project's choice, see [`plant::MEDIUM`]
//!
//! Hasser and Cutkosky (2002) and Kuchenbecker, Park and Niemeyer (2003) find a second-order hand whose damping and stiffness rise
//! with the grip; their numbers were not available. The ranges are therefore chosen, not measured.

use serde::Serialize;
use touchstone_world::plant::{self, Hand};

/// Square of the grip's radius of 15 mm, m². It converts stiffness in N/m to N·m/rad and mass in kg to kg·m².
const RADIUS_SQUARED_M2: f64 = 2.25e-4;

/// The set of hands that a certificate examines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// The scene's own hand, or no hand if the scene has none.
    Own,
    /// The scene's own hand, if it has one, and the three grips `light`, `medium` and `firm`.
    Grips,
    /// The scene's own hand, the three simulated grips (light, medium, firm), and the worst hand within [`RANGES`].
    #[default]
    All,
}

/// Lowest and highest value of each of a hand's five parameters, in the order of [`parameters`].
pub const RANGES: [[f64; 2]; 5] = [
    [0.1 * RADIUS_SQUARED_M2, 1.0 * RADIUS_SQUARED_M2],
    [1.0 * RADIUS_SQUARED_M2, 10.0 * RADIUS_SQUARED_M2],
    [0.0, 300.0 * RADIUS_SQUARED_M2],
    [0.33e-4, 3.3e-4],
    [300.0 * RADIUS_SQUARED_M2, 2000.0 * RADIUS_SQUARED_M2],
];

/// A hand's inertia, damping, stiffness, pad damping and pad stiffness, SI units.
#[must_use]
pub fn parameters(hand: &Hand) -> [f64; 5] {
    [
        hand.inertia,
        hand.damping,
        hand.stiffness,
        hand.pad_damping,
        hand.pad_stiffness,
    ]
}

/// Creates a hand from the five values of [`parameters`].
#[must_use]
pub fn from_parameters(values: [f64; 5]) -> Hand {
    let [inertia, damping, stiffness, pad_damping, pad_stiffness] = values;
    Hand {
        inertia,
        damping,
        stiffness,
        pad_damping,
        pad_stiffness,
    }
}

/// The three simulated grips (light, medium, firm) of the simulated hand, with their names.
pub const GRIPS: [(&str, Hand); 3] = [
    ("light", plant::LIGHT),
    ("medium", plant::MEDIUM),
    ("firm", plant::FIRM),
];

/// Name of the worst hand within [`RANGES`], which is found by a search.
pub const HYPOTHETICAL: &str = "worst of all";

/// The hand at a position within [`RANGES`]. Each coordinate goes from 0 to 1 over the range of one parameter. The scale is
/// logarithmic, except for the stiffness, which may be zero.
fn at(place: [f64; 5]) -> Hand {
    from_parameters(std::array::from_fn(|index| {
        let [low, high] = RANGES[index];
        if low > 0.0 {
            low * (high / low).powf(place[index])
        } else {
            low + (high - low) * place[index]
        }
    }))
}

/// Searches the ranges for the hand with the greatest `badness`. The search tries all corners and the middle, then goes from the
/// worst of them along each coordinate with steps that are halved. Returns the hand and its `badness`.
pub fn worst(badness: impl Fn(&Hand) -> f64) -> (Hand, f64) {
    let corner = |bits: usize| std::array::from_fn(|index| f64::from((bits >> index & 1) as u8));
    let mut place = [0.5; 5];
    let mut most = badness(&at(place));
    for candidate in (0..32).map(corner) {
        let bad = badness(&at(candidate));
        if bad > most {
            (place, most) = (candidate, bad);
        }
    }
    let mut step = 0.5;
    while step > 0.03 {
        let mut better = false;
        for index in 0..5 {
            for change in [-step, step] {
                let mut candidate = place;
                candidate[index] = (place[index] + change).clamp(0.0, 1.0);
                let bad = badness(&at(candidate));
                if bad > most {
                    (place, most, better) = (candidate, bad, true);
                }
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    (at(place), most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grips_lie_in_the_ranges() {
        for (name, hand) in GRIPS {
            for (value, [low, high]) in parameters(&hand).into_iter().zip(RANGES) {
                assert!(
                    (low * (1.0 - 1e-12)..=high * (1.0 + 1e-12)).contains(&value),
                    "{name}: {value:e} outside {low:e} to {high:e}"
                );
            }
        }
    }

    #[test]
    fn the_search_finds_a_worst_hand_inside_the_ranges() {
        let peak = from_parameters([1e-4, 1e-3, 0.03, 1e-4, 0.2]);
        let (found, _) = worst(|hand| {
            -parameters(hand)
                .into_iter()
                .zip(parameters(&peak))
                .map(|(a, b)| (a / b).max(1e-9).ln().powi(2))
                .sum::<f64>()
        });
        for (a, b) in parameters(&found).into_iter().zip(parameters(&peak)) {
            assert!((a / b).ln().abs() < 0.1, "{a:e} {b:e}");
        }
    }
}
