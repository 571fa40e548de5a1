//! A run without an end, whose hand is moved from outside: one rest point a tick.

use super::chain::Control;
use super::mechanics::{Mechanics, Standing};
use super::plan;
use super::tick::{Recorder, Tick};
use crate::error::Result;
use crate::scene::{MotionSpec, Recorded, RestPath, Scene};
use std::path::Path;

/// The loop of a scene, tick by tick. It is the loop of [`super::simulate`], so that the rest points which it was fed, replayed as
/// an exact recording, give the same forces bit for bit.
pub struct Live {
    scene: Scene,
    control: Box<dyn Control>,
    mechanics: Box<dyn Mechanics>,
    start: Standing,
    next: u64,
    energies: Energies,
    stored_j: f64,
}

/// Energies so far, J. All except kinetic energy are sums over ticks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Energies {
    /// Absorbed by the wall's port, true under the zero-order hold.
    pub wall_j: f64,
    /// Dissipated in the device.
    pub device_loss_j: f64,
    /// Energy of the device's motion, and of springs, gravity and magnets in it.
    pub motion_j: f64,
}

impl Energies {
    /// Energy that the hand put into the device: wall, losses and motion; negative where it got more out.
    #[must_use]
    pub fn hand_j(&self) -> f64 {
        self.wall_j + self.device_loss_j + self.motion_j
    }
}

/// A tick, and the energies up to its sample; what moves in the tick itself comes after it.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// The tick.
    pub tick: Tick,
    /// The energies before it.
    pub energies: Energies,
}

/// Takes the one tick.
struct Last(Option<Tick>);

impl Recorder for Last {
    fn record(&mut self, tick: &Tick) {
        self.0 = Some(*tick);
    }
}

impl Live {
    /// A scene's loop at its start. Its motion and its duration are of no account.
    ///
    /// # Errors
    /// Settings that the law or its number format cannot take; a plant that cannot be built.
    pub fn new(scene: &Scene) -> Result<Self> {
        // The hand waits where it would without a motion, so a recording is not looked for.
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

    /// Another scene's loop from where device and hand of this one are: a law without a memory, no command on its way, accounts
    /// and time from 0.
    ///
    /// # Errors
    /// Same as [`Live::new`].
    pub fn changed(&self, scene: &Scene) -> Result<Self> {
        let mut still = scene.clone();
        still.operator.motion = MotionSpec::None;
        Self::from(still, self.mechanics.standing())
    }

    /// The scene that is running, without a motion.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Angle of the device now, rad.
    #[must_use]
    pub fn angle_rad(&self) -> f64 {
        self.mechanics.angle_rad()
    }

    /// Ticks done.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.next
    }

    /// Runs one tick with the hand's rest point here, rad.
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

    /// The scene that repeats these ticks from a file of their rest points (columns `time_s` and `rest_rad`, and `force_n_m` as in
    /// all files of this program). A loop that was [changed](Live::changed) started from a hand and a device
    /// apart, which no scene can say: start anew before a recording.
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
