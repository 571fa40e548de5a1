//! A small plot writer for inline SVG.
//!
//! Why not a plotting library: the drawing must follow the reader's light or dark theme, so every mark needs a CSS class instead
//! of a colour; strokes and dashes must keep their width when a plot is scaled to a phone or a wide screen; and a page of 160
//! plots must stay small, so coordinates are short integers relative to each other. `plotters` writes fixed colours and one
//! absolute decimal coordinate after another. What is needed here is little: two linear axes, lines, a band.

use std::fmt::Write;

use super::decimate;
use super::quantity::{Scale, scale_for, ticks};

/// Drawing steps to a nominal pixel: lines are written in whole steps.
pub const FINE: f64 = 10.0;

/// Nominal size of a plot with its labels, px. It is scaled to the width that the page has.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Width.
    pub width: u32,
    /// Height.
    pub height: u32,
}

/// Margins around the plot's area, px: room for tick labels and axis titles.
const LEFT: u32 = 40;
const RIGHT: u32 = 10;
const TOP: u32 = 20;
const BOTTOM: u32 = 35;

/// A line of more points than this is drawn with a finer stroke.
const DENSE: usize = 700;

/// One linear axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Title without the unit.
    title: String,
    /// Unit with prefix.
    scale: Scale,
    /// Ends in the SI unit.
    min: f64,
    max: f64,
}

impl Axis {
    /// An axis over `range` (SI); the prefix of `unit` is chosen for its larger end.
    pub fn new(title: &str, unit: &str, range: Range) -> Self {
        let range = range.or_unit();
        let scale = scale_for(range.min.abs().max(range.max.abs()), unit);
        Axis {
            title: title.to_owned(),
            scale,
            min: range.min,
            max: range.max,
        }
    }

    /// Where `value` (SI) lies, 0 at the lower end, 1 at the upper.
    fn place(&self, value: f64) -> f64 {
        (value - self.min) / (self.max - self.min)
    }

    fn ticks(&self, wanted: usize) -> Vec<(f64, String)> {
        let factor = self.scale.factor;
        let marks = ticks(self.min / factor, self.max / factor, wanted);
        marks
            .into_iter()
            .map(|(value, label)| (self.place(value * factor), label))
            .collect()
    }

    /// Ends in the shown unit, and the unit, for the read-out script.
    fn attributes(&self, name: char) -> String {
        let (min, max) = (self.min / self.scale.factor, self.max / self.scale.factor);
        format!(r#"data-{name}="{min:.6} {max:.6} {}""#, self.scale.unit)
    }
}

/// An interval that grows by what it is shown. Empty until the first finite value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
}

impl Range {
    /// Nothing yet.
    pub const EMPTY: Range = Range {
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
    };

    /// The smallest interval with all finite `values`.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        values.into_iter().fold(Range::EMPTY, Range::with)
    }

    /// Also with `value`, if it is finite.
    pub fn with(self, value: f64) -> Self {
        if value.is_finite() {
            Range {
                min: self.min.min(value),
                max: self.max.max(value),
            }
        } else {
            self
        }
    }

    /// Both.
    pub fn union(self, other: Range) -> Self {
        Range {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The part inside `limits`; `limits` is not empty.
    pub fn within(self, limits: Range) -> Self {
        Range {
            min: self.min.max(limits.min),
            max: self.max.min(limits.max),
        }
    }

    /// Wider by these shares of its width.
    pub fn padded(self, below: f64, above: f64) -> Self {
        let width = self.max - self.min;
        Range {
            min: self.min - below * width,
            max: self.max + above * width,
        }
    }

    /// Itself, or something that can be drawn if it is empty or a single value.
    fn or_unit(self) -> Self {
        if self.min < self.max && (self.max - self.min).is_finite() {
            // Narrower than an f64 can divide, ticks and places would be NaN.
            let least = self.min.abs().max(self.max.abs()) * 1e-9;
            if self.max - self.min > least {
                self
            } else {
                Range {
                    min: self.min - least,
                    max: self.max + least,
                }
            }
        } else if self.min == self.max {
            let half = if self.min == 0.0 {
                1.0
            } else {
                self.min.abs() * 0.1
            };
            Range {
                min: self.min - half,
                max: self.max + half,
            }
        } else {
            Range { min: 0.0, max: 1.0 }
        }
    }
}

/// A plot under construction.
pub struct Plot {
    size: Size,
    x: Axis,
    y: Axis,
    /// What is behind the grid, then what is before it.
    behind: String,
    marks: String,
}

impl Plot {
    /// An empty plot.
    pub fn new(size: Size, x: Axis, y: Axis) -> Self {
        Plot {
            size,
            x,
            y,
            behind: String::new(),
            marks: String::new(),
        }
    }

    fn area(&self) -> (f64, f64) {
        (
            f64::from(self.size.width - LEFT - RIGHT),
            f64::from(self.size.height - TOP - BOTTOM),
        )
    }

    /// A place in fine steps. What lies far outside is brought nearer, so that numbers stay short; it is clipped anyway.
    fn fine(&self, x: f64, y: f64) -> (f64, f64) {
        let (width, height) = self.area();
        let near = |place: f64| place.clamp(-30.0, 30.0);
        (
            near(self.x.place(x)) * width * FINE,
            (1.0 - near(self.y.place(y))) * height * FINE,
        )
    }

    /// Shades everything from `x` (SI) to the upper end of the axis.
    pub fn shade_from_x(&mut self, x: f64, class: &str) {
        let (width, height) = self.area();
        let left = self.fine(x, 0.0).0.clamp(0.0, width * FINE);
        let wide = width * FINE - left;
        let tall = height * FINE;
        let _ = write!(
            self.behind,
            r#"<rect class="{class}" x="{left:.0}" width="{wide:.0}" height="{tall:.0}"/>"#
        );
    }

    /// Shades everything from `y` (SI) to the upper end of the axis.
    pub fn shade_from_y(&mut self, y: f64, class: &str) {
        let (width, height) = self.area();
        let (wide, tall) = (width * FINE, self.fine(0.0, y).1.clamp(0.0, height * FINE));
        let _ = write!(
            self.behind,
            r#"<rect class="{class}" width="{wide:.0}" height="{tall:.0}"/>"#
        );
    }

    /// A straight line between two places (SI).
    pub fn line(&mut self, class: &str, name: &str, from: (f64, f64), to: (f64, f64)) {
        let (from, to) = (self.fine(from.0, from.1), self.fine(to.0, to.1));
        self.write_path(class, name, &decimate::path(vec![vec![from, to]]));
    }

    /// A horizontal line across the plot.
    pub fn horizontal(&mut self, class: &str, name: &str, y: f64) {
        self.line(class, name, (self.x.min, y), (self.x.max, y));
    }

    /// A vertical line across the plot.
    pub fn vertical(&mut self, class: &str, name: &str, x: f64) {
        self.line(class, name, (x, self.y.min), (x, self.y.max));
    }

    /// A time series (SI); NaN makes a gap.
    pub fn series(&mut self, class: &str, name: &str, points: impl Iterator<Item = (f64, f64)>) {
        let lines = decimate::series(points.map(|(x, y)| {
            if y.is_finite() {
                self.fine(x, y)
            } else {
                (x, f64::NAN)
            }
        }));
        self.write_path(class, name, &lines);
    }

    /// A path that may turn back, in stretches (SI).
    pub fn path(&mut self, class: &str, name: &str, stretches: &[Vec<(f64, f64)>]) {
        let fine = stretches
            .iter()
            .map(|s| s.iter().map(|&(x, y)| self.fine(x, y)).collect())
            .collect();
        self.write_path(class, name, &decimate::path(fine));
    }

    fn write_path(&mut self, class: &str, name: &str, stretches: &[Vec<decimate::Point>]) {
        if stretches.is_empty() {
            return;
        }
        let out = &mut self.marks;
        // An oscillation that fills an area is drawn finer, or its strokes run together.
        let dense = stretches.iter().map(Vec::len).sum::<usize>() > DENSE;
        let dense = if dense { " data-dense" } else { "" };
        let _ = write!(out, r#"<path class="{class}" data-n="{name}"{dense} d=""#);
        for stretch in stretches {
            let mut pen = stretch[0];
            let _ = write!(out, "M{} {}", pen.0, pen.1);
            if stretch.len() == 1 {
                // A lone sample: a line of no length shows as a dot under round caps.
                out.push_str("h0");
            }
            for (index, point) in stretch[1..].iter().enumerate() {
                out.push(if index == 0 { 'l' } else { ' ' });
                let (dx, dy) = (point.0 - pen.0, point.1 - pen.1);
                // A minus sign separates numbers as well as a blank does.
                let _ = if dy < 0 {
                    write!(out, "{dx}{dy}")
                } else {
                    write!(out, "{dx} {dy}")
                };
                pen = *point;
            }
        }
        out.push_str("\"/>");
    }

    /// The finished `<svg>`. `id` is unique in the page, `title` and `description` are read out instead of the drawing.
    pub fn finish(self, out: &mut String, id: &str, title: &str, description: &str) {
        let Size { width, height } = self.size;
        let (wide, tall) = self.area();
        let (right, bottom) = (f64::from(LEFT) + wide, f64::from(TOP) + tall);
        let _ = write!(
            out,
            r#"<svg class="plot" viewBox="0 0 {width} {height}" role="img" aria-labelledby="{id}-t {id}-d" {} {}><title id="{id}-t">{}</title><desc id="{id}-d">{}</desc>"#,
            self.x.attributes('x'),
            self.y.attributes('y'),
            escape(title),
            escape(description),
        );
        let inner = |out: &mut String, content: &str| {
            let _ = write!(
                out,
                r#"<svg x="{LEFT}" y="{TOP}" width="{wide}" height="{tall}" viewBox="0 0 {:.0} {:.0}" preserveAspectRatio="none">{content}</svg>"#,
                wide * FINE,
                tall * FINE
            );
        };
        inner(out, &self.behind);
        let (mut grid, mut labels) = (String::new(), String::new());
        for (place, label) in self.x.ticks((wide / 48.0) as usize) {
            let x = f64::from(LEFT) + place * wide;
            let _ = write!(grid, "M{x:.1} {TOP}V{bottom}");
            // A label at the very end of the axis stays inside the drawing.
            let x = x.min(f64::from(width) - 3.2 * label.chars().count() as f64);
            let _ = write!(
                labels,
                r#"<text x="{x:.1}" y="{:.1}" class="tx">{label}</text>"#,
                bottom + 14.5
            );
        }
        for (place, label) in self.y.ticks((tall / 34.0) as usize) {
            let y = f64::from(TOP) + (1.0 - place) * tall;
            let _ = write!(grid, "M{LEFT} {y:.1}H{right}");
            let _ = write!(
                labels,
                r#"<text x="{}" y="{:.1}" class="ty">{label}</text>"#,
                LEFT - 6,
                y + 3.6
            );
        }
        let _ = write!(out, r#"<path class="grid" d="{grid}"/>"#);
        inner(out, &self.marks);
        let _ = write!(
            out,
            r#"<path class="axis" d="M{LEFT} {TOP}V{bottom}H{right}"/>{labels}<text x="2" y="11" class="at">{} ({})</text><text x="{right}" y="{}" class="at te">{} ({})</text></svg>"#,
            escape(&self.y.title),
            self.y.scale.unit,
            height - 5,
            escape(&self.x.title),
            self.x.scale.unit,
        );
    }
}

/// Text made safe for HTML and SVG, in content and in attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size {
        width: 250,
        height: 155,
    };

    fn plot(y: Range) -> Plot {
        let time = Axis::new("time", "s", Range { min: 0.0, max: 2.0 });
        Plot::new(SIZE, time, Axis::new("force", "N·m", y))
    }

    #[test]
    fn lines_are_short_relative_integers() {
        let mut plot = plot(Range { min: 0.0, max: 0.1 });
        plot.series(
            "l",
            "force",
            [(0.0, 0.0), (1.0, 0.1), (2.0, 0.05)].into_iter(),
        );
        let mut out = String::new();
        plot.finish(&mut out, "p", "a < b", "d");
        assert!(out.contains(r#"d="M0 1000l1000-1000 1000 500""#), "{out}");
        assert!(out.contains("<title id=\"p-t\">a &lt; b</title>"), "{out}");
        assert!(
            out.contains("force (mN·m)") && out.contains("time (s)"),
            "{out}"
        );
        assert!(
            out.contains(r#"data-y="0.000000 100.000000 mN·m""#),
            "{out}"
        );
        assert_eq!(out.matches("<svg").count(), out.matches("</svg>").count());
    }

    #[test]
    fn odd_ranges_draw_without_nan() {
        let same = Range::of([0.3, 0.3]);
        let hair = Range {
            min: 0.5,
            max: 0.5 + 1e-15,
        };
        for range in [
            Range::EMPTY,
            same,
            Range::of([0.0]),
            Range::of([f64::NAN]),
            hair,
        ] {
            let mut plot = plot(range);
            plot.series(
                "l",
                "n",
                [(0.0, 1e300), (1.0, f64::NAN), (2.0, f64::NEG_INFINITY)].into_iter(),
            );
            plot.horizontal("h", "n", 0.0);
            let mut out = String::new();
            plot.finish(&mut out, "p", "t", "d");
            assert!(
                !out.contains("NaN") && !out.contains("inf"),
                "{range:?}: {out}"
            );
        }
    }
}
