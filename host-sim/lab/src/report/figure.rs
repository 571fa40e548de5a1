//! A figure as data: axes with units, lines with their meaning. The renderer chooses colours, dashes and pixels.
//!
//! All numbers are SI. `svg.rs` is one renderer; the page's script, which reads the same lines as JSON, is another.

use serde::Serialize;

/// A figure.
#[derive(Debug, Clone, Serialize)]
pub struct Figure {
    /// The title above the figure.
    pub title: String,
    /// What the figure shows, in a sentence or two, computed from the runs.
    pub description: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The inside of the wall.
    pub wall: Option<Wall>,
    /// Lines, those behind first.
    pub lines: Vec<Line>,
}

/// The half of a figure that is inside the wall.
#[derive(Debug, Clone, Copy, Serialize)]
pub enum Wall {
    /// Right of this place.
    RightOf(f64),
    /// The wall is above this coordinate.
    Above(f64),
}

/// One axis.
#[derive(Debug, Clone, Serialize)]
pub struct Axis {
    /// Title without the unit.
    pub title: String,
    /// SI unit; empty for a plain number.
    pub unit: String,
    /// Ends.
    pub range: Range,
    /// Marked places with their labels; `None`: round numbers, chosen by the renderer.
    pub marks: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// An axis over `range`, with round marks.
    pub fn new(title: &str, unit: &str, range: Range) -> Self {
        Axis {
            title: title.to_owned(),
            unit: unit.to_owned(),
            range: range.or_unit(),
            marks: None,
        }
    }

    /// An axis of decimal logarithms over `range`, which is one of logarithms too; marked by powers of ten, and between them where
    /// there are few.
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
                    // By its digits: a product would carry rounding into the label.
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

    /// Where `value` lies, 0 at the lower end, 1 at the upper.
    pub fn place(&self, value: f64) -> f64 {
        (value - self.range.min) / (self.range.max - self.range.min)
    }
}

/// One line of a figure.
#[derive(Debug, Clone, Serialize)]
pub struct Line {
    /// Role of the line, used as the name of its style: `hip`, `surf`, `force`, …
    pub role: &'static str,
    /// Name for legend and read-out; empty: it needs none.
    pub name: String,
    /// Where it runs.
    pub shape: Shape,
}

/// The course of a line.
#[derive(Debug, Clone, Serialize)]
pub enum Shape {
    /// Points in order of x; NaN makes a gap.
    Series(Vec<(f64, f64)>),
    /// Stretches that may turn back.
    Path(Vec<Vec<(f64, f64)>>),
    /// Across the whole figure at this height.
    Horizontal(f64),
    /// From bottom to top at this place.
    Vertical(f64),
    /// Filled rectangles: left, right, bottom, top.
    Tiles(Vec<[f64; 4]>),
    /// Single places, each with a sign.
    Signs(Vec<(f64, f64, Sign)>),
}

/// A sign at a place, for a verdict: distinguished by shape as well as by colour.
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
    /// Axes without lines.
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

    /// Adds a line.
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
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
}

impl Range {
    /// An empty range.
    pub const EMPTY: Range = Range {
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
    };

    /// The smallest interval with all finite `values`.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        values.into_iter().fold(Range::EMPTY, Range::with)
    }

    /// The interval that also includes `value`, if it is finite.
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

    /// The smallest interval that includes both.
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
    pub fn or_unit(self) -> Self {
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
