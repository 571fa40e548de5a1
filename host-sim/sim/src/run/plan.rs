//! Scene to plan: the law's side with the effects that the scene names, and the mechanics with theirs.
//!
//! An effect that the scene does not name is not a branch that is never taken: it is not there.

use super::chain::{
    Control, Counts, Crossing, Delayed, ExactAngle, Limited, Prompt, Sampled, Staged, Stepped,
};
use super::mechanics::{Mechanics, Moving, Standing};
use super::settings;
use super::wall::Controlled;
use crate::error::{Error, Result};
use crate::scene::{self, Integrator, Number, RestPath, Scene};
use touchstone_control::{ChangeOfForce, CountScale, Fixed16, Fixed32, Reported, Si};
use touchstone_world::integrator::{
    ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4, SemiImplicitEuler, Substepped,
};
use touchstone_world::plant::{
    self, BareCoulomb, BareLinear, HeldCoulomb, HeldLinear, Kinematics as _, State, Stepper,
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
    Ok(control)
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
    match (hand(scene), device.friction.is_some()) {
        (None, false) => crossed(scene, |h| BareLinear::new(&device, h), bare),
        (None, true) => crossed(scene, |h| BareCoulomb::new(&device, h), bare),
        (Some(hand), false) => crossed(scene, |h| HeldLinear::new(&device, &hand, h), held),
        (Some(hand), true) => crossed(scene, |h| HeldCoulomb::new(&device, &hand, h), held),
    }
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

/// A plant with what lies between it and the torque.
fn crossed<S>(
    scene: &Scene,
    plant: impl Fn(f64) -> std::result::Result<S, plant::Invalid>,
    state: S::State,
) -> Result<Box<dyn Mechanics>>
where
    S: Stepper<State: 'static> + 'static,
{
    let period = scene.timing.period_s();
    let delay = scene.timing.computational_delay_s;
    let built = |interval| plant(interval).map_err(|invalid| refused(scene, &invalid));
    if delay == 0.0 {
        let crossing = Prompt(built(period)?);
        return Ok(Box::new(Moving { crossing, state }));
    }
    let whole = (delay / period).floor();
    let fraction = delay - whole * period;
    let delayed = Delayed::new(built(fraction)?, built(period - fraction)?, whole as usize);
    let guard = &scene.law.guard;
    let measured = guard.on && guard.change == ChangeOfForce::Measured;
    let crossing: Box<dyn Crossing<State = S::State>> = Box::new(if measured {
        delayed.measured(state.position())
    } else {
        delayed
    });
    Ok(Box::new(Moving { crossing, state }))
}

/// A plant's refusal, at its place in the scene.
fn refused(scene: &Scene, invalid: &plant::Invalid) -> Error {
    // The plant speaks of positions and forces of any kind, the scene of angles and torques.
    let path = match invalid.field {
        "inertia" => "device.inertia_kg_m2",
        "damping" => "device.damping_n_m_s_per_rad",
        "kinetic" => "device.friction.kinetic_n_m",
        "breakaway" => "device.friction.static_n_m",
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
