//! Draws the map of tuned walls, one panel per delay, and formats its results as sentences, JSON and report page.

use super::{BoundaryCell, BoundaryPlan, ColumnLimits, TunedEnding, limits, slope};
use serde_json::{Value, json};
use touchstone_report::figure::{Axis, Figure, Range, Shape, Sign};
use touchstone_report::quantity::significant;
use touchstone_report::svg::Size;
use touchstone_report::{Block, Section, drawn};

/// Size of one panel of the map, pixels.
const SIZE: Size = Size {
    width: 430,
    height: 380,
};
/// Least `b T/J` from which a device counts as heavily damped. It is the fraction of its speed that a free device with damping `b`
/// and inertia `J` loses per control period `T`. Such devices are left out of the summaries, because their damping is not small
/// compared with inertia.
pub const HEAVILY_DAMPED: f64 = 0.05;

/// CSS class and name of the map's tiles, in the order of [`TunedEnding::ALL`].
const TILES: [(&str, &str); 5] = [
    ("tile passive", "rests, moving hand too"),
    ("tile active", "rests, moving hand not"),
    ("tile limit-cycle", "rests elsewhere"),
    ("tile unstable", "does not rest"),
    ("tile refused", "refused"),
];

/// Lower and upper edge of each value's tile in the map, as decimal logarithms, half-way to the neighbouring values.
fn edges(values: &[f64]) -> Vec<[f64; 2]> {
    let at = |index: usize| values[index].log10();
    let last = values.len() - 1;
    (0..=last)
        .map(|index| {
            let half = |a: usize, b: usize| 0.5 * (at(b) - at(a));
            let (below, above) = match (index > 0, index < last) {
                (true, true) => (half(index - 1, index), half(index, index + 1)),
                (false, true) => (half(0, 1), half(0, 1)),
                (true, false) => (half(last - 1, last), half(last - 1, last)),
                (false, false) => (0.05, 0.05),
            };
            [at(index) - below, at(index) + above]
        })
        .collect()
}

/// Draws the figures of the map: one panel for each delay.
#[must_use]
pub fn figures(plan: &BoundaryPlan, cells: &[BoundaryCell]) -> Vec<Figure> {
    let (columns, rows) = (edges(&plan.dampings), edges(&plan.stiffnesses));
    let whole = |edges: &[[f64; 2]]| Range::of(edges.iter().flatten().copied());
    let (across, up) = (whole(&columns), whole(&rows));
    let panel = |&delay: &f64| {
        let mut figure = Figure::new(
            &format!("{}, delay {delay} tick", plan.rival.name),
            Axis::powers_of_ten("damping b T/J", "", across),
            Axis::powers_of_ten("stiffness T sqrt(k_de/J)", "", up),
        );
        let own: Vec<&BoundaryCell> = cells
            .iter()
            .filter(|cell| cell.delay_ticks == delay)
            .collect();
        for (ending, (role, name)) in TunedEnding::ALL.into_iter().zip(TILES) {
            let tiles: Vec<[f64; 4]> = own
                .iter()
                .filter(|cell| cell.ended == ending)
                .filter_map(|cell| {
                    let place = |values: &[f64], value: f64| {
                        values.iter().position(|other| *other == value)
                    };
                    let column = place(&plan.dampings, cell.damping_per_tick)?;
                    let row = place(&plan.stiffnesses, cell.stiffness_per_tick)?;
                    Some([
                        columns[column][0],
                        columns[column][1],
                        rows[row][0],
                        rows[row][1],
                    ])
                })
                .collect();
            if !tiles.is_empty() {
                figure.line(role, name, Shape::Tiles(tiles));
            }
        }
        let certified = own
            .iter()
            .filter(|cell| cell.is_certified())
            .map(|cell| {
                let at = (
                    cell.damping_per_tick.log10(),
                    cell.stiffness_per_tick.log10(),
                );
                (at.0, at.1, Sign::Dot)
            })
            .collect();
        figure.line("law-g", "certified stable", Shape::Signs(certified));
        // The bound b/(T/2 + t_d), divided by J/T².
        for (role, name, times) in [("kc", "k_c", 1.0), ("law-b", "20 k_c", 20.0_f64)] {
            let at = |damping: f64| 0.5 * (times * damping / (0.5 + delay)).log10();
            // The part of the line that is inside the panel.
            let points: Vec<(f64, f64)> = (0..=200)
                .map(|step| across.min + (across.max - across.min) * f64::from(step) / 200.0)
                .map(|x| (x, at(10.0_f64.powf(x))))
                .filter(|(_, y)| (up.min..=up.max).contains(y))
                .collect();
            if points.len() > 1 {
                figure.line(role, name, Shape::Series(points));
            }
        }
        let counts: Vec<String> = TunedEnding::ALL
            .into_iter()
            .zip(TILES)
            .filter_map(|(ending, (_, name))| {
                let count = own.iter().filter(|cell| cell.ended == ending).count();
                (count > 0).then(|| format!("{count} {name}"))
            })
            .collect();
        figure.description = format!("{}.", counts.join("; "));
        figure
    };
    plan.delays.iter().map(panel).collect()
}

/// All panels of the map as one SVG picture.
#[must_use]
pub fn picture(plan: &BoundaryPlan, cells: &[BoundaryCell]) -> String {
    let title = format!("Where a tuned wall ends: {}", plan.rival.about);
    drawn(&title, &figures(plan, cells), SIZE)
}

/// Describes the map in sentences: for each delay, whether inertia or damping limits the wall, and any wrong certificates.
#[must_use]
pub fn words(plan: &BoundaryPlan, cells: &[BoundaryCell]) -> Vec<String> {
    let limits = limits(plan, cells);
    plan.delays
        .iter()
        .map(|&delay| {
            let own: Vec<&ColumnLimits> = limits
                .iter()
                .filter(|it| it.delay_ticks == delay && it.damping_per_tick <= HEAVILY_DAMPED)
                .collect();
            let range = |of: &dyn Fn(&ColumnLimits) -> Option<f64>| {
                let range = Range::of(own.iter().filter_map(|it| of(it)));
                match range.min <= range.max {
                    true => format!(
                        "{} to {}",
                        significant(range.min, 3),
                        significant(range.max, 3)
                    ),
                    false => "nowhere".to_owned(),
                }
            };
            let limit = match slope(&limits, delay, HEAVILY_DAMPED) {
                Some(slope) => format!(
                    "slope over damping {slope:.2} (0: inertia limits; 0.5: damping does)"
                ),
                None => "too few columns for a slope".to_owned(),
            };
            format!(
                "{delay} tick of delay, b T/J up to {HEAVILY_DAMPED}: every wall rests up to T sqrt(k_de/J) of {}, {} k_c; a moving hand too up to {}; certified up to {}; {limit}.",
                range(&|it| it.rests_up_to),
                range(&|it| it.times_critical),
                range(&|it| it.holds_up_to),
                range(&|it| it.certified_up_to),
            )
        })
        .chain(wrongly_stable(cells))
        .collect()
}

/// A sentence about walls that were certified stable but do not come to rest, with the cause; `None` if there are none.
fn wrongly_stable(cells: &[BoundaryCell]) -> Option<String> {
    let wrong: Vec<String> = cells
        .iter()
        .filter(|cell| cell.is_wrongly_stable())
        .map(|cell| {
            format!(
                "{} tick, b T/J {}, T sqrt(k_de/J) {} ({})",
                cell.delay_ticks,
                significant(cell.damping_per_tick, 3),
                significant(cell.stiffness_per_tick, 3),
                cell.rest_cause.map_or("unexplained", |cause| cause.words())
            )
        })
        .collect();
    let stable = cells.iter().filter(|cell| cell.is_certified()).count();
    (!wrong.is_empty()).then(|| {
        format!(
            "Called stable and not at rest, {} of {stable}: {}.",
            wrong.len(),
            wrong.join("; ")
        )
    })
}

/// Contents of `results.json`: stiffness limits of every column of the map, and slopes of the boundary.
#[must_use]
pub fn results(plan: &BoundaryPlan, cells: &[BoundaryCell]) -> Value {
    let limits = limits(plan, cells);
    let slopes: Vec<Value> = plan
        .delays
        .iter()
        .map(|&delay| json!({"delay_ticks": delay, "slope": slope(&limits, delay, HEAVILY_DAMPED)}))
        .collect();
    json!({
        "scene": plan.base.name,
        "law": plan.rival.name,
        "seed": plan.seed,
        "ticks": plan.ticks,
        "cells": cells.len(),
        "called_stable_and_not_at_rest": cells.iter().filter(|cell| cell.is_wrongly_stable()).count(),
        "columns": limits,
        "slopes": slopes,
    })
}

/// Sections of the report page with the map.
#[must_use]
pub fn sections(plan: &BoundaryPlan, cells: &[BoundaryCell]) -> Vec<Section> {
    let mut body = vec![Block::Figure(picture(plan, cells))];
    body.extend(words(plan, cells).into_iter().map(Block::Text));
    let text = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |it| significant(it, 3));
    body.push(Block::Table {
        caption: "T sqrt(k_de/J) up to which every wall of a column …".to_owned(),
        header: [
            "delay, ticks",
            "b T/J",
            "rests",
            "highest that rests",
            "and a moving hand",
            "highest certified",
            "k_de there over k_c",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: limits(plan, cells)
            .iter()
            .map(|it| {
                vec![
                    it.delay_ticks.to_string(),
                    significant(it.damping_per_tick, 3),
                    text(it.rests_up_to),
                    text(it.highest_at_rest),
                    text(it.holds_up_to),
                    text(it.certified_up_to),
                    text(it.times_critical),
                ]
            })
            .collect(),
    });
    vec![Section {
        title: "Inertia or damping?".to_owned(),
        body,
        folded: false,
    }]
}
