//! Judges a run: gathers measures tick by tick (per control period), and derives the verdict, such as passive or unstable.

use super::measure::{
    ContactRise, DynamicStiffness, PeakPenetration, RateHardness, Release, Response, Ripple,
    Settle, Settled, WorstWindow,
};
use super::rest::{Rest, Rested};
use super::terms::Terms;
use super::tick::{Recorder, Tick};
use super::verdict::{NotJudged, Verdict};
use super::wall::InsideGuard;

/// Collects the values of each tick (control period) from which verdict and measures of a run follow.
#[derive(Debug, Clone)]
pub struct Judge {
    terms: Terms,
    rest: Rest,
    energy_true: f64,
    loss: f64,
    throughput: f64,
    energy_true_min: f64,
    energy_user_min: f64,
    energy_observed_min: f64,
    /// Sums of force in N·m and penetration in rad over the second half of the last hold. Force over penetration is the displayed
    /// stiffness.
    shown: (f64, f64),
    felt: Felt,
    guard: Option<GuardWatch>,
    beyond_reach_tick: Option<u64>,
    touching: bool,
    contact_ticks: u64,
    force_max: f64,
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
struct Felt {
    peak: PeakPenetration,
    settle: Option<Settle>,
    response: Option<Response>,
    ripple: Ripple,
    release: Option<Release>,
    hardness: RateHardness,
    rise: ContactRise,
    /// Kinetic energy of the device at the start of the first tick, J; `None` before it.
    kinetic_start_j: Option<f64>,
    /// Energy stored since the start in the device's springs, gravity and magnets, J.
    stored_j: f64,
    wall_window: WorstWindow,
    hand_window: WorstWindow,
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

/// Verdict and measures of a whole run. A measure is `None` if the run has nothing to measure, such as no main wall or no hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Verdict on the run, such as passive or unstable.
    pub verdict: Verdict,
    /// Reason why the run could not be judged; `None` if it was judged.
    pub not_judged: Option<NotJudged>,
    /// Displayed stiffness: mean force over mean penetration in the second half of the last hold, N·m/rad. `None` without a hold or
    /// the main wall, or if the verdict is unstable or no-contact.
    pub k_displayed: Option<f64>,
    /// Rate-hardness of the first contact, N·m/rad: slope of the force over the penetration, fitted to at most 20 ms.
    pub rate_hardness: Option<f64>,
    /// Extended rate-hardness of the first contact, N·m/rad: largest rise of the force within 1 ms, divided by that time and by the
    /// largest speed.
    pub extended_rate_hardness: Option<f64>,
    /// Largest motor torque in the first 5 ms of the first contact, N·m.
    pub touch_torque_n_m: Option<f64>,
    /// Deepest penetration divided by that of an ideal spring, `F/k_de`, under the push `F`. `k_de` is the requested stiffness; 1
    /// is ideal.
    pub peak_penetration_ratio: Option<f64>,
    /// Dynamic stiffness, the ratio of force to penetration, while the hand moves rhythmically inside the wall.
    pub dynamic_stiffness: Option<DynamicStiffness>,
    /// Ripple of the motor's torque from tick to tick, rms, N·m.
    pub ripple_rms_n_m: Option<f64>,
    /// Ripple of the motor's torque above 50 Hz, rms, N·m.
    pub ripple_above_50_hz_rms_n_m: Option<f64>,
    /// Largest outward speed after the hand begins to let go, rad/s.
    pub release_speed_rad_per_s: Option<f64>,
    /// Largest distance of the device outside the wall's surface after the hand begins to let go, rad.
    pub release_excursion_rad: Option<f64>,
    /// Largest peak-to-peak motion of the device in the last quarter of a hold, rad.
    pub limit_cycle_peak_to_peak: Option<f64>,
    /// Lowest energy that the wall has absorbed since the start, J, computed from true positions. It is negative if at some time
    /// the wall had given the device more energy than it had absorbed.
    pub energy_true_min: f64,
    /// Lowest energy that the user has put in since the start, J: the wall's absorbed energy plus the device's dissipation.
    pub energy_user_min: f64,
    /// Most energy that the user got out beyond what was put in, J; 0 if the difference is within the rounding of the sums.
    pub energy_out: f64,
    /// Lowest energy that the passivity observer of the control law reported, J; `None` for a law without an observer.
    pub energy_observed_min: Option<f64>,
    /// Most energy that the hand got out of the device in any window of time, J. The window may start at any tick.
    pub energy_out_worst_window_j: f64,
    /// Most energy that the wall gave out in any window of time, J. The window may start at any tick.
    pub energy_out_wall_worst_window_j: f64,
    /// Interventions of the energy guard; `None` for a scene without a guard.
    pub guard: Option<GuardWatch>,
    /// First tick in which a wall was off, because the device was deeper inside it than the number format of positions reaches.
    pub beyond_reach_tick: Option<u64>,
    /// Time until the press had settled, in ticks; `None` if it did not, or if the verdict is neither passive nor active.
    pub settled: Option<Settled>,
    /// Largest penetration of the device into the wall, rad.
    pub penetration_max: f64,
    /// Largest absolute force of the control law, N·m.
    pub force_max: f64,
    /// Number of ticks (control periods) in which the control law gave a force.
    pub contact_ticks: u64,
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

    /// Returns verdict and measures of all ticks so far.
    #[must_use]
    pub fn finish(&self) -> Judgement {
        let held = !self.terms.holds.is_empty();
        let rested = self.rest.finish(&self.terms);
        let verdict = self.verdict(&rested);
        let shown = self.shown.0 / self.shown.1;
        let felt = &self.felt;
        let has_wall = self.terms.has_wall;
        Judgement {
            verdict,
            not_judged: rested.not_judged.filter(|_| verdict == Verdict::NotJudged),
            // Over an oscillation that leaves the wall, mean force over mean penetration is not a stiffness.
            k_displayed: (held
                && has_wall
                && !matches!(verdict, Verdict::Unstable | Verdict::NoContact)
                && shown.is_finite())
            .then_some(shown),
            rate_hardness: felt.hardness.n_m_per_rad().filter(|_| has_wall),
            extended_rate_hardness: felt.rise.n_m_per_rad().filter(|_| has_wall),
            touch_torque_n_m: felt.rise.torque_n_m().filter(|_| has_wall),
            peak_penetration_ratio: self
                .terms
                .press
                .filter(|_| has_wall)
                .map(|press| felt.peak.ratio(press.push_n_m, self.terms.k_desired)),
            dynamic_stiffness: felt.response.and_then(|response| response.stiffness()),
            ripple_rms_n_m: felt.ripple.tick_to_tick_rms_n_m(),
            ripple_above_50_hz_rms_n_m: felt.ripple.above_50_hz_rms_n_m(),
            release_speed_rad_per_s: felt.release.map(|release| release.speed_rad_per_s()),
            // The excursion is measured from the wall's surface, so it needs the main wall.
            release_excursion_rad: felt
                .release
                .filter(|_| has_wall)
                .map(|release| release.excursion_rad()),
            limit_cycle_peak_to_peak: rested.peak_to_peak,
            energy_true_min: self.energy_true_min,
            energy_user_min: self.energy_user_min,
            energy_out: self.energy_out(),
            energy_observed_min: self
                .energy_observed_min
                .is_finite()
                .then_some(self.energy_observed_min),
            energy_out_worst_window_j: felt.hand_window.worst_j(),
            energy_out_wall_worst_window_j: felt.wall_window.worst_j(),
            guard: self.guard,
            beyond_reach_tick: self.beyond_reach_tick,
            settled: if verdict < Verdict::LimitCycle && has_wall {
                felt.settle.and_then(|settle| settle.settled())
            } else {
                None
            },
            penetration_max: if self.finite {
                if has_wall { self.penetration_max } else { 0.0 }
            } else {
                f64::INFINITY
            },
            force_max: self.force_max,
            contact_ticks: self.contact_ticks,
        }
    }

    /// Most energy that the user got out beyond what was put in, J.
    fn energy_out(&self) -> f64 {
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
