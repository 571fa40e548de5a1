//! Prepares a run for its plots: where it touches the wall, its displayed stiffness, its force–position path, and suitable axes.

use super::figure::Range;
use touchstone_sim::run::record::{Run, Trace};

/// Stretches of a path of angle in rad and force in N·m.
pub type Strokes = Vec<Vec<(f64, f64)>>;

/// A run's trace, with values that all its plots need.
pub struct View<'a> {
    /// The run that is plotted.
    pub run: &'a Run,
    /// The recorded trace of the run.
    pub trace: &'a Trace,
    /// Largest stable stiffness of a plain sampled spring on the device, N·m/rad; `None` if it is not drawn.
    pub k_critical: Option<f64>,
    /// Indices from the first to the last sample with a force or inside the wall.
    pub contact: std::ops::Range<usize>,
    /// Penetration below which the displayed stiffness (force over penetration) is not drawn, rad.
    pub shallow: f64,
}

/// Ends of the axes in SI units.
#[derive(Debug, Clone, Copy)]
pub struct Ranges {
    /// Range of the time axis, s.
    pub time: Range,
    /// Range of the knob's angle near the wall, rad.
    pub angle: Range,
    /// Range of the force axis, N·m.
    pub force: Range,
    /// Range of the displayed stiffness, N·m/rad.
    pub stiffness: Range,
    /// Range of the energies, J: the true energy, and the energy that the control law observes.
    pub energy: Range,
}

impl Ranges {
    /// Ranges of axes that fit two runs, which are to be compared.
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
    /// Creates the view of a run; `None` if the run has no recorded trace.
    pub fn new(run: &'a Run, k_critical: Option<f64>) -> Option<Self> {
        let trace = run
            .trace
            .as_ref()
            .filter(|trace| super::columns::len(trace) > 0)?;
        let touches =
            |&i: &usize| trace.force_n_m[i] != 0.0 || trace.angle_rad[i] > trace.surface_rad[i];
        let mut touching = (0..super::columns::len(trace)).filter(touches);
        let first = touching.next();
        let contact = first.map_or(0..0, |first| {
            first..touching.next_back().unwrap_or(first) + 1
        });
        let deepest = contact
            .clone()
            .map(|i| trace.angle_rad[i] - trace.surface_rad[i])
            .fold(0.0, f64::max);
        // At a penetration of a count or less the quotient has only two or three possible values (the singularity of equation
        // (2.13) of the thesis). Without an encoder there is no such limit; a thousandth of the largest penetration avoids 0/0.
        let shallow = run
            .summary
            .encoder_counts_per_rev
            .map_or(deepest / 1000.0, |counts| {
                2.0 * std::f64::consts::TAU / counts
            });
        Some(View {
            run,
            trace,
            k_critical,
            contact,
            shallow,
        })
    }

    /// Number of samples in the trace.
    fn len(&self) -> usize {
        super::columns::len(self.trace)
    }

    /// Angle of the wall's surface at the first contact, before the law moves it, rad; only for runs with a contact.
    pub fn surface(&self) -> f64 {
        self.trace.surface_rad[self.contact.start]
    }

    /// Measured penetration of a sample, rad, which is the law's input.
    fn penetration(&self, index: usize) -> f64 {
        self.trace.angle_measured_rad[index] - self.trace.surface_rad[index]
    }

    /// Displayed stiffness of a sample (magnitude of force over penetration), N·m/rad; NaN if the penetration is below `shallow`.
    pub fn displayed(&self, index: usize) -> f64 {
        let e = self.penetration(index);
        // A small tolerance, because exactly two counts may come out slightly below in `f64`.
        if e > 0.0 && e >= self.shallow * (1.0 - 1e-9) {
            self.trace.force_n_m[index].abs() / e
        } else {
            f64::NAN
        }
    }

    /// Ranges of the axes that fit this run alone.
    pub fn ranges(&self) -> Ranges {
        let trace = self.trace;
        let k_de = self.run.summary.k_desired;
        // Only the part with a force: free flight before and after would squeeze the wall into a corner.
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
        // The highest few values come from the shallowest contacts. They may leave the plot; k_de may not, nor k_c up to 2 k_de.
        let high = shown
            .get(shown.len() * 98 / 100)
            .copied()
            .unwrap_or(0.0)
            .min(2.0 * k_de);
        let top = high
            .max(k_de)
            .max(self.k_critical.unwrap_or(0.0).min(2.0 * k_de));
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

    /// The path of angle and force, split where the motion turns by more than `hysteresis` in rad. Returns the inward stretches,
    /// then the outward stretches.
    ///
    /// The force is constant between samples while the device moves, so the path is a staircase. The area that it encloses is the
    /// true energy that the wall exchanges. Straight lines between samples would hide exactly what makes a stiff wall active.
    pub fn strokes(&self, hysteresis: f64) -> (Strokes, Strokes) {
        let (angle, force) = (&self.trace.angle_rad, &self.trace.force_n_m);
        let mut parts: (Strokes, Strokes) = Default::default();
        // One more sample on either side shows the way into and out of contact.
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;

    #[test]
    fn the_area_under_the_strokes_is_the_true_energy() {
        for law in [LawKind::Spring, LawKind::EnhancedSfa] {
            let run = synthetic::run(law, 5.0, 3.2);
            let view = View::new(&run, None).unwrap();
            let (inbound, outbound) = view.strokes(1e-3);
            let under = |stroke: &Vec<(f64, f64)>| -> f64 {
                stroke
                    .windows(2)
                    .map(|w| (w[1].0 - w[0].0) * (w[0].1 + w[1].1) / 2.0)
                    .sum()
            };
            let area: f64 = inbound.iter().chain(&outbound).map(under).sum();
            let last = *view.trace.energy_true_j.last().unwrap();
            assert!(
                (area - last).abs() < 1e-9 + 1e-9 * last.abs(),
                "{area} {last}"
            );
        }
    }

    #[test]
    fn strokes_turn_where_the_motion_does() {
        let run = synthetic::run(LawKind::Fba, 1.0, 3.2);
        let view = View::new(&run, None).unwrap();
        let (inbound, outbound) = view.strokes(2e-3);
        let net = |stroke: &Vec<(f64, f64)>| stroke.last().unwrap().0 - stroke[0].0;
        assert!(inbound.iter().all(|s| net(s) > 0.0) && outbound.iter().all(|s| net(s) < 0.0));
        // In, two oscillations, out: no more turns than a person would count.
        assert!(
            (3..12).contains(&(inbound.len() + outbound.len())),
            "{} {}",
            inbound.len(),
            outbound.len()
        );
    }

    #[test]
    fn stiffness_is_hidden_below_two_counts() {
        let mut run = synthetic::run(LawKind::Spring, 2.5, 0.01);
        let count = std::f64::consts::TAU / 16_384.0;
        let trace = run.trace.as_mut().unwrap();
        for (i, counts) in [-3.0, 0.0, 1.0, 2.0, 3.0].into_iter().enumerate() {
            trace.angle_measured_rad[i] = trace.surface_rad[i] + counts * count;
            trace.force_n_m[i] = 2.5 * counts * count;
        }
        let view = View::new(&run, None).unwrap();
        let shown: Vec<bool> = (0..5).map(|i| view.displayed(i).is_finite()).collect();
        assert_eq!(shown, [false, false, false, true, true]);
        assert!((view.displayed(4) - 2.5).abs() < 1e-9);
    }

    #[test]
    fn a_run_that_never_touches_has_a_view() {
        let run = synthetic::run(LawKind::Spring, 2.5, 0.2);
        let view = View::new(&run, Some(1.0)).unwrap();
        assert!(view.contact.is_empty());
        let ranges = view.ranges();
        assert!(ranges.angle.min < ranges.angle.max && ranges.stiffness.max > 2.5);
        assert_eq!(view.strokes(1e-3), (Strokes::new(), Strokes::new()));
        let bare = Run {
            trace: Some(Trace::default()),
            ..run.clone()
        };
        assert!(View::new(&bare, None).is_none());
    }
}
