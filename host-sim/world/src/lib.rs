//! What a control law meets: exact plants of a device and of the hand that holds it, the motor with its bridge, shunts and sensors.
//!
//! Nothing here knows scenes, files or laws: numbers in, numbers out, `nalgebra` at most. The same numbers have the same bits on
//! every machine: transcendental functions are those of `libm`.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod integrator;
pub mod motor;
pub mod plant;
