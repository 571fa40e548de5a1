//! Runs a scene: `scene -> plan -> loop -> record`.
//!
//! One tick (control period) turns a position sample into a torque: [`chain::Sensor`] (encoder), [`wall::Wall`] (control law),
//! [`chain::Stage`] (torque limit and resolution), [`chain::Crossing`] (delay and plant). Then the tick is recorded.

pub mod chain;
mod crossed;
pub mod effects;
mod guard_mismatch;
pub mod judge;
pub mod live;
pub mod measure;
pub mod mechanics;
pub mod passivity;
pub mod plan;
pub mod plant_half;
pub mod record;
mod rest;
pub mod settings;
pub mod summary;
pub mod surroundings;
pub mod terms;
pub mod tick;
mod traced;
pub mod train;
pub mod verdict;
pub mod wall;
pub mod work;

use crate::error::{Error, Result};
use crate::scene::Scene;
use chain::{Control, Crossing};
use judge::Judge;
use plan::Plan;
use record::{Run, Summary};
use std::ops::Range;
use terms::Terms;
use touchstone_control::{Settings, Warning};
use touchstone_world::plant::Kinematics as _;
use traced::Traced;
use work::Work;

pub use tick::{Recorder, Tick};

/// The control loop without a recorder: simulates the given ticks (control periods) from the present state of the plant, and
/// returns the state at their end. Time is an integer number of ticks, so it does not drift.
// Inlined, the state stays in registers; behind a call it would be written back in every tick.
#[inline(always)]
pub fn cycle<C: Crossing>(
    crossing: &mut C,
    mut state: C::State,
    control: &mut dyn Control,
    rest_rad: impl Fn(f64) -> f64,
    ticks: Range<u64>,
    period_s: f64,
) -> C::State {
    for index in ticks {
        let rest = rest_rad(index as f64 * period_s);
        let torque = control.torque_n_m(state.position());
        crossing.cross(&mut state, torque, rest);
        if let Some(angle) = crossing.changed_at_rad() {
            control.changed_at(angle);
        }
    }
    state
}

/// The control loop with a recorder. It computes the same as [`cycle`], bit for bit.
pub fn cycle_recorded<C: Crossing>(
    crossing: &mut C,
    mut state: C::State,
    control: &mut dyn Control,
    rest_rad: impl Fn(f64) -> f64,
    ticks: Range<u64>,
    period_s: f64,
    recorder: &mut dyn Recorder,
) -> C::State {
    for index in ticks {
        let time_s = index as f64 * period_s;
        let rest = rest_rad(time_s);
        let before = state;
        let answer = control.answer(before.position());
        let flow = crossing.cross_with_flow(&mut state, answer.torque_n_m, rest);
        if let Some(angle) = crossing.changed_at_rad() {
            control.changed_at(angle);
        }
        recorder.record(&Tick {
            index,
            time_s,
            angle_rad: before.position(),
            velocity_rad_per_s: before.velocity(),
            angle_after_rad: state.position(),
            velocity_after_rad_per_s: state.velocity(),
            hand_rad: before.hand_position(),
            rest_rad: rest,
            told_rad: answer.told_rad,
            force_n_m: answer.force_n_m,
            motor_force_n_m: -flow.torque_n_m,
            absorbed_j: -flow.motor_j,
            device_loss_j: flow.device_loss_j,
            stored_j: flow.stored_j,
            inside: answer.inside,
        });
    }
    state
}

/// Runs a scene and returns its measures, with a trace of all ticks (control periods) if `with_trace`.
///
/// # Errors
/// Settings that the law or its number format cannot represent, named by their field of the scene; a plant or recording that cannot
/// be built or read.
pub fn run(scene: &Scene, with_trace: bool) -> Result<Run> {
    let judge = Judge::new(Terms::of(scene));
    let (judge, trace) = if with_trace {
        watch(scene, Traced::of(scene, judge)?)?.into_parts()
    } else {
        (watch(scene, judge)?, None)
    };
    Ok(run_of(scene, &judge, trace))
}

/// Same as [`run()`], with progress: calls `done` with the number of finished ticks every 1,024 ticks.
///
/// # Errors
/// Same as [`run()`].
pub fn run_told(scene: &Scene, with_trace: bool, done: &mut dyn FnMut(u64)) -> Result<Run> {
    let judge = Judge::new(Terms::of(scene));
    let (judge, trace) = if with_trace {
        let inner = Traced::of(scene, judge)?;
        watch(scene, tick::WithProgress { inner, done })?
            .inner
            .into_parts()
    } else {
        (
            watch(scene, tick::WithProgress { inner: judge, done })?.inner,
            None,
        )
    };
    Ok(run_of(scene, &judge, trace))
}

fn run_of(scene: &Scene, judge: &Judge, trace: Option<record::Trace>) -> Run {
    Run {
        summary: Summary::of(scene, judge),
        trace,
    }
}

/// Runs a scene, passes every tick (control period) to the recorder, and returns the recorder.
///
/// # Errors
/// Same as [`run()`].
pub fn watch<R: Recorder>(scene: &Scene, mut recorder: R) -> Result<R> {
    simulate(scene, Some(&mut recorder))?;
    Ok(recorder)
}

/// Runs a scene, with or without a recorder. Without a recorder, values that only a recorder needs are not computed.
///
/// # Errors
/// Same as [`run()`].
pub fn simulate(scene: &Scene, recorder: Option<&mut dyn Recorder>) -> Result<()> {
    Work::of(scene).check(scene)?;
    let mut plan = Plan::of(scene)?;
    plan.mechanics.advance(
        plan.control.as_mut(),
        &plan.motion,
        0..scene.timing.ticks(),
        scene.timing.period_s(),
        recorder,
    );
    Ok(())
}

/// Returns a warning for each passivity bound that the scene's settings violate, with a one-line message that names the field.
///
/// # Errors
/// Settings that the control crate cannot represent, named by their field of the scene.
pub fn warnings(scene: &Scene) -> Result<Vec<(Warning, Error)>> {
    let settings: Settings = scene.settings()?;
    Ok(settings
        .warnings()
        .map(|warning| (warning, settings::warned(scene, &warning)))
        .collect())
}

/// Returns the warnings that are printed without `--strict-passive`: most of [`warnings`], and one if the energy guard is
/// configured for a smaller sensor error than the sensor has. Left out are bounds that the energy guard covers, and the warning
/// about the law's energy credit per contact, which is a documented default. Results files contain all of [`warnings`].
///
/// # Errors
/// Same as [`warnings`].
pub fn spoken_warnings(scene: &Scene) -> Result<Vec<Error>> {
    let guarded = scene.law.guard.on;
    let silent = |warning: &Warning| {
        guarded && warning.is_answered_by_guard() || matches!(warning, Warning::EnergyCredit { .. })
    };
    let of_settings = warnings(scene)?
        .into_iter()
        .filter(|(warning, _)| !silent(warning))
        .map(|(_, message)| message);
    Ok(of_settings.chain(guard_mismatch::warnings(scene)).collect())
}
