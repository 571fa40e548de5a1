//! Draws figures like those of §5.2 of the thesis: displayed stiffness, trajectory and force over time, per coordinate.

use super::record::{Record, dot};
use super::{Approach, Object, Phase};
use touchstone_report::figure::{Axis, Figure, Range, Shape};

/// CSS classes of the lines for the three coordinates.
const ROLES: [&str; 3] = ["law-a", "law-d", "law-g"];
const AXES: [&str; 3] = ["x1", "x2", "x3"];

/// Number of the thesis' figure for the same object and approach (way to compute the force); `not in the thesis` for the shipped
/// wall.
#[must_use]
pub fn reference(object: Object, approach: Approach) -> &'static str {
    match (object, approach) {
        (_, Approach::Shipped) => "not in the thesis",
        (Object::Horizontal, Approach::Spring | Approach::SpringDamper | Approach::Bounding) => {
            "Fig. 5.9"
        }
        (Object::Horizontal, _) => "Fig. 5.10",
        (Object::Inclined, _) => "Fig. 5.11",
        (Object::Sphere, Approach::PerAxis) => "Figs. 5.12 and 5.13",
        (Object::Sphere, _) => "Fig. 5.12",
    }
}

/// All figures of a run in three degrees of freedom.
#[must_use]
pub fn of(run: &Record) -> Vec<Figure> {
    vec![stiffness(run), forces(run), trajectory(run), view(run)]
}

fn title(run: &Record, what: &str) -> String {
    let cell = &run.cell;
    format!(
        "{}, {}, {} N/mm: {what}",
        cell.object.name(),
        cell.approach.name(),
        cell.k_desired_n_per_mm
    )
}

fn over_time(
    run: &Record,
    what: &str,
    axis: &str,
    unit: &str,
    lines: [Vec<(f64, f64)>; 3],
) -> Figure {
    let time = Axis::new("time", "s", Range::of(run.time_s.iter().copied()));
    let values = lines.iter().flatten().map(|point| point.1);
    let mut figure = Figure::new(
        &title(run, what),
        time,
        Axis::new(axis, unit, Range::of(values).padded(0.05, 0.05)),
    );
    for ((role, name), points) in ROLES.into_iter().zip(AXES).zip(lines) {
        figure.line(role, name, Shape::Series(points));
    }
    figure
}

fn per_axis(run: &Record, of: impl Fn(usize, usize) -> f64) -> [Vec<(f64, f64)>; 3] {
    std::array::from_fn(|i| {
        let value = |t: usize| (run.time_s[t], of(t, i));
        (0..run.time_s.len()).map(value).collect()
    })
}

/// Force over penetration per coordinate; the line has gaps where there is no contact.
fn stiffness(run: &Record) -> Figure {
    let most = 2.0 * run.cell.k_desired_n_per_mm;
    let lines = per_axis(run, |t, i| {
        let n = run.normal(t)[i];
        let deep = run.depth_mm(t) * n;
        let shown = run.force_n[t][i] / deep;
        if run.depth_mm(t) > 0.02 && n.abs() > 0.05 && shown.abs() <= most {
            shown * 1e3
        } else {
            f64::NAN
        }
    });
    let mut figure = over_time(
        run,
        "displayed stiffness",
        "displayed stiffness",
        "N/m",
        lines,
    );
    figure.line(
        "kde",
        "desired",
        Shape::Horizontal(run.cell.k_desired_n_per_mm * 1e3),
    );
    let hold = run.late(Phase::Hold, 0.25);
    figure.description = format!(
        "{:.2} N/mm at rest, {:.2} N/mm while sliding, of {} N/mm.",
        run.displayed_n_per_mm(hold),
        run.displayed_n_per_mm(run.late(Phase::Slide, 0.9)),
        run.cell.k_desired_n_per_mm
    );
    figure
}

fn forces(run: &Record) -> Figure {
    let lines = per_axis(run, |t, i| run.force_n[t][i]);
    let mut figure = over_time(run, "force", "force", "N", lines);
    let slide = run.late(Phase::Slide, 0.95);
    figure.description = format!(
        "Of the force, at most {:.3} of the part out of the surface is along it while sliding; its largest step in a tick is {:.3}.",
        run.most_tangential(slide.clone()),
        run.largest_jump(slide)
    );
    figure
}

fn trajectory(run: &Record) -> Figure {
    let lines = per_axis(run, |t, i| run.hip_mm[t][i] * 1e-3);
    let mut figure = over_time(run, "HIP over time", "position", "m", lines);
    figure.description = format!(
        "Probed, held, slid along it and let go; ripple in the hold {:.4} mm.",
        run.ripple_mm(run.late(Phase::Hold, 0.5))
    );
    figure
}

/// Trajectory and forces in space, seen along the direction (1, -2, 1).
fn view(run: &Record) -> Figure {
    let (right, up) = (
        [2.0 / 5.0_f64.sqrt(), 1.0 / 5.0_f64.sqrt(), 0.0],
        [
            -1.0 / 30.0_f64.sqrt(),
            2.0 / 30.0_f64.sqrt(),
            5.0 / 30.0_f64.sqrt(),
        ],
    );
    let seen = |p: [f64; 3]| (dot(p, right) * 1e-3, dot(p, up) * 1e-3);
    let path: Vec<(f64, f64)> = run.hip_mm.iter().map(|p| seen(*p)).collect();
    // A newton is drawn as two millimetres.
    let arrows: Vec<Vec<(f64, f64)>> = (0..run.hip_mm.len())
        .step_by(50)
        .filter(|t| run.normal_force_n(*t) > 0.1)
        .map(|t| {
            let tip = std::array::from_fn(|i| run.hip_mm[t][i] + 2.0 * run.force_n[t][i]);
            vec![seen(run.hip_mm[t]), seen(tip)]
        })
        .collect();
    let outline = outline(run.cell.object, &seen);
    let all = || {
        let shown = arrows.iter().chain(&outline).flatten();
        path.iter().chain(shown)
    };
    let x = Range::of(all().map(|p| p.0)).padded(0.05, 0.05);
    let y = Range::of(all().map(|p| p.1)).padded(0.05, 0.05);
    let mut figure = Figure::new(
        &title(run, "in space"),
        Axis::new("to the right", "m", x),
        Axis::new("upwards", "m", y),
    );
    figure.line("surf", "object", Shape::Path(outline));
    figure.line("law-a", "force, 2 mm a newton", Shape::Path(arrows));
    figure.line("law-g", "HIP", Shape::Path(vec![path]));
    figure.description = "Seen along (1, -2, 1).".to_owned();
    figure
}

/// Lines on the object's surface, projected to the picture plane by `seen`.
fn outline(object: Object, seen: &impl Fn([f64; 3]) -> (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let normal = object.normal();
    match object {
        Object::Horizontal | Object::Inclined => {
            // Two directions across the normal.
            let u = [normal[2], 0.0, -normal[0]];
            let v = [
                normal[1] * u[2] - normal[2] * u[1],
                normal[2] * u[0] - normal[0] * u[2],
                normal[0] * u[1] - normal[1] * u[0],
            ];
            let at = |a: f64, b: f64| seen(std::array::from_fn(|i| a * u[i] + b * v[i]));
            let mut lines = Vec::new();
            for i in -2..=2 {
                let c = 40.0 * f64::from(i);
                lines.push(vec![at(-80.0, c), at(80.0, c)]);
                lines.push(vec![at(c, -80.0), at(c, 80.0)]);
            }
            lines
        }
        Object::Sphere => {
            let circle = |of: &dyn Fn(f64, f64) -> [f64; 3]| -> Vec<(f64, f64)> {
                (0..=72)
                    .map(|i| {
                        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 72.0).sin_cos();
                        seen(of(cos, sin).map(|x| super::RADIUS_MM * x))
                    })
                    .collect()
            };
            vec![
                circle(&|c, s| [c, s, 0.0]),
                circle(&|c, s| [c, 0.0, s]),
                circle(&|c, s| [0.0, c, s]),
            ]
        }
    }
}
