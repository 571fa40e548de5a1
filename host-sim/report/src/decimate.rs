//! Reduces traces to the points that a plot can show, so that a page with many plots stays small. Extremes are kept.
//!
//! Coordinates are in fine steps of the drawing; [`super::svg::FINE`] steps make a pixel at the plot's nominal size.

use std::collections::HashSet;

/// A point of a drawing, in fine steps (tenths of a pixel).
pub type Point = (i32, i32);

/// Largest deviation of a simplified line, in fine steps: a sixth of a pixel.
const TOLERANCE: f64 = 1.6;

/// Width of a column in which [`series`] keeps extremes, in fine steps. Half a pixel looks sharp even in an enlarged plot or on a
/// dense screen.
const COLUMN: i32 = 5;

/// Largest number of points of a force–position path. A path with more points is drawn on coarser grids.
const PATH_POINTS: usize = 6000;

/// Reduces a time series with points in order of `x`. In each column half a pixel wide, the first, lowest, highest and last sample
/// are kept; others are not visible. Then points on straight stretches are dropped. A NaN interrupts the line.
pub fn series(points: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<Point>> {
    let mut stretches = Vec::new();
    let mut stretch: Vec<Point> = Vec::new();
    // First, lowest, highest and last of the current column, with their order of appearance.
    let mut column: Option<(i32, [(usize, Point); 4])> = None;
    let flush = |column: &mut Option<(i32, [(usize, Point); 4])>, stretch: &mut Vec<Point>| {
        if let Some((_, mut kept)) = column.take() {
            kept.sort_by_key(|(order, _)| *order);
            for (_, point) in kept {
                if stretch.last() != Some(&point) {
                    stretch.push(point);
                }
            }
        }
    };
    for (order, (x, y)) in points.enumerate() {
        if !(x.is_finite() && y.is_finite()) {
            flush(&mut column, &mut stretch);
            if !stretch.is_empty() {
                stretches.push(simplify(&std::mem::take(&mut stretch)));
            }
            continue;
        }
        let point = (x.round() as i32, y.round() as i32);
        let index = point.0.div_euclid(COLUMN);
        match &mut column {
            Some((current, [_, low, high, last])) if *current == index => {
                *last = (order, point);
                if point.1 < low.1.1 {
                    *low = (order, point);
                }
                if point.1 > high.1.1 {
                    *high = (order, point);
                }
            }
            _ => {
                flush(&mut column, &mut stretch);
                column = Some((index, [(order, point); 4]));
            }
        }
    }
    flush(&mut column, &mut stretch);
    if !stretch.is_empty() {
        stretches.push(simplify(&stretch));
    }
    stretches
}

/// Reduces a path that may turn back on itself. Points that do not move the pen visibly are dropped, then the Douglas–Peucker
/// algorithm simplifies the path.
///
/// An oscillation draws the same lines repeatedly. If the path still has too many points, it is rounded to a grid and each line
/// of the grid is drawn once. The grid becomes coarser until the points are few enough, from a fifth of a pixel up to three
/// pixels.
pub fn path(stretches: Vec<Vec<(f64, f64)>>) -> Vec<Vec<Point>> {
    let snap = |stretch: &Vec<(f64, f64)>, grid: f64| {
        let mut points: Vec<Point> = stretch
            .iter()
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .map(|(x, y)| {
                (
                    ((x / grid).round() * grid) as i32,
                    ((y / grid).round() * grid) as i32,
                )
            })
            .collect();
        points.dedup();
        points
    };
    let mut kept: Vec<Vec<Point>> = stretches.iter().map(|s| simplify(&snap(s, 1.0))).collect();
    for grid in [2.0, 5.0, 10.0, 30.0] {
        if kept.iter().map(Vec::len).sum::<usize>() <= PATH_POINTS {
            break;
        }
        let mut drawn = HashSet::new();
        kept = stretches
            .iter()
            .flat_map(|s| draw_once(&snap(s, grid), &mut drawn))
            .collect();
    }
    kept.retain(|stretch| stretch.len() > 1);
    kept
}

/// Splits a path into pieces so that no line between two points is drawn a second time, in either direction.
fn draw_once(points: &[Point], drawn: &mut HashSet<(Point, Point)>) -> Vec<Vec<Point>> {
    let mut stretches = Vec::new();
    let mut stretch: Vec<Point> = Vec::new();
    for pair in points.windows(2) {
        let line = (pair[0].min(pair[1]), pair[0].max(pair[1]));
        if drawn.insert(line) {
            if stretch.is_empty() {
                stretch.push(pair[0]);
            }
            stretch.push(pair[1]);
        } else if !stretch.is_empty() {
            stretches.push(std::mem::take(&mut stretch));
        }
    }
    stretches.push(stretch);
    stretches
}

/// Simplifies a path by the Douglas–Peucker algorithm without recursion, so that no dropped point is further than [`TOLERANCE`]
/// from the line.
fn simplify(points: &[Point]) -> Vec<Point> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut open = vec![(0, points.len() - 1)];
    while let Some((first, last)) = open.pop() {
        let farthest = (first + 1..last)
            .map(|i| (i, distance_squared(points[i], points[first], points[last])))
            .fold((first, TOLERANCE * TOLERANCE), |best, next| {
                if next.1 > best.1 { next } else { best }
            });
        if farthest.0 != first {
            keep[farthest.0] = true;
            open.push((first, farthest.0));
            open.push((farthest.0, last));
        }
    }
    points
        .iter()
        .zip(keep)
        .filter(|(_, keep)| *keep)
        .map(|(point, _)| *point)
        .collect()
}

/// Squared distance of `p` from the line segment `a`–`b`. The segment counts, not the infinite line, so that a spike beyond an end
/// is kept.
fn distance_squared(p: Point, a: Point, b: Point) -> f64 {
    let d = |p: Point, q: Point| {
        (
            f64::from(p.0) - f64::from(q.0),
            f64::from(p.1) - f64::from(q.1),
        )
    };
    let (ab, ap) = (d(b, a), d(p, a));
    let length = ab.0 * ab.0 + ab.1 * ab.1;
    let along = if length > 0.0 {
        ((ap.0 * ab.0 + ap.1 * ab.1) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let off = (ap.0 - along * ab.0, ap.1 - along * ab.1);
    off.0 * off.0 + off.1 * off.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_spike_survives() {
        let wave = (0..100_000).map(|i| {
            (
                f64::from(i) * 0.024,
                if i == 54_321 { 900.0 } else { 500.0 },
            )
        });
        let lines = series(wave);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().any(|p| p.1 == 900), "{:?}", lines[0]);
        assert!(lines[0].len() < 12, "{}", lines[0].len());
    }

    #[test]
    fn a_dense_oscillation_keeps_both_edges_and_few_points() {
        let wave = (0..200_000).map(|i| {
            (
                f64::from(i) * 0.012,
                500.0 + 400.0 * (f64::from(i) * 0.7).sin(),
            )
        });
        let lines = series(wave);
        assert!(lines[0].len() <= 4 * 2401 / 5, "{}", lines[0].len());
        // Every column reaches both edges, whichever samples it contains.
        for columns in lines[0].chunks(8) {
            assert!(columns.iter().any(|p| p.1 < 110) && columns.iter().any(|p| p.1 > 890));
        }
    }

    #[test]
    fn nan_makes_a_gap() {
        let lines = series((0..30).map(|i| {
            (
                f64::from(i) * 10.0,
                if (10..20).contains(&i) { f64::NAN } else { 1.0 },
            )
        }));
        assert_eq!(lines, [vec![(0, 1), (90, 1)], vec![(200, 1), (290, 1)]]);
        assert!(series(std::iter::empty()).is_empty());
    }

    #[test]
    fn paths_stay_within_the_tolerance() {
        let circle: Vec<(f64, f64)> = (0..5000)
            .map(|i| f64::from(i) * 0.001256637)
            .map(|a| (1000.0 * a.cos(), 1000.0 * a.sin()))
            .collect();
        let drawn = path(vec![circle.clone()]);
        assert!(drawn[0].len() < 150, "{}", drawn[0].len());
        for &(x, y) in &circle {
            let p = (x.round() as i32, y.round() as i32);
            let off = drawn[0]
                .windows(2)
                .map(|w| distance_squared(p, w[0], w[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(off.sqrt() <= TOLERANCE + 1e-9);
        }
    }

    #[test]
    fn a_repeated_path_is_drawn_once() {
        let noisy = |i: u32| {
            let a = f64::from(i) * 0.9;
            (
                1000.0 * a.cos() + f64::from(i % 7),
                1000.0 * (1.3 * a).sin(),
            )
        };
        let drawn = path(vec![(0..200_000).map(noisy).collect()]);
        let points: usize = drawn.iter().map(Vec::len).sum();
        assert!(points < 200_000 / 2, "{points}");
        let edge = drawn.iter().flatten().map(|p| p.0).max().unwrap();
        assert!((990..=1020).contains(&edge), "{edge}");
    }
}
