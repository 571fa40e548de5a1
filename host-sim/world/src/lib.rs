//! What a control law meets: exact plants of a device and of the hand that holds it, the motor with its bridge, shunts and sensors.
//!
//! Nothing here knows scenes, files or laws: numbers in, numbers out, `nalgebra` at most.

pub mod motor;
pub mod plant;
