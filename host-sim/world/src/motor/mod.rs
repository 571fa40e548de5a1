//! The electrical side: a permanent-magnet motor, its bridge and its sensors, coupled to a plant of [`crate::plant`].
//!
//! ```text
//! duties -> Bridge -> phase voltages -> Windings -> currents, torque -> plant -> angle -> Windings (back-EMF)
//!                                          |                                 |
//!                                       shunts (codes)                    encoder (frames)
//! ```
//!
//! Everything goes in steps of one PWM period. During one the bridge is its average, a constant voltage vector that stands
//! still, and the shaft's speed is its mean over the period, looked up ahead. Then windings and plant are both linear and both
//! steps are exact ([`Windings::step`], [`crate::plant::Stepper`]). What is left is the coupling: a constant speed for the windings
//! and a constant torque for the plant, an error that falls with the square of the period (tested).
//!
//! The same inputs give the same bits: there is no clock and no random number in here.

mod bridge;
mod encoder;
mod rig;
mod shunt;
mod windings;

pub use bridge::{Bridge, Drive};
pub use encoder::{as5047p_frame, count, mt6701_frame};
pub use rig::{KNOB, Reading, Rig};
pub use shunt::Shunt;
pub use windings::{GIMBAL, MotorParameters, Windings};
