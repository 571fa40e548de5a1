//! Describes the results of a scorecard in sentences.

use super::measure::{Measure, is_beyond};
use super::{Cell, Row};

/// Formats the value of a measure for readers.
#[must_use]
pub fn shown(measure: Measure, value: f64) -> String {
    let (_, factor) = measure.heading();
    match measure {
        _ if !value.is_finite() => "lost".to_owned(),
        Measure::PeakPenetrationRatio => format!("{value:.3}"),
        Measure::EnergyOutJ if value <= super::measure::ENERGY_ROUNDING_J => "0".to_owned(),
        Measure::EnergyOutJ => format!("{:.4}", factor * value),
        Measure::RippleRmsNM => format!("{:.2}", factor * value),
        _ => format!("{:.1}", factor * value),
    }
}

/// Describes where a control law fails: one sentence for every measure beyond its limit, with the worst device; the worst measure
/// first.
#[must_use]
pub fn fails(cells: &[Cell]) -> Vec<String> {
    let mut fails: Vec<(f64, String)> = Vec::new();
    for (index, measure) in Measure::ALL.into_iter().enumerate() {
        let beyond: Vec<(&Cell, f64)> = cells
            .iter()
            .map(|cell| (cell, cell.figures.shares(&cell.limits)[index]))
            .filter(|(_, share)| is_beyond(*share))
            .collect();
        let Some((worst, share)) = beyond.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        let value = shown(measure, worst.figures.get(measure));
        let limit = shown(measure, worst.limits.of(measure));
        fails.push((
            share,
            format!(
                "{} {value} (limit {limit}) at {}, beyond its limit on {} of {} devices",
                measure.heading().0,
                worst.case,
                beyond.len(),
                cells.len()
            ),
        ));
    }
    fails.sort_by(|a, b| b.0.total_cmp(&a.0));
    fails.into_iter().map(|(_, text)| text).collect()
}

/// Sentences that say which limits each spring with damping exceeds, and in which measures it is better or worse than each other
/// law.
#[must_use]
pub fn damped_spring(rows: &[Row]) -> Vec<String> {
    let mut said = Vec::new();
    let (springs, others): (Vec<&Row>, Vec<&Row>) = rows
        .iter()
        .filter(|row| row.worst.is_some())
        .partition(|row| row.damped_spring);
    for spring in &springs {
        said.push(match spring.fails.first() {
            None => format!("{} is within every limit.", spring.law),
            Some(worst) => format!(
                "{} fails in {}: worst {worst}.",
                spring.law,
                figures(spring.fails.len())
            ),
        });
    }
    for other in others {
        for spring in &springs {
            let better: Vec<&str> = Measure::ALL
                .into_iter()
                .filter(|measure| clearly_less(spring, other, *measure))
                .map(|measure| measure.heading().0)
                .collect();
            let worse: Vec<&str> = Measure::ALL
                .into_iter()
                .filter(|measure| clearly_less(other, spring, *measure))
                .map(|measure| measure.heading().0)
                .collect();
            if better.is_empty() && worse.is_empty() {
                said.push(format!("{} and {} are alike.", spring.law, other.law));
            } else {
                let of = |figures: Vec<&str>| match figures.is_empty() {
                    true => "nothing".to_owned(),
                    false => figures.join(", "),
                };
                said.push(format!(
                    "{} against {}: the damped spring is better in {}; worse in {}.",
                    spring.law,
                    other.law,
                    of(better),
                    of(worse)
                ));
            }
        }
    }
    said
}

/// Whether a measure of `one` is smaller than that of `other` by more than 5 % and by more than rounding.
fn clearly_less(one: &Row, other: &Row, measure: Measure) -> bool {
    let of = |row: &Row| row.worst.map_or(f64::INFINITY, |worst| worst.get(measure));
    let (one, other) = match measure {
        Measure::PeakPenetrationRatio => (of(one) - 1.0, of(other) - 1.0),
        _ => (of(one), of(other)),
    };
    let rounding = match measure {
        Measure::EnergyOutJ => super::measure::ENERGY_ROUNDING_J,
        Measure::RippleRmsNM => 1e-6,
        Measure::PhaseDeg => 0.1,
        _ => 1e-3,
    };
    one < 0.95 * other && other > one + rounding
}

fn figures(count: usize) -> String {
    match count {
        1 => "one figure".to_owned(),
        count => format!("{count} figures"),
    }
}
