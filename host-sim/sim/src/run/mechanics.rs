//! Device and hand at one instant, and the loop that carries them on.

use super::chain::{Control, Crossing};
use super::tick::Recorder;
use super::{cycle, cycle_recorded};
use crate::scene::RestPath;
use std::ops::Range;
use touchstone_world::plant::Kinematics as _;

/// The mechanical half of a run, whatever plant it is.
pub trait Mechanics {
    /// Runs the loop over these ticks, and passes each to the recorder, if there is one.
    fn advance(
        &mut self,
        control: &mut dyn Control,
        motion: &RestPath,
        ticks: Range<u64>,
        period_s: f64,
        recorder: Option<&mut dyn Recorder>,
    );

    /// True angle of the device, rad.
    fn angle_rad(&self) -> f64;

    /// Where device and hand are, and how fast they move.
    fn standing(&self) -> Standing;
}

/// Device and hand at one instant; without a hand, its values are the device's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// Angle of the device, rad.
    pub angle_rad: f64,
    /// Velocity of the device, rad/s.
    pub velocity_rad_per_s: f64,
    /// Angle of the hand's mass, rad.
    pub hand_rad: f64,
    /// Velocity of the hand's mass, rad/s.
    pub hand_velocity_rad_per_s: f64,
}

impl Standing {
    /// Device and hand as one, at this angle and velocity.
    #[must_use]
    pub fn together(angle_rad: f64, velocity_rad_per_s: f64) -> Self {
        Self {
            angle_rad,
            velocity_rad_per_s,
            hand_rad: angle_rad,
            hand_velocity_rad_per_s: velocity_rad_per_s,
        }
    }
}

/// A plant behind its crossing, with its state. The loop is compiled once for each.
pub struct Moving<C: Crossing> {
    /// What lies between torque and plant, and the plant.
    pub crossing: C,
    /// Place of the effect in the loop.
    pub state: C::State,
}

impl<C: Crossing> Mechanics for Moving<C> {
    fn advance(
        &mut self,
        control: &mut dyn Control,
        motion: &RestPath,
        ticks: Range<u64>,
        period_s: f64,
        recorder: Option<&mut dyn Recorder>,
    ) {
        let Self { crossing, state } = self;
        let rest_rad = |time_s| motion.rest_rad(time_s);
        *state = match (recorder, motion.still_rad()) {
            (Some(recorder), _) => cycle_recorded(
                crossing, *state, control, rest_rad, ticks, period_s, recorder,
            ),
            // A hand that does not move is not asked where it is.
            (None, Some(still)) => cycle(crossing, *state, control, |_| still, ticks, period_s),
            (None, None) => cycle(crossing, *state, control, rest_rad, ticks, period_s),
        };
    }

    fn angle_rad(&self) -> f64 {
        self.state.position()
    }

    fn standing(&self) -> Standing {
        Standing {
            angle_rad: self.state.position(),
            velocity_rad_per_s: self.state.velocity(),
            hand_rad: self.state.hand_position(),
            hand_velocity_rad_per_s: self.state.hand_velocity(),
        }
    }
}
