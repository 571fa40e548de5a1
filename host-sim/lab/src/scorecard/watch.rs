//! Computes the measures of a scorecard from one run.
//!
//! The force is the motor's true mean force in a tick (control period), after limits, energy guard, amplifier resolution and delay.
//! The penetration is the true one in the middle of the tick, to which that force belongs.

use super::cases::Deed;
use super::measure::{Beside, Figures, Measure};
use super::press::{DesiredStiffness, HELD_AFTER_S, PressFigures};
use touchstone_sim::error::Result;
use touchstone_sim::run::judge::Judge;
use touchstone_sim::run::measure::{ContactRise, DynamicStiffness, RateHardness, Response, Ripple};
use touchstone_sim::run::record::Summary;
use touchstone_sim::run::terms::{Press, Terms};
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_sim::scene::{MotionSpec, Scene};

/// Duration of the last part of a hold, in which the device should rest, s.
const REST_S: f64 = 0.25;
/// Largest distance of the knob from the surface, inside or outside, rad; beyond it the wall counts as lost.
const LOST_RAD: f64 = 3.0;

/// Measures of the scorecard from one run.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Measures that have a limit.
    pub figures: Figures,
    /// Measures that have no limit.
    pub beside: Beside,
    /// Response to an oscillating hand; `None` if the hand did not oscillate, or the knob left the wall.
    pub met: Option<DynamicStiffness>,
}

/// Recorder that computes the scorecard's measures of a run.
#[derive(Debug, Clone)]
struct Watch {
    terms: Terms,
    press: Option<(Press, PressFigures)>,
    rest_from: u64,
    count_rad: f64,
    response: Option<Response>,
    ripple: Option<Ripple>,
    hardness: RateHardness,
    rise: ContactRise,
    judge: Option<Judge>,
    figures: Figures,
    beside: Beside,
    wall_j: f64,
    loss_j: f64,
    rest: (f64, f64),
    lost: bool,
}

impl Watch {
    fn new(scene: &Scene, deed: Deed, fully: bool) -> Self {
        let terms = Terms::of(scene);
        let ticks = |seconds: f64| (seconds / terms.period_s).round() as u64;
        let press = terms.press.filter(|_| deed == Deed::Press);
        let ramp_start = match &scene.operator.motion {
            MotionSpec::TouchAndPress(m) => ticks(m.start_s + m.touch_ramp_s + m.touch_s),
            _ => 0,
        };
        let moving = matches!(deed, Deed::Move(_));
        // Without an encoder no depth is too shallow, and half a count is zero.
        let count_rad = scene
            .encoder
            .as_ref()
            .map_or(0.0, |encoder| encoder.step_rad());
        Self {
            press: press.map(|press| {
                let figures = PressFigures {
                    stiffness: DesiredStiffness {
                        k_desired: terms.k_desired,
                        count: count_rad,
                        unsure: 0.5 * count_rad,
                    },
                    push: press.push_n_m,
                    ramp_start,
                    held_from: press.ramp_end + ticks(HELD_AFTER_S),
                    release: press.release,
                };
                (press, figures)
            }),
            rest_from: press
                .map_or(0, |press| press.release)
                .saturating_sub(ticks(REST_S)),
            count_rad,
            response: terms.wiggle.map(|it| Response::new(it, terms.period_s)),
            ripple: moving.then(|| Ripple::new(terms.ripple, 1.0 / terms.period_s)),
            hardness: RateHardness::new(terms.period_s),
            rise: ContactRise::new(terms.period_s),
            judge: fully.then(|| Judge::new(terms.clone())),
            terms,
            figures: Figures::NONE,
            beside: Beside::default(),
            wall_j: 0.0,
            loss_j: 0.0,
            rest: (f64::INFINITY, f64::NEG_INFINITY),
            lost: false,
        }
    }

    fn pressed(&mut self, press: Press, figures: PressFigures, tick: &Tick, x: f64) {
        let index = tick.index;
        if let Some(depth) = figures.take(&mut self.figures, index, x, tick.motor_force_n_m) {
            self.beside.touch_penetration_ratio = self.beside.touch_penetration_ratio.max(depth);
            return;
        }
        if index < press.release && index >= self.rest_from {
            self.rest.0 = self.rest.0.min(tick.angle_rad);
            self.rest.1 = self.rest.1.max(tick.angle_rad);
        }
    }

    fn finish(self, scene: &Scene) -> (Figures, Beside) {
        let seen = self.seen(scene);
        (seen.figures, seen.beside)
    }

    fn seen(mut self, scene: &Scene) -> Seen {
        if let Some(response) = &self.response {
            self.figures.raise_moved(response, self.terms.k_desired);
        }
        if let Some(ripple) = &self.ripple {
            self.figures.raise_ripple(ripple);
        }
        if self.lost {
            self.figures = Figures::LOST;
        }
        if let Some(judge) = &self.judge {
            let summary = Summary::of(scene, judge);
            let beside = &mut self.beside;
            beside.settle_from_ramp_end_s = summary.settle_from_ramp_end_s;
            beside.release_speed_rad_per_s = summary.release_speed_rad_per_s.unwrap_or(0.0);
            beside.release_excursion_rad = summary.release_excursion_rad.unwrap_or(0.0);
            beside.energy_out_worst_window_j = summary.energy_out_worst_window_j;
        }
        self.beside.rate_hardness = self.hardness.n_m_per_rad();
        self.beside.extended_rate_hardness = self.rise.n_m_per_rad();
        self.beside.touch_torque_n_m = self.rise.torque_n_m();
        if self.press.is_some() && self.count_rad > 0.0 {
            let motion = self.rest.1 - self.rest.0;
            self.beside.motion_at_rest_counts = Some(motion / self.count_rad);
        }
        Seen {
            figures: self.figures,
            beside: self.beside,
            met: self.response.and_then(|response| response.stiffness()),
        }
    }
}

impl Recorder for Watch {
    fn record(&mut self, tick: &Tick) {
        let x = 0.5 * (tick.angle_rad + tick.angle_after_rad) - self.terms.surface_rad;
        if self.lost || x.is_nan() || x.abs() > LOST_RAD {
            self.lost = true;
            return;
        }
        self.wall_j += tick.absorbed_j;
        // Energy stored by the device's springs, gravity and magnets is not lost, but the hand does not have it either.
        self.loss_j += tick.device_loss_j + tick.stored_j;
        let v = tick.velocity_after_rad_per_s;
        // The device starts at rest.
        let hand_j = self.wall_j + self.loss_j + 0.5 * self.terms.inertia_kg_m2 * v * v;
        self.figures.raise(Measure::EnergyOutJ, -hand_j);
        self.beside.energy_out_wall_j = self.beside.energy_out_wall_j.max(-self.wall_j);
        let entered = tick.angle_rad - self.terms.surface_rad;
        let (touches, force) = (self.terms.touches(tick), tick.motor_force_n_m);
        self.hardness
            .record(entered, if touches { force } else { 0.0 });
        self.rise.record(touches, tick.velocity_rad_per_s, force);
        if let Some((press, figures)) = self.press {
            self.pressed(press, figures, tick, x);
        }
        if let Some(response) = &mut self.response {
            response.record(tick.index, x, tick.motor_force_n_m);
        }
        if let Some(ripple) = &mut self.ripple {
            ripple.record(tick.index, tick.motor_force_n_m);
        }
        if let Some(judge) = &mut self.judge {
            judge.record(tick);
        }
    }
}

/// Simulates a scene of a [`super::cases::Programme`]; returns the measures with and without limits. Settling time, speed and
/// distance after the release, and the energy in any window of time are only computed if `fully` is set; otherwise they are
/// absent or 0. The run then takes half as long again.
///
/// # Errors
/// The control law does not accept its settings.
pub fn watch(scene: &Scene, deed: Deed, fully: bool) -> Result<(Figures, Beside)> {
    run::watch(scene, Watch::new(scene, deed, fully)).map(|watch| watch.finish(scene))
}

/// Simulates a scene and computes all measures of the scorecard.
///
/// # Errors
/// The control law does not accept its settings.
pub fn seen(scene: &Scene, deed: Deed) -> Result<Seen> {
    run::watch(scene, Watch::new(scene, deed, true)).map(|watch| watch.seen(scene))
}

/// Computes all measures of a scene from ticks that were recorded elsewhere, such as on a board.
#[must_use]
pub fn seen_of(scene: &Scene, deed: Deed, ticks: &[Tick]) -> Seen {
    let mut watch = Watch::new(scene, deed, true);
    ticks.iter().for_each(|tick| watch.record(tick));
    watch.seen(scene)
}
