//! Runs a scene: `scene -> plan -> loop -> record`.
//!
//! One tick of the loop, in the order in which a sample becomes a torque: [`chain::Sensor`] (encoder), [`wall::Wall`] (the law
//! of the control crate), [`chain::Amplifier`] (limit, steps), [`chain::Crossing`] (delay, plant), then what is recorded.

pub mod chain;
pub mod judge;
pub mod passivity;
pub mod plan;
pub mod record;
pub mod settings;
pub mod verdict;
pub mod wall;

use crate::error::{Error, Result};
use crate::scene::{Motion, Number, Scene};
use chain::{Amplifier, Crossing, Sensor};
use judge::{Judge, Terms, Tick};
use plan::{Prepared, Visitor};
use record::{Run, Summary, Trace};
use touchstone_control::{CountScale, Fixed16, Fixed32, Settings, Si, Warning};
use touchstone_world::plant::{Motion as _, Stepper};
use wall::{Controlled, Wall};

/// A scene's law, ready to be touched.
///
/// # Errors
/// Settings that the law or its number format cannot take, at their place in the scene.
pub fn wall(scene: &Scene) -> Result<Box<dyn Wall>> {
    let settings = settings::settings(scene)?;
    let scale = count_scale(scene)?;
    let boxed =
        match scene.law.number {
            Number::Fixed32 => Controlled::<Fixed32>::new(&settings, scale)
                .map(|wall| Box::new(wall) as Box<dyn Wall>),
            Number::Fixed16 => Controlled::<Fixed16>::new(&settings, scale)
                .map(|wall| Box::new(wall) as Box<dyn Wall>),
            Number::F32 => {
                Controlled::<f32>::new(&settings, scale).map(|wall| Box::new(wall) as Box<dyn Wall>)
            }
            Number::F64 => {
                Controlled::<f64>::new(&settings, scale).map(|wall| Box::new(wall) as Box<dyn Wall>)
            }
        };
    boxed.map_err(|error| settings::refused(scene, &error))
}

fn count_scale(scene: &Scene) -> Result<CountScale> {
    let surface = Si::checked_from_num(scene.wall.surface_rad)
        .ok_or_else(|| scene.error("wall.surface_rad", "too large", "give a value below 2e9"))?;
    // Without an encoder the scale is never read.
    let counts = scene
        .encoder
        .as_ref()
        .map_or(1.0, |encoder| encoder.counts_per_rev);
    let whole = counts as u32;
    (f64::from(whole) == counts)
        .then(|| CountScale::new(whole, surface))
        .flatten()
        .ok_or_else(|| {
            let problem = format!("{counts} is not a whole number of counts");
            scene.error(
                "encoder.counts_per_rev",
                problem,
                "give a whole number from 1 to 4294967295",
            )
        })
}

/// The passivity bounds that the scene's settings leave, each as a one-line message at its place.
///
/// # Errors
/// As [`wall()`].
pub fn warnings(scene: &Scene) -> Result<Vec<(Warning, Error)>> {
    let settings: Settings = settings::settings(scene)?;
    Ok(settings
        .warnings()
        .map(|warning| (warning, settings::warned(scene, &warning)))
        .collect())
}

/// Runs a scene.
///
/// # Errors
/// As [`wall()`], and a plant or recording that the scene describes but that cannot be.
pub fn run(scene: &Scene, with_trace: bool) -> Result<Run> {
    let judge = Judge::new(terms(scene));
    let (judge, trace) = if with_trace {
        let recorder = Traced {
            judge,
            trace: Trace::default(),
            surface_rad: scene.wall.surface_rad,
        };
        let done = watch(scene, recorder)?;
        (done.judge, Some(done.trace))
    } else {
        (watch(scene, judge)?, None)
    };
    Ok(Run {
        summary: summary(scene, &judge),
        trace,
    })
}

/// Runs a scene under any recorder and gives the recorder back.
///
/// # Errors
/// As [`run`].
pub fn watch<R: Recorder>(scene: &Scene, recorder: R) -> Result<R> {
    let mut wall = wall(scene)?;
    plan::prepare(scene, wall.as_mut(), Loop { scene, recorder })
}

/// Largest hold motion that is still called a limit cycle, rad: beyond a quarter radian the wall is lost.
const UNSTABLE_RAD: f64 = 0.25;
/// Counts a revolution that the limit cycle's threshold assumes without an encoder.
const ASSUMED_COUNTS: f64 = 40_000.0;

fn terms(scene: &Scene) -> Terms {
    let rate = f64::from(scene.timing.rate_hz);
    let ticks = scene.timing.ticks();
    let tick = |seconds: f64| ((seconds * rate).round() as u64).min(ticks);
    let step = scene
        .encoder
        .as_ref()
        .map_or(std::f64::consts::TAU / ASSUMED_COUNTS, |encoder| {
            encoder.step_rad()
        });
    let device_limit = scene.device.torque_limit_n_m.unwrap_or(f64::INFINITY);
    Terms {
        surface_rad: scene.wall.surface_rad,
        k_desired: scene.wall.k_desired_n_m_per_rad,
        limit_cycle_rad: 4.0 * step,
        unstable_rad: UNSTABLE_RAD,
        // The law's own limit is met a quantum early: it is rounded towards zero.
        force_limit_n_m: device_limit.min(scene.law.force_limit_n_m) * (1.0 - 1e-3),
        holds: scene
            .operator
            .motion
            .holds_s()
            .into_iter()
            .map(|(from, to)| (tick(from), tick(to)))
            .collect(),
        ticks,
    }
}

fn summary(scene: &Scene, judge: &Judge) -> Summary {
    let judged = judge.finish();
    Summary {
        scene: scene.name.clone(),
        law: scene.law.kind,
        number: scene.law.number.name().to_owned(),
        k_desired: scene.wall.k_desired_n_m_per_rad,
        grip: scene.operator.grip.name().to_owned(),
        encoder_counts_per_rev: scene.encoder.as_ref().map(|encoder| encoder.counts_per_rev),
        rate_hz: scene.timing.rate_hz,
        verdict: judged.verdict,
        k_displayed: judged.k_displayed,
        k_first_contact: judged.k_first_contact,
        limit_cycle_peak_to_peak: judged.limit_cycle_peak_to_peak,
        energy_true_min: judged.energy_true_min,
        energy_user_min: judged.energy_user_min,
        energy_out: judged.energy_out,
        energy_observed_min: judged.energy_observed_min,
        settle_time: judged
            .settle_ticks
            .map(|ticks| ticks as f64 * scene.timing.period_s()),
        penetration_max: judged.penetration_max,
        force_max: judged.force_max,
        ticks: scene.timing.ticks(),
        contact_ticks: judged.contact_ticks,
    }
}

/// What is done with each tick beside simulating it. `()` does nothing, and costs nothing.
pub trait Recorder {
    /// Whether the loss in the device and the law's inside are wanted.
    const WATCHES: bool;
    /// A tick, with the plant's state and the hand's rest point at its sample.
    fn take(
        &mut self,
        tick: &Tick,
        state: &impl touchstone_world::plant::Motion,
        rest_rad: f64,
        time_s: f64,
    );
}

impl Recorder for () {
    const WATCHES: bool = false;
    #[inline(always)]
    fn take(&mut self, _: &Tick, _: &impl touchstone_world::plant::Motion, _: f64, _: f64) {}
}

impl Recorder for Judge {
    const WATCHES: bool = true;
    #[inline]
    fn take(&mut self, tick: &Tick, _: &impl touchstone_world::plant::Motion, _: f64, _: f64) {
        Judge::take(self, tick);
    }
}

/// A judge that also keeps every tick.
#[derive(Debug, Clone)]
struct Traced {
    judge: Judge,
    trace: Trace,
    surface_rad: f64,
}

impl Recorder for Traced {
    const WATCHES: bool = true;
    fn take(
        &mut self,
        tick: &Tick,
        state: &impl touchstone_world::plant::Motion,
        rest_rad: f64,
        time_s: f64,
    ) {
        let trace = &mut self.trace;
        trace.time_s.push(time_s);
        trace.angle_rad.push(state.position());
        trace.velocity_rad_per_s.push(state.velocity());
        trace
            .angle_measured_rad
            .push(tick.told_rad + self.surface_rad);
        trace.hand_rad.push(state.hand_position());
        trace.rest_rad.push(rest_rad);
        trace.force_n_m.push(tick.force_n_m);
        trace.surface_rad.push(self.surface_rad);
        trace
            .surface_shifted_rad
            .push(self.surface_rad - tick.inside.offset_rad);
        trace.mass_rad.push(
            tick.inside
                .mass_rad
                .map_or(state.position(), |mass| mass + self.surface_rad),
        );
        trace.energy_observed_j.push(tick.inside.energy_j);
        // Up to the sample, as the observed energy: what this tick moves comes after it.
        trace.energy_true_j.push(self.judge.energy_true_j());
        trace.energy_device_loss_j.push(self.judge.device_loss_j());
        self.judge.take(tick);
    }
}

/// The loop, as a visitor of the prepared scene; gives its recorder back.
struct Loop<'a, R> {
    scene: &'a Scene,
    recorder: R,
}

impl<R: Recorder> Visitor for Loop<'_, R> {
    type Output = R;

    fn visit<C: Crossing, S: Sensor, A: Amplifier>(
        self,
        prepared: Prepared<C, S, A>,
        wall: &mut dyn Wall,
        motion: &Motion,
    ) -> R {
        let mut recorder = self.recorder;
        let ticks = self.scene.timing.ticks();
        let period_s = self.scene.timing.period_s();
        follow(prepared, wall, motion, ticks, period_s, &mut recorder);
        recorder
    }
}

/// [`cycle`] with the hand's motion. A hand that does not move is not asked where it is.
pub fn follow<C: Crossing, S: Sensor, A: Amplifier, R: Recorder>(
    prepared: Prepared<C, S, A>,
    wall: &mut dyn Wall,
    motion: &Motion,
    ticks: u64,
    period_s: f64,
    recorder: &mut R,
) -> <C::Plant as Stepper>::State {
    match motion.still_rad() {
        Some(rest_rad) => cycle(prepared, wall, |_| rest_rad, ticks, period_s, recorder),
        None => {
            let rest_rad = |time_s| motion.rest_rad(time_s);
            cycle(prepared, wall, rest_rad, ticks, period_s, recorder)
        }
    }
}

/// The loop itself: so many ticks from where `prepared` stands. Time is an integer; nothing drifts.
pub fn cycle<C: Crossing, S: Sensor, A: Amplifier, R: Recorder>(
    prepared: Prepared<C, S, A>,
    wall: &mut dyn Wall,
    rest_rad: impl Fn(f64) -> f64,
    ticks: u64,
    period_s: f64,
    recorder: &mut R,
) -> <C::Plant as Stepper>::State {
    let Prepared {
        mut crossing,
        mut state,
        sensor,
        amplifier,
    } = prepared;
    for index in 0..ticks {
        let time_s = index as f64 * period_s;
        let rest = rest_rad(time_s);
        let angle_rad = state.position();
        let (force, told_rad) = sensor.read(wall, angle_rad);
        // The wall pushes out, along -x.
        let torque = amplifier.torque(-force);
        if R::WATCHES {
            let before = state;
            let flow = crossing.cross_with_loss(&mut state, torque, rest);
            let tick = Tick {
                index,
                angle_rad,
                told_rad,
                force_n_m: force,
                absorbed_j: -flow.motor_j,
                device_loss_j: flow.device_loss_j,
                inside: wall.inside(),
            };
            recorder.take(&tick, &before, rest, time_s);
        } else {
            crossing.cross(&mut state, torque, rest);
        }
    }
    state
}
