//! The electrical side of a simulated knob: a permanent-magnet motor, its bridge and its sensors, coupled to the mechanics of
//! [`crate::plant`].
//!
//! ```text
//! duties -> Bridge -> phase voltages -> Windings -> currents, torque -> plant -> angle -> Windings (back-EMF)
//!                                          |                                 |
//!                                       shunts (codes)                    encoder (frames)
//! ```
//!
//! Each step lasts one PWM period. During a period the bridge is represented by its average voltages, constant in the stator's
//! frame. The shaft's speed is also taken as constant: a trial step gives its mean over the period. With these two assumptions
//! windings and mechanics are linear, and each has a closed-form solution ([`Windings::step`], [`crate::plant::Stepper`]). The
//! remaining error of constant speed and torque falls with the square of the period (a test checks this).
//!
//! Equal inputs give results with equal bits: the module uses no clock and no random numbers.

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
