//! Draws a [`Figure`] as inline SVG.
//!
//! A plotting library such as `plotters` does not fit. The drawing must follow the reader's light or dark theme, so every mark
//! needs a CSS class instead of a fixed colour. Strokes and dashes must keep their width when a plot is scaled to a phone or a wide
//! screen. A page of 160 plots must stay small, so coordinates are short relative integers. Only two linear axes, lines and a band
//! are needed.

use std::fmt::Write;

use super::decimate;
use super::figure::{Axis, Figure, Line, Shape, Sign, Wall};
use super::quantity::{Scale, scale_for, ticks};

/// Fine drawing steps per nominal pixel; coordinates of lines are whole steps.
pub const FINE: f64 = 10.0;

/// Nominal size of a plot with its labels, pixels. The page scales it to the available width.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Width of the plot, pixels.
    pub width: u32,
    /// Height of the plot, pixels.
    pub height: u32,
}

/// Margins around the plot area for tick labels and axis titles, pixels.
const LEFT: u32 = 40;
const RIGHT: u32 = 10;
const TOP: u32 = 20;
const BOTTOM: u32 = 35;

/// Number of points above which a line is drawn with a thinner stroke.
const DENSE: usize = 700;

/// Draws `figure` as an `<svg>` element. `id` must be unique in the page; screen readers read title and description.
pub fn draw(figure: &Figure, size: Size, id: &str) -> String {
    let mut plot = Plot {
        size,
        figure,
        x: scale_of(&figure.x),
        y: scale_of(&figure.y),
        marks: String::new(),
    };
    for line in &figure.lines {
        plot.line(line);
    }
    plot.finish(id)
}

/// Legend of the figure's lines that have a name.
pub fn legend(figure: &Figure) -> String {
    let mut out = String::from("<ul class=\"legend\">");
    let drawn = |line: &&Line| !line.name.is_empty() && !is_empty(&line.shape);
    for Line { role, name, .. } in figure.lines.iter().filter(drawn) {
        let _ = write!(
            out,
            "<li><svg viewBox=\"0 0 26 8\" aria-hidden=\"true\"><path class=\"{role}\" d=\"M1 4H25\"/></svg>{}</li>",
            typeset(name)
        );
    }
    out + "</ul>"
}

fn is_empty(shape: &Shape) -> bool {
    match shape {
        Shape::Series(points) => points.is_empty(),
        Shape::Path(stretches) => stretches.is_empty(),
        Shape::Signs(signs) => signs.is_empty(),
        Shape::Tiles(tiles) => tiles.is_empty(),
        Shape::Horizontal(_) | Shape::Vertical(_) => false,
    }
}

fn scale_of(axis: &Axis) -> Scale {
    if axis.marks.is_some() {
        return scale_for(1.0, &axis.unit);
    }
    scale_for(axis.range.min.abs().max(axis.range.max.abs()), &axis.unit)
}

/// Marks of an axis: relative positions from 0 to 1, and labels.
fn marks(axis: &Axis, scale: &Scale, wanted: usize) -> Vec<(f64, String)> {
    if let Some(marks) = &axis.marks {
        let place = |(value, label): &(f64, String)| (axis.place(*value), escape(label));
        return marks.iter().map(place).collect();
    }
    let factor = scale.factor;
    ticks(axis.range.min / factor, axis.range.max / factor, wanted)
        .into_iter()
        .map(|(value, label)| (axis.place(value * factor), label))
        .collect()
}

/// Title of an axis with its unit.
fn axis_title(axis: &Axis, scale: &Scale) -> String {
    if scale.unit.is_empty() {
        escape(&axis.title)
    } else {
        format!("{} ({})", escape(&axis.title), scale.unit)
    }
}

/// HTML attributes with the ends of the axis in the displayed unit, and with the unit. The page's script uses them to read out
/// values.
fn attributes(axis: &Axis, scale: &Scale, name: char) -> String {
    let (min, max) = (axis.range.min / scale.factor, axis.range.max / scale.factor);
    format!(r#"data-{name}="{min:.6} {max:.6} {}""#, scale.unit)
}

/// A figure while it is drawn as SVG.
struct Plot<'a> {
    size: Size,
    figure: &'a Figure,
    x: Scale,
    y: Scale,
    marks: String,
}

impl Plot<'_> {
    fn area(&self) -> (f64, f64) {
        (
            f64::from(self.size.width - LEFT - RIGHT),
            f64::from(self.size.height - TOP - BOTTOM),
        )
    }

    /// Position of a point in fine steps of the drawing. A point far outside the plot is moved nearer so that its numbers stay
    /// short; it is clipped anyway.
    fn fine(&self, x: f64, y: f64) -> (f64, f64) {
        let (width, height) = self.area();
        let near = |place: f64| place.clamp(-30.0, 30.0);
        (
            near(self.figure.x.place(x)) * width * FINE,
            (1.0 - near(self.figure.y.place(y))) * height * FINE,
        )
    }

    /// Draws the area of the figure that is inside the wall.
    fn wall(&self) -> String {
        let (width, height) = self.area();
        let (width, height) = (width * FINE, height * FINE);
        match self.figure.wall {
            Some(Wall::RightOf(x)) => {
                let left = self.fine(x, 0.0).0.clamp(0.0, width);
                let wide = width - left;
                format!(
                    r#"<rect class="wall" x="{left:.0}" width="{wide:.0}" height="{height:.0}"/>"#
                )
            }
            Some(Wall::Above(y)) => {
                let tall = self.fine(0.0, y).1.clamp(0.0, height);
                format!(r#"<rect class="wall" width="{width:.0}" height="{tall:.0}"/>"#)
            }
            None => String::new(),
        }
    }

    fn line(&mut self, line: &Line) {
        let (x, y) = (self.figure.x.range, self.figure.y.range);
        let straight = |from: (f64, f64), to: (f64, f64)| {
            let (from, to) = (self.fine(from.0, from.1), self.fine(to.0, to.1));
            decimate::path(vec![vec![from, to]])
        };
        let stretches = match &line.shape {
            Shape::Horizontal(at) => straight((x.min, *at), (x.max, *at)),
            Shape::Vertical(at) => straight((*at, y.min), (*at, y.max)),
            Shape::Series(points) => decimate::series(points.iter().map(|&(x, y)| {
                if y.is_finite() {
                    self.fine(x, y)
                } else {
                    (x, f64::NAN)
                }
            })),
            Shape::Path(stretches) => {
                let fine = |s: &Vec<(f64, f64)>| s.iter().map(|&(x, y)| self.fine(x, y)).collect();
                decimate::path(stretches.iter().map(fine).collect())
            }
            Shape::Tiles(tiles) => {
                self.tiles(line.role, tiles);
                return;
            }
            Shape::Signs(signs) => {
                for &(x, y, sign) in signs {
                    let (x, y) = self.fine(x, y);
                    let _ = write!(
                        self.marks,
                        r#"<path class="sign {} {}" d="M{x:.0} {y:.0}{}"/>"#,
                        line.role,
                        sign_class(sign),
                        sign_path(sign)
                    );
                }
                return;
            }
        };
        self.write_path(line.role, &line.name, &stretches);
    }

    /// Draws filled rectangles. Their corners are whole steps, so that neighbours touch.
    fn tiles(&mut self, class: &str, tiles: &[[f64; 4]]) {
        let _ = write!(self.marks, r#"<path class="{class}" d=""#);
        for &[left, right, low, high] in tiles {
            let ((x, y), (to_x, to_y)) = (self.fine(left, high), self.fine(right, low));
            let (x, y, to_x, to_y) = (x.round(), y.round(), to_x.round(), to_y.round());
            let _ = write!(self.marks, "M{x} {y}h{}v{}H{x}z", to_x - x, to_y - y);
        }
        self.marks.push_str("\"/>");
    }

    fn write_path(&mut self, class: &str, name: &str, stretches: &[Vec<decimate::Point>]) {
        if stretches.is_empty() {
            return;
        }
        let out = &mut self.marks;
        // An oscillation that fills an area gets a thinner stroke, so that its lines stay distinct.
        let dense = stretches.iter().map(Vec::len).sum::<usize>() > DENSE;
        // The attribute has a value, because a picture in its own file is XML.
        let dense = if dense { " data-dense=\"\"" } else { "" };
        let name = escape(name);
        let _ = write!(out, r#"<path class="{class}" data-n="{name}"{dense} d=""#);
        for stretch in stretches {
            let mut pen = stretch[0];
            let _ = write!(out, "M{} {}", pen.0, pen.1);
            if stretch.len() == 1 {
                // A single sample: a line of zero length shows as a dot with round caps.
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

    fn finish(self, id: &str) -> String {
        let Size { width, height } = self.size;
        let (wide, tall) = self.area();
        let (right, bottom) = (f64::from(LEFT) + wide, f64::from(TOP) + tall);
        let mut out = format!(
            r#"<svg class="plot" viewBox="0 0 {width} {height}" role="img" aria-labelledby="{id}-t {id}-d" {} {}><title id="{id}-t">{}</title><desc id="{id}-d">{}</desc>"#,
            attributes(&self.figure.x, &self.x, 'x'),
            attributes(&self.figure.y, &self.y, 'y'),
            escape(&self.figure.title),
            escape(&self.figure.description),
        );
        let inner = |out: &mut String, class: &str, content: &str| {
            let _ = write!(
                out,
                r#"<svg class="{class}" x="{LEFT}" y="{TOP}" width="{wide}" height="{tall}" viewBox="0 0 {:.0} {:.0}" preserveAspectRatio="none">{content}</svg>"#,
                wide * FINE,
                tall * FINE
            );
        };
        inner(&mut out, "behind", &self.wall());
        let (mut grid, mut labels) = (String::new(), String::new());
        for (place, label) in marks(&self.figure.x, &self.x, (wide / 48.0) as usize) {
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
        for (place, label) in marks(&self.figure.y, &self.y, (tall / 34.0) as usize) {
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
        inner(&mut out, "lines", &self.marks);
        let _ = write!(
            out,
            r#"<path class="axis" d="M{LEFT} {TOP}V{bottom}H{right}"/><g class="labels">{labels}</g><text x="2" y="11" class="at">{}</text><text x="{right}" y="{}" class="at te">{}</text></svg>"#,
            axis_title(&self.figure.y, &self.y),
            height - 5,
            axis_title(&self.figure.x, &self.x),
        );
        out
    }
}

/// CSS class of a symbol: `dot` for the full dot, `open` for the outlined symbols.
fn sign_class(sign: Sign) -> &'static str {
    match sign {
        Sign::Dot => "dot",
        _ => "open",
    }
}

/// SVG path of a symbol, relative to the pen position, in fine steps.
fn sign_path(sign: Sign) -> &'static str {
    match sign {
        // A line of zero length: its stroke's round caps are the dot, equally large on any screen.
        Sign::Dot => "h0",
        Sign::Ring => "m-40 0a40 40 0 1 0 80 0a40 40 0 1 0 -80 0z",
        Sign::Triangle => "m0 -46l44 78h-88z",
        Sign::Waves => "m-52 -8q26 -46 52 0t52 0m-104 34q26 -46 52 0t52 0",
        Sign::Cross => "m-38 -38l76 76m0 -76l-76 76",
    }
}

/// Formats text of this program for the page: escaped, symbols with subscripts, numbers with a true minus sign.
pub fn typeset(text: &str) -> String {
    let mut text = escape(text);
    for (plain, subscript) in [
        ("k_de", "k<sub>de</sub>"),
        ("k_c", "k<sub>c</sub>"),
        ("x_s", "x<sub>s</sub>"),
    ] {
        text = text.replace(plain, subscript);
    }
    text.strip_prefix('-')
        .map_or(text.clone(), |rest| format!("\u{2212}{rest}"))
        .replace("(-", "(\u{2212}")
        .replace(" -", " \u{2212}")
}

/// Escapes text for HTML and SVG, in content and in attributes.
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
    use crate::figure::Range;

    const SIZE: Size = Size {
        width: 250,
        height: 155,
    };

    fn figure(y: Range) -> Figure {
        let time = Axis::new("time", "s", Range { min: 0.0, max: 2.0 });
        let mut figure = Figure::new("a < b", time, Axis::new("force", "N·m", y));
        figure.description = "d".to_owned();
        figure
    }

    #[test]
    fn lines_are_short_relative_integers() {
        let mut figure = figure(Range { min: 0.0, max: 0.1 });
        let points = vec![(0.0, 0.0), (1.0, 0.1), (2.0, 0.05)];
        figure.line("l", "force", Shape::Series(points));
        let out = draw(&figure, SIZE, "p");
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
            let mut figure = figure(range);
            let points = vec![(0.0, 1e300), (1.0, f64::NAN), (2.0, f64::NEG_INFINITY)];
            figure.line("l", "n", Shape::Series(points));
            figure.line("h", "n", Shape::Horizontal(0.0));
            let out = draw(&figure, SIZE, "p");
            assert!(
                !out.contains("NaN") && !out.contains("inf"),
                "{range:?}: {out}"
            );
        }
    }
}
