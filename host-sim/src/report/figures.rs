//! The four plots of a run: position–force, energy, displayed stiffness, trajectories.

use super::label;
use super::svg::{Axis, Plot, Range, Size};
use crate::run::record::{Run, Trace};

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
        Kind::Stiffness => &[("k", "|f|/e"), ("kde", "k_de"), ("kc", "k_c")],
        Kind::Trajectory => &[
            ("hip", "HIP"),
            ("surf", "surface x_s"),
            ("shift", "shifted surface"),
            ("mass", "filter mass"),
        ],
        Kind::Energy => &[
            ("true", "true"),
            ("user", "true, with device losses"),
            ("obs", "observed"),
        ],
    }
}

/// What can be seen of one run: its trace with what all plots need to know about it.
pub struct View<'a> {
    /// The run.
    pub run: &'a Run,
    trace: &'a Trace,
    /// Samples from the first to the last one with a force or inside the wall.
    contact: std::ops::Range<usize>,
    /// Below this penetration |f|/e is not drawn, rad.
    shallow: f64,
}

/// Ends of the axes, SI.
#[derive(Debug, Clone, Copy)]
pub struct Ranges {
    time: Range,
    angle: Range,
    force: Range,
    stiffness: Range,
    energy: Range,
}

impl Ranges {
    /// One set of axes for two runs that are to be compared.
    pub fn union(self, other: Ranges) -> Self {
        Ranges {
            time: self.time.union(other.time),
            angle: self.angle.union(other.angle),
            force: self.force.union(other.force),
            stiffness: self.stiffness.union(other.stiffness),
            energy: self.energy.union(other.energy),
        }
    }
}

impl<'a> View<'a> {
    /// `None` if the run kept no trace.
    pub fn new(run: &'a Run) -> Option<Self> {
        let trace = run
            .trace
            .as_ref()
            .filter(|trace| super::columns::len(trace) > 0)?;
        let touches =
            |&i: &usize| trace.force_n_m[i] != 0.0 || trace.angle_rad[i] > trace.surface_rad[i];
        let mut touching = (0..super::columns::len(trace)).filter(touches);
        let first = touching.next();
        let contact = first.map_or(0..0, |first| first..touching.last().unwrap_or(first) + 1);
        let deepest = contact
            .clone()
            .map(|i| trace.angle_rad[i] - trace.surface_rad[i])
            .fold(0.0, f64::max);
        // At a count or less the quotient is one of two or three values and says nothing (the singularity of thesis (2.13)).
        // Without an encoder there is no such grain; a thousandth of the penetration keeps 0/0 out.
        let shallow = run
            .summary
            .encoder_counts_per_rev
            .map_or(deepest / 1000.0, |counts| {
                2.0 * std::f64::consts::TAU / counts
            });
        Some(View {
            run,
            trace,
            contact,
            shallow,
        })
    }

    fn len(&self) -> usize {
        super::columns::len(self.trace)
    }

    fn surface(&self) -> f64 {
        self.trace.surface_rad[self.contact.start]
    }

    /// Measured penetration, what the law acts on, rad.
    fn penetration(&self, index: usize) -> f64 {
        self.trace.angle_measured_rad[index] - self.trace.surface_rad[index]
    }

    /// |f|/e, NaN where the penetration is too small to say, N·m/rad.
    fn displayed(&self, index: usize) -> f64 {
        let e = self.penetration(index);
        // A hair of slack: two counts exactly, in f64, may come out a bit below.
        if e > 0.0 && e >= self.shallow * (1.0 - 1e-9) {
            self.trace.force_n_m[index].abs() / e
        } else {
            f64::NAN
        }
    }

    /// Axes that show this run well by itself.
    pub fn ranges(&self, k_critical: Option<f64>) -> Ranges {
        let trace = self.trace;
        let k_de = self.run.summary.k_desired;
        // Where a force acts: free flight before and after would squeeze the wall into a corner.
        let acting = self
            .contact
            .clone()
            .filter(|&i| trace.force_n_m[i] != 0.0)
            .map(|i| trace.angle_rad[i]);
        let whole = || Range::of(trace.angle_rad.iter().copied());
        let angle = if self.contact.is_empty() {
            whole()
        } else {
            Range::of(acting).with(self.surface())
        };
        let force = Range::of(trace.force_n_m.iter().copied()).with(0.0);
        let mut shown: Vec<f64> = self
            .contact
            .clone()
            .map(|i| self.displayed(i))
            .filter(|k| k.is_finite())
            .collect();
        shown.sort_by(f64::total_cmp);
        // The highest few values come from the shallowest contacts; they may leave the plot, k_de and k_c may not.
        let high = shown
            .get(shown.len() * 98 / 100)
            .copied()
            .unwrap_or(0.0)
            .min(2.0 * k_de);
        let top = high
            .max(k_de)
            .max(k_critical.unwrap_or(0.0).min(2.0 * k_de));
        let energy = Range::of(
            trace
                .energy_true_j
                .iter()
                .chain(&trace.energy_observed_j)
                .copied(),
        )
        .with(0.0);
        Ranges {
            time: Range::of(trace.time_s.iter().copied()),
            angle: angle.padded(0.12, 0.06),
            force: force.padded(0.05, 0.08),
            stiffness: Range {
                min: 0.0,
                max: 1.15 * top,
            },
            energy: energy.padded(0.06, 0.08),
        }
    }

    /// Draws one plot into `out`. `detail` adds the lines that only matter to one run: offset, filter mass, device losses.
    pub fn draw(
        &self,
        out: &mut String,
        kind: Kind,
        size: Size,
        ranges: &Ranges,
        k_critical: Option<f64>,
        detail: bool,
        id: &str,
    ) {
        let plot = match kind {
            Kind::PositionForce => self.position_force(size, ranges),
            Kind::Stiffness => self.stiffness(size, ranges, k_critical),
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

    fn over_time<'b>(&'b self, values: &'b [f64]) -> impl Iterator<Item = (f64, f64)> + 'b {
        self.trace
            .time_s
            .iter()
            .copied()
            .zip(values.iter().copied())
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

    /// The path of (angle, force), parted where the motion turns by more than `hysteresis` (rad).
    ///
    /// Between samples the force is held while the device moves on, so the path is a staircase, and the area that it encloses
    /// is the true energy of the port. Straight lines between samples would hide just what makes a stiff wall active.
    fn strokes(&self, hysteresis: f64) -> (Vec<Vec<(f64, f64)>>, Vec<Vec<(f64, f64)>>) {
        let (angle, force) = (&self.trace.angle_rad, &self.trace.force_n_m);
        let mut parts = (Vec::new(), Vec::new());
        // One sample more on either side, so that the way in and out of contact is seen.
        let from = self.contact.start.saturating_sub(1);
        let to = (self.contact.end + 1).min(self.len());
        let mut put = |inbound: bool, stretch: std::ops::RangeInclusive<usize>| {
            let (first, last) = stretch.into_inner();
            if last > first {
                let mut steps = vec![(angle[first], force[first])];
                for i in first + 1..=last {
                    steps.extend([(angle[i], force[i - 1]), (angle[i], force[i])]);
                }
                if inbound {
                    parts.0.push(steps)
                } else {
                    parts.1.push(steps)
                }
            }
        };
        let (mut start, mut extreme, mut inbound) = (from, from, true);
        for i in from..to {
            let back = if inbound {
                angle[extreme] - angle[i]
            } else {
                angle[i] - angle[extreme]
            };
            if back <= 0.0 {
                extreme = i;
            } else if back > hysteresis {
                put(inbound, start..=extreme);
                (start, extreme, inbound) = (extreme, i, !inbound);
            }
        }
        if to > from {
            put(inbound, start..=to - 1);
        }
        parts
    }

    fn stiffness(&self, size: Size, ranges: &Ranges, k_critical: Option<f64>) -> Plot {
        let y = Axis::new("displayed stiffness |f|/e", "N·m/rad", ranges.stiffness);
        let mut plot = Plot::new(size, self.time_axis(ranges), y);
        plot.horizontal("kde", "k_de", self.run.summary.k_desired);
        if let Some(k_c) = k_critical {
            plot.horizontal("kc", "k_c", k_c);
        }
        let displayed: Vec<f64> = (0..self.len()).map(|i| self.displayed(i)).collect();
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
            plot.series("user", "with device losses", self.over_time(&user));
        }
        plot.series("true", "true", self.over_time(&trace.energy_true_j));
        plot.series("obs", "observed", self.over_time(&trace.energy_observed_j));
        plot
    }
}
