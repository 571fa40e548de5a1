//! Builds the plant (device and hand) of a scene, together with the effects between the motor's torque command and the plant:
//! delay, jitter, and tremor and reflex of the hand.

use super::chain::{
    Channel, Crossing, Delayed, Handled, Irregular, Lateness, PARTS, Prompt, Reflex, Stream, Tremor,
};
use super::mechanics::{Mechanics, Moving};
use crate::error::{Error, Result};
use crate::scene::{self, Scene};
use touchstone_control::ChangeOfForce;
use touchstone_world::plant::{self, Kinematics as _, Stepper};

/// Converts the device of a scene to the device settings of the plant.
#[must_use]
pub fn device(scene: &Scene) -> plant::Device {
    plant::Device {
        inertia: scene.device.inertia_kg_m2,
        damping: scene.device.damping_n_m_s_per_rad,
        friction: scene
            .device
            .friction
            .as_ref()
            .map(|friction| plant::Coulomb {
                kinetic: friction.kinetic_n_m,
                breakaway: friction.static_n_m(),
            }),
    }
}

/// Converts the hand of a scene to the hand settings of the plant; `None` for a scene without a hand.
#[must_use]
pub fn hand(scene: &Scene) -> Option<plant::Hand> {
    scene.operator.hand().map(|hand| plant::Hand {
        inertia: hand.inertia_kg_m2,
        damping: hand.damping_n_m_s_per_rad,
        stiffness: hand.stiffness_n_m_per_rad,
        pad_damping: hand.pad_damping_n_m_s_per_rad,
        pad_stiffness: hand.pad_stiffness_n_m_per_rad,
    })
}

/// Builds the mechanics of a run: a plant with the effects between torque command and plant (delay, jitter, tremor). For a plant
/// without such effects, the simulation loop is compiled with the plant inlined.
pub(super) fn crossed<S>(
    scene: &Scene,
    plant: impl Fn(f64) -> std::result::Result<S, plant::Invalid>,
    state: S::State,
) -> Result<Box<dyn Mechanics>>
where
    S: Stepper<State: 'static> + 'static,
{
    let timing = &scene.timing;
    if timing.computational_delay_s == 0.0 && !is_irregular(scene) && !is_unsteady(scene) {
        let crossing =
            Prompt(plant(timing.period_s()).map_err(|invalid| refused(scene, &invalid))?);
        return Ok(Box::new(Moving { crossing, state }));
    }
    crossed_apart(scene, plant, state)
}

/// Same as [`crossed`], but always calls the plant indirectly, so that one compiled loop serves all plants with the same type of
/// state.
pub(super) fn crossed_apart<S>(
    scene: &Scene,
    plant: impl Fn(f64) -> std::result::Result<S, plant::Invalid>,
    state: S::State,
) -> Result<Box<dyn Mechanics>>
where
    S: Stepper<State: 'static> + 'static,
{
    let timing = &scene.timing;
    let period = timing.period_s();
    let measured = tells_change(scene);
    let built = |interval| plant(interval).map_err(|invalid| refused(scene, &invalid));
    let delay = timing.computational_delay_s;
    let mut crossing: Box<dyn Crossing<State = S::State>> = if is_irregular(scene) {
        let parts = |time_s: f64| (time_s / period * f64::from(PARTS)).round() as u64;
        let lateness = Lateness {
            delay: parts(delay),
            jitter: parts(timing.jitter_s.unwrap_or(0.0)),
            spread: parts(timing.latency_spread_s.unwrap_or(0.0)),
        };
        let streams = [Channel::Jitter, Channel::Latency].map(|channel| stream(scene, channel));
        let irregular = Irregular::new(built, period, lateness, streams)?;
        if measured {
            Box::new(irregular.measured(state.position()))
        } else {
            Box::new(irregular)
        }
    } else if delay == 0.0 {
        Box::new(Prompt(built(period)?))
    } else {
        let whole = (delay / period).floor();
        let fraction = delay - whole * period;
        let delayed = Delayed::new(built(fraction)?, built(period - fraction)?, whole as usize);
        if measured {
            Box::new(delayed.measured(state.position()))
        } else {
            Box::new(delayed)
        }
    };
    // Adds the effects of the hand from the plant outwards.
    if let (Some(reflex), Some(hand)) = (reflex(scene), hand(scene)) {
        let ticks = (reflex.delay_s / period).round() as usize;
        let gain = reflex.muscle_stiffness_n_m_per_rad / hand.stiffness;
        crossing = Handled::before(crossing, Reflex::new(gain, ticks));
    }
    if let Some(tremor) = tremor(scene) {
        let tremor = Tremor {
            amplitude_rad: tremor.amplitude_rad,
            per_tick_rad: std::f64::consts::TAU * tremor.frequency_hz * period,
            tick: 0,
        };
        crossing = Handled::before(crossing, tremor);
    }
    Ok(Box::new(Moving { crossing, state }))
}

/// Largest number of plant steps into which delay or jitter splits one tick (control period), if the command changes once in it.
pub(super) fn parts(scene: &Scene) -> u64 {
    if is_irregular(scene) {
        // Each stretch of constant torque, before and after the change, takes at most one step of each power of two.
        return 2 * u64::from(PARTS.ilog2());
    }
    1 + u64::from(scene.timing.computational_delay_s > 0.0)
}

/// Whether the law needs the angle at which the motor's torque changes, and so gets it from the plant. The scene's guard then
/// measures the change, and the torque does not change at the sample itself.
#[must_use]
pub fn tells_change(scene: &Scene) -> bool {
    let guard = &scene.law.guard;
    let is_late = scene.timing.computational_delay_s > 0.0 || is_irregular(scene);
    guard.on && guard.change == ChangeOfForce::Measured && is_late
}

/// Whether samples or commands come late by a random time (jitter, latency spread).
fn is_irregular(scene: &Scene) -> bool {
    let timing = &scene.timing;
    [timing.jitter_s, timing.latency_spread_s]
        .into_iter()
        .flatten()
        .any(|most| most > 0.0)
}

fn is_unsteady(scene: &Scene) -> bool {
    tremor(scene).is_some() || reflex(scene).is_some()
}

fn tremor(scene: &Scene) -> Option<&scene::HandTremor> {
    let tremor = scene.operator.tremor.as_ref();
    tremor.filter(|tremor| tremor.amplitude_rad > 0.0)
}

fn reflex(scene: &Scene) -> Option<&scene::HandReflex> {
    let reflex = scene.operator.reflex.as_ref();
    reflex.filter(|reflex| reflex.muscle_stiffness_n_m_per_rad > 0.0)
}

/// Converts an error of the plant's settings to an error that names the field of the scene.
pub(super) fn refused(scene: &Scene, invalid: &plant::Invalid) -> Error {
    // The plant's names are for any axis; the scene's names are those of a knob.
    let path = match invalid.field {
        "inertia" => "device.inertia_kg_m2",
        "damping" => "device.damping_n_m_s_per_rad",
        "kinetic" => "device.friction.kinetic_n_m",
        "breakaway" => "device.friction.static_n_m",
        "asymmetry" => "device.friction.asymmetry_n_m",
        "bandwidth_hz" => "device.current_loop.bandwidth_hz",
        "back_emf" => "device.current_loop.back_emf_n_m_s_per_rad",
        "transmission.stiffness" => "device.transmission.spring_n_m_per_rad",
        "transmission.damping" => "device.transmission.damper_n_m_s_per_rad",
        "transmission.gap" => "device.transmission.play_rad",
        "transmission.knob_inertia" => "device.transmission.knob_share",
        "hand.inertia" => "operator.hand.inertia_kg_m2",
        "hand.damping" => "operator.hand.damping_n_m_s_per_rad",
        "hand.stiffness" => "operator.hand.stiffness_n_m_per_rad",
        "hand.pad_damping" => "operator.hand.pad_damping_n_m_s_per_rad",
        "hand.pad_stiffness" => "operator.hand.pad_stiffness_n_m_per_rad",
        _ => "device",
    };
    let problem = match invalid.field {
        "rates" => format!(
            "something of the plant moves {:e} times in a tick",
            invalid.value
        ),
        _ => format!("{} is not usable", invalid.value),
    };
    scene.error(path, problem, format!("give {}", invalid.needs))
}

/// Makes the random-number sequence for one purpose from the scene's seed. Sequences for different purposes are independent.
pub(super) fn stream(scene: &Scene, channel: Channel) -> Stream {
    Stream::new(scene.seed.unwrap_or(1), channel)
}
