//! What a run is judged by, gathered tick by tick, and the verdict.

use super::record::Verdict;
use super::wall::Inside;

/// Two numbers whose range is wanted.
#[derive(Debug, Clone, Copy)]
struct Span {
    low: f64,
    high: f64,
}

impl Span {
    const EMPTY: Span = Span {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    fn take(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    fn width(self) -> Option<f64> {
        (self.high >= self.low).then_some(self.high - self.low)
    }
}

/// One tick as the loop saw it.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    /// Index from 0.
    pub index: u64,
    /// True angle at the sample, rad.
    pub angle_rad: f64,
    /// Penetration that the law was told, rad.
    pub told_rad: f64,
    /// Force of the law, pushing out, N·m.
    pub force_n_m: f64,
    /// Work of the wall's port in this tick, J, positive = absorbed.
    pub absorbed_j: f64,
    /// Dissipated in the device in this tick, J.
    pub device_loss_j: f64,
    /// The law's inside after the tick.
    pub inside: Inside,
}

/// What to judge by: fixed for a run.
#[derive(Debug, Clone)]
pub struct Terms {
    /// `x_s`, rad.
    pub surface_rad: f64,
    /// `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Smallest motion that counts as a limit cycle, rad: four encoder counts.
    pub limit_cycle_rad: f64,
    /// Largest motion inside a hold that still is one and not the loss of the wall, rad.
    pub unstable_rad: f64,
    /// Torque limit of device or law, N·m.
    pub force_limit_n_m: f64,
    /// Quiet holds in ticks, first and past the last; the last one is the press.
    pub holds: Vec<(u64, u64)>,
    /// Ticks of the run.
    pub ticks: u64,
}

/// Displacements of one quiet hold, in its last quarter.
#[derive(Debug, Clone, Copy)]
struct Hold {
    from: u64,
    to: u64,
    motion: Span,
    exits: u32,
    at_limit: bool,
    /// Whether the wall was touched at all; a device that coasts outside is not judged by its motion.
    touched: bool,
}

/// Gathers.
#[derive(Debug, Clone)]
pub struct Judge {
    terms: Terms,
    holds: Vec<Hold>,
    current_hold: usize,
    energy_true: f64,
    loss: f64,
    throughput: f64,
    energy_true_min: f64,
    energy_user_min: f64,
    energy_observed_min: f64,
    /// Sums over the press' second half: force, penetration.
    shown: (f64, f64),
    /// Sums over the first contact: force·e, e².
    first: (f64, f64),
    first_over: bool,
    last_told: f64,
    settled_since: Option<u64>,
    touching: bool,
    contact_ticks: u64,
    force_max: f64,
    penetration_max: f64,
    finite: bool,
}

/// The judgement of a whole run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// How it ended.
    pub verdict: Verdict,
    /// N·m/rad.
    pub k_displayed: Option<f64>,
    /// N·m/rad.
    pub k_first_contact: Option<f64>,
    /// rad.
    pub limit_cycle_peak_to_peak: Option<f64>,
    /// J.
    pub energy_true_min: f64,
    /// J.
    pub energy_user_min: f64,
    /// J, beyond the rounding of the sums; 0 or more.
    pub energy_out: f64,
    /// J.
    pub energy_observed_min: Option<f64>,
    /// Ticks from the start of the press' hold.
    pub settle_ticks: Option<u64>,
    /// rad.
    pub penetration_max: f64,
    /// N·m.
    pub force_max: f64,
    /// Ticks with a force.
    pub contact_ticks: u64,
}

impl Judge {
    /// Starts.
    #[must_use]
    pub fn new(terms: Terms) -> Self {
        // Without a hold, the last fifth of the run stands for one.
        let quiet = if terms.holds.is_empty() {
            vec![(terms.ticks - terms.ticks / 5, terms.ticks)]
        } else {
            terms.holds.clone()
        };
        let holds = quiet
            .into_iter()
            .map(|(from, to)| Hold {
                from: to - (to - from) / 4,
                to,
                motion: Span::EMPTY,
                exits: 0,
                at_limit: false,
                touched: !terms.holds.is_empty(),
            })
            .collect();
        Self {
            terms,
            holds,
            current_hold: 0,
            energy_true: 0.0,
            loss: 0.0,
            throughput: 0.0,
            energy_true_min: 0.0,
            energy_user_min: 0.0,
            energy_observed_min: f64::INFINITY,
            shown: (0.0, 0.0),
            first: (0.0, 0.0),
            first_over: false,
            last_told: f64::NEG_INFINITY,
            settled_since: None,
            touching: false,
            contact_ticks: 0,
            force_max: 0.0,
            penetration_max: 0.0,
            finite: true,
        }
    }

    /// True energy of the wall's port so far, J.
    #[must_use]
    pub fn energy_true_j(&self) -> f64 {
        self.energy_true
    }

    /// Dissipated in the device so far, J.
    #[must_use]
    pub fn device_loss_j(&self) -> f64 {
        self.loss
    }

    /// Takes a tick.
    pub fn take(&mut self, tick: &Tick) {
        let e = tick.angle_rad - self.terms.surface_rad;
        let force = tick.force_n_m;
        let touching = force != 0.0;
        self.finite &= tick.angle_rad.is_finite();
        self.contact_ticks += u64::from(touching);
        self.force_max = self.force_max.max(force);
        self.penetration_max = self.penetration_max.max(e);
        self.energy_true += tick.absorbed_j;
        self.throughput += tick.absorbed_j.abs();
        self.loss += tick.device_loss_j;
        self.energy_true_min = self.energy_true_min.min(self.energy_true);
        self.energy_user_min = self.energy_user_min.min(self.energy_true + self.loss);
        // NaN (no observer) never is the smaller.
        self.energy_observed_min = self.energy_observed_min.min(tick.inside.energy_j);
        self.first_contact(tick);
        self.press(tick, e);
        self.hold(tick, touching);
        self.touching = touching;
    }

    fn first_contact(&mut self, tick: &Tick) {
        if !self.first_over && tick.told_rad > 0.0 {
            if tick.told_rad < self.last_told {
                self.first_over = true;
            } else {
                self.first.0 += tick.force_n_m * tick.told_rad;
                self.first.1 += tick.told_rad * tick.told_rad;
            }
        }
        self.last_told = tick.told_rad;
    }

    fn press(&mut self, tick: &Tick, e: f64) {
        let Some(&(from, to)) = self.terms.holds.last() else {
            return;
        };
        if tick.index < from || tick.index >= to {
            return;
        }
        let wanted = self.terms.k_desired * e;
        if (tick.force_n_m - wanted).abs() > 0.05 * wanted.abs() {
            self.settled_since = None;
        } else if self.settled_since.is_none() {
            self.settled_since = Some(tick.index - from);
        }
        if tick.index >= from + (to - from) / 2 {
            self.shown.0 += tick.force_n_m;
            self.shown.1 += e;
        }
    }

    fn hold(&mut self, tick: &Tick, touching: bool) {
        let Some(hold) = self.holds.get_mut(self.current_hold) else {
            return;
        };
        if tick.index >= hold.to {
            self.current_hold += 1;
        } else if tick.index >= hold.from {
            hold.motion.take(tick.angle_rad);
            hold.touched |= touching;
            hold.exits += u32::from(self.touching && !touching);
            hold.at_limit |= tick.force_n_m >= self.terms.force_limit_n_m;
        }
    }

    /// The judgement.
    #[must_use]
    pub fn finish(&self) -> Judgement {
        let held = !self.terms.holds.is_empty();
        let peak_to_peak = self
            .holds
            .iter()
            .filter(|hold| hold.touched)
            .filter_map(|hold| hold.motion.width())
            .reduce(f64::max);
        let verdict = self.verdict(peak_to_peak);
        let shown = self.shown.0 / self.shown.1;
        Judgement {
            verdict,
            // The mean over an oscillation that leaves the wall is no stiffness.
            k_displayed: (held && verdict < Verdict::Unstable && shown.is_finite())
                .then_some(shown),
            k_first_contact: (self.first.1 > 0.0).then(|| self.first.0 / self.first.1),
            limit_cycle_peak_to_peak: peak_to_peak,
            energy_true_min: self.energy_true_min,
            energy_user_min: self.energy_user_min,
            energy_out: self.energy_out(),
            energy_observed_min: self
                .energy_observed_min
                .is_finite()
                .then_some(self.energy_observed_min),
            settle_ticks: if verdict < Verdict::LimitCycle {
                self.settled_since
            } else {
                None
            },
            penetration_max: if self.finite {
                self.penetration_max
            } else {
                f64::INFINITY
            },
            force_max: self.force_max,
            contact_ticks: self.contact_ticks,
        }
    }

    /// What the user's port gave beyond what it had taken, J.
    fn energy_out(&self) -> f64 {
        // Rounding of the two sums, and a millionth of what went through the port.
        let tolerance = 1e-12 + 1e-6 * self.throughput;
        if self.energy_user_min < -tolerance {
            -self.energy_user_min
        } else {
            0.0
        }
    }

    fn verdict(&self, peak_to_peak: Option<f64>) -> Verdict {
        let motion = peak_to_peak.unwrap_or(0.0);
        let lost = self
            .holds
            .iter()
            .any(|hold| hold.exits >= 2 || hold.at_limit);
        let oscillates = motion > self.terms.limit_cycle_rad;
        if !self.finite || (oscillates && lost) || motion > self.terms.unstable_rad {
            Verdict::Unstable
        } else if oscillates {
            Verdict::LimitCycle
        } else if self.energy_out() > 0.0 {
            Verdict::Active
        } else {
            Verdict::Passive
        }
    }
}
