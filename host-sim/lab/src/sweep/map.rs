//! Draws the map as a figure: a tile for each cell, and over the tiles predicted lines and points from a user's measurements.

use super::Sweep;
use super::lines::Line;
use super::measure::{Measure, VERDICT, verdicts};
use super::store::Cells;
use touchstone_report::figure::{Axis as FigureAxis, Figure, Range, Shape, Sign};
use touchstone_report::quantity::significant;
use touchstone_sim::scene::schema::Field;

/// CSS classes for the colours of a measure's values, one per range of values.
const BANDS: [&str; 8] = [
    "band band0",
    "band band1",
    "band band2",
    "band band3",
    "band band4",
    "band band5",
    "band band6",
    "band band7",
];

/// Points from a user's measurements.
#[derive(Debug, Clone, Default)]
pub struct Overlay {
    /// Name of the user's measurements, for the legend.
    pub name: String,
    /// Coordinates of the points in the axes' units.
    pub points: Vec<(f64, f64)>,
}

/// The lines and points that are drawn over the map's tiles.
#[derive(Debug, Clone, Default)]
pub struct Over {
    /// Lines that theory predicts.
    pub lines: Vec<Line>,
    /// Points from a user's measurements.
    pub points: Option<Overlay>,
}

/// Draws the map of verdicts.
#[must_use]
pub fn of_verdicts(sweep: &Sweep, cells: &Cells, over: &Over) -> Figure {
    let words = verdicts();
    let class = |cell: u64| {
        let row = cells.get(&cell)?;
        words.iter().position(|word| *word == row.3)
    };
    let mut figure = empty(sweep, "Verdict");
    let counts: Vec<String> = words
        .iter()
        .enumerate()
        .filter_map(|(index, word)| {
            let count = cells.values().filter(|row| row.3 == *word).count();
            (count > 0).then(|| {
                figure.line(
                    VERDICT_CLASSES[index],
                    word,
                    Shape::Tiles(tiles(sweep, &|cell| class(cell) == Some(index))),
                );
                format!("{count} {word}")
            })
        })
        .collect();
    figure.description = format!("{} cells: {}.", cells.len(), counts.join(", "));
    draw_over(&mut figure, sweep, over);
    figure
}

const VERDICT_CLASSES: [&str; 7] = [
    "tile passive",
    "tile active",
    "tile limit-cycle",
    "tile unstable",
    // Not judged and no contact have one colour; the legend tells them apart.
    "tile no-contact",
    "tile no-contact",
    "tile refused",
];

/// Draws the map of a measure's values.
#[must_use]
pub fn of_measure(
    sweep: &Sweep,
    cells: &Cells,
    index: usize,
    measure: &Measure,
    over: &Over,
) -> Figure {
    let value = |cell: u64| cells.get(&cell).and_then(|row| row.4.get(index).copied()?);
    let range = Range::of(cells.keys().filter_map(|cell| value(*cell)));
    // On a linear scale over more than three decades, all small values would have one colour.
    let log = range.min > 0.0 && range.max > 1e3 * range.min;
    let scaled = |value: f64| if log { value.log10() } else { value };
    let (low, high) = (scaled(range.min), scaled(range.max));
    let band = |cell: u64| {
        value(cell).map(|value| {
            let share = (scaled(value) - low) / (high - low).max(f64::MIN_POSITIVE);
            ((share * BANDS.len() as f64) as usize).min(BANDS.len() - 1)
        })
    };
    let unit = if measure.unit == "1" {
        ""
    } else {
        measure.unit
    };
    let mut figure = empty(sweep, measure.words);
    for (index, class) in BANDS.into_iter().enumerate() {
        let share = (index + 1) as f64 / BANDS.len() as f64;
        let top = low + (high - low) * share;
        let top = if log { 10.0_f64.powf(top) } else { top };
        let found = tiles(sweep, &|cell| band(cell) == Some(index));
        if !found.is_empty() {
            figure.line(
                class,
                &format!("≤ {}", significant(top, 3)),
                Shape::Tiles(found),
            );
        }
    }
    let none = cells.keys().filter(|cell| value(**cell).is_none()).count();
    figure.description = format!(
        "{} from {} to {}{}; {none} of {} cells have no value and are blank.",
        measure.words,
        significant(range.min, 4),
        significant(range.max, 4),
        if unit.is_empty() {
            String::new()
        } else {
            format!(" {unit}")
        },
        cells.len()
    );
    draw_over(&mut figure, sweep, over);
    figure
}

fn empty(sweep: &Sweep, title: &str) -> Figure {
    let axis = |axis: &super::axis::Axis| {
        let last = axis.values.len() - 1;
        let range = Range {
            min: *axis.edges(0).start(),
            max: *axis.edges(last).end(),
        };
        let unit = unit(axis.field);
        if axis.log {
            return FigureAxis::powers_of_ten(axis.field.path, unit, range);
        }
        let mut drawn = FigureAxis::new(axis.field.path, unit, range);
        if axis.numbers().is_none() {
            drawn.marks = Some(
                (0..=last)
                    .map(|index| (index as f64, axis.text(index)))
                    .collect(),
            );
        }
        drawn
    };
    Figure::new(
        &format!("{title}, {}", sweep.grid.base.name),
        axis(&sweep.grid.x),
        axis(&sweep.grid.y),
    )
}

/// Unit of a field of the scene file; empty if it has none.
#[must_use]
pub fn unit(field: &Field) -> &'static str {
    field.unit_shown()
}

/// Rectangles that cover the chosen cells. Neighbouring cells of a row are joined; then equal stretches of neighbouring rows are
/// joined.
fn tiles(sweep: &Sweep, chosen: &dyn Fn(u64) -> bool) -> Vec<[f64; 4]> {
    let (x, y) = (&sweep.grid.x, &sweep.grid.y);
    let wide = x.values.len();
    let mut tiles: Vec<[f64; 4]> = Vec::new();
    // Rectangles that reach up to the current row.
    let mut open: Vec<usize> = Vec::new();
    for row in 0..y.values.len() {
        let (low, high) = y.edges(row).into_inner();
        let mut column = 0;
        let mut here = Vec::new();
        while column < wide {
            let begin = column;
            while column < wide && chosen((row * wide + column) as u64) {
                column += 1;
            }
            if column == begin {
                column += 1;
                continue;
            }
            let (left, right) = (*x.edges(begin).start(), *x.edges(column - 1).end());
            let below = open.iter().copied().find(|&index| {
                let tile: &[f64; 4] = &tiles[index];
                tile[0] == left && tile[1] == right && tile[3] == low
            });
            match below {
                Some(index) => {
                    tiles[index][3] = high;
                    here.push(index);
                }
                None => {
                    tiles.push([left, right, low, high]);
                    here.push(tiles.len() - 1);
                }
            }
        }
        open = here;
    }
    tiles
}

fn draw_over(figure: &mut Figure, sweep: &Sweep, over: &Over) {
    for line in &over.lines {
        let pieces = line.pieces.iter().map(|piece| piece.to_vec()).collect();
        figure.line(line.role, line.name, Shape::Path(pieces));
    }
    if let Some(overlay) = &over.points {
        let (x, y) = (&sweep.grid.x, &sweep.grid.y);
        let signs = overlay
            .points
            .iter()
            .map(|&(a, b)| (x.scaled(a), y.scaled(b), Sign::Ring))
            .collect();
        figure.line("law-b", &overlay.name, Shape::Signs(signs));
    }
}

/// File name of the map of a measure, or of the map of verdicts if `measure` is `None`.
#[must_use]
pub fn file(measure: Option<&Measure>) -> String {
    format!(
        "map-{}.svg",
        measure.map_or(VERDICT, |it| it.name).replace('_', "-")
    )
}
