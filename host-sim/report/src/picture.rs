//! The picture at the top of a report: which fraction of the requested stiffness each law displays, and two runs drawn over each
//! other.

use std::fmt::Write;

use super::ReportInput;
use super::figure::{Axis, Figure, Line, Range, Shape, Wall};
use super::figures::Kind;
use super::label;
use super::matrix::{Column, Matrix, matrices};
use super::quantity::{plain, with_unit};
use super::svg::{self, Size, escape};
use super::view::View;
use touchstone_control::LawKind;
use touchstone_sim::run::record::{Run, Verdict};

/// Size of each figure in the picture, pixels.
pub const SIZE: Size = Size {
    width: 560,
    height: 300,
};

/// Whether the report has such a picture.
pub fn has(input: &ReportInput) -> bool {
    !figures(input).is_empty()
}

/// The one or two figures of the picture.
pub fn figures(input: &ReportInput) -> Vec<Figure> {
    if let [run] = input.runs {
        return View::new(run, input.k_critical).map_or(Vec::new(), |view| {
            let ranges = view.ranges();
            [Kind::PositionForce, Kind::Trajectory]
                .map(|kind| view.figure(kind, &ranges, true))
                .into()
        });
    }
    let tables = matrices(input.runs);
    let Some(leading) = tables.first() else {
        return Vec::new();
    };
    let mut figures = Vec::new();
    figures.extend(shown(input.runs, leading));
    figures.extend(over_each_other(input, leading));
    figures
}

/// CSS class of the lines for a column of the table of runs.
fn column_class(column: Column) -> &'static str {
    if column.is_named() {
        "law-h"
    } else {
        law_class(column.law)
    }
}

/// CSS class of the lines for a control law.
pub fn law_class(law: LawKind) -> &'static str {
    match law {
        LawKind::Spring => "law-a",
        LawKind::SpringDamper => "law-b",
        LawKind::Tdpa => "law-c",
        LawKind::Fba => "law-d",
        LawKind::Sfa => "law-e",
        LawKind::SfaContinuous => "law-f",
        LawKind::EnhancedSfa => "law-g",
    }
}

/// Figure of the displayed stiffness in percent of the requested stiffness, for each law at each requested stiffness.
fn shown(runs: &[Run], table: &Matrix) -> Option<Figure> {
    let share = |index: usize| {
        let s = &runs[index].summary;
        s.k_displayed.map(|k| 100.0 * k / s.k_desired)
    };
    let all: Vec<usize> = table.cells.iter().flatten().flatten().copied().collect();
    if !all.iter().any(|&index| share(index).is_some()) {
        return None;
    }
    let top = Range::of(all.iter().filter_map(|&index| share(index))).with(100.0);
    let columns = table.stiffnesses.len();
    let range = Range {
        min: -0.5,
        max: columns as f64 - 0.5,
    };
    let mut x = Axis::new("desired stiffness k_de, N·m/rad", "", range);
    let mark = |(index, k): (usize, &f64)| (index as f64, plain(*k));
    x.marks = Some(table.stiffnesses.iter().enumerate().map(mark).collect());
    // The range below zero leaves room for the symbols of walls without a displayed stiffness, which are drawn at zero.
    let range = Range {
        min: -12.0,
        max: (1.1 * top.max).min(250.0),
    };
    let mut y = Axis::new("displayed stiffness, % of k_de", "", range);
    let step = if range.max > 130.0 { 50.0 } else { 25.0 };
    let marks = (0..=(range.max / step) as u32).map(|i| f64::from(i) * step);
    y.marks = Some(marks.map(|value| (value, plain(value))).collect());
    let mut figure = Figure::new("Displayed stiffness, by law and desired stiffness", x, y);
    figure.line("kde", "k_de", Shape::Horizontal(100.0));
    let width = 0.7 / table.laws.len().max(1) as f64;
    for (column, law) in table.laws.iter().enumerate() {
        let place = |row: usize| {
            row as f64 + (column as f64 - 0.5 * (table.laws.len() as f64 - 1.0)) * width
        };
        let mut stems = Vec::new();
        let mut signs = Vec::new();
        for (row, cells) in table.cells.iter().enumerate() {
            for &index in &cells[column] {
                let height = share(index).unwrap_or(0.0);
                stems.push(vec![(place(row), 0.0), (place(row), height)]);
                let sign = label::verdict_words(runs[index].summary.verdict).mark;
                signs.push((place(row), height, sign));
            }
        }
        stems.retain(|stem| stem[1].1 != 0.0);
        let class = column_class(*law);
        figure.line(class, law.name(), Shape::Path(stems));
        figure.line(class, "", Shape::Signs(signs));
    }
    let held = |v: Verdict| v < Verdict::LimitCycle;
    let near = |&&index: &&usize| {
        held(runs[index].summary.verdict) && share(index).is_some_and(|s| (s - 100.0).abs() <= 5.0)
    };
    figure.description = format!(
        "{} of {} runs came to rest within 5 % of the desired stiffness.{}",
        all.iter().filter(near).count(),
        all.len(),
        signs(runs, &all)
    );
    Some(figure)
}

/// Explains the verdict symbols that occur among the runs `members`.
fn signs(runs: &[Run], members: &[usize]) -> String {
    let mut verdicts: Vec<Verdict> = members.iter().map(|&i| runs[i].summary.verdict).collect();
    verdicts.sort();
    verdicts.dedup();
    let name = |verdict: &Verdict| {
        let words = label::verdict_words(*verdict);
        let sign = if words.sign == "✓" {
            "●"
        } else {
            words.sign
        };
        format!("{sign} {}", words.name)
    };
    let names: Vec<String> = verdicts.iter().map(name).collect();
    format!(" {}.", names.join(", "))
}

/// Chooses two runs of a table to draw over each other, at the highest stiffness at which more than one run has a trace. Returns
/// the indices of the worst and the best run; `None` without such a stiffness.
pub fn pair(runs: &[Run], table: &Matrix) -> Option<(usize, usize)> {
    let traced = |row: usize| -> Vec<usize> {
        let members = table.row(row);
        members.filter(|&i| runs[i].trace.is_some()).collect()
    };
    let rows = (0..table.stiffnesses.len()).rev().map(traced);
    let members = rows.into_iter().find(|members| members.len() > 1)?;
    let off = |i: usize| {
        let s = &runs[i].summary;
        s.k_displayed
            .map_or(f64::INFINITY, |k| (k / s.k_desired - 1.0).abs())
    };
    // Of the laws that display the requested stiffness, the one with the best verdict.
    let rank = |i: usize| (off(i) > 0.05, runs[i].summary.verdict);
    let best = members
        .iter()
        .copied()
        .min_by(|&a, &b| rank(a).cmp(&rank(b)).then(off(a).total_cmp(&off(b))))?;
    let worst = members
        .iter()
        .copied()
        .filter(|&i| i != best)
        .max_by_key(|&i| (runs[i].summary.verdict, std::cmp::Reverse(i)))?;
    Some((worst, best))
}

fn over_each_other(input: &ReportInput, table: &Matrix) -> Option<Figure> {
    let (worst, best) = pair(input.runs, table)?;
    let view = View::new(&input.runs[best], input.k_critical)?;
    let other = View::new(&input.runs[worst], input.k_critical)?;
    let ranges = view.ranges();
    let whole = other.ranges().angle.union(ranges.angle);
    // The axes are those of the better run. The other run may leave them; the description says so.
    let wide = ranges.angle.padded(0.6, 0.6);
    let angle = whole.within(wide);
    let words = |run: &Run| {
        let s = &run.summary;
        let stiffness = s
            .k_displayed
            .map(|k| format!(", {}", with_unit(k, "N·m/rad", 3)))
            .unwrap_or_default();
        format!(
            "{} ({}{stiffness})",
            label::run_name(s),
            label::verdict(s.verdict)
        )
    };
    let mut figure = Figure::new(
        &format!(
            "The device at the wall, k_de = {} N·m/rad",
            plain(input.runs[best].summary.k_desired)
        ),
        Axis::new("time", "s", ranges.time),
        Axis::new("angle", "rad", angle),
    );
    if !view.contact.is_empty() {
        figure.wall = Some(Wall::Above(view.surface()));
        figure.line("surf", "", Shape::Horizontal(view.surface()));
    }
    for view in [&other, &view] {
        let trace = view.trace;
        let points = trace
            .time_s
            .iter()
            .copied()
            .zip(trace.angle_rad.iter().copied());
        figure.line(
            column_class(Column::of(&view.run.summary)),
            &words(view.run),
            Shape::Series(points.collect()),
        );
    }
    let beyond = |x: &f64| !(angle.min..=angle.max).contains(x);
    let leaves = if other.trace.angle_rad.iter().any(beyond) {
        format!(
            " {} leaves the figure.",
            label::run_name(&other.run.summary)
        )
    } else {
        String::new()
    };
    figure.description = format!(
        "{} and {}; the inside of the wall is shaded.{leaves}",
        words(other.run),
        words(view.run)
    );
    Some(figure)
}

/// The picture as a separate SVG file that follows the reader's light or dark theme.
pub fn alone(input: &ReportInput) -> Option<String> {
    let figures = figures(input);
    (!figures.is_empty()).then(|| standalone(input.title, &figures))
}

/// Figures side by side as a separate SVG file that follows the reader's light or dark theme.
pub fn standalone(title: &str, figures: &[Figure]) -> String {
    drawn(title, figures, SIZE)
}

/// Figures side by side as a separate SVG file, each with the given size. The file follows the reader's light or dark theme.
pub fn drawn(title: &str, figures: &[Figure], size: Size) -> String {
    let css = crate::PAGE_STYLE;
    let variables = css.split("* {").next().unwrap_or_default();
    let plots = css.split("/* plots */").nth(1).unwrap_or_default();
    let (gap, head) = (24, 34);
    let rows = figures.iter().map(|figure| legend(figure, size).1).max();
    let foot = 24 + 16 * rows.unwrap_or(1);
    let count = figures.len() as u32;
    let width = count * size.width + (count + 1) * gap;
    let height = head + size.height + foot + gap;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n\
         <title>{}</title>\n<style>\n{variables}{plots}text {{ font-family: system-ui, sans-serif; fill: var(--text); font-size: 10.5px; }}\n\
         .ground {{ fill: var(--page); }} .head {{ font-size: 14px; font-weight: 600; }}\n</style>\n\
         <rect class=\"ground\" width=\"{width}\" height=\"{height}\"/>\n",
        escape(title)
    );
    for (index, figure) in figures.iter().enumerate() {
        let left = gap + index as u32 * (size.width + gap);
        let drawing = svg::draw(figure, size, &format!("s{index}"));
        let place = format!(
            "<svg x=\"{left}\" y=\"{head}\" width=\"{}\" height=\"{}\" ",
            size.width, size.height
        );
        let _ = write!(
            out,
            "<text class=\"head\" x=\"{left}\" y=\"24\">{}</text>\n{}\n<g class=\"plot\">",
            escape(&figure.title),
            drawing.replacen("<svg ", &place, 1)
        );
        let (entries, rows) = legend(figure, size);
        let y = head + size.height + 14;
        for (line, x, row) in entries {
            let (x, y) = (left + x, y + 16 * row);
            let sample = match line.shape {
                Shape::Tiles(_) => format!("M{x} {}h20v9h-20z", y - 8),
                Shape::Signs(_) => {
                    format!("M{} {}m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z", x + 10, y - 4)
                }
                _ => format!("M{x} {}h20", y - 4),
            };
            let _ = write!(
                out,
                "<path class=\"{}\" d=\"{sample}\"/><text x=\"{}\" y=\"{y}\">{}</text>",
                line.role,
                x + 25,
                escape(&line.name)
            );
        }
        let _ = writeln!(
            out,
            "</g><text x=\"{left}\" y=\"{}\">{}</text>",
            y + 6 + 16 * rows,
            escape(&figure.description)
        );
    }
    out.push_str("</svg>\n");
    out
}

/// Layout of the legend: the lines of a figure that have a name, each with its distance from the figure's left edge and its row.
/// Also the number of rows.
fn legend(figure: &Figure, size: Size) -> (Vec<(&Line, u32, u32)>, u32) {
    let (mut x, mut row) = (40, 0);
    let mut entries = Vec::new();
    for line in figure.lines.iter().filter(|line| !line.name.is_empty()) {
        let wide = 40 + 6 * line.name.chars().count() as u32;
        if x > 40 && x + wide > size.width {
            (x, row) = (40, row + 1);
        }
        entries.push((line, x, row));
        x += wide;
    }
    (entries, row + 1)
}
