//! The world around a control law: exact plants of a device and its hand, the motor with its bridge, shunts and
//! sensors.
//!
//! Nothing here knows scenes, files or laws: numbers in, numbers out, `nalgebra` at most. Equal numbers have equal
//! bits on every machine: transcendental functions are those of `libm`.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod integrator;
pub mod motor;
pub mod plant;
