//! Judges a run: gathers measures tick by tick (per control period), and derives the verdict, such as passive or unstable.

use super::measure::{
    ContactRise, PeakPenetration, RateHardness, Release, Response, Ripple, Settle, Settled,
    WorstWindow,
};
use super::rest::{Rest, Rested};
use super::terms::Terms;
use super::tick::{Recorder, Tick};
use super::verdict::{NotJudged, Verdict};
use super::wall::InsideGuard;

/// Collects the values of each tick (control period) from which verdict and measures of a run follow.
#[derive(Debug, Clone)]
pub struct Judge {
    pub(super) terms: Terms,
    rest: Rest,
    energy_true: f64,
    loss: f64,
    throughput: f64,
    pub(super) energy_true_min: f64,
    pub(super) energy_user_min: f64,
    pub(super) energy_observed_min: f64,
    /// Sums of force in N·m and penetration in rad over the second half of the last hold. Force over penetration is the displayed
    /// stiffness.
    shown: (f64, f64),
    pub(super) felt: Felt,
    pub(super) guard: Option<GuardWatch>,
    pub(super) beyond_reach_tick: Option<u64>,
    touching: bool,
    pub(super) contact_ticks: u64,
    pub(super) force_max: f64,
    penetration_max: f64,
    finite: bool,
}

/// How often and how far the energy guard reduced the force in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuardWatch {
    /// Lowest value of the energy guard's account, J: energy that the wall may still give.
    pub account_min_j: f64,
    /// Number of ticks in which the energy guard passed less force than the control law requested.
    pub limited_ticks: u64,
    /// Tick from which the energy guard held the force at zero after a shut-down (such as overspeed); `None` if it did not shut
    /// down.
    pub tripped_tick: Option<u64>,
}

impl GuardWatch {
    fn record(seen: &mut Option<Self>, index: u64, guard: &InsideGuard) {
        let watch = seen.get_or_insert(Self {
            account_min_j: f64::INFINITY,
            limited_ticks: 0,
            tripped_tick: None,
        });
        watch.account_min_j = watch.account_min_j.min(guard.account_j);
        watch.limited_ticks += u64::from(guard.limited);
        if guard.tripped {
            watch.tripped_tick.get_or_insert(index);
        }
    }
}

/// Measures of how the wall feels to a hand, such as stiffness, hardness and ripple.
#[derive(Debug, Clone)]
pub(super) struct Felt {
    pub peak: PeakPenetration,
    pub settle: Option<Settle>,
    pub response: Option<Response>,
    pub ripple: Ripple,
    pub release: Option<Release>,
    pub hardness: RateHardness,
    pub rise: ContactRise,
    /// Kinetic energy of the device at the start of the first tick, J; `None` before it.
    kinetic_start_j: Option<f64>,
    /// Energy stored since the start in the device's springs, gravity and magnets, J.
    stored_j: f64,
    pub wall_window: WorstWindow,
    pub hand_window: WorstWindow,
}

impl Felt {
    fn new(terms: &Terms) -> Self {
        let press = terms.press;
        Self {
            peak: PeakPenetration::default(),
            settle: press.map(|press| Settle::new(terms.k_desired, press.ramp_end, press.release)),
            response: terms
                .wiggle
                .map(|wiggle| Response::new(wiggle, terms.period_s)),
            ripple: Ripple::new(terms.ripple, 1.0 / terms.period_s),
            release: press.map(|press| Release::new(press.release)),
            hardness: RateHardness::new(terms.period_s),
            rise: ContactRise::new(terms.period_s),
            kinetic_start_j: None,
            stored_j: 0.0,
            wall_window: WorstWindow::default(),
            hand_window: WorstWindow::default(),
        }
    }

    /// Adds one tick (control period) to the measures. `wall_j` is the energy absorbed by the wall, `loss_j` the energy dissipated
    /// in the device. Both are in J, from the start of the run to the end of the tick.
    fn record(&mut self, tick: &Tick, terms: &Terms, wall_j: f64, loss_j: f64) {
        let e = tick.angle_rad - terms.surface_rad;
        let force = tick.motor_force_n_m;
        // The force is held over the tick, so it belongs to the position in the middle of the tick.
        let middle = 0.5 * (tick.angle_rad + tick.angle_after_rad) - terms.surface_rad;
        self.peak.record(e);
        if let Some(settle) = &mut self.settle {
            settle.record(tick.index, e, force);
        }
        if let Some(response) = &mut self.response {
            response.record(tick.index, middle, force);
        }
        if let Some(release) = &mut self.release {
            release.record(tick.index, e, tick.velocity_rad_per_s);
        }
        self.ripple.record(tick.index, force);
        let touches = terms.touches(tick);
        self.hardness.record(e, if touches { force } else { 0.0 });
        self.rise.record(touches, tick.velocity_rad_per_s, force);
        let kinetic_j = |velocity: f64| 0.5 * terms.inertia_kg_m2 * velocity * velocity;
        let start_j = *self
            .kinetic_start_j
            .get_or_insert(kinetic_j(tick.velocity_rad_per_s));
        self.wall_window.record(wall_j);
        self.stored_j += tick.stored_j;
        // The hand's energy went into the wall, the device's losses, its motion, or its springs, gravity and magnets.
        let moving_j = kinetic_j(tick.velocity_after_rad_per_s) + self.stored_j;
        self.hand_window
            .record(wall_j + loss_j + moving_j - start_j);
    }
}

/// A judged run, from which the table in `summary.rs` takes the measures.
pub(super) struct Judged<'a> {
    /// Verdict on the run, such as passive or unstable.
    pub verdict: Verdict,
    /// Reason why the run could not be judged; `None` if it was judged.
    pub not_judged: Option<NotJudged>,
    /// Largest peak-to-peak motion of the device in the last quarter of a hold, rad.
    pub peak_to_peak: Option<f64>,
    /// The judge that observed the run.
    pub judge: &'a Judge,
}

impl Judged<'_> {
    /// A measure of the wall; `None` without the main wall.
    pub fn of_wall<T>(&self, measure: Option<T>) -> Option<T> {
        measure.filter(|_| self.judge.terms.has_wall)
    }

    /// Displayed stiffness, N·m/rad. Over an oscillation that leaves the wall, mean force over mean penetration is not a stiffness.
    pub fn k_displayed(&self) -> Option<f64> {
        let lost = matches!(self.verdict, Verdict::Unstable | Verdict::NoContact);
        let (force, penetration) = self.judge.shown;
        let shown = force / penetration;
        let held = !self.judge.terms.holds.is_empty();
        self.of_wall(Some(shown))
            .filter(|shown| held && !lost && shown.is_finite())
    }

    /// Time until the press had settled, in ticks; `None` if it did not, or if the verdict is neither passive nor active.
    pub fn settled(&self) -> Option<Settled> {
        self.of_wall(self.judge.felt.settle)
            .filter(|_| self.verdict < Verdict::LimitCycle)
            .and_then(|settle| settle.settled())
    }

    /// Largest penetration of the device into the wall, rad.
    pub fn penetration_max_rad(&self) -> f64 {
        match self.judge.finite {
            true => self
                .of_wall(Some(self.judge.penetration_max))
                .unwrap_or(0.0),
            false => f64::INFINITY,
        }
    }

    /// Length of this number of ticks (control periods), s.
    pub fn seconds(&self, ticks: u64) -> f64 {
        ticks as f64 * self.judge.terms.period_s
    }
}

impl Judge {
    /// Starts to judge a run by the criteria of `terms`.
    #[must_use]
    pub fn new(terms: Terms) -> Self {
        Self {
            felt: Felt::new(&terms),
            rest: Rest::new(&terms),
            terms,
            energy_true: 0.0,
            loss: 0.0,
            throughput: 0.0,
            energy_true_min: 0.0,
            energy_user_min: 0.0,
            energy_observed_min: f64::INFINITY,
            shown: (0.0, 0.0),
            guard: None,
            beyond_reach_tick: None,
            touching: false,
            contact_ticks: 0,
            force_max: 0.0,
            penetration_max: 0.0,
            finite: true,
        }
    }

    /// Energy that the wall has absorbed since the start of the run, J, computed from true positions.
    #[must_use]
    pub fn energy_true_j(&self) -> f64 {
        self.energy_true
    }

    /// Energy dissipated in the device so far, J.
    #[must_use]
    pub fn device_loss_j(&self) -> f64 {
        self.loss
    }

    fn press(&mut self, tick: &Tick, e: f64) {
        let Some(&(from, to)) = self.terms.holds.last() else {
            return;
        };
        if tick.index >= from + (to - from) / 2 && tick.index < to {
            self.shown.0 += tick.force_n_m;
            self.shown.1 += e;
        }
    }

    /// Judges all ticks so far.
    pub(super) fn judged(&self) -> Judged<'_> {
        let rested = self.rest.finish(&self.terms);
        let verdict = self.verdict(&rested);
        Judged {
            verdict,
            not_judged: rested.not_judged.filter(|_| verdict == Verdict::NotJudged),
            peak_to_peak: rested.peak_to_peak,
            judge: self,
        }
    }

    /// Most energy that the user got out beyond what was put in, J.
    pub(super) fn energy_out(&self) -> f64 {
        // Tolerance for the rounding of the two sums: a millionth of the exchanged energy.
        let tolerance = 1e-12 + 1e-6 * self.throughput;
        if self.energy_user_min < -tolerance {
            -self.energy_user_min
        } else {
            0.0
        }
    }

    fn verdict(&self, rested: &Rested) -> Verdict {
        if !self.finite || rested.lost {
            Verdict::Unstable
        } else if self.contact_ticks == 0 {
            Verdict::NoContact
        } else if rested.oscillates {
            Verdict::LimitCycle
        } else if rested.not_judged.is_some() {
            Verdict::NotJudged
        } else if self.energy_out() > 0.0 {
            Verdict::Active
        } else {
            Verdict::Passive
        }
    }
}

impl Recorder for Judge {
    fn record(&mut self, tick: &Tick) {
        let e = tick.angle_rad - self.terms.surface_rad;
        let force = tick.force_n_m;
        let touching = force != 0.0;
        self.finite &= tick.angle_rad.is_finite();
        self.contact_ticks += u64::from(touching);
        // The lower end stop pushes with a negative force.
        self.force_max = self.force_max.max(force.abs());
        self.penetration_max = self.penetration_max.max(e);
        self.energy_true += tick.absorbed_j;
        self.throughput += tick.absorbed_j.abs();
        self.loss += tick.device_loss_j;
        self.energy_true_min = self.energy_true_min.min(self.energy_true);
        self.energy_user_min = self.energy_user_min.min(self.energy_true + self.loss);
        // `min` ignores NaN, which stands for a law without an observer.
        self.energy_observed_min = self.energy_observed_min.min(tick.inside.energy_j);
        if let Some(guard) = &tick.inside.guard {
            GuardWatch::record(&mut self.guard, tick.index, guard);
        }
        if tick.inside.beyond_reach {
            self.beyond_reach_tick.get_or_insert(tick.index);
        }
        self.press(tick, e);
        // The force is also 0 in the middle of a detent, where there is no wall to leave.
        let left = self.terms.has_wall && self.touching && !touching;
        self.rest.record(tick, left, &self.terms);
        self.felt
            .record(tick, &self.terms, self.energy_true, self.loss);
        self.touching = touching;
    }
}
