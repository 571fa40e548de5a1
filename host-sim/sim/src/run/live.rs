//! A simulation that runs until the caller stops it: the caller gives the hand's rest point for each tick (control period).

use super::chain::Control;
use super::mechanics::{Mechanics, Standing};
use super::plan;
use super::tick::{Last, Tick};
use crate::error::Result;
use crate::scene::{MotionSpec, Recorded, RestPath, Scene};
use std::path::Path;

/// Runs the control loop of a scene tick by tick (per control period). It computes the same loop as [`super::simulate`]: a replay
/// of the recorded rest points gives the same forces bit for bit, unless [`Live::changed`] started the loop.
pub struct Live {
    scene: Scene,
    control: Box<dyn Control>,
    mechanics: Box<dyn Mechanics>,
    start: Standing,
    next: u64,
    energies: Energies,
    stored_j: f64,
}

/// Energies of a run from its start to the present tick, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Energies {
    /// Energy that the wall absorbed, J, exact for a force held over each tick (control period).
    pub wall_j: f64,
    /// Energy dissipated in the device, J.
    pub device_loss_j: f64,
    /// Kinetic energy of the device and energy stored in its springs, gravity and magnets, as the change since the start, J.
    pub motion_j: f64,
}

impl Energies {
    /// Energy that the hand put into the device, J: the sum of the three fields. Negative if the hand got more energy out than it
    /// put in.
    #[must_use]
    pub fn hand_j(&self) -> f64 {
        self.wall_j + self.device_loss_j + self.motion_j
    }
}

/// Result of one tick (control period), and the energies up to the position sample with which the tick starts.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// Values of the simulated tick.
    pub tick: Tick,
    /// Energies at the start of the tick.
    pub energies: Energies,
}

impl Live {
    /// Starts the loop of a scene. The scene's hand motion and duration are ignored.
    ///
    /// # Errors
    /// Settings that the control law or its number format cannot represent; a plant that cannot be built.
    pub fn new(scene: &Scene) -> Result<Self> {
        // The hand starts where a hand without a motion rests, so the scene's recording is not read.
        let mut still = scene.clone();
        still.operator.motion = MotionSpec::None;
        let motion = RestPath::from_scene(&still)?;
        Self::from(still, plan::start(scene, &motion))
    }

    fn from(scene: Scene, start: Standing) -> Result<Self> {
        Ok(Self {
            control: plan::control(&scene)?,
            mechanics: plan::mechanics(&scene, start)?,
            scene,
            start,
            next: 0,
            energies: Energies::default(),
            stored_j: 0.0,
        })
    }

    /// Starts the loop of another scene from the present position and velocity of device and hand. The control law, the queue of
    /// delayed commands, energies and time are reset.
    ///
    /// # Errors
    /// Same as [`Live::new`].
    pub fn changed(&self, scene: &Scene) -> Result<Self> {
        let mut still = scene.clone();
        still.operator.motion = MotionSpec::None;
        Self::from(still, self.mechanics.standing())
    }

    /// The running scene, without the motion of its hand.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Present angle of the device, rad.
    #[must_use]
    pub fn angle_rad(&self) -> f64 {
        self.mechanics.angle_rad()
    }

    /// Number of ticks (control periods) simulated so far.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.next
    }

    /// Runs one tick with the hand's rest point at `rest_rad`.
    pub fn tick(&mut self, rest_rad: f64) -> Moment {
        let mut last = Last(None);
        self.mechanics.advance(
            self.control.as_mut(),
            &RestPath::still(rest_rad),
            self.next..self.next + 1,
            self.scene.timing.period_s(),
            Some(&mut last),
        );
        self.next += 1;
        let tick = last.0.expect("a range of one tick is one tick");
        let energies = self.energies;
        let half_j = 0.5 * self.scene.device.inertia_kg_m2;
        let kinetic_j = |velocity: f64| half_j * velocity * velocity;
        self.energies.wall_j += tick.absorbed_j;
        self.energies.device_loss_j += tick.device_loss_j;
        self.stored_j += tick.stored_j;
        self.energies.motion_j = kinetic_j(tick.velocity_after_rad_per_s)
            - kinetic_j(self.start.velocity_rad_per_s)
            + self.stored_j;
        Moment { tick, energies }
    }

    /// Makes a scene that repeats the ticks of this loop from a file of rest points (columns `time_s`, `rest_rad` and `force_n_m`).
    ///
    /// A loop that [`Live::changed`] started cannot be replayed exactly: it may start with the hand at another angle than the
    /// device, which a scene cannot express. Start a new loop before a recording.
    #[must_use]
    pub fn replay(&self, file: &Path) -> Scene {
        let mut scene = self.scene.clone();
        scene.timing.duration_s = self.next.max(1) as f64 * scene.timing.period_s();
        scene.device.initial_angle_rad = Some(self.start.angle_rad);
        scene.device.initial_velocity_rad_per_s = self.start.velocity_rad_per_s;
        if scene.operator.hand().is_some() {
            scene.operator.motion = MotionSpec::Recorded(Recorded {
                exact: true,
                ..Recorded::new(file.to_owned())
            });
        }
        scene
    }
}
