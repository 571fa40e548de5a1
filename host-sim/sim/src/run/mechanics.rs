//! Position and velocity of device and hand, and the loop that advances them in time.

use super::chain::{Control, Crossing};
use super::tick::Recorder;
use super::{cycle, cycle_recorded};
use crate::scene::RestPath;
use std::ops::Range;
use touchstone_world::plant::Kinematics as _;

/// The mechanical half of a run: device and hand. The trait hides the type of the plant.
pub trait Mechanics: Send {
    /// Simulates the ticks (control periods) of a range, and passes each tick to the recorder, if there is one.
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

    /// Position and velocity of device and hand.
    fn standing(&self) -> Standing;
}

/// Position and velocity of device and hand at one instant. Without a hand, the hand's values are those of the device.
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
    /// Device and hand with the same angle and velocity.
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

/// A plant with its state, behind the delay and jitter of its torque command (crossing). The loop is compiled once for each type of
/// crossing.
pub struct Moving<C: Crossing> {
    /// Delay and jitter of the torque command, and the plant on which the command acts.
    pub crossing: C,
    /// Present state of the plant.
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
            // If the hand does not move, its rest point is not computed again in every tick.
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
