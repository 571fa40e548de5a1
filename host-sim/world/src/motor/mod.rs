//! The electrical side of a simulated knob: a permanent-magnet motor, its bridge and its sensors, coupled to the mechanics of
//! [`crate::plant`].
//!
//! ```text
//! duties -> Bridge -> phase voltages -> Windings -> currents, torque -> plant -> angle -> Windings (back-EMF)
//!                                          |                                 |
//!                                       shunts (codes)                    encoder (frames)
//! ```
//!
//! All steps are one PWM period long. During a period the bridge gives its average, a constant voltage vector in the stationary
//! frame. The shaft's speed is taken as constant too: its mean over the period, from a trial step. With these two assumptions
//! windings and mechanics are linear and their steps exact ([`Windings::step`], [`crate::plant::Stepper`]). The remaining error
//! comes from constant speed and constant torque within a period; it falls with the square of the period (a test checks it).
//!
//! Equal inputs give results with equal bits: this module has no clock and no random number.

mod bridge;
mod encoder;
mod rig;
mod shunt;
mod windings;

pub use bridge::{Bridge, Drive};
pub use encoder::{as5047p_frame, count, mt6701_frame};
pub use rig::{KNOB, Reading, Rig, Wires};
pub use shunt::Shunt;
pub use windings::{GIMBAL, MotorParameters, Windings};
