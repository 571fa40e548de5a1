//! A figure as data: axes with units, and lines with their roles. The code that draws the figure chooses colours, dashes and
//! pixels.
//!
//! All numbers are in SI units. `svg.rs` draws figures as SVG; the page's script draws the same lines from JSON.

use serde::Serialize;

/// A figure: axes and lines.
#[derive(Debug, Clone, Serialize)]
pub struct Figure {
    /// The title above the figure.
    pub title: String,
    /// What the figure shows, in one or two sentences with numbers from the runs.
    pub description: String,
    /// Horizontal axis of the figure.
    pub x: Axis,
    /// Vertical axis of the figure.
    pub y: Axis,
    /// The side of the figure that is inside the wall; `None` for a figure without a wall.
    pub wall: Option<Wall>,
    /// Lines in drawing order; later ones cover earlier ones.
    pub lines: Vec<Line>,
}

/// The side of a figure that is inside the wall.
#[derive(Debug, Clone, Copy, Serialize)]
pub enum Wall {
    /// The wall is to the right of this coordinate of the horizontal axis.
    RightOf(f64),
    /// The wall is above this coordinate of the vertical axis.
    Above(f64),
}

/// One axis of a figure.
#[derive(Debug, Clone, Serialize)]
pub struct Axis {
    /// Title of the axis without the unit.
    pub title: String,
    /// SI unit of the axis; empty for a plain number.
    pub unit: String,
    /// Lower and upper end of the axis.
    pub range: Range,
    /// Coordinates of the axis' tick marks, with their labels; `None` for round numbers that the drawing code chooses.
    pub marks: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// Makes an axis over `range` with round tick marks.
    pub fn new(title: &str, unit: &str, range: Range) -> Self {
        Axis {
            title: title.to_owned(),
            unit: unit.to_owned(),
            range: range.or_unit(),
            marks: None,
        }
    }

    /// Makes an axis of decimal logarithms over `range`, which is also in logarithms. Powers of ten are marked, and values between
    /// them if there are few powers.
    pub fn powers_of_ten(title: &str, unit: &str, range: Range) -> Self {
        let mut axis = Axis::new(title, unit, range);
        let width = axis.range.max - axis.range.min;
        let every = if width > 9.0 { 2 } else { 1 };
        let steps: &[f64] = if width > 3.0 {
            &[1.0]
        } else if width > 1.0 {
            &[1.0, 3.0]
        } else {
            &[1.0, 2.0, 3.0, 5.0]
        };
        let powers = axis.range.min.floor() as i32..=axis.range.max.ceil() as i32;
        let marks = powers
            .filter(|power| power % every == 0)
            .flat_map(|power| {
                steps.iter().map(move |step| {
                    // The label is parsed from its digits, because a product would carry rounding into it.
                    let label = match format!("{step}e{power}") {
                        far if !(-3..=4).contains(&power) => far,
                        near => near.parse().map_or(near, |value: f64| value.to_string()),
                    };
                    (f64::from(power) + step.log10(), label)
                })
            })
            .filter(|(place, _)| (axis.range.min..=axis.range.max).contains(place))
            .collect();
        axis.marks = Some(marks);
        axis
    }

    /// Relative position of `value` on the axis: 0 at the lower end, 1 at the upper.
    pub fn place(&self, value: f64) -> f64 {
        (value - self.range.min) / (self.range.max - self.range.min)
    }
}

/// One line of a figure.
#[derive(Debug, Clone, Serialize)]
pub struct Line {
    /// Role of the line, which is also the name of its CSS class: `hip` (device position), `surf` (surface), `force`, …
    pub role: &'static str,
    /// Name of the line in the legend and in read-outs; empty for a line without a name.
    pub name: String,
    /// Points or position of the line.
    pub shape: Shape,
}

/// Geometry of a line.
#[derive(Debug, Clone, Serialize)]
pub enum Shape {
    /// Points in order of x; a NaN makes a gap.
    Series(Vec<(f64, f64)>),
    /// Several stretches of points; a stretch may turn back.
    Path(Vec<Vec<(f64, f64)>>),
    /// Horizontal line across the figure at this y.
    Horizontal(f64),
    /// Vertical line across the figure at this x.
    Vertical(f64),
    /// Filled rectangles, each as left, right, bottom, top.
    Tiles(Vec<[f64; 4]>),
    /// Single points, each with a symbol for a verdict.
    Signs(Vec<(f64, f64, Sign)>),
}

/// A symbol that stands for a verdict in a figure. Symbols differ in shape as well as in colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Sign {
    /// A full dot.
    Dot,
    /// An open triangle.
    Triangle,
    /// Two waves.
    Waves,
    /// A cross.
    Cross,
    /// An open circle.
    Ring,
}

impl Figure {
    /// Creates a figure without lines.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Figure {
            title: title.to_owned(),
            description: String::new(),
            x,
            y,
            wall: None,
            lines: Vec::new(),
        }
    }

    /// Adds a line to the figure.
    pub fn line(&mut self, role: &'static str, name: &str, shape: Shape) {
        self.lines.push(Line {
            role,
            name: name.to_owned(),
            shape,
        });
    }
}

/// An interval that grows to include values. Empty until the first finite value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Range {
    /// Lower end of the interval.
    pub min: f64,
    /// Upper end of the interval.
    pub max: f64,
}

impl Range {
    /// An empty interval, to which values can be added.
    pub const EMPTY: Range = Range {
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
    };

    /// The smallest interval with all finite `values`.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        values.into_iter().fold(Range::EMPTY, Range::with)
    }

    /// The interval extended to include `value`, if `value` is finite.
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

    /// The smallest interval that includes both intervals.
    pub fn union(self, other: Range) -> Self {
        Range {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The part of the interval that is inside `limits`; the two must overlap.
    pub fn within(self, limits: Range) -> Self {
        Range {
            min: self.min.max(limits.min),
            max: self.max.min(limits.max),
        }
    }

    /// The interval, extended below and above by the given fractions of its width.
    pub fn padded(self, below: f64, above: f64) -> Self {
        let width = self.max - self.min;
        Range {
            min: self.min - below * width,
            max: self.max + above * width,
        }
    }

    /// The interval itself, or a drawable one if it is empty or has zero width.
    pub fn or_unit(self) -> Self {
        if self.min < self.max && (self.max - self.min).is_finite() {
            // In a range narrower than `f64` can divide, ticks and positions would be NaN.
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
