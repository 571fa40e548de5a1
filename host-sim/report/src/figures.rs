//! Makes the figures of a run as data: force over position, and force, positions, stiffness, hand and energies over time.

use super::figure::{Axis, Figure, Range, Shape, Wall};
use super::label;
use super::quantity::with_unit;
use super::view::{Ranges, View};

/// The types of figures of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Force over position, as in the thesis' Figs. 5.2 to 5.5.
    PositionForce,
    /// Force over time.
    Force,
    /// Positions over time, as in the thesis' Fig. 5.6.
    Trajectory,
    /// Displayed stiffness over time, as in the thesis' Fig. 5.7.
    Stiffness,
    /// Angles of the hand and of its rest point over time.
    Hand,
    /// Energy of the wall over time: the true energy, and the energy that the control law observes.
    Energy,
}

impl Kind {
    /// All figures of a run, in the order of the page.
    pub const ALL: [Kind; 6] = [
        Kind::PositionForce,
        Kind::Force,
        Kind::Trajectory,
        Kind::Stiffness,
        Kind::Hand,
        Kind::Energy,
    ];

    /// Types of figures that are drawn side by side for all control laws, because the laws differ visibly in them.
    pub const SIDE_BY_SIDE: [Kind; 4] = [
        Kind::PositionForce,
        Kind::Trajectory,
        Kind::Stiffness,
        Kind::Energy,
    ];

    /// Heading of the figure.
    pub fn title(self) -> &'static str {
        match self {
            Kind::PositionForce => "Force against position",
            Kind::Force => "Force",
            Kind::Trajectory => "Positions at the wall",
            Kind::Stiffness => "Displayed stiffness",
            Kind::Hand => "The hand",
            Kind::Energy => "Energy",
        }
    }

    /// Short name of the figure, for identifiers in the page.
    pub fn key(self) -> &'static str {
        match self {
            Kind::PositionForce => "f",
            Kind::Force => "t",
            Kind::Trajectory => "x",
            Kind::Stiffness => "k",
            Kind::Hand => "h",
            Kind::Energy => "e",
        }
    }
}

impl View<'_> {
    /// Makes one figure of the run. With `detail` it also has lines that matter only for a single run: offset of the surface,
    /// virtual mass, device losses.
    pub fn figure(&self, kind: Kind, ranges: &Ranges, detail: bool) -> Figure {
        let mut figure = match kind {
            Kind::PositionForce => self.position_force(ranges),
            Kind::Force => self.force(ranges),
            Kind::Trajectory => self.trajectory(ranges, detail),
            Kind::Stiffness => self.stiffness(ranges),
            Kind::Hand => self.hand(ranges),
            Kind::Energy => self.energy(ranges, detail),
        };
        let summary = &self.run.summary;
        figure.title = format!(
            "{}: {}, k_de {} N·m/rad",
            kind.title(),
            label::run_name(summary),
            summary.k_desired
        );
        figure.description = self.description(kind);
        figure
    }

    fn description(&self, kind: Kind) -> String {
        let s = &self.run.summary;
        let verdict = label::verdict(s.verdict);
        let found = match kind {
            Kind::PositionForce => {
                "Force is held between samples, so the area between inbound and outbound is the energy exchanged.".to_owned()
            }
            Kind::Force => format!("Largest force {}.", with_unit(s.force_max, "N·m", 3)),
            Kind::Stiffness => s.k_displayed.map_or(String::new(), |k| {
                format!("{} at the end of the hold.", with_unit(k, "N·m/rad", 3))
            }),
            Kind::Trajectory => s.limit_cycle_peak_to_peak.map_or(String::new(), |a| {
                format!("Motion of {} peak to peak at the end.", with_unit(a, "rad", 3))
            }),
            Kind::Hand => {
                let most = self.trace.hand_rad.iter().zip(&self.trace.angle_rad).map(|(hand, hip)| (hand - hip).abs());
                let most = Range::of(most).max;
                if most.is_finite() {
                    format!("The fingertip pad gives by up to {}.", with_unit(most, "rad", 3))
                } else {
                    String::new()
                }
            }
            Kind::Energy => format!("Lowest true energy {}.", with_unit(s.energy_true_min, "J", 3)),
        };
        format!("{found} Verdict: {verdict}.")
            .trim_start()
            .to_owned()
    }

    fn over(&self, ranges: &Ranges, title: &str, unit: &str, range: Range) -> Figure {
        let time = Axis::new("time", "s", ranges.time);
        Figure::new("", time, Axis::new(title, unit, range))
    }

    fn series(&self, values: &[f64]) -> Shape {
        let time = self.trace.time_s.iter().copied();
        Shape::Series(time.zip(values.iter().copied()).collect())
    }

    fn position_force(&self, ranges: &Ranges) -> Figure {
        let x = Axis::new("device angle x", "rad", ranges.angle);
        let mut figure = Figure::new("", x, Axis::new("force f", "N·m", ranges.force));
        let end = ranges.angle.max;
        if !self.contact.is_empty() {
            let surface = self.surface();
            figure.wall = Some(Wall::RightOf(surface));
            figure.line("surf", "surface x_s", Shape::Vertical(surface));
            let top = self.run.summary.k_desired * (end - surface);
            let ideal = vec![(surface, 0.0), (end, top)];
            figure.line("ideal", "ideal, k_de·e", Shape::Path(vec![ideal]));
        }
        figure.line("zero", "", Shape::Horizontal(0.0));
        let hysteresis = self
            .shallow
            .max(0.004 * (ranges.angle.max - ranges.angle.min));
        let (inbound, outbound) = self.strokes(hysteresis);
        figure.line("in", "inbound", Shape::Path(inbound));
        figure.line("out", "outbound", Shape::Path(outbound));
        figure
    }

    fn force(&self, ranges: &Ranges) -> Figure {
        let mut figure = self.over(ranges, "force", "N·m", ranges.force);
        figure.line("zero", "", Shape::Horizontal(0.0));
        let wanted = |i: usize| {
            let e = self.trace.angle_rad[i] - self.trace.surface_rad[i];
            (self.run.summary.k_desired * e).max(0.0)
        };
        let wanted: Vec<f64> = (0..self.trace.time_s.len()).map(wanted).collect();
        figure.line("ideal", "ideal, k_de·e", self.series(&wanted));
        figure.line("force", "force f", self.series(&self.trace.force_n_m));
        figure
    }

    fn stiffness(&self, ranges: &Ranges) -> Figure {
        let mut figure = self.over(
            ranges,
            "displayed stiffness |f|/e",
            "N·m/rad",
            ranges.stiffness,
        );
        let k_de = self.run.summary.k_desired;
        figure.line("kde", "k_de", Shape::Horizontal(k_de));
        if let Some(k_c) = self.k_critical {
            figure.line("kc", "k_c", Shape::Horizontal(k_c));
        }
        let displayed: Vec<f64> = (0..self.trace.time_s.len())
            .map(|i| self.displayed(i))
            .collect();
        let name = match self.run.summary.encoder_counts_per_rev {
            Some(_) => "|f|/e, hidden where e is below 2 counts",
            None => "|f|/e, hidden where e is below a thousandth of the deepest",
        };
        figure.line("k", name, self.series(&displayed));
        figure
    }

    fn trajectory(&self, ranges: &Ranges, detail: bool) -> Figure {
        let trace = self.trace;
        let mut range = ranges.angle;
        // For most laws the offset is zero, and the virtual mass is at the device's position. A line that coincides with another is
        // left out.
        let far = |a: &[f64], b: &[f64]| self.contact.clone().any(|i| (a[i] - b[i]).abs() > 1e-9);
        let shifted = detail && far(&trace.surface_shifted_rad, &trace.surface_rad);
        let mass = detail && far(&trace.mass_rad, &trace.angle_rad);
        if shifted {
            let all = Range::of(self.contact.clone().map(|i| trace.surface_shifted_rad[i]));
            range = range.union(all.padded(0.05, 0.0));
        }
        if mass {
            range = range.union(Range::of(self.contact.clone().map(|i| trace.mass_rad[i])));
        }
        let mut figure = self.over(ranges, "angle", "rad", range);
        if !self.contact.is_empty() {
            figure.wall = Some(Wall::Above(self.surface()));
        }
        figure.line("surf", "surface x_s", self.series(&trace.surface_rad));
        if shifted {
            let values = self.series(&trace.surface_shifted_rad);
            figure.line("shift", "shifted surface", values);
        }
        figure.line("hip", "device x", self.series(&trace.angle_rad));
        if mass {
            figure.line("mass", "filter mass", self.series(&trace.mass_rad));
        }
        figure
    }

    fn hand(&self, ranges: &Ranges) -> Figure {
        let trace = self.trace;
        // The rest point of a pressing hand is deep in the wall; a range with it would squeeze device and hand into one line.
        let near = Range::of(trace.hand_rad.iter().chain(&trace.angle_rad).copied());
        let wide = near.padded(0.5, 0.5);
        let rest = Range::of(trace.rest_rad.iter().copied());
        let leaves = near.max > near.min && (rest.max > wide.max || rest.min < wide.min);
        let all = near.union(rest);
        let range = if leaves { all.within(wide) } else { all };
        let mut figure = self.over(ranges, "angle", "rad", range.padded(0.05, 0.05));
        if !self.contact.is_empty() {
            figure.wall = Some(Wall::Above(self.surface()));
        }
        let name = if leaves {
            "rest point, leaves the figure"
        } else {
            "rest point"
        };
        figure.line("rest", name, self.series(&trace.rest_rad));
        figure.line("hand", "hand", self.series(&trace.hand_rad));
        figure.line("hip", "device x", self.series(&trace.angle_rad));
        figure
    }

    fn energy(&self, ranges: &Ranges, detail: bool) -> Figure {
        let trace = self.trace;
        let pairs = trace.energy_true_j.iter().zip(&trace.energy_device_loss_j);
        let user: Vec<f64> = pairs.map(|(wall, loss)| wall + loss).collect();
        let mut range = ranges.energy;
        if detail {
            range = range.union(Range::of(user.iter().copied()).padded(0.0, 0.05));
        }
        let mut figure = self.over(ranges, "energy", "J", range);
        figure.line("zero", "", Shape::Horizontal(0.0));
        if detail {
            figure.line("user", "true, at the user's port", self.series(&user));
        }
        figure.line(
            "true",
            "true, at the wall's port",
            self.series(&trace.energy_true_j),
        );
        if trace.energy_observed_j.iter().any(|e| e.is_finite()) {
            figure.line("obs", "observed", self.series(&trace.energy_observed_j));
        }
        figure
    }
}
