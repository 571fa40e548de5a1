//! Device and hand of a scene without its control law: another program gives the motor's torque for each tick (control period).

use super::chain::{Answer, Control};
use super::mechanics::{Mechanics, Standing};
use super::plan;
use super::tick::{Last, Tick};
use super::wall::Inside;
use crate::error::Result;
use crate::scene::{RestPath, Scene};

/// Device and hand of a scene, with all effects between torque command and motion. With the torques of [`plan::control`] it moves
/// as in [`super::run`], bit for bit.
pub struct PlantHalf {
    mechanics: Box<dyn Mechanics>,
    motion: RestPath,
    period_s: f64,
    next: u64,
    given: Given,
}

impl PlantHalf {
    /// Puts device and hand of a scene at their initial positions.
    ///
    /// # Errors
    /// A recording that cannot be read; a plant that cannot be built.
    pub fn new(scene: &Scene) -> Result<Self> {
        let motion = RestPath::from_scene(scene)?;
        Ok(Self {
            mechanics: plan::mechanics(scene, plan::start(scene, &motion))?,
            motion,
            period_s: scene.timing.period_s(),
            next: 0,
            given: Given {
                torque_n_m: 0.0,
                changed_at_rad: None,
            },
        })
    }

    /// Position and velocity of device and hand.
    #[must_use]
    pub fn standing(&self) -> Standing {
        self.mechanics.standing()
    }

    /// True angle at which the motor's torque changed in the last tick, rad; `None` if the scene's guard does not measure it.
    #[must_use]
    pub fn changed_at_rad(&self) -> Option<f64> {
        self.given.changed_at_rad
    }

    /// Simulates one tick with this torque command. `offset_rad` is added to the rest point of the scene's hand. Of the returned
    /// values, those of the control law are NaN, `None` or false.
    pub fn tick(&mut self, torque_n_m: f64, offset_rad: f64) -> Tick {
        let mut last = Last(None);
        let index = self.next;
        let moved;
        let motion = if offset_rad == 0.0 {
            &self.motion
        } else {
            let rest_rad = self.motion.rest_rad(index as f64 * self.period_s);
            moved = RestPath::still(rest_rad + offset_rad);
            &moved
        };
        self.given.torque_n_m = torque_n_m;
        self.mechanics.advance(
            &mut self.given,
            motion,
            index..index + 1,
            self.period_s,
            Some(&mut last),
        );
        self.next += 1;
        last.0.expect("a range of one tick is one tick")
    }
}

/// Takes the place of the control law: returns the torque that the other program gave.
struct Given {
    torque_n_m: f64,
    changed_at_rad: Option<f64>,
}

impl Control for Given {
    fn torque_n_m(&mut self, _: f64) -> f64 {
        self.torque_n_m
    }

    fn answer(&mut self, _: f64) -> Answer {
        Answer {
            torque_n_m: self.torque_n_m,
            force_n_m: f64::NAN,
            told_rad: f64::NAN,
            inside: Inside {
                energy_j: f64::NAN,
                offset_rad: f64::NAN,
                mass_rad: None,
                guard: None,
                beyond_reach: false,
            },
        }
    }

    fn commanded(&mut self, _: f64) {}

    fn changed_at(&mut self, angle_rad: f64) {
        self.changed_at_rad = Some(angle_rad);
    }
}
