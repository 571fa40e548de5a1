//! The parts of a feel whose torque depends on the angle, divided into cells of constant stiffness.

use std::f64::consts::TAU;
use touchstone_control::environment::{Refused, WHOLE};
use touchstone_sim::scene::Environment;

/// Largest number of angles per part at which the sum of all parts is examined. If there are more angles, the steepest slopes of
/// the parts are added instead.
const MOST_PLACES: usize = 100_000;

/// A range of angles, in rad, in which a part has a constant stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub from: f64,
    pub to: f64,
    /// Stiffness, N·m/rad; positive if the torque draws the knob back.
    pub stiffness: f64,
    /// Largest amplitude of an oscillation within which the torque is linear, rad; in general half the cell's width.
    pub half: f64,
}

/// A part whose torque is linear in the angle within each cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Static {
    pub part: &'static str,
    cells: Vec<Cell>,
    /// Distance after which the cells repeat, rad; `None` if they do not repeat.
    pub every: Option<f64>,
    /// Whether a turn is a whole number of these distances.
    per_turn: bool,
}

impl Static {
    fn at(&self, angle: f64) -> f64 {
        let Some(first) = self.cells.first() else {
            return 0.0;
        };
        let angle = match self.every {
            Some(every) => first.from + (angle - first.from).rem_euclid(every),
            None => angle,
        };
        let cell = self
            .cells
            .iter()
            .find(|it| it.from <= angle && angle < it.to);
        cell.map_or(0.0, |it| it.stiffness)
    }

    /// The steepest restoring cell and the steepest driving cell; `None` if there is none.
    pub fn steepest(&self) -> [Option<Cell>; 2] {
        let by = |sign: f64| {
            let cells = self.cells.iter().filter(|it| it.stiffness * sign > 0.0);
            cells
                .copied()
                .max_by(|a, b| (a.stiffness * sign).total_cmp(&(b.stiffness * sign)))
        };
        [by(1.0), by(-1.0)]
    }
}

/// All parts of the feel whose torque depends on the angle.
pub(super) fn statics(around: &Environment) -> std::result::Result<Vec<Static>, Refused> {
    let mut all = Vec::new();
    let once = |part, cells| Static {
        part,
        cells,
        every: None,
        per_turn: false,
    };
    if let Some(ring) = around.detents.as_ref().filter(|it| it.strength_n_m > 0.0) {
        let per_turn = ring.per_rev > 0;
        let pitch = match per_turn {
            true => TAU / f64::from(ring.per_rev),
            false => ring.pitch_rad,
        };
        // The torque is a triangle wave, with its maximum a quarter of the way to the next detent.
        let (stiffness, near) = (4.0 * ring.strength_n_m / pitch, 0.25 * pitch);
        let cell = |from: f64, to: f64, stiffness| Cell {
            from: ring.centre_rad + from,
            to: ring.centre_rad + to,
            stiffness,
            half: near,
        };
        all.push(Static {
            part: "environment.detents",
            cells: vec![
                cell(-near, near, stiffness),
                cell(near, 3.0 * near, -stiffness),
            ],
            every: Some(pitch),
            per_turn,
        });
    }
    if let Some(profile) = around.acting_profile() {
        let shape = profile.points()?;
        let points: Vec<f64> = (shape.points().iter())
            .map(|point| f64::from(*point) / f64::from(WHOLE) * profile.strength_n_m)
            .collect();
        let (n, repeats) = (points.len(), profile.per_rev > 0);
        let (length, steps) = match repeats {
            true => (TAU / f64::from(profile.per_rev), n),
            false => (profile.end_rad - profile.start_rad, n - 1),
        };
        let step = length / steps as f64;
        let cells = (0..steps).map(|i| Cell {
            from: profile.start_rad + step * i as f64,
            to: profile.start_rad + step * (i + 1) as f64,
            stiffness: (points[i] - points[(i + 1) % n]) / step,
            half: 0.5 * step,
        });
        all.push(Static {
            every: repeats.then_some(length),
            per_turn: repeats,
            ..once(around.profile_table(), cells.collect())
        });
    }
    let spring = around.spring.as_ref();
    if let Some(it) = spring.filter(|it| it.stiffness_n_m_per_rad > 0.0 && it.strength_n_m > 0.0) {
        let reach = it.strength_n_m / it.stiffness_n_m_per_rad;
        let cell = Cell {
            from: it.centre_rad - reach,
            to: it.centre_rad + reach,
            stiffness: it.stiffness_n_m_per_rad,
            half: reach,
        };
        all.push(once("environment.spring", vec![cell]));
    }
    let friction = around.dry_friction.as_ref();
    if let Some(it) = friction.filter(|it| it.strength_n_m > 0.0) {
        // Until dry friction slides, it acts like a spring, at any angle.
        let cell = Cell {
            from: f64::NEG_INFINITY,
            to: f64::INFINITY,
            stiffness: it.strength_n_m / it.stretch_rad,
            half: it.stretch_rad,
        };
        all.push(once("environment.dry_friction", vec![cell]));
    }
    Ok(all)
}

/// The cell in which the sum of all parts is most restoring; `None` for fewer than two parts. If the parts have no common period,
/// too many cells or no angles, the sum of their steepest restoring slopes is returned. These slopes may not meet at one angle.
pub(super) fn together(parts: &[Static]) -> Option<Cell> {
    if parts.len() < 2 {
        return None;
    }
    let steepest = || parts.iter().filter_map(|part| part.steepest()[0]);
    let bound = Cell {
        from: f64::NEG_INFINITY,
        to: f64::INFINITY,
        stiffness: steepest().map(|cell| cell.stiffness).sum(),
        half: steepest()
            .map(|cell| cell.half)
            .fold(f64::INFINITY, f64::min),
    };
    let repeated = parts.iter().filter(|part| part.every.is_some()).count();
    let drifts = repeated > 1 && parts.iter().any(|it| it.every.is_some() && !it.per_turn);
    let ends = |pick: fn(&Cell) -> f64| {
        let once = parts.iter().filter(|part| part.every.is_none());
        once.flat_map(move |part| part.cells.iter().map(pick))
            .filter(|end| end.is_finite())
    };
    let low = ends(|cell| cell.from).reduce(f64::min).unwrap_or(0.0);
    let high = ends(|cell| cell.to).reduce(f64::max).unwrap_or(low) + TAU;
    let mut places: Vec<f64> = Vec::new();
    for part in parts {
        let turns = part
            .every
            .map_or(1.0, |every| ((high - low) / every).ceil() + 1.0);
        if drifts || turns * part.cells.len() as f64 > MOST_PLACES as f64 {
            return Some(bound);
        }
        for cell in part.cells.iter().filter(|cell| cell.from.is_finite()) {
            match part.every {
                None => places.extend([cell.from, cell.to]),
                Some(every) => {
                    let first = low + (cell.from - low).rem_euclid(every);
                    places.extend((0..turns as usize).map(|turn| first + every * turn as f64));
                }
            }
        }
    }
    // Some repeating parts have angles beyond the end, others do not.
    places.retain(|place| *place <= high);
    places.sort_by(f64::total_cmp);
    let cells = places.windows(2).map(|ends| {
        let (from, to) = (ends[0], ends[1]);
        let middle = 0.5 * (from + to);
        let stiffness = parts.iter().map(|part| part.at(middle)).sum();
        Cell {
            from,
            to,
            stiffness,
            half: 0.5 * (to - from),
        }
    });
    // Two angles that differ only by rounding do not bound a cell.
    cells
        .filter(|cell| cell.to - cell.from > 1e-9)
        .max_by(|a, b| a.stiffness.total_cmp(&b.stiffness))
        .or(Some(bound))
}
