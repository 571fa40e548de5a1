//! Scene to plan: the law's side with the effects that the scene names, and the mechanics with theirs.
//!
//! An effect that the scene does not name is not a branch that is never taken: it is not there.

use super::chain::{
    Channel, Control, Counts, Crossing, CurrentError, Delayed, Eccentric, ExactAngle, Handled,
    Irregular, Lateness, Limited, Lossy, Noisy, PARTS, Prompt, Reflex, Sampled, Staged, Stepped,
    Stream, Tremor,
};
use super::mechanics::{Mechanics, Moving, Standing};
use super::settings;
use super::train::Train;
use super::wall::Controlled;
use crate::error::{Error, Result};
use crate::scene::{self, Integrator, Number, RestPath, Scene};
use touchstone_control::{ChangeOfForce, CountScale, Fixed16, Fixed32, Reported, Si};
use touchstone_world::integrator::{
    ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4, SemiImplicitEuler, Substepped,
};
use touchstone_world::plant::{
    self, BareCoulomb, BareLinear, Biased, HeldCoulomb, HeldLinear, Kinematics as _, State, Stepper,
};

/// A scene, ready to run.
pub struct Plan {
    /// From the true angle to the motor's torque.
    pub control: Box<dyn Control>,
    /// Device and hand, at their start.
    pub mechanics: Box<dyn Mechanics>,
    /// The hand's rest point over time.
    pub motion: RestPath,
}

impl Plan {
    /// Plans a scene.
    ///
    /// # Errors
    /// Settings that the law or its number format cannot take; a recording that cannot be read; a plant that cannot be built.
    pub fn of(scene: &Scene) -> Result<Self> {
        let control = control(scene)?;
        let motion = RestPath::from_scene(scene)?;
        Ok(Self {
            control,
            mechanics: mechanics(scene, start(scene, &motion))?,
            motion,
        })
    }
}

/// The law's side of a scene: from the true angle to the motor's torque.
///
/// # Errors
/// Settings that the law or its number format cannot take, at their place in the scene.
pub fn control(scene: &Scene) -> Result<Box<dyn Control>> {
    let mut control = match scene.law.number {
        Number::Fixed32 => sampled::<Fixed32>(scene),
        Number::Fixed16 => sampled::<Fixed16>(scene),
        Number::F32 => sampled::<f32>(scene),
        Number::F64 => sampled::<f64>(scene),
    }?;
    // From the law outwards, a line an effect.
    if let Some(limit_n_m) = scene.device.torque_limit_n_m {
        control = Staged::around(control, Limited { limit_n_m });
    }
    if let Some(step_n_m) = scene.device.amplifier_step_n_m {
        control = Staged::around(control, Stepped { step_n_m });
    }
    if let Some(sensor) = &scene.device.current_sensor
        && (sensor.noise_rms_n_m > 0.0 || sensor.step_n_m > 0.0)
    {
        let error = CurrentError {
            rms_n_m: sensor.noise_rms_n_m,
            step_n_m: sensor.step_n_m,
            stream: stream(scene, Channel::Current),
        };
        control = Staged::around(control, error);
    }
    if let Some(noise) = scene.sensor.noise.as_ref().filter(|it| it.rms_rad > 0.0) {
        let noisy = Noisy {
            rms_rad: noise.rms_rad,
            stream: stream(scene, Channel::Sensor),
        };
        control = Staged::around(control, noisy);
    }
    let periodic = scene.sensor.periodic.as_ref();
    if let Some(error) = periodic.filter(|it| it.amplitude_rad > 0.0) {
        let eccentric = Eccentric {
            amplitude_rad: error.amplitude_rad,
            per_rev: f64::from(error.periods_per_rev),
            phase_rad: error.phase_rad,
        };
        control = Staged::around(control, eccentric);
    }
    if let Some(share) = scene.timing.lost_share.filter(|share| *share > 0.0) {
        control = Lossy::around(control, share, stream(scene, Channel::Lost));
    }
    Ok(control)
}

/// The random numbers of a scene for a purpose.
fn stream(scene: &Scene, channel: Channel) -> Stream {
    Stream::new(scene.seed.unwrap_or(1), channel)
}

/// The law with what tells it the angle.
fn sampled<N: Reported + 'static>(scene: &Scene) -> Result<Box<dyn Control>> {
    let settings = scene.settings()?;
    let wall = Controlled::<N>::new(&settings, count_scale(scene)?)
        .map_err(|error| settings::refused(scene, &error))?;
    let surface_rad = scene.wall.surface_rad;
    Ok(match &scene.encoder {
        None => Box::new(Sampled {
            sensor: ExactAngle { surface_rad },
            wall,
        }),
        Some(encoder) => {
            let step_rad = encoder.step_rad();
            let sensor = Counts {
                per_rad: 1.0 / step_rad,
                step_rad,
                surface_rad,
            };
            Box::new(Sampled { sensor, wall })
        }
    })
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

/// Device of a scene, for the plant.
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

/// Hand of a scene, for the plant.
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

/// Where device and hand of a scene start.
#[must_use]
pub fn start(scene: &Scene, motion: &RestPath) -> Standing {
    Standing::together(
        scene.start_rad(motion),
        scene.device.initial_velocity_rad_per_s,
    )
}

/// Device and hand of a scene, from where they are.
///
/// # Errors
/// A plant that cannot be built, at its place in the scene.
pub fn mechanics(scene: &Scene, from: Standing) -> Result<Box<dyn Mechanics>> {
    if let Some(train) = Train::of(scene) {
        return train.mechanics(scene, from);
    }
    let device = device(scene);
    let (angle_rad, velocity) = (from.angle_rad, from.velocity_rad_per_s);
    let bare = State::from_array([angle_rad, velocity]);
    let held = State::from_array([
        angle_rad,
        velocity,
        from.hand_rad,
        from.hand_velocity_rad_per_s,
    ]);
    if let Some(method) = scene
        .plant
        .as_ref()
        .filter(|plant| plant.integrator != Integrator::Exact)
    {
        if asymmetry(scene).is_some() {
            return Err(scene.error(
                "plant.integrator",
                "no integrator knows friction that differs by direction",
                "leave device.friction.asymmetry_n_m out, or give plant.integrator = \"exact\"",
            ));
        }
        let refused = |invalid| refused(scene, &invalid);
        return match hand(scene) {
            None => {
                let model = Model::bare(&device).map_err(refused)?;
                stepped(scene, method, &model, bare)
            }
            Some(hand) => {
                let model = Model::held(&device, &hand).map_err(refused)?;
                stepped(scene, method, &model, held)
            }
        };
    }
    if let (Some(bias), Some(friction)) = (asymmetry(scene), device.friction) {
        let kinetic = friction.kinetic;
        return match hand(scene) {
            None => {
                let plant = |h| Biased::new(BareCoulomb::new(&device, h)?, kinetic, bias);
                crossed_apart(scene, plant, bare)
            }
            Some(hand) => {
                let plant = |h| Biased::new(HeldCoulomb::new(&device, &hand, h)?, kinetic, bias);
                crossed_apart(scene, plant, held)
            }
        };
    }
    match (hand(scene), device.friction.is_some()) {
        (None, false) => crossed(scene, |h| BareLinear::new(&device, h), bare),
        (None, true) => crossed(scene, |h| BareCoulomb::new(&device, h), bare),
        (Some(hand), false) => crossed(scene, |h| HeldLinear::new(&device, &hand, h), held),
        (Some(hand), true) => crossed(scene, |h| HeldCoulomb::new(&device, &hand, h), held),
    }
}

/// Asymmetry of the dry friction, N·m, where it has any.
fn asymmetry(scene: &Scene) -> Option<f64> {
    let friction = scene.device.friction.as_ref()?;
    friction.asymmetry_n_m.filter(|bias| *bias != 0.0)
}

/// A plant that a method steps over, in the place of the exact one.
fn stepped<const N: usize>(
    scene: &Scene,
    plant: &scene::Plant,
    model: &Model<N>,
    state: State<N>,
) -> Result<Box<dyn Mechanics>> {
    match plant.integrator {
        Integrator::SemiImplicitEuler => by::<SemiImplicitEuler<N>, N>(scene, plant, model, state),
        Integrator::ImplicitMidpoint => by::<ImplicitMidpoint<N>, N>(scene, plant, model, state),
        Integrator::RungeKutta4 => by::<RungeKutta4<N>, N>(scene, plant, model, state),
        Integrator::ImplicitEuler | Integrator::Exact => {
            by::<ImplicitEuler<N>, N>(scene, plant, model, state)
        }
    }
}

fn by<M: Method<N> + 'static, const N: usize>(
    scene: &Scene,
    plant: &scene::Plant,
    model: &Model<N>,
    state: State<N>,
) -> Result<Box<dyn Mechanics>> {
    // The parts of a delayed tick share its substeps by their lengths.
    let per_s = f64::from(plant.substeps) / scene.timing.period_s();
    let substeps = |interval_s: f64| (interval_s * per_s).round().max(1.0) as u32;
    crossed(
        scene,
        |h| Substepped::<M, N>::new(model, h, substeps(h)),
        state,
    )
}

/// A plant with what lies between it and the torque. Without anything the loop is compiled for the plant.
fn crossed<S>(
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

/// The same, reached by an indirect call in any case: one loop for all plants of one kind of state.
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
    let guard = &scene.law.guard;
    let measured = guard.on && guard.change == ChangeOfForce::Measured;
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
    // From the plant outwards.
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

/// Whether ticks or commands come late by chance.
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

/// A plant's refusal, at its place in the scene.
fn refused(scene: &Scene, invalid: &plant::Invalid) -> Error {
    // The plant speaks of positions and forces of any kind, the scene of angles and torques.
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
    scene.error(
        path,
        format!("{} is not usable", invalid.value),
        format!("give {}", invalid.needs),
    )
}
