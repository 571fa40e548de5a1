//! The picture at the top of the report in three degrees of freedom: which fraction of the requested stiffness each law displays,
//! and a spring compared with the shipped wall.

use crate::thesis::space::{Approach, Object, Phase, Record};
use std::fmt::Write;
use touchstone_report::figure::{Axis, Figure, Range, Shape, Sign, Wall};
use touchstone_report::quantity::plain;
use touchstone_report::svg::{self, escape};
use touchstone_sim::run::verdict::Verdict;

/// CSS class of the lines for an approach (way to compute the force): that of the same law on the page for one axis, except for
/// the spring-damper, whose colour there is that of the shipped wall here, and the law per axis.
fn class(approach: Approach) -> &'static str {
    match approach {
        Approach::Spring => "law-a",
        Approach::SpringDamper => "law-c",
        Approach::Bounding => "law-d",
        Approach::PerAxis => "law-e",
        Approach::Magnitude => "law-g",
        Approach::Shipped => "law-h",
    }
}

/// The runs to compare: the shipped wall, and the other laws at their highest stiffness.
fn compared(runs: &[Record]) -> Vec<&Record> {
    let stiffness = |run: &Record| run.cell.k_desired_n_per_mm;
    let ships = |run: &Record| run.cell.approach == Approach::Shipped;
    let others = runs.iter().filter(|run| !ships(run));
    let highest = others.map(stiffness).fold(0.0, f64::max);
    let chosen = |run: &&Record| ships(run) || stiffness(run) == highest;
    runs.iter().filter(chosen).collect()
}

/// The figures of the picture; empty if there are no runs to compare.
pub fn figures(runs: &[Record]) -> Vec<Figure> {
    let runs = compared(runs);
    if runs.len() < 2 {
        return Vec::new();
    }
    let mut figures = vec![displayed(&runs)];
    figures.extend(over_each_other(&runs));
    figures
}

/// Figure of the displayed stiffness at rest in percent of the requested stiffness, by object and law.
fn displayed(runs: &[&Record]) -> Figure {
    let range = Range {
        min: -0.5,
        max: Object::ALL.len() as f64 - 0.5,
    };
    let mut x = Axis::new("object", "", range);
    let objects = Object::ALL.iter().enumerate();
    x.marks = Some(
        objects
            .map(|(i, it)| (i as f64, it.name().to_owned()))
            .collect(),
    );
    // The range below zero leaves room for the symbols of walls that do not come to rest, which are drawn at zero.
    let range = Range {
        min: -12.0,
        max: 140.0,
    };
    let mut y = Axis::new("displayed stiffness, % of k_de", "", range);
    let marks = (0..=5).map(|i| 25.0 * f64::from(i));
    y.marks = Some(marks.map(|value| (value, plain(value))).collect());
    let mut figure = Figure::new("Displayed stiffness at rest, by object and approach", x, y);
    figure.line("kde", "k_de", Shape::Horizontal(100.0));
    let width = 0.8 / Approach::ALL.len() as f64;
    let mut near = 0;
    for (column, approach) in Approach::ALL.into_iter().enumerate() {
        let (mut stems, mut signs) = (Vec::new(), Vec::new());
        let its = runs.iter().filter(|run| run.cell.approach == approach);
        for run in its {
            let object = Object::ALL.iter().position(|it| *it == run.cell.object);
            let middle = 0.5 * (Approach::ALL.len() as f64 - 1.0);
            let place = object.unwrap_or(0) as f64 + (column as f64 - middle) * width;
            let hold = run.late(Phase::Hold, 0.25);
            let verdict = run.judged().0;
            let rests = matches!(verdict, Verdict::Passive | Verdict::Active);
            let share = 100.0 * run.displayed_n_per_mm(hold) / run.cell.k_desired_n_per_mm;
            near += usize::from(rests && (share - 100.0).abs() <= 5.0);
            // A wall that does not come to rest has no mean stiffness.
            let height = if rests { share.clamp(0.0, 135.0) } else { 0.0 };
            stems.push(vec![(place, 0.0), (place, height)]);
            let sign = match verdict {
                Verdict::NotJudged | Verdict::NoContact => Sign::Ring,
                _ if rests => Sign::Dot,
                _ => Sign::Waves,
            };
            signs.push((place, height, sign));
        }
        figure.line(class(approach), approach.name(), Shape::Path(stems));
        figure.line(class(approach), "", Shape::Signs(signs));
    }
    figure.description = format!(
        "{near} of {} came to rest within 5 % of the desired stiffness. ● at rest, ≈ never at rest.",
        runs.len()
    );
    figure
}

/// Penetration over time in the inclined plane, which is not parallel to any axis: a spring and the shipped wall under the same
/// hand.
fn over_each_other(runs: &[&Record]) -> Option<Figure> {
    let find = |approach| {
        let mut its = runs.iter().filter(|run| run.cell.approach == approach);
        its.find(|run| run.cell.object == Object::Inclined)
    };
    let (spring, ships) = (find(Approach::Spring)?, find(Approach::Shipped)?);
    let depth = |run: &Record| -> Vec<(f64, f64)> {
        let at = |t: usize| (run.time_s[t], 1e-3 * run.depth_mm(t));
        (0..run.time_s.len()).map(at).collect()
    };
    let deepest = Range::of(depth(ships).iter().map(|p| p.1)).max.max(1e-5);
    let range = Range {
        min: -2.0 * deepest,
        max: 4.0 * deepest,
    };
    let time = Range::of(ships.time_s.iter().copied());
    let mut figure = Figure::new(
        "Depth in the inclined plane",
        Axis::new("time", "s", time),
        Axis::new("depth", "m", range),
    );
    figure.wall = Some(Wall::Above(0.0));
    figure.line("surf", "", Shape::Horizontal(0.0));
    for run in [spring, ships] {
        let stiffness = plain(run.cell.k_desired_n_per_mm);
        let name = format!("{}, {stiffness} N/mm", run.cell.approach.name());
        figure.line(class(run.cell.approach), &name, Shape::Series(depth(run)));
    }
    figure.description =
        "Pressed, held, slid along and released; the inside of the object is shaded.".to_owned();
    Some(figure)
}

/// The section of the page with the picture; empty if there is none.
pub fn section(runs: &[Record]) -> String {
    let figures = figures(runs);
    if figures.is_empty() {
        return String::new();
    }
    let mut part = String::from("<section class=\"picture\" aria-label=\"Summary picture\">\n");
    for (index, figure) in figures.iter().enumerate() {
        let _ = writeln!(
            part,
            "<figure><figcaption><strong>{}</strong><span class=\"note\">{}</span></figcaption>{}{}</figure>",
            escape(&figure.title),
            escape(&figure.description),
            svg::draw(
                figure,
                touchstone_report::PICTURE_SIZE,
                &format!("p{index}")
            ),
            svg::legend(figure)
        );
    }
    part.push_str("</section>\n");
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::space::{Cell, Mechanism, SurfaceFeel, run};

    /// Checks that the shipped wall is in both figures, and displays the requested stiffness where the spring does not come to
    /// rest.
    #[test]
    fn what_ships_is_in_the_picture() {
        let of = |approach| {
            run(&Cell {
                mechanism: Mechanism::Cartesian,
                object: Object::Inclined,
                k_desired_n_per_mm: 25.0,
                approach,
                feel: SurfaceFeel::default(),
            })
            .expect("settings")
        };
        let runs = [of(Approach::Spring), of(Approach::Shipped)];
        let found = figures(&runs);
        let [bars, depth] = &found[..] else {
            panic!("two figures")
        };
        let names = |figure: &Figure| -> Vec<String> {
            let lines = figure.lines.iter().map(|line| line.name.clone());
            lines.filter(|name| !name.is_empty()).collect()
        };
        for approach in ["spring", "shipped"] {
            assert!(names(bars).contains(&approach.to_owned()));
            assert!(svg::legend(bars).contains(approach), "{approach}");
        }
        assert_eq!(names(depth), ["spring, 25 N/mm", "shipped, 25 N/mm"]);
        assert!(
            bars.description.starts_with("1 of 2"),
            "{}",
            bars.description
        );
        assert!(figures(&runs[..1]).is_empty());
    }
}
