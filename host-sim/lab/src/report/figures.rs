//! The four plots of a run: position–force, energy, displayed stiffness, trajectories.

use super::label;
use super::svg::{Axis, Plot, Range, Size};
use super::view::{Ranges, View};

/// Which plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Force against position, thesis Figs. 5.2–5.5.
    PositionForce,
    /// Displayed stiffness against time, thesis Fig. 5.7.
    Stiffness,
    /// Positions against time, thesis Fig. 5.6.
    Trajectory,
    /// Observed and true energy against time.
    Energy,
}

impl Kind {
    /// All, in the order of the page.
    pub const ALL: [Kind; 4] = [
        Kind::PositionForce,
        Kind::Stiffness,
        Kind::Trajectory,
        Kind::Energy,
    ];

    /// Heading.
    pub fn title(self) -> &'static str {
        match self {
            Kind::PositionForce => "Force against position",
            Kind::Stiffness => "Displayed stiffness",
            Kind::Trajectory => "Trajectories",
            Kind::Energy => "Energy",
        }
    }

    /// Short name for identifiers.
    pub fn key(self) -> &'static str {
        match self {
            Kind::PositionForce => "f",
            Kind::Stiffness => "k",
            Kind::Trajectory => "x",
            Kind::Energy => "e",
        }
    }
}

/// Classes of lines with what they mean; a plot need not have all of them.
pub fn legend(kind: Kind) -> &'static [(&'static str, &'static str)] {
    match kind {
        Kind::PositionForce => &[
            ("in", "inbound"),
            ("out", "outbound"),
            ("ideal", "ideal, k_de·e"),
            ("surf", "surface x_s"),
        ],
        Kind::Stiffness => &[
            ("k", "|f|/e, hidden where e is below 2 counts"),
            ("kde", "k_de"),
            ("kc", "k_c"),
        ],
        Kind::Trajectory => &[
            ("hip", "HIP"),
            ("surf", "surface x_s"),
            ("shift", "shifted surface"),
            ("mass", "filter mass"),
        ],
        Kind::Energy => &[
            ("true", "true, at the wall's port"),
            ("user", "true, at the user's port"),
            ("obs", "observed"),
        ],
    }
}

impl View<'_> {
    /// Draws one plot into `out`. `detail` adds the lines that only matter to one run: offset, filter mass, device losses.
    pub fn draw(
        &self,
        out: &mut String,
        kind: Kind,
        size: Size,
        ranges: &Ranges,
        detail: bool,
        id: &str,
    ) {
        let plot = match kind {
            Kind::PositionForce => self.position_force(size, ranges),
            Kind::Stiffness => self.stiffness(size, ranges),
            Kind::Trajectory => self.trajectory(size, ranges, detail),
            Kind::Energy => self.energy(size, ranges, detail),
        };
        let summary = &self.run.summary;
        let title = format!(
            "{}: {}, k_de {} N·m/rad",
            kind.title(),
            label::law(summary.law),
            summary.k_desired
        );
        plot.finish(out, id, &title, &self.description(kind));
    }

    fn description(&self, kind: Kind) -> String {
        use super::quantity::with_unit;
        let s = &self.run.summary;
        let verdict = label::verdict(s.verdict);
        match kind {
            Kind::PositionForce => {
                let area = "Force is held between samples, so the area between inbound and outbound is the energy exchanged.";
                format!(
                    "{area} Largest force {}. Verdict: {verdict}.",
                    with_unit(s.force_max, "N·m", 3)
                )
            }
            Kind::Stiffness => match s.k_displayed {
                Some(k) => format!(
                    "{} at the end of the hold. Verdict: {verdict}.",
                    with_unit(k, "N·m/rad", 3)
                ),
                None => format!("Verdict: {verdict}."),
            },
            Kind::Trajectory => match s.limit_cycle_peak_to_peak {
                Some(a) => format!(
                    "Oscillation of {} peak to peak at the end. Verdict: {verdict}.",
                    with_unit(a, "rad", 3)
                ),
                None => format!("Verdict: {verdict}."),
            },
            Kind::Energy => format!(
                "Lowest true energy {}. Verdict: {verdict}.",
                with_unit(s.energy_true_min, "J", 3)
            ),
        }
    }

    fn time_axis(&self, ranges: &Ranges) -> Axis {
        Axis::new("time", "s", ranges.time)
    }

    fn position_force(&self, size: Size, ranges: &Ranges) -> Plot {
        let x = Axis::new("HIP angle x", "rad", ranges.angle);
        let mut plot = Plot::new(size, x, Axis::new("force f", "N·m", ranges.force));
        let end = ranges.angle.max;
        if !self.contact.is_empty() {
            let surface = self.surface();
            plot.shade_from_x(surface, "wall");
            plot.vertical("surf", "surface", surface);
            plot.line(
                "ideal",
                "ideal",
                (surface, 0.0),
                (end, self.run.summary.k_desired * (end - surface)),
            );
        }
        plot.horizontal("zero", "zero", 0.0);
        let hysteresis = self
            .shallow
            .max(0.004 * (ranges.angle.max - ranges.angle.min));
        let (inbound, outbound) = self.strokes(hysteresis);
        plot.path("in", "inbound", &inbound);
        plot.path("out", "outbound", &outbound);
        plot
    }

    fn stiffness(&self, size: Size, ranges: &Ranges) -> Plot {
        let y = Axis::new("displayed stiffness |f|/e", "N·m/rad", ranges.stiffness);
        let mut plot = Plot::new(size, self.time_axis(ranges), y);
        plot.horizontal("kde", "k_de", self.run.summary.k_desired);
        if let Some(k_c) = self.k_critical {
            plot.horizontal("kc", "k_c", k_c);
        }
        let displayed: Vec<f64> = (0..self.trace.time_s.len())
            .map(|i| self.displayed(i))
            .collect();
        plot.series("k", "|f|/e", self.over_time(&displayed));
        plot
    }

    fn trajectory(&self, size: Size, ranges: &Ranges, detail: bool) -> Plot {
        let trace = self.trace;
        let mut range = ranges.angle;
        // The offset is zero for most laws and the mass is the HIP for most: a line on top of another only confuses.
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
        let mut plot = Plot::new(
            size,
            self.time_axis(ranges),
            Axis::new("angle", "rad", range),
        );
        if !self.contact.is_empty() {
            plot.shade_from_y(self.surface(), "wall");
        }
        plot.series("surf", "surface", self.over_time(&trace.surface_rad));
        if shifted {
            plot.series(
                "shift",
                "shifted surface",
                self.over_time(&trace.surface_shifted_rad),
            );
        }
        plot.series("hip", "HIP", self.over_time(&trace.angle_rad));
        if mass {
            plot.series("mass", "filter mass", self.over_time(&trace.mass_rad));
        }
        plot
    }

    fn energy(&self, size: Size, ranges: &Ranges, detail: bool) -> Plot {
        let trace = self.trace;
        let pairs = trace.energy_true_j.iter().zip(&trace.energy_device_loss_j);
        let user: Vec<f64> = pairs.map(|(wall, loss)| wall + loss).collect();
        let mut range = ranges.energy;
        if detail {
            range = range.union(Range::of(user.iter().copied()).padded(0.0, 0.05));
        }
        let mut plot = Plot::new(
            size,
            self.time_axis(ranges),
            Axis::new("energy", "J", range),
        );
        plot.horizontal("zero", "zero", 0.0);
        if detail {
            plot.series("user", "at the user's port", self.over_time(&user));
        }
        plot.series(
            "true",
            "at the wall's port",
            self.over_time(&trace.energy_true_j),
        );
        plot.series("obs", "observed", self.over_time(&trace.energy_observed_j));
        plot
    }
}
