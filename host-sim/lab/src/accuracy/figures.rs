//! Draws the diagrams of an accuracy measurement: computing time against error on logarithmic axes, and the results of the
//! sampling.

use super::plant::{Diagram, Point};
use super::sampling::SamplingPoint;
use super::{Accuracy, COUNT_RAD, FORCE_QUANTUM_N_M};
use touchstone_report::figure::{Axis, Figure, Range, Shape, Sign};
use touchstone_report::standalone;

/// Stiffness by which a force error is divided to compare it with an angle error in the diagrams, N·m/rad.
const WALL_N_M_PER_RAD: f64 = 1.0;
/// Least error in a diagram. Smaller errors are drawn at this value, because rounding errors do not follow a curve.
const LEAST: f64 = 1e-17;

const CLASSES: [&str; 7] = [
    "law-g", "law-a", "law-d", "law-c", "law-f", "law-b", "law-e",
];

fn log(value: f64) -> f64 {
    value.max(LEAST).log10()
}

/// A logarithmic axis with marks at powers of ten that covers the values.
fn axis(title: &str, values: impl Iterator<Item = f64>) -> Axis {
    let range = Range::of(values.map(log));
    let (low, high) = (range.min.floor(), range.max.ceil());
    let range = Range {
        min: low,
        max: high.max(low + 1.0),
    };
    let mut axis = Axis::new(title, "", range);
    let every = if range.max - range.min > 9.0 { 2 } else { 1 };
    let marks = (range.min as i32..=range.max as i32).filter(|power| power % every == 0);
    axis.marks = Some(
        marks
            .map(|power| (f64::from(power), format!("1e{power}")))
            .collect(),
    );
    axis
}

/// All diagrams: file names and SVG texts.
#[must_use]
pub fn all(found: &Accuracy) -> Vec<(String, String)> {
    let mut files: Vec<(String, String)> = found
        .plant
        .iter()
        .map(|diagram| {
            let figure = plant(diagram);
            let name = format!("plant-{}.svg", diagram.problem);
            (name, standalone(&figure.title.clone(), &[figure]))
        })
        .collect();
    let figure = law(found);
    files.push((
        "law.svg".to_owned(),
        standalone(&figure.title.clone(), &[figure]),
    ));
    for law in ["spring", "enhanced-sfa", "shipped"] {
        let points: Vec<&SamplingPoint> = found
            .sampling
            .iter()
            .filter(|point| point.law == law)
            .collect();
        let figures = sampling(law, &points);
        files.push((
            format!("sampling-{law}.svg"),
            standalone(&format!("Sampling, {law}"), &figures),
        ));
    }
    files
}

fn plant(diagram: &Diagram) -> Figure {
    let errors = diagram.points.iter().filter_map(|point| point.error_rad);
    let marks = [COUNT_RAD, FORCE_QUANTUM_N_M / WALL_N_M_PER_RAD, 1e-15];
    let mut x = axis("largest error of the angle, rad", errors.chain(marks));
    // Space at the right edge for methods that diverged.
    x.range.max += 0.5;
    let times = diagram
        .points
        .iter()
        .flat_map(|point| [point.time.lower_quartile_ns, point.time.upper_quartile_ns]);
    let y = axis("time per simulated millisecond, ns", times);
    let edge = x.range.max;
    let mut figure = Figure::new(
        &format!("Plant, {}: what accuracy costs", diagram.problem),
        x,
        y,
    );
    figure.line("kc", "one encoder count", Shape::Vertical(log(COUNT_RAD)));
    let quantum = log(FORCE_QUANTUM_N_M / WALL_N_M_PER_RAD);
    figure.line("rest", "one force step", Shape::Vertical(quantum));
    let floor = diagram.reference_floor_rad;
    figure.line("surf", "reference's floor", Shape::Vertical(log(floor)));
    let mut methods: Vec<&str> = Vec::new();
    for point in &diagram.points {
        if !methods.contains(&point.method) {
            methods.push(point.method);
        }
    }
    let mut diverged = 0;
    for (class, method) in CLASSES.into_iter().zip(methods) {
        let points: Vec<&Point> = diagram
            .points
            .iter()
            .filter(|point| point.method == method)
            .collect();
        let mut curve = Vec::new();
        let (mut spread, mut signs) = (Vec::new(), Vec::new());
        for point in points {
            let time = log(point.time.median_ns);
            let place = point.error_rad.map_or(edge, log);
            if point.error_rad.is_some() {
                curve.push((place, time));
            } else {
                diverged += 1;
            }
            spread.push(vec![
                (place, log(point.time.lower_quartile_ns)),
                (place, log(point.time.upper_quartile_ns)),
            ]);
            let sign = if point.error_rad.is_some() {
                Sign::Dot
            } else {
                Sign::Cross
            };
            signs.push((place, time, sign));
        }
        figure.line(class, method, Shape::Path(vec![curve]));
        figure.line(class, "", Shape::Path(spread));
        figure.line(class, "", Shape::Signs(signs));
    }
    figure.description = format!(
        "{} ms, {} stops and starts; dots are medians, strokes quartiles; {diverged} diverged (× at the right edge); reference known to {floor:.0e} rad.",
        diagram.ticks, diagram.events
    );
    figure
}

fn law(found: &Accuracy) -> Figure {
    let drawn = || found.law.iter().filter(|point| point.time.is_some());
    let errors = drawn().filter_map(|point| point.force_error_n_m);
    let floors = drawn()
        .map(|point| point.force_floor_n_m)
        .filter(|floor| *floor > 0.0);
    let x = axis(
        "largest error of the force, N·m",
        errors.chain(floors).chain([FORCE_QUANTUM_N_M]),
    );
    let y = axis(
        "time per tick, ns",
        drawn()
            .filter_map(|point| point.time)
            .flat_map(|time| [time.least_ns, time.upper_quartile_ns]),
    );
    let mut figure = Figure::new("Law: what a number format costs", x, y);
    figure.line(
        "rest",
        "one force step of fixed32",
        Shape::Vertical(log(FORCE_QUANTUM_N_M)),
    );
    for (class, number) in CLASSES
        .into_iter()
        .zip(["fixed16", "fixed32", "f32", "f64"])
    {
        let signs: Vec<(f64, f64, Sign)> = drawn()
            .filter(|point| point.number == number)
            .filter_map(|point| {
                Some((
                    log(point.force_error_n_m?),
                    log(point.time?.median_ns),
                    Sign::Dot,
                ))
            })
            .collect();
        // A stroke of zero length for the legend.
        let stroke = signs
            .iter()
            .map(|&(x, y, _)| vec![(x, y), (x, y)])
            .collect();
        figure.line(class, number, Shape::Path(stroke));
        figure.line(class, "", Shape::Signs(signs));
    }
    figure.description =
        "A dot is a law; the error is that against the same law in f64, which itself stands at the left edge.".to_owned();
    figure
}

fn sampling(law: &str, points: &[&SamplingPoint]) -> Vec<Figure> {
    type Value = fn(&SamplingPoint) -> Option<f64>;
    let measures: [(&str, Value); 3] = [
        ("error of the stiffness at rest, share", |p| {
            p.stiffness_error.map(f64::abs)
        }),
        ("ripple of the torque, rms, N·m", |p| p.ripple_rms_n_m),
        ("energy out of the wall, worst window, J", |p| {
            p.energy_out_wall_worst_window_j
        }),
    ];
    let mut counts: Vec<u32> = points.iter().map(|point| point.counts_per_rev).collect();
    counts.sort_unstable();
    counts.dedup();
    measures
        .into_iter()
        .map(|(title, value)| {
            let x = axis("control rate, Hz", points.iter().map(|point| f64::from(point.rate_hz)));
            let y = axis(title, points.iter().filter_map(|point| value(point)));
            let mut figure = Figure::new(&format!("{law}: {title}"), x, y);
            for (class, &count) in CLASSES.into_iter().zip(&counts) {
                let (mut curve, mut signs) = (Vec::new(), Vec::new());
                for point in points.iter().filter(|point| point.counts_per_rev == count) {
                    let Some(height) = value(point) else { continue };
                    let place = (log(f64::from(point.rate_hz)), log(height));
                    let sign = match point.verdict {
                        "passive" => Sign::Dot,
                        "active" => Sign::Triangle,
                        "limit-cycle" => Sign::Waves,
                        _ => Sign::Cross,
                    };
                    curve.push(place);
                    signs.push((place.0, place.1, sign));
                }
                figure.line(class, &format!("{count} counts"), Shape::Path(vec![curve]));
                figure.line(class, "", Shape::Signs(signs));
            }
            figure.description = "Dots are passive runs, triangles active ones, waves limit cycles, crosses unstable ones.".to_owned();
            figure
        })
        .collect()
}
