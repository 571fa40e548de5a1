//! Builds a runnable plan from a scene: the controller side and the mechanics, each with the effects that the scene names.
//!
//! An effect that the scene does not name is not built, so it costs no branch in the loop.

use super::chain::{
    Channel, Control, Counts, CurrentError, Eccentric, ExactAngle, Limited, Lossy, Noisy, Sampled,
    Staged, Stepped,
};
use super::crossed::{crossed, crossed_apart, refused, stream};
pub use super::crossed::{device, hand, tells_change};
use super::mechanics::{Mechanics, Standing};
use super::settings;
use super::surroundings::{Surroundings, surrounded};
use super::train::Train;
use super::wall::Controlled;
use crate::error::Result;
use crate::scene::{self, Integrator, Number, RestPath, Scene};
use touchstone_control::{CountScale, Fixed16, Fixed32, Reported, Si};
use touchstone_world::integrator::{
    ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4, SemiImplicitEuler, Substepped,
};
use touchstone_world::plant::{BareCoulomb, BareLinear, Biased, HeldCoulomb, HeldLinear, State};

/// A scene that is ready to run.
pub struct Plan {
    /// The controller side: computes the motor's torque from the device's true angle.
    pub control: Box<dyn Control>,
    /// Device and hand in their initial state.
    pub mechanics: Box<dyn Mechanics>,
    /// The hand's rest point over time.
    pub motion: RestPath,
}

impl Plan {
    /// Builds the plan of a scene.
    ///
    /// # Errors
    /// Settings that the law or its number format cannot represent; a recording that cannot be read; a plant that cannot be built.
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

/// Builds the controller side of a scene: sensor, control law, effects on torque and angle, and lost ticks.
///
/// # Errors
/// Settings that the law or its number format cannot represent, named by their field of the scene.
pub fn control(scene: &Scene) -> Result<Box<dyn Control>> {
    let mut control = match scene.law.number {
        Number::Fixed32 => sampled::<Fixed32>(scene),
        Number::Fixed16 => sampled::<Fixed16>(scene),
        Number::F32 => sampled::<f32>(scene),
        Number::F64 => sampled::<f64>(scene),
    }?;
    // Adds the effects from the control law outwards: first on the torque, then on the angle, then lost ticks.
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
    if let Some(error) = periodic
        && (error.amplitude_rad > 0.0 || error.second_amplitude_rad > 0.0)
    {
        let second = (error.second_amplitude_rad, error.second_phase_rad);
        let eccentric = Eccentric {
            amplitude_rad: error.amplitude_rad,
            per_rev: f64::from(error.periods_per_rev),
            phase_rad: error.phase_rad,
            second: (second.0 > 0.0).then_some(second),
        };
        control = Staged::around(control, eccentric);
    }
    if let Some(share) = scene.timing.lost_share.filter(|share| *share > 0.0) {
        control = Lossy::around(control, share, stream(scene, Channel::Lost));
    }
    Ok(control)
}

/// Builds the control law in the number format `N`, with its position sensor.
fn sampled<N: Reported + 'static>(scene: &Scene) -> Result<Box<dyn Control>>
where
    Controlled<N>: Send,
    Surroundings<N>: Send,
{
    if let Some(named) = scene.environment.as_ref()
        && named.is_more_than_the_wall()
    {
        return surrounded::<N>(scene, count_scale(scene)?);
    }
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
            let sensor = Counts::of(encoder.step_rad(), surface_rad);
            Box::new(Sampled { sensor, wall })
        }
    })
}

fn count_scale(scene: &Scene) -> Result<CountScale> {
    let surface = Si::checked_from_num(scene.wall.surface_rad)
        .ok_or_else(|| scene.error("wall.surface_rad", "too large", "give a value below 2e9"))?;
    // Without an encoder the scale is not used.
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

/// Initial position and velocity of device and hand of a scene.
#[must_use]
pub fn start(scene: &Scene, motion: &RestPath) -> Standing {
    Standing::together(
        scene.start_rad(motion),
        scene.device.initial_velocity_rad_per_s,
    )
}

/// Builds device and hand of a scene, with the initial positions and velocities `from`.
///
/// # Errors
/// A plant that cannot be built, named by its field of the scene.
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
                "only the exact integrator supports friction that differs by direction",
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

/// Asymmetry of the dry friction, N·m; `None` if friction is the same in both directions.
fn asymmetry(scene: &Scene) -> Option<f64> {
    let friction = scene.device.friction.as_ref()?;
    friction.asymmetry_n_m.filter(|bias| *bias != 0.0)
}

/// Builds a plant that a numerical integration method advances, in place of the closed-form solution.
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
    // A delay divides a tick into parts; each gets substeps in proportion to its length.
    let per_s = f64::from(plant.substeps) / scene.timing.period_s();
    let substeps = |interval_s: f64| (interval_s * per_s).round().max(1.0) as u32;
    crossed(
        scene,
        |h| Substepped::<M, N>::new(model, h, substeps(h)),
        state,
    )
}
